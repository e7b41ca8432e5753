/** The streams of the contract: how each of them comes. */
import { Tooltip } from "@mantine/core";
import { Panel } from "../../ui/Panel";
import type { LinkStatus, StreamStatus } from "../../api/types";
import { Icon } from "../../ui/theme/Icon";
import { fixed } from "../../units/units";
import styles from "./LinkPage.module.css";
import { age, milliseconds, sentence, streamWord } from "./words";

const COLUMNS = [
  ["Rate", "Arrivals a second over the last two seconds, of those that the contract says"],
  ["Age", "Since the last arrival"],
  ["Jitter", "Standard deviation of the delay over the last two seconds"],
  ["Loss", "Part of the last two seconds that did not arrive, by the stamps"],
  ["Received", "Since the service began"],
  ["Lost", "Since the service began, by the stamps"],
  ["Refused", "Came and was not believed, since the service began"],
] as const;

function StreamRow({ stream }: { readonly stream: StreamStatus }) {
  const { word, sign, tone, detail } = streamWord(stream);
  return (
    <tr data-tone={tone}>
      <th scope="row">
        {stream.name}
        {!stream.needed && <small> only shown</small>}
        <code>{stream.key}</code>
        {word === "refused" && <small>{detail}</small>}
      </th>
      <td className={styles.state}>
        <Tooltip label={detail}>
          <span className={styles.word} data-tone={tone}>
            <Icon sign={sign} size={12} />
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
