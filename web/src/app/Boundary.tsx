/** Holds what fails within: the rest of the console, STOP above all, stays. */
import { Button } from "@mantine/core";
import { Component, type ReactNode } from "react";
import styles from "./EmptyPage.module.css";

interface BoundaryProps {
  /** What may fail, as a person calls it. */
  readonly what: string;
  readonly children: ReactNode;
}

interface BoundaryState {
  readonly failure: string | null;
}

export class Boundary extends Component<BoundaryProps, BoundaryState> {
  override state: BoundaryState = { failure: null };

  static getDerivedStateFromError(cause: unknown): BoundaryState {
    return { failure: cause instanceof Error ? cause.message : String(cause) };
  }

  override render(): ReactNode {
    const { what, children } = this.props;
    if (this.state.failure === null) return children;
    return (
      <section className={styles.empty} role="alert">
        <h2>{`${what} has failed`}</h2>
        <p>{this.state.failure}</p>
        <Button
          onClick={() => {
            this.setState({ failure: null });
          }}
        >
          Show it again
        </Button>
      </section>
    );
  }
}
