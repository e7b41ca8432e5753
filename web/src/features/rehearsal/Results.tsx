/** What the futures of a rehearsal say: as it is beside as changed. */
import { usePreferences } from "../../units/preferences";
import type { RehearsalCase, RehearsalResult } from "../../api/types";
import { Icon, type IconName } from "../../ui/theme/Icon";
import { fixed } from "../../units/units";
import { classStyle } from "../glossary/class-style";
import { Term } from "../glossary/Term";
import styles from "./Rehearse.module.css";
import { casesOf, CASE_WORDS, decidingOf, oddsWords, rangesOf, type MeasureRanges, type NamedCase } from "./words";

const percent = (part: number): string => `${100 * part}%`;

/** A letter needs so much of the bar to stand in it. */
const LETTERED = 0.06;

function OddsOfCase({ named: { name, of } }: { readonly named: NamedCase }) {
  const { caged, odds, futures } = of;
  return (
    <div className={styles.case} role="group" aria-label={`${CASE_WORDS[name]}: ${oddsWords(caged, futures)}`}>
      <div className={styles.caseHead}>
        <strong>{CASE_WORDS[name]}</strong>
        <span>{oddsWords(caged, futures)}</span>
      </div>
      <div className={styles.stack} aria-hidden="true">
        {odds.map(({ outcome, share }) => (
          <span key={outcome} style={{ width: percent(share), background: classStyle(outcome).colour }}>
            {share >= LETTERED && classStyle(outcome).letter}
          </span>
        ))}
      </div>
      <div className={styles.interval} aria-hidden="true" title="95 % interval of being caged (Wilson)">
        <span style={{ left: percent(caged.low), width: percent(caged.high - caged.low) }} />
      </div>
      <ul className={styles.classes}>
        {odds.map((each) => (
          <li key={each.outcome} title={`${oddsWords(each, futures)} (95 % interval)`}>
            <span className={styles.swatch} style={{ background: classStyle(each.outcome).colour }} aria-hidden="true" />
            {each.futures} <Term term={each.outcome}>{classStyle(each.outcome).words}</Term>
          </li>
        ))}
      </ul>
    </div>
  );
}

const VERDICTS: Readonly<Record<string, { readonly icon: IconName; readonly words: string }>> = {
  better: { icon: "check", words: "Better: " },
  worse: { icon: "warning", words: "Worse: " },
};

type Changes = RehearsalResult["compared"];

function Told({ changes }: { readonly changes: Changes }) {
  return (
    <ul className={styles.changes}>
      {changes.map(({ measure, verdict, words }) => (
        <li key={measure} data-change={verdict}>
          <Icon icon={VERDICTS[verdict]?.icon ?? "bar"} size={11} />
          <span>
            <strong>{VERDICTS[verdict]?.words}</strong>
            {words}
          </span>
        </li>
      ))}
    </ul>
  );
}

function Compared({ compared }: { readonly compared: Changes }) {
  const of = (...verdicts: readonly string[]): Changes => verdicts.flatMap((verdict) => compared.filter((each) => each.verdict === verdict));
  const [told, same] = [of("better", "worse"), of("same")];
  return (
    <section className={styles.section} aria-label="What the changes do">
      <h3>What the changes do</h3>
      {told.length === 0 ? <p>Nothing that these futures tell from chance.</p> : <Told changes={told} />}
      {same.length > 0 && (
        <details className={styles.same}>
          <summary>{`Not told from chance: ${same.length} of ${compared.length}`}</summary>
          <Told changes={same} />
        </details>
      )}
    </section>
  );
}

function Ranges({ measure: { title, unit, description, ranges } }: { readonly measure: MeasureRanges }) {
  return (
    <div className={styles.measure}>
      <h4 title={description}>{unit === "" ? title : `${title} [${unit}]`}</h4>
      {ranges.map((range) => (
        <div key={range.case} className={styles.range}>
          <span>{CASE_WORDS[range.case]}</span>
          <div className={styles.track} data-case={range.case} aria-hidden="true">
            <i style={{ left: percent(range.low), width: percent(Math.max(0.005, range.high - range.low)) }} />
            <b style={{ left: percent(range.median) }} />
          </div>
          <span>{range.words}</span>
        </div>
      ))}
    </div>
  );
}

function Bands({ result }: { readonly result: RehearsalResult }) {
  const { angles } = usePreferences();
  const measures = rangesOf(result, angles);
  if (measures.length === 0) return null;
  return (
    <section className={`${styles.section} ${styles.bands}`} aria-label="Median, and what 90 % of the futures are between">
      <h3>Median, and 5 to 95 % of the futures</h3>
      {measures.map((measure) => (
        <Ranges key={measure.measure} measure={measure} />
      ))}
    </section>
  );
}

function Deciding({ of }: { readonly of: RehearsalCase }) {
  const deciding = decidingOf(of);
  if (deciding === null) return null;
  const words = deciding.with === "caged" ? "being caged" : "the peak force";
  return (
    <section className={styles.section} aria-label="What decides most">
      <h3 title={`Spearman's rank correlation of each uncertain number with ${words}`}>{`Decides ${words} most`}</h3>
      {deciding.rows.map(({ name, description, value }) => (
        <div key={name} className={styles.decider} title={description}>
          <span>{name}</span>
          <div className={styles.lever} aria-hidden="true">
            <i data-sign={value < 0 ? "-" : "+"} style={value < 0 ? { right: "50%", width: percent(-value / 2) } : { left: "50%", width: percent(value / 2) }} />
          </div>
          <span>{value > 0 ? `+${fixed(value, 2)}` : fixed(value, 2)}</span>
        </div>
      ))}
    </section>
  );
}

export function Results({ result }: { readonly result: RehearsalResult }) {
  return (
    <>
      {result.notices.length > 0 && (
        <ul className={styles.notices}>
          {result.notices.map((notice) => (
            <li key={notice}>
              <Icon icon="info" size={12} /> <span>{notice}</span>
            </li>
          ))}
        </ul>
      )}
      <section className={styles.section} aria-label="Odds">
        {casesOf(result).map((named) => (
          <OddsOfCase key={named.name} named={named} />
        ))}
      </section>
      {result.compared.length > 0 && <Compared compared={result.compared} />}
      <Bands result={result} />
      <Deciding of={result.as_changed ?? result.as_it_is} />
    </>
  );
}
