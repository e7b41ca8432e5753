/** The bodies of the API by the names this console uses, taken from the generated schema by path. */
import type { paths } from "../client/schema";

type Answer<Operation> = Operation extends { responses: { 200: { content: { "application/json": infer Body } } } } ? Body : never;
type Request<Operation> = Operation extends { requestBody: { content: { "application/json": infer Body } } } ? Body : never;

export type MissionSnapshot = Answer<paths["/api/v1/mission"]["get"]>;
export type Health = Answer<paths["/api/v1/health"]["get"]>;
export type CommandRequest = Request<paths["/api/v1/mission/commands"]["post"]>;
export type CommandAnswer = Answer<paths["/api/v1/mission/commands"]["post"]>;
export type MissionConfiguration = Answer<paths["/api/v1/mission/config"]["get"]>;
export type ConfigurationSchema = Answer<paths["/api/v1/mission/config/schema"]["get"]>;
export type NamedConfiguration = Answer<paths["/api/v1/configurations"]["get"]>[number];
export type History = Answer<paths["/api/v1/mission/history"]["get"]>;
export type MissionEvent = Answer<paths["/api/v1/runs/{run_id}/events"]["get"]>[number];

export type Parameter = ConfigurationSchema["parameters"][number];
export type Outcome = NonNullable<MissionSnapshot["outcome"]>;
export type Touch = MissionSnapshot["contacts"][number];
export type Problem = MissionSnapshot["problems"][number];
export type Command = CommandRequest["command"];
export type Severity = MissionEvent["severity"];
