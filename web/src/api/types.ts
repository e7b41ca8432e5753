/** The bodies of the API by the names this console uses, taken from the generated schema by path. */
import type { paths } from "../client/schema";

type Answer<Operation> = Operation extends { responses: infer Responses }
  ? Extract<Responses[keyof Responses & (200 | 201 | 202)], { content: unknown }> extends { content: { "application/json": infer Body } }
    ? Body
    : never
  : never;
type Request<Operation> = Operation extends { requestBody: { content: { "application/json": infer Body } } } ? Body : never;

export type MissionSnapshot = Answer<paths["/api/v1/mission"]["get"]>;
export type Session = Answer<paths["/api/v1/session"]["get"]>;
export type Role = NonNullable<Session["role"]>;
export type Health = Answer<paths["/api/v1/health"]["get"]>;
export type CommandRequest = Request<paths["/api/v1/mission/commands"]["post"]>;
export type CommandAnswer = Answer<paths["/api/v1/mission/commands"]["post"]>;
export type ArmingRequest = Request<paths["/api/v1/mission/arming"]["post"]>;
export type Arming = Answer<paths["/api/v1/mission/arming"]["post"]>;
export type Armed = NonNullable<MissionSnapshot["armed"]>;
export type MissionConfiguration = Answer<paths["/api/v1/mission/config"]["get"]>;
export type ConfigurationSchema = Answer<paths["/api/v1/mission/config/schema"]["get"]>;
export type NamedConfiguration = Answer<paths["/api/v1/configurations"]["get"]>[number];
export type SceneView = Answer<paths["/api/v1/scene"]["get"]>;
export type SceneChange = Request<paths["/api/v1/scene"]["patch"]>;
export type FuturesChoice = Request<paths["/api/v1/scene/futures"]["put"]>;
export type History = Answer<paths["/api/v1/mission/history"]["get"]>;
export type HistoryColumn = History["columns"][number];
export type MissionEvent = Answer<paths["/api/v1/runs/{run_id}/events"]["get"]>[number];

export type Control = MissionSnapshot["control"];
export type ControlStatus = Answer<paths["/api/v1/mission/control"]["get"]>;
export type ControlRequest = Request<paths["/api/v1/mission/control"]["post"]>;
export type Preset = Answer<paths["/api/v1/presets"]["get"]>[number];
export type PresetBody = Request<paths["/api/v1/presets/{name}"]["put"]>;
export type Parameter = ConfigurationSchema["parameters"][number];
export type Outcome = NonNullable<MissionSnapshot["outcome"]>;
export type Touch = MissionSnapshot["contacts"][number];
export type Problem = MissionSnapshot["problems"][number];
export type Command = CommandRequest["command"];
export type Severity = MissionEvent["severity"];

export type Alarm = Answer<paths["/api/v1/alarms"]["get"]>[number];
export type AlarmRecord = Answer<paths["/api/v1/alarms/history"]["get"]>[number];
export type WatchedSignal = Answer<paths["/api/v1/alarms/limits"]["get"]>[number];
export type Limits = WatchedSignal["limits"];
export type ShiftEntry = Answer<paths["/api/v1/shift-log"]["get"]>[number];
export type LinkStatus = Answer<paths["/api/v1/link"]["get"]>;
export type StreamStatus = LinkStatus["streams"][number];
export type Tared = Answer<paths["/api/v1/link/tare"]["post"]>;

export type StudyPage = Answer<paths["/api/v1/studies"]["get"]>;
export type StudySummary = StudyPage["studies"][number];
export type StudyDetail = Answer<paths["/api/v1/studies/{study_id}"]["get"]>;
export type StudyRequest = Request<paths["/api/v1/studies"]["post"]>;
export type StudyEstimate = Answer<paths["/api/v1/studies/estimate"]["post"]>;
export type StudyRowPage = Answer<paths["/api/v1/studies/{study_id}/rows"]["get"]>;
export type StudyRow = StudyRowPage["rows"][number];
export type PublishedTables = Answer<paths["/api/v1/studies/published/tables"]["get"]>;
export type RunPage = Answer<paths["/api/v1/runs"]["get"]>;
export type RunSummary = RunPage["runs"][number];
export type RunsQuery = NonNullable<paths["/api/v1/runs"]["get"]["parameters"]["query"]>;
export type RemarksChange = Request<paths["/api/v1/runs/{run_id}"]["patch"]>;
export type Run = Answer<paths["/api/v1/runs/{run_id}"]["get"]>;

export type RehearsalRequest = Request<paths["/api/v1/rehearsals"]["post"]>;
export type RehearsalDetail = Answer<paths["/api/v1/rehearsals"]["post"]>;
export type RehearsalResult = NonNullable<RehearsalDetail["result"]>;
export type RehearsalCase = RehearsalResult["as_it_is"];
export type FitRequest = Request<paths["/api/v1/fits"]["post"]>;
export type FitDetail = Answer<paths["/api/v1/fits"]["post"]>;
export type FitResult = NonNullable<FitDetail["result"]>;
export type FittableParameter = Answer<paths["/api/v1/fits/parameters"]["get"]>[number];
export type Odds = RehearsalCase["caged"];
export type Band = RehearsalCase["bands"][number];
export type Decider = RehearsalCase["deciding"][number];
export type Fan = RehearsalCase["fans"][number];
export type UncertaintyField = Answer<paths["/api/v1/rehearsals/uncertainty"]["get"]>["fields"][number];
export type LookAhead = Answer<paths["/api/v1/rehearsals/look-ahead"]["get"]>;
export type AtlasRequest = Request<paths["/api/v1/atlases"]["post"]>;
export type AtlasDetail = Answer<paths["/api/v1/atlases"]["post"]>;
export type AtlasCell = AtlasDetail["cells"][number];
