/** Holds what fails within: the rest of the page stays. STOP does not depend on it (src/stop). */
import { Component, type ReactNode } from "react";
import styles from "./Boundary.module.css";

interface BoundaryProps {
  /** What may fail, as it is called on the page: "The runs page". */
  readonly what: string;
  /** Recovers from a failure; without it, what is within is drawn again. */
  readonly onReload?: () => void;
  readonly children: ReactNode;
}

interface BoundaryState {
  readonly failure: string | null;
}

/** What was thrown, in words; anything can be thrown, also what has none. */
function wordsOf(cause: unknown): string {
  try {
    return cause instanceof Error ? cause.message : String(cause);
  } catch {
    return "";
  }
}

export class Boundary extends Component<BoundaryProps, BoundaryState> {
  override state: BoundaryState = { failure: null };

  static getDerivedStateFromError(cause: unknown): BoundaryState {
    return { failure: wordsOf(cause) };
  }

  override render(): ReactNode {
    const { what, onReload, children } = this.props;
    if (this.state.failure === null) return children;
    return (
      <section className={styles.failed} role="alert">
        <h2>{`${what} failed`}</h2>
        <p>STOP still works.</p>
        <p>{this.state.failure}</p>
        <button
          type="button"
          onClick={() => {
            onReload?.();
            this.setState({ failure: null });
          }}
        >
          Reload
        </button>
      </section>
    );
  }
}
