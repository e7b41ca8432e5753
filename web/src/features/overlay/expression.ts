/**
 * Expressions over columns of the log, as people type them: `left.hand_force - right.hand_force`,
 * `hypot(target.twist.x, target.twist.y)`. A column is named as in docs/logs.md; numbers, + - * / ^ and functions go
 * with it. Units are carried along where they are sure.
 */

/** Reads a column by its name; NaN where nothing was recorded. */
export type Column = (name: string) => number;

export interface Expression {
  readonly of: (column: Column) => number;
  /** The columns that it reads, each once. */
  readonly columns: readonly string[];
  /** SI; null where it is not known, such as that of a product. */
  readonly unit: string | null;
}

export interface Fault {
  readonly fault: string;
}

interface Part {
  readonly of: (column: Column) => number;
  readonly unit: string | null;
}

const NUMBER = "1";

interface Known {
  readonly count: number | null;
  readonly of: (...values: number[]) => number;
  /** Whether the result has the unit that all arguments have. */
  readonly keepsUnit: boolean;
}

const DEGREES = 180 / Math.PI;

const FUNCTIONS: ReadonlyMap<string, Known> = new Map(Object.entries({
  abs: { count: 1, of: Math.abs, keepsUnit: true },
  sqrt: { count: 1, of: Math.sqrt, keepsUnit: false },
  exp: { count: 1, of: Math.exp, keepsUnit: false },
  log: { count: 1, of: Math.log, keepsUnit: false },
  sin: { count: 1, of: Math.sin, keepsUnit: false },
  cos: { count: 1, of: Math.cos, keepsUnit: false },
  atan2: { count: 2, of: Math.atan2, keepsUnit: false },
  degrees: { count: 1, of: (value) => value * DEGREES, keepsUnit: false },
  hypot: { count: null, of: Math.hypot, keepsUnit: true },
  min: { count: null, of: Math.min, keepsUnit: true },
  max: { count: null, of: Math.max, keepsUnit: true },
}));

export const FUNCTION_NAMES: readonly string[] = [...FUNCTIONS.keys()];

const TOKEN = /\s*(?:(\d+\.?\d*(?:[eE][+-]?\d+)?|\.\d+(?:[eE][+-]?\d+)?)|([A-Za-z_]\w*(?:\.\w+)*)|([-+*/^(),]))/y;

interface Token {
  readonly kind: "number" | "name" | "sign" | "end";
  readonly text: string;
}

class Invalid extends Error {}

function tokensOf(text: string): Token[] {
  const tokens: Token[] = [];
  TOKEN.lastIndex = 0;
  const rest = text.trimEnd();
  while (TOKEN.lastIndex < rest.length) {
    const from = TOKEN.lastIndex;
    const match = TOKEN.exec(rest);
    if (match === null) throw new Invalid(`"${rest.slice(from).trim().slice(0, 12)}" is not understood`);
    const [, number, name, sign] = match;
    tokens.push(number !== undefined ? { kind: "number", text: number } : name !== undefined ? { kind: "name", text: name } : { kind: "sign", text: sign ?? "" });
  }
  return tokens;
}

const OPERATORS: Readonly<Record<string, (one: number, other: number) => number>> = {
  "+": (one, other) => one + other,
  "-": (one, other) => one - other,
  "*": (one, other) => one * other,
  "/": (one, other) => one / other,
  "^": (one, other) => one ** other,
};

/** Sums keep a unit that both sides have; a factor without a unit changes nothing. */
function unitOf(sign: string, one: Part, other: Part): string | null {
  if (sign === "+" || sign === "-") return one.unit === other.unit ? one.unit : null;
  if (other.unit === NUMBER && sign !== "^") return one.unit;
  return sign === "*" && one.unit === NUMBER ? other.unit : null;
}

class Parser {
  readonly columns = new Set<string>();
  private place = 0;

  constructor(
    private readonly tokens: readonly Token[],
    private readonly units: ReadonlyMap<string, string>,
  ) {}

  whole(): Part {
    const part = this.sum();
    if (this.next.kind !== "end") throw new Invalid(`"${this.next.text}" is not expected there`);
    return part;
  }

  private get next(): Token {
    return this.tokens[this.place] ?? { kind: "end", text: "" };
  }

  private took(...signs: string[]): string | null {
    const { kind, text } = this.next;
    if (kind !== "sign" || !signs.includes(text)) return null;
    this.place += 1;
    return text;
  }

  private need(sign: string): void {
    if (this.took(sign) === null) throw new Invalid(`"${sign}" is missing`);
  }

  private joined(signs: readonly string[], side: () => Part): Part {
    let one = side();
    for (let sign = this.took(...signs); sign !== null; sign = this.took(...signs)) {
      const [left, right] = [one, side()];
      const operator = OPERATORS[sign] ?? OPERATORS["+"];
      one = { of: (column) => operator?.(left.of(column), right.of(column)) ?? Number.NaN, unit: unitOf(sign, left, right) };
    }
    return one;
  }

  private sum(): Part {
    return this.joined(["+", "-"], () => this.product());
  }

  private product(): Part {
    return this.joined(["*", "/"], () => this.signed());
  }

  private signed(): Part {
    if (this.took("-") === null) return this.power();
    const part = this.signed();
    return { of: (column) => -part.of(column), unit: part.unit };
  }

  private power(): Part {
    const one = this.single();
    if (this.took("^") === null) return one;
    const other = this.signed();
    return { of: (column) => one.of(column) ** other.of(column), unit: one.unit === NUMBER ? NUMBER : null };
  }

  private single(): Part {
    const { kind, text } = this.next;
    if (this.took("(") !== null) {
      const part = this.sum();
      this.need(")");
      return part;
    }
    this.place += 1;
    if (kind === "number") return { of: () => Number(text), unit: NUMBER };
    if (kind !== "name") throw new Invalid(kind === "end" ? "it ends too early" : `"${text}" is not expected there`);
    return this.took("(") === null ? this.named(text) : this.called(text);
  }

  private named(name: string): Part {
    if (name === "pi") return { of: () => Math.PI, unit: NUMBER };
    const unit = this.units.get(name);
    if (unit === undefined) throw new Invalid(`"${name}" is no column of the log`);
    this.columns.add(name);
    return { of: (column) => column(name), unit };
  }

  private called(name: string): Part {
    const known = FUNCTIONS.get(name);
    if (known === undefined) throw new Invalid(`"${name}" is none of the functions ${FUNCTION_NAMES.join(", ")}`);
    const given = [this.sum()];
    while (this.took(",") !== null) given.push(this.sum());
    this.need(")");
    if (known.count !== null && given.length !== known.count) throw new Invalid(`${name} takes ${known.count === 1 ? "one value" : `${known.count} values`}`);
    const same = given.every(({ unit }) => unit === given[0]?.unit);
    return { of: (column) => known.of(...given.map((part) => part.of(column))), unit: known.keepsUnit && same ? (given[0]?.unit ?? null) : null };
  }
}

/** Longer ones are not read by anybody. */
const LONGEST = 400;

/** @param units of the columns that there are, by name. */
export function expressionOf(text: string, units: ReadonlyMap<string, string>): Expression | Fault {
  if (text.trim() === "") return { fault: "Name a column, such as left.hand_force" };
  if (text.length > LONGEST) return { fault: `At most ${LONGEST} letters` };
  try {
    const parser = new Parser(tokensOf(text), units);
    const part = parser.whole();
    return { of: part.of, columns: [...parser.columns], unit: part.unit };
  } catch (cause) {
    if (cause instanceof Invalid) return { fault: cause.message };
    // So many brackets that the browser's stack is full.
    if (cause instanceof RangeError) return { fault: "It is too deep" };
    throw cause;
  }
}
