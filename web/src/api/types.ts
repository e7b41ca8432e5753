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
export type History = Answer<paths["/api/v1/mission/history"]["get"]>;
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
