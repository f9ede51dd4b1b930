// Names of knees and disorders as people read them, in the chosen language.

import { latest } from "./connection.js";
import { levelName, presetText } from "./labels.js";
import { text, textOr } from "./strings.js";

export { levelName, presetText };

/** All presets. */
export const presets = () => latest.presets ?? [];

/** A preset by its name. */
export const presetOf = (name) => presets().find((preset) => preset.name === name);

/** The title of the preset with this name, or "healthy". */
function presetTitle(name) {
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

/** "spasticity, severe" */
export function kneeText(disorder, level) {
  const name = disorderName(disorder);
  return level ? text("answer.knee", { disorder: name, level: levelName(level) }) : name;
}

/** The title of a knee that a message describes: on a phone there is no list of presets. */
function knownTitle({ preset, title }) {
  if (preset === "healthy" || presetOf(preset)) return presetTitle(preset);
  return textOr(`preset.${preset}.title`, title);
}

/** "Spasticity, MAS 2 (spasticity, moderate)" */
export const kneeTitle = (knee) =>
  knee.disorder && knee.disorder !== "healthy"
    ? `${knownTitle(knee)} (${kneeText(knee.disorder, knee.level)})`
    : knownTitle(knee);

/** The title of a lesson. */
export const lessonTitle = ({ name, title }) => textOr(`lesson.${name}.title`, title);

/** How many have answered the current trial of a lesson. */
export function answeredText({ answers, trial, students }) {
  const count = answers.filter((one) => one.trial === trial).length;
  return text("wall.answered", { count, all: students.length });
}

/** The name of a recording: its knee, where that may be known, and its trial. */
export function recordingTitle({ lesson, knee, title, name }) {
  const own = title ?? name;
  if (!lesson) return knee ? `${knownTitle(knee)} · ${own}` : own;
  const shown = lesson.knee ? knownTitle(lesson.knee) : text("hidden");
  return text("recordings.trial", { trial: lesson.trial, knee: shown, lesson: lessonTitle(lesson) });
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
