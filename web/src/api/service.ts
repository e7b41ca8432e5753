/** Every request that the console makes of the service; each returns the body or throws a `Refusal`. */
import createClient from "openapi-fetch";
import type { paths } from "../client/schema";
import { HERE, addressOf } from "./address";
import { patience } from "../stop/patience";
import { noAnswer, refusalOf } from "./refusal";
import type {
  Alarm,
  AlarmRecord,
  Arming,
  ArmingRequest,
  AtlasDetail,
  AtlasRequest,
  CommandAnswer,
  CommandRequest,
  ConfigurationSchema,
  ControlRequest,
  ControlStatus,
  FitDetail,
  FitRequest,
  FittableParameter,
  FuturesChoice,
  Health,
  History,
  HistoryColumn,
  Limits,
  LinkStatus,
  LookAhead,
  MissionConfiguration,
  MissionEvent,
  NamedConfiguration,
  Preset,
  PresetBody,
  PublishedTables,
  RehearsalDetail,
  RehearsalRequest,
  RehearsalResult,
  RemarksChange,
  Run,
  RunPage,
  RunsQuery,
  SceneChange,
  SceneView,
  Session,
  ShiftEntry,
  StudyDetail,
  StudyEstimate,
  StudyPage,
  StudyRequest,
  StudyRowPage,
  Tared,
  UncertaintyField,
  WatchedSignal,
} from "./types";

const client = createClient<paths>({ baseUrl: HERE });

const ANSWER_TIME = 5000;

interface Reply<Body> {
  readonly data?: Body | undefined;
  readonly error?: unknown;
  readonly response: Response;
}

async function bodyOf<Body>(reply: Promise<Reply<Body>>): Promise<Body> {
  const { data, error, response } = await reply.catch((cause: unknown) => {
    throw noAnswer(cause);
  });
  if (!response.ok || data === undefined) throw refusalOf(response.status, error);
  return data;
}

/** For answers without a body. */
async function nothingOf(reply: Promise<Reply<unknown>>): Promise<null> {
  const { error, response } = await reply.catch((cause: unknown) => {
    throw noAnswer(cause);
  });
  if (!response.ok) throw refusalOf(response.status, error);
  return null;
}

const within = (milliseconds: number) => ({ signal: patience(milliseconds) });

export const readSession = (): Promise<Session> => bodyOf(client.GET("/api/v1/session", within(ANSWER_TIME)));

export const signIn = (token: string): Promise<Session> =>
  bodyOf(client.POST("/api/v1/session", { body: { token }, ...within(ANSWER_TIME) }));

export const signOut = (): Promise<null> => nothingOf(client.DELETE("/api/v1/session", within(ANSWER_TIME)));

export const readHealth = (): Promise<Health> => bodyOf(client.GET("/api/v1/health", within(2000)));

/** A fork is flown again from its start, and a very large study in part, before the service answers. */
const LONG_ANSWER_TIME = 120_000;

export const sendCommand = (request: CommandRequest): Promise<CommandAnswer> =>
  bodyOf(
    client.POST("/api/v1/mission/commands", {
      body: request,
      ...within(request.command === "fork" ? LONG_ANSWER_TIME : ANSWER_TIME),
    }),
  );

/** What moves a robot, or takes it over again, is refused without the token that this gives. */
export const armCommand = (request: ArmingRequest): Promise<Arming> =>
  bodyOf(client.POST("/api/v1/mission/arming", { body: request, ...within(ANSWER_TIME) }));

export const readControl = (): Promise<ControlStatus> => bodyOf(client.GET("/api/v1/mission/control", within(ANSWER_TIME)));

export const changeControl = (body: ControlRequest): Promise<CommandAnswer> =>
  bodyOf(client.POST("/api/v1/mission/control", { body, ...within(ANSWER_TIME) }));

export const readAlarmHistory = (): Promise<AlarmRecord[]> =>
  bodyOf(client.GET("/api/v1/alarms/history", { params: { query: { limit: 300 } }, ...within(ANSWER_TIME) }));

/** One alarm has been seen; null: all. */
export const acknowledgeAlarm = (alarm: string | null): Promise<Alarm[]> =>
  bodyOf(client.POST("/api/v1/alarms/acknowledge", { body: { alarm }, ...within(ANSWER_TIME) }));

export const shelveAlarm = (alarm: string, minutes: number): Promise<Alarm[]> =>
  bodyOf(client.POST("/api/v1/alarms/shelve", { body: { alarm, minutes }, ...within(ANSWER_TIME) }));

export const unshelveAlarm = (alarm: string): Promise<Alarm[]> =>
  bodyOf(client.POST("/api/v1/alarms/unshelve", { body: { alarm }, ...within(ANSWER_TIME) }));

export const readLimits = (): Promise<WatchedSignal[]> => bodyOf(client.GET("/api/v1/alarms/limits", within(ANSWER_TIME)));

export const chooseLimits = (signal: string, body: Limits): Promise<WatchedSignal> =>
  bodyOf(client.PUT("/api/v1/alarms/limits/{signal}", { params: { path: { signal } }, body, ...within(ANSWER_TIME) }));

export const forgetLimits = (signal: string): Promise<null> =>
  nothingOf(client.DELETE("/api/v1/alarms/limits/{signal}", { params: { path: { signal } }, ...within(ANSWER_TIME) }));

export const readShiftLog = (): Promise<ShiftEntry[]> =>
  bodyOf(client.GET("/api/v1/shift-log", { params: { query: { limit: 300 } }, ...within(ANSWER_TIME) }));

export const noteShift = (text: string): Promise<ShiftEntry> => bodyOf(client.POST("/api/v1/shift-log", { body: { text }, ...within(ANSWER_TIME) }));

export const readLink = (): Promise<LinkStatus> => bodyOf(client.GET("/api/v1/link", within(2000)));

/** What both wrists of the robot read now counts as zero. */
export const tareWrists = (): Promise<Tared> => bodyOf(client.POST("/api/v1/link/tare", within(ANSWER_TIME)));

export const readConfiguration = (): Promise<MissionConfiguration> =>
  bodyOf(client.GET("/api/v1/mission/config", within(ANSWER_TIME)));

export const changeConfiguration = (changes: Record<string, unknown>, arming: string | null = null): Promise<MissionConfiguration> =>
  bodyOf(
    client.PATCH("/api/v1/mission/config", {
      body: changes,
      params: { header: { "becalm-arming": arming } },
      ...within(ANSWER_TIME),
    }),
  );

export const readConfigurationSchema = (): Promise<ConfigurationSchema> =>
  bodyOf(client.GET("/api/v1/mission/config/schema", within(ANSWER_TIME)));

export const readNamedConfigurations = (): Promise<NamedConfiguration[]> =>
  bodyOf(client.GET("/api/v1/configurations", within(ANSWER_TIME)));

export const readPresets = (): Promise<Preset[]> => bodyOf(client.GET("/api/v1/presets", within(ANSWER_TIME)));

export const keepPreset = (name: string, body: PresetBody): Promise<Preset> =>
  bodyOf(client.PUT("/api/v1/presets/{name}", { params: { path: { name } }, body, ...within(ANSWER_TIME) }));

export const removePreset = (name: string): Promise<null> =>
  nothingOf(client.DELETE("/api/v1/presets/{name}", { params: { path: { name } }, ...within(ANSWER_TIME) }));

export const readScene = (): Promise<SceneView> => bodyOf(client.GET("/api/v1/scene", within(ANSWER_TIME)));

export const changeScene = (change: SceneChange): Promise<SceneView> =>
  bodyOf(client.PATCH("/api/v1/scene", { body: change, ...within(ANSWER_TIME) }));

export const drawFutures = async (choice: FuturesChoice): Promise<void> => {
  await nothingOf(client.PUT("/api/v1/scene/futures", { body: choice, ...within(ANSWER_TIME) }));
};

export const eraseFutures = async (): Promise<void> => {
  await nothingOf(client.DELETE("/api/v1/scene/futures", within(ANSWER_TIME)));
};

export const readHistory = (since: number): Promise<History> =>
  bodyOf(client.GET("/api/v1/mission/history", { params: { query: { since } }, ...within(ANSWER_TIME) }));

export const readEvents = (id: string): Promise<MissionEvent[]> =>
  bodyOf(client.GET("/api/v1/runs/{run_id}/events", { params: { path: { run_id: id } }, ...within(ANSWER_TIME) }));

/** What was foreseen of it when its sequence began; null if nothing was. */
export const readForeseen = (id: string): Promise<RehearsalResult | null> =>
  bodyOf(client.GET("/api/v1/runs/{run_id}/foreseen", { params: { path: { run_id: id } }, ...within(ANSWER_TIME) }));

export interface Tagged<Body> {
  readonly body: Body;
  /** Names this very answer: an `ETag`. */
  readonly tag: string | null;
}

/** @param known the tag of the answer that is there already; null is answered while it is still right. */
export async function listRuns(query: RunsQuery, known: string | null): Promise<Tagged<RunPage> | null> {
  let response: Response | undefined;
  const header = known === null ? {} : { "If-None-Match": known };
  const reply = client.GET("/api/v1/runs", { params: { query, header }, ...within(ANSWER_TIME) }).then((answer) => {
    response = answer.response;
    return answer;
  });
  try {
    const body = await bodyOf(reply);
    return { body, tag: response?.headers.get("ETag") ?? null };
  } catch (cause) {
    if (response?.status === 304) return null;
    throw cause;
  }
}

export const readRun = (id: string): Promise<Run> =>
  bodyOf(client.GET("/api/v1/runs/{run_id}", { params: { path: { run_id: id } }, ...within(ANSWER_TIME) }));

/** The run, or a stretch of it in seconds, in at most so many rows, the extremes of every piece of time among them. */
export const readTicks = (id: string, points: number, stretch?: { readonly from: number; readonly to: number }): Promise<History> =>
  bodyOf(
    client.GET("/api/v1/runs/{run_id}/ticks", {
      params: { path: { run_id: id }, query: { points, ...stretch } },
      ...within(30_000),
    }),
  );

/** What may be asked of its samples. */
export const readColumns = (id: string): Promise<HistoryColumn[]> =>
  bodyOf(client.GET("/api/v1/runs/{run_id}/columns", { params: { path: { run_id: id } }, ...within(ANSWER_TIME) }));

/** Those columns at every tick, or every n-th of a long run. */
export const readSamples = (id: string, columns: readonly string[]): Promise<History> =>
  bodyOf(
    client.GET("/api/v1/runs/{run_id}/samples", {
      params: { path: { run_id: id }, query: { columns: columns.join(",") } },
      ...within(30_000),
    }),
  );

export const remarkRun = (id: string, change: RemarksChange): Promise<Run> =>
  bodyOf(client.PATCH("/api/v1/runs/{run_id}", { params: { path: { run_id: id } }, body: change, ...within(ANSWER_TIME) }));

export const cancelRun = (id: string): Promise<Run> =>
  bodyOf(client.POST("/api/v1/runs/{run_id}/cancel", { params: { path: { run_id: id } }, ...within(ANSWER_TIME) }));

export const deleteRun = (id: string): Promise<null> =>
  nothingOf(client.DELETE("/api/v1/runs/{run_id}", { params: { path: { run_id: id } }, ...within(ANSWER_TIME) }));

/** Where a browser downloads the log of a run, also of one in progress. */
export const logAddress = (id: string, format: "csv" | "parquet" | "mcap"): string =>
  addressOf(`/api/v1/runs/${encodeURIComponent(id)}/log?format=${format}`);

/** Where a browser downloads the report of a run. */
export const runReportAddress = (id: string, format: "html" | "pdf"): string =>
  addressOf(`/api/v1/runs/${encodeURIComponent(id)}/report?format=${format}`);

/** Where it downloads that of a study. */
export const studyReportAddress = (id: string, format: "html" | "pdf"): string =>
  addressOf(`/api/v1/studies/${encodeURIComponent(id)}/report?format=${format}`);

export const listStudies = (): Promise<StudyPage> =>
  bodyOf(client.GET("/api/v1/studies", { params: { query: { limit: 100 } }, ...within(ANSWER_TIME) }));

export const readStudy = (id: string): Promise<StudyDetail> =>
  bodyOf(client.GET("/api/v1/studies/{study_id}", { params: { path: { study_id: id } }, ...within(ANSWER_TIME) }));

/** Rows that came after the row `after`, in the order in which their cells ended. */
export const readRows = (id: string, after: number): Promise<StudyRowPage> =>
  bodyOf(
    client.GET("/api/v1/studies/{study_id}/rows", {
      params: { path: { study_id: id }, query: { after } },
      ...within(ANSWER_TIME),
    }),
  );

export const startStudy = (request: StudyRequest): Promise<StudyDetail> =>
  bodyOf(client.POST("/api/v1/studies", { body: request, ...within(LONG_ANSWER_TIME) }));

/** How many cells a study has, and how long it would take; nothing is started. */
export const estimateStudy = (request: StudyRequest): Promise<StudyEstimate> =>
  bodyOf(client.POST("/api/v1/studies/estimate", { body: request, ...within(ANSWER_TIME) }));

export const cancelStudy = (id: string): Promise<StudyDetail> =>
  bodyOf(client.POST("/api/v1/studies/{study_id}/cancel", { params: { path: { study_id: id } }, ...within(ANSWER_TIME) }));

export const resumeStudy = (id: string): Promise<StudyDetail> =>
  bodyOf(client.POST("/api/v1/studies/{study_id}/resume", { params: { path: { study_id: id } }, ...within(ANSWER_TIME) }));

export const deleteStudy = (id: string): Promise<null> =>
  nothingOf(client.DELETE("/api/v1/studies/{study_id}", { params: { path: { study_id: id } }, ...within(ANSWER_TIME) }));

/** Flies one cell again as a run of the library. */
export const runCell = (id: string, index: number): Promise<Run> =>
  bodyOf(
    client.POST("/api/v1/studies/{study_id}/cells/{index}/run", {
      params: { path: { study_id: id, index } },
      ...within(ANSWER_TIME),
    }),
  );

export const readPublishedTables = (): Promise<PublishedTables> =>
  bodyOf(client.GET("/api/v1/studies/published/tables", within(ANSWER_TIME)));

/** Where a browser downloads the table of a study, also of one that flies. */
export const resultsAddress = (id: string, format: "csv" | "parquet" | "json"): string =>
  addressOf(`/api/v1/studies/${encodeURIComponent(id)}/results?format=${format}`);

/** Until the futures of a state are planned: a service that is busy takes a while. */
const PLANNING_TIME = 15_000;

export const startRehearsal = (request: RehearsalRequest): Promise<RehearsalDetail> =>
  bodyOf(client.POST("/api/v1/rehearsals", { body: request, ...within(PLANNING_TIME) }));

/** With its result once it has finished: half a megabyte. */
export const readRehearsal = (id: string): Promise<RehearsalDetail> =>
  bodyOf(client.GET("/api/v1/rehearsals/{rehearsal_id}", { params: { path: { rehearsal_id: id } }, ...within(PLANNING_TIME) }));

export const cancelRehearsal = (id: string): Promise<RehearsalDetail> =>
  bodyOf(client.POST("/api/v1/rehearsals/{rehearsal_id}/cancel", { params: { path: { rehearsal_id: id } }, ...within(ANSWER_TIME) }));

/** Flies one future again as a run of the library. */
export const runFuture = (id: string, future: number, of: "as_it_is" | "as_changed"): Promise<Run> =>
  bodyOf(
    client.POST("/api/v1/rehearsals/{rehearsal_id}/futures/{future}/run", {
      params: { path: { rehearsal_id: id, future }, query: { case: of } },
      ...within(PLANNING_TIME),
    }),
  );

/** Where a browser downloads what the futures of a rehearsal say. */
export const rehearsalAddress = (id: string, format: "json" | "parquet"): string =>
  addressOf(`/api/v1/rehearsals/${encodeURIComponent(id)}/result?format=${format}`);

export const readFittable = (): Promise<FittableParameter[]> => bodyOf(client.GET("/api/v1/fits/parameters", within(ANSWER_TIME)));

export const startFit = (request: FitRequest): Promise<FitDetail> => bodyOf(client.POST("/api/v1/fits", { body: request, ...within(PLANNING_TIME) }));

/** With its result once it has finished: some hundred kilobytes. */
export const readFit = (id: string): Promise<FitDetail> =>
  bodyOf(client.GET("/api/v1/fits/{fit_id}", { params: { path: { fit_id: id } }, ...within(PLANNING_TIME) }));

export const cancelFit = (id: string): Promise<FitDetail> =>
  bodyOf(client.POST("/api/v1/fits/{fit_id}/cancel", { params: { path: { fit_id: id } }, ...within(ANSWER_TIME) }));

export const keepFit = (id: string, name: string): Promise<Preset> =>
  bodyOf(client.POST("/api/v1/fits/{fit_id}/preset", { params: { path: { fit_id: id } }, body: { name }, ...within(ANSWER_TIME) }));

/** Where a browser downloads the report of a fit. */
export const fitAddress = (id: string, format: "json" | "html" | "pdf"): string =>
  addressOf(`/api/v1/fits/${encodeURIComponent(id)}/report?format=${format}`);

export const readUncertainty = async (): Promise<UncertaintyField[]> =>
  (await bodyOf(client.GET("/api/v1/rehearsals/uncertainty", within(ANSWER_TIME)))).fields;

/** Asking is looking: the service flies the next request's futures while somebody asks. */
export const readLookAhead = (): Promise<LookAhead> => bodyOf(client.GET("/api/v1/rehearsals/look-ahead", within(ANSWER_TIME)));

export const startAtlas = (request: AtlasRequest): Promise<AtlasDetail> =>
  bodyOf(client.POST("/api/v1/atlases", { body: request, ...within(PLANNING_TIME) }));

/** With the cells that came after that revision. */
export const readAtlas = (id: string, after: number): Promise<AtlasDetail> =>
  bodyOf(client.GET("/api/v1/atlases/{atlas_id}", { params: { path: { atlas_id: id }, query: { after } }, ...within(ANSWER_TIME) }));

export const cancelAtlas = (id: string): Promise<AtlasDetail> =>
  bodyOf(client.POST("/api/v1/atlases/{atlas_id}/cancel", { params: { path: { atlas_id: id } }, ...within(ANSWER_TIME) }));

/** Flies one future of a cell again as a run of the library. */
export const runAtlasFuture = (id: string, x: number, y: number, future: number): Promise<Run> =>
  bodyOf(
    client.POST("/api/v1/atlases/{atlas_id}/cells/{x}/{y}/run", {
      params: { path: { atlas_id: id, x, y }, query: { future } },
      ...within(PLANNING_TIME),
    }),
  );
