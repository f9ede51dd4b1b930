// Names of knees and disorders as people read them, in the chosen language.

import { latest } from "./connection.js";
import { presetText } from "./labels.js";
import { text, textOr } from "./strings.js";

export { levelName, presetText } from "./labels.js";

/** All presets: those saved since the greeting replace its list. */
export const presets = () => latest.presets ?? latest.hello?.presets ?? [];

/** A preset by its name. */
export const presetOf = (name) => presets().find((preset) => preset.name === name);

/** The title of the preset with this name, or "healthy". */
export function presetTitle(name) {
  if (name === "healthy") return text("knee.healthy");
  const preset = presetOf(name);
  return preset ? presetText(preset, "title") : name;
}

/** The heading of a disorder. */
export function disorderName(name) {
  if (name === "healthy") return text("knee.healthy");
  const heading = latest.hello?.disorders.find((disorder) => disorder.name === name)?.heading;
  return name ? textOr(`disorder.${name}`, heading ?? name) : text("disorder.other");
}

/** The title of the knee that is on the device. */
export function kneeName() {
  const parameters = latest.parameters;
  if (!parameters || !latest.hello) return "–";
  if (parameters.hidden) return text("hidden");
  return parameters.preset ? presetTitle(parameters.preset) : text("knee.own");
}

/** The answer of a student to the current knee of a lesson. */
export const answerOf = (lesson, student) =>
  lesson.answers.findLast((one) => one.student === student && one.trial === lesson.trial);
