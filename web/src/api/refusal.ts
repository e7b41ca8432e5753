/** What the service says when it does not do a thing (problem JSON, RFC 9457), or that it does not answer. */

export interface FieldError {
  readonly field: string;
  readonly message: string;
}

interface ProblemBody {
  readonly title?: unknown;
  readonly detail?: unknown;
  readonly tip?: unknown;
  readonly errors?: unknown;
}

/** A request that the service refused, failed at, or never answered (status 0). */
export class Refusal extends Error {
  constructor(
    readonly status: number,
    readonly title: string,
    detail: string,
    readonly tip: string,
    readonly fields: readonly FieldError[],
  ) {
    super(detail);
    this.name = "Refusal";
  }

  /** The service looked at the request and said no; otherwise nobody knows what it did. */
  get decided(): boolean {
    return this.status >= 400 && this.status < 500;
  }

  /** The service did nothing of it, and would at another time. */
  get postponed(): boolean {
    return this.status === 503;
  }
}

const text = (value: unknown): string => (typeof value === "string" ? value : "");

function isFieldError(value: unknown): value is FieldError {
  return typeof value === "object" && value !== null && "field" in value && "message" in value;
}

/** Reads whatever body came with an error status. */
export function refusalOf(status: number, body: unknown): Refusal {
  const problem: ProblemBody = typeof body === "object" && body !== null ? body : {};
  const fields = Array.isArray(problem.errors) ? problem.errors.filter(isFieldError) : [];
  const title = text(problem.title) || `The service answered ${status}`;
  return new Refusal(status, title, text(problem.detail) || title, text(problem.tip), fields);
}

/** The request did not reach the service, or its answer did not come back. */
export function noAnswer(cause: unknown): Refusal {
  const timedOut = cause instanceof DOMException && cause.name === "TimeoutError";
  const detail = timedOut ? "The service did not answer in time." : "The service cannot be reached.";
  return new Refusal(0, "No answer", detail, "Check that the service runs and that this computer reaches it.", []);
}
