// The examination of a knee so far: what was measured, which steps were done, and after an answer what was missed.

import { el, setText } from "../dom.js";
import { findingText, makeMeasures } from "../measures.js";
import { onLanguage, text } from "../strings.js";
import { data } from "./data.js";

const SPEED = data.measures.findIndex(({ name }) => name === "peak-speed");

/** The examination in a box; `letGo()` is called when the leg is to fall. */
export function makeExamination(host, letGo) {
  let measured = new Float32Array(data.measures.length).fill(NaN);
  let showState = null;
  const lists = el("div");
  const button = el("button", { type: "button", onclick: letGo });
  host.replaceChildren(lists, el("div", { class: "row" }, button));

  function build() {
    showState = makeMeasures(lists, data.measures);
    setText(button, text("page.let-go"));
  }

  /** Shows measures and steps; what tells something of the torque is left out while that is hidden. */
  function show(engine, isHidden) {
    measured = engine.measures(data.measures.length);
    const done = engine.steps();
    showState({
      measures: data.measures.map(({ is_of_torque }, i) => (isHidden && is_of_torque ? NaN : measured[i])),
      steps: data.steps.map((step, i) => ({ step, done: (done & (1 << i)) !== 0 })),
      findings: null,
    });
  }

  /** What these movements could not show of a knee, as elements. */
  function missed(preset) {
    const fastest = Number.isFinite(measured[SPEED]) ? measured[SPEED] : 0;
    const late = preset.signs.filter(({ appears_from_deg_s: needed }) => needed > fastest);
    const words = ({ effect, appears_from_deg_s: needed }) =>
      findingText({ effect, outcome: "too-slow", reached: fastest, needed });
    return late.map((sign) => el("p", { class: "instruction" }, words(sign)));
  }

  onLanguage(build);
  build();
  return { show, missed };
}
