/** One unmistakable line when what is on the screen is not what is happening. */
import { Button } from "@mantine/core";
import type { CutOff } from "../source/source";
import { useStore, useView } from "../store/context";
import { Icon } from "../ui/theme/Icon";
import { useClock } from "../ui/use-clock";
import { clock, duration } from "../units/units";
import { hashOf } from "../store/route";
import styles from "./TrustNotice.module.css";

/** What the notice says while the connection is as it is. */
function retryWords(lost: boolean, retryIn: number): string {
  if (!lost) return "The connection is open but silent.";
  return retryIn > 1000 ? `Reconnecting in ${retryIn / 1000} s.` : "Reconnecting now.";
}

function StaleNotice() {
  const age = useView((view) => view.age);
  const lost = useView((view) => view.link.state !== "open");
  const retryIn = useView((view) => view.retryIn);
  return (
    <div className={styles.notice} data-tone="error" role="alert">
      <Icon icon="error" size={18} />
      <strong>The data are {duration(age / 1000)} old.</strong>
      <span>
        {retryWords(lost, retryIn)} Commands are disabled until the data are fresh; STOP still works.
      </span>
    </div>
  );
}

/** The service is well; what it shows of the robot is not of now. */
function RobotNotice() {
  const age = useView((view) => view.robotAge);
  const stream = useView((view) => view.snapshot?.robot?.stream ?? "");
  const silent = useView((view) => (view.snapshot?.robot?.silent_for ?? 0) > 0.5);
  return (
    <div className={styles.notice} data-tone="error" role="alert">
      <Icon icon="link" size={18} />
      <strong>{silent ? `The robot has been silent for ${duration(age / 1000)}.` : `The robot's ${stream} is ${duration(age / 1000)} old.`}</strong>
      <span>The service is live; the robot's data are as last received. STOP still works.</span>
    </div>
  );
}

/** A restart is no fault of the mission, but its run has ended in the middle. */
function CutOffNotice({ cutOff }: { readonly cutOff: CutOff }) {
  const store = useStore();
  return (
    <div className={styles.notice} data-tone="preparing" role="status">
      <Icon icon="reset" size={18} />
      <strong>The service was restarted.</strong>
      <span>
        Run <a href={hashOf({ page: "runs", item: cutOff.run_id })}>{cutOff.run_id}</a>, then {cutOff.phase}, was cut off at {clock(cutOff.time, 1)}.
      </span>
      <Button size="compact-xs" onClick={store.dismissCutOff}>
        Close
      </Button>
    </div>
  );
}

/** From here on all is compiled, and only has to be loaded. */
const COMPILED = 0.99;

function PreparingNotice({ since }: { readonly since: number }) {
  const seconds = Math.max(0, Math.round((useClock(250) - since) / 1000));
  const prepared = useView((view) => view.health?.prepared ?? 0);
  const compiling = prepared < COMPILED;
  return (
    <div className={styles.notice} data-tone="preparing" role="status">
      <Icon icon="wait" size={18} />
      <strong>{compiling ? `The controller is being compiled for this machine: ${Math.floor(100 * prepared)} %.` : "The controller is being loaded."}</strong>
      <span>
        {compiling ? "About half a minute, once; later starts take a second. " : ""}
        {seconds > 0 ? `${seconds} s so far.` : ""}
      </span>
      <progress className={styles.progress} value={prepared} aria-label="Compiled" />
    </div>
  );
}

function ConnectingNotice() {
  const attempt = useView((view) => (view.link.state === "lost" ? view.link.attempt : 0));
  return (
    <div className={styles.notice} data-tone={attempt > 2 ? "error" : "preparing"} role="status">
      <Icon icon="link" size={18} />
      <strong>{attempt > 2 ? "The service does not answer." : "Connecting to the service."}</strong>
      <span>{attempt > 2 ? "Is `becalm serve` running? This page reconnects by itself." : ""}</span>
    </div>
  );
}

export function TrustNotice() {
  const trust = useView((view) => view.trust);
  const robotSilent = useView((view) => view.robotAge > 0);
  const cutOff = useView((view) => view.cutOff);
  const since = useView((view) => view.preparingSince);
  if (trust === "stale") return <StaleNotice />;
  if (trust === "live" && robotSilent) return <RobotNotice />;
  if (trust === "live" && cutOff !== null) return <CutOffNotice cutOff={cutOff} />;
  if (trust === "preparing" && since !== null) return <PreparingNotice since={since} />;
  return trust === "connecting" ? <ConnectingNotice /> : null;
}
