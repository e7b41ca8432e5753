/** The streams of the contract: how each of them comes. */
import { Tooltip } from "@mantine/core";
import { Panel } from "../../ui/Panel";
import type { LinkStatus, StreamStatus } from "../../api/types";
import { Icon } from "../../ui/theme/Icon";
import { fixed } from "../../units/units";
import styles from "./LinkPage.module.css";
import { age, milliseconds, sentence, streamWord } from "./labels";

const COLUMNS = [
  ["Rate", "Messages per second over the last two seconds, of the contract's rate"],
  ["Age", "Time since the last message"],
  ["Jitter", "Standard deviation of the delay over the last two seconds"],
  ["Loss", "Share of messages lost over the last two seconds, by time stamps"],
  ["Received", "Since the service started"],
  ["Lost", "Since the service started, by time stamps"],
  ["Refused", "Received but rejected, since the service started"],
] as const;

function StreamRow({ stream }: { readonly stream: StreamStatus }) {
  const { word, icon, tone, detail } = streamWord(stream);
  return (
    <tr data-tone={tone}>
      <th scope="row">
        {stream.name}
        {!stream.needed && <small> display only</small>}
        <code>{stream.key}</code>
        {word === "refused" && <small>{detail}</small>}
      </th>
      <td className={styles.state}>
        <Tooltip label={detail}>
          <span className={styles.word} data-tone={tone}>
            <Icon icon={icon} size={12} />
            {word}
          </span>
        </Tooltip>
      </td>
      <td>
        {fixed(stream.rate, 1)} <small>of {fixed(stream.nominal_rate, 0)} Hz</small>
      </td>
      <td>{age(stream.age)}</td>
      <td>
        {milliseconds(stream.jitter, 2)} <small>ms</small>
      </td>
      <td>
        {stream.loss === null ? "—" : fixed(100 * stream.loss, 1)} <small>%</small>
      </td>
      <td>{stream.received}</td>
      <td>{stream.lost}</td>
      <td>
        {stream.refused === 0 ? (
          0
        ) : (
          <Tooltip label={`${sentence(stream.last_refusal)} ${age(stream.refusal_age)} ago`}>
            <span tabIndex={0}>{stream.refused}</span>
          </Tooltip>
        )}
      </td>
    </tr>
  );
}

export function StreamTable({ link }: { readonly link: LinkStatus }) {
  return (
    <Panel title="Streams from the robot" dated="service">
      <div className={styles.scroll}>
        <table className={styles.streams}>
          <thead>
            <tr>
              <th scope="col">Stream</th>
              <th scope="col">State</th>
              {COLUMNS.map(([name, meaning]) => (
                <th key={name} scope="col" title={meaning}>
                  {name}
                </th>
              ))}
            </tr>
          </thead>
          <tbody>
            {link.streams.map((stream) => (
              <StreamRow key={stream.key} stream={stream} />
            ))}
          </tbody>
        </table>
      </div>
    </Panel>
  );
}
