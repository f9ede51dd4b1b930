// The examination of a knee so far: what was measured, which steps were done, and what was missed.

import { el, setText } from "../dom.js";
import { findingText, makeMeasures, missed } from "../measures.js";
import { onLanguage, text } from "../strings.js";
import { data } from "./data.js";

/** The signs of a knee, and whether the movement of each was made. */
const findingsOf = (engine, preset) =>
  engine.findings().map((found, i) => ({
    ...found,
    effect: preset.signs[i],
    outcome: data.outcomes[found.outcome],
  }));

/** What the examination has missed of a knee, as elements. */
export function missedOf(engine, preset) {
  const findings = findingsOf(engine, preset);
  const left = missed(findings).map((finding) => findingText(finding));
  const lines = left.length || !findings.length ? left : [text("run.missed-nothing")];
  return lines.map((line) => el("p", { class: "instruction" }, line));
}

/**
 * The examination in a box; `letGo()` is called when the leg is to fall. The returned function shows that of a knee;
 * what tells something of the torque is left out while that is hidden.
 */
export function makeExamination(host, letGo) {
  let showState = null;
  const lists = el("div");
  const button = el("button", { type: "button", onclick: letGo });
  host.replaceChildren(lists, el("div", { class: "row" }, button));

  function build() {
    showState = makeMeasures(lists, data.measures);
    setText(button, text("page.let-go"));
  }

  onLanguage(build);
  build();
  return (engine, preset, isHidden) => {
    const measured = engine.measures(data.measures.length);
    const done = engine.steps();
    showState({
      measures: data.measures.map(({ is_of_torque }, i) => (isHidden && is_of_torque ? NaN : measured[i])),
      steps: data.steps.map((step, i) => ({ step, done: (done & (1 << i)) !== 0 })),
      findings: isHidden ? null : findingsOf(engine, preset),
    });
  };
}
