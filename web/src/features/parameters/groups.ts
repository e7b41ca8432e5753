/** The groups of the form: in which order they stand, which is open, and whose they are. */
import type { Parameter } from "../../api/types";

export interface ParameterGroup {
  readonly group: string;
  readonly title: string;
  readonly members: readonly Parameter[];
  /** The method that they belong to, if it is another than the configured one: they change nothing then. */
  readonly idleMethod: string | null;
  /** Whether it is the first of that method's. */
  readonly begins: boolean;
}

/** The method whose parameters these are, if they are of one. */
const methodOf = (group: string, methods: readonly string[]): string | null => methods.find((method) => group === method || group.startsWith(`${method}.`)) ?? null;

/**
 * The configured method's groups first, then those that may change while the mission flies; other methods' last.
 *
 * The service's order holds otherwise.
 */
export function groupsOf(shown: readonly Parameter[], methods: readonly string[], configured: string): ParameterGroup[] {
  const groups = new Map<string, Parameter[]>();
  for (const parameter of shown) groups.set(parameter.group, [...(groups.get(parameter.group) ?? []), parameter]);
  const rank = (group: string, members: readonly Parameter[]): number => {
    const method = methodOf(group, methods);
    if (method !== null) return method === configured ? 0 : 3;
    return members.some(({ live }) => live) ? 1 : 2;
  };
  const ranked = [...groups].sort(([one, its], [other, others]) => rank(one, its) - rank(other, others));
  const idle = ranked.map(([group]) => methodOf(group, methods)).map((method) => (method === configured ? null : method));
  return ranked.map(([group, members], place) => {
    const idleMethod = idle[place] ?? null;
    return { group, title: members[0]?.group_title ?? group, members, idleMethod, begins: idleMethod !== (idle[place - 1] ?? null) };
  });
}
