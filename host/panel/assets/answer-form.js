// The parts of an answer, on the teacher's page and on a phone: disorder, severity, confidence.

import { el, field, tick } from "./dom.js";
import { disorderName, levelName } from "./names.js";
import { text } from "./strings.js";

/** A tag: right or wrong; null while that is hidden. */
export const outcome = (is) =>
  is === null || is === undefined
    ? null
    : el("span", { class: `tag ${is ? "yes" : "no"}` }, text(is ? "answer.right" : "answer.wrong"));

/** A choice of one of these names; first there is none, with this text. */
export const choice = (name, names, nameOf, none) =>
  el(
    "select",
    { name },
    el("option", { value: "" }, none),
    ...names.map((value) => el("option", { value }, nameOf(value))),
  );

/** A scale from 1 to 5 with a text at each end. */
export function scale(name, legend, [low, high]) {
  const inputs = [1, 2, 3, 4, 5].map((value) => el("input", { type: "radio", name, value }));
  const labels = { 1: low, 5: high };
  return {
    root: el(
      "fieldset",
      { class: "choices" },
      el("legend", null, legend),
      ...inputs.map((input) => tick(labels[input.value] ?? input.value, input)),
    ),
    /** What was chosen; 0 as long as nothing is. */
    read: () => Number(inputs.find((input) => input.checked)?.value ?? 0),
    fill(chosen) {
      for (const input of inputs) input.checked = Number(input.value) === chosen;
    },
  };
}

/** Fields of an answer from the choices of a lesson. */
export function makeAnswer(choices) {
  const disorder = choice("disorder", choices.disorders, disorderName, text("answer.choose"));
  const level = choice("level", choices.levels, levelName, text("answer.no-level"));
  const ends = [text("answer.low"), text("answer.high")];
  const confidence = scale("confidence", text("answer.confidence"), ends);
  const update = () => (level.disabled = disorder.value === "healthy");
  disorder.addEventListener("change", update);
  return {
    fields: [field(text("answer.disorder"), disorder), field(text("answer.level"), level)],
    confidence: confidence.root,
    /** What was entered; null as long as something is missing. */
    read() {
      const sure = confidence.read();
      if (!disorder.value || !sure) return null;
      return { disorder: disorder.value, level: (!level.disabled && level.value) || null, confidence: sure };
    },
    /** Enters an answer; without one, empties the fields. */
    fill(given) {
      disorder.value = given?.disorder ?? "";
      level.value = given?.level ?? "";
      confidence.fill(given?.confidence);
      update();
    },
  };
}
