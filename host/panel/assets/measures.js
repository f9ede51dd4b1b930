// What an examination measures, its steps, and what was missed: lists that follow what comes.

import { el, setText } from "./dom.js";
import { number, text, textOr } from "./strings.js";

/** Shows texts as the lines of a list, and changes only what is different. */
export function setLines(list, lines) {
  while (list.childElementCount > lines.length) list.lastElementChild.remove();
  while (list.childElementCount < lines.length) list.append(el("li"));
  lines.forEach((line, i) => setText(list.children[i], line));
}

/** The text of a sign of the knee: that its movement was made, or what was missing. */
export function findingText({ effect, outcome, reached, needed }) {
  const digits = outcome === "not-held" ? 1 : 0;
  return text(`finding.${outcome}`, {
    what: textOr(`group.${effect}`, effect),
    reached: number(reached ?? NaN, digits),
    needed: number(needed ?? NaN, digits),
  });
}

/** The signs whose movement was not made. */
export const missed = (findings) => findings.filter((finding) => finding.outcome !== "shown");

function measured(value, { unit, digits }) {
  const shown = number(value ?? NaN, digits);
  return unit === "°" || !unit ? shown + unit : `${shown} ${unit}`;
}

/**
 * Builds the lists for measures of this table. The returned function shows a state: `measures` in the order of
 * the table, null for none; `steps`, each with `step` and `done`; `findings`, null while the knee is hidden.
 */
export function makeMeasures(host, table) {
  const steps = el("ul", { class: "lines", "aria-label": text("examination.steps") });
  const findings = el("ul", { class: "lines", "aria-label": text("examination.signs") });
  const values = table.map(() => el("dd"));
  const names = table.map(({ name }) => el("dt", null, text(`measure.${name}`)));
  const rows = names.map((name, i) => el("div", null, name, values[i]));
  host.replaceChildren(steps, findings, el("dl", { class: "facts" }, ...rows));
  return (state) => {
    const line = ({ step, done }) => text(done ? "step.done" : "step.open", { step: text(`step.${step}`) });
    setLines(steps, state.steps.map(line));
    setLines(findings, (state.findings ?? []).map(findingText));
    table.forEach((spec, i) => setText(values[i], measured(state.measures[i], spec)));
  };
}
