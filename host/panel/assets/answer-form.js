// The parts of an answer, on the teacher's page and on a phone: disorder, severity, confidence.

import { el, field, tick } from "./dom.js";
import { disorderName, levelName } from "./names.js";
import { text } from "./strings.js";

/** A tag: right or wrong; null while that is hidden. */
export const outcome = (is) =>
  is === null || is === undefined
    ? null
    : el("span", { class: `tag ${is ? "yes" : "no"}` }, text(is ? "answer.right" : "answer.wrong"));

/** Fields of an answer from the choices of a lesson. */
export function makeAnswer(choices) {
  const options = (names, nameOf) => names.map((name) => el("option", { value: name }, nameOf(name)));
  const disorder = el(
    "select",
    { name: "disorder" },
    el("option", { value: "" }, text("answer.choose")),
    ...options(choices.disorders, disorderName),
  );
  const level = el(
    "select",
    { name: "level" },
    el("option", { value: "" }, text("answer.no-level")),
    ...options(choices.levels, levelName),
  );
  const radio = (value) => el("input", { type: "radio", name: "confidence", value });
  const confidence = [1, 2, 3, 4, 5].map(radio);
  const labels = { 1: text("answer.low"), 5: text("answer.high") };
  const update = () => (level.disabled = disorder.value === "healthy");
  disorder.addEventListener("change", update);
  return {
    fields: [field(text("answer.disorder"), disorder), field(text("answer.level"), level)],
    confidence: el(
      "fieldset",
      { class: "choices" },
      el("legend", null, text("answer.confidence")),
      ...confidence.map((input) => tick(labels[input.value] ?? input.value, input)),
    ),
    /** What was entered; null as long as something is missing. */
    read() {
      const sure = Number(confidence.find((input) => input.checked)?.value);
      if (!disorder.value || !sure) return null;
      return { disorder: disorder.value, level: (!level.disabled && level.value) || null, confidence: sure };
    },
    /** Enters an answer; without one, empties the fields. */
    fill(given) {
      disorder.value = given?.disorder ?? "";
      level.value = given?.level ?? "";
      for (const input of confidence) input.checked = Number(input.value) === given?.confidence;
      update();
    },
  };
}
