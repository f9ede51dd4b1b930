// What to do next, in one sentence: that of the first row that fits what the header knows.

import { text } from "./strings.js";

const ROWS = [
  ["refused", ({ state }) => state === "refused"],
  ["connecting", ({ state }) => state === "connecting"],
  ["no-program", ({ state }) => state === "connection-lost" || state === "silent"],
  ["replay", ({ state }) => state === "replay"],
  ["no-device", ({ state }) => state === "device-lost"],
  ["viewer", ({ isTeacher }) => !isTeacher],
  ["take", ({ isController }) => !isController],
  ["other", ({ other }) => other],
  ["fault", ({ hasFault }) => hasFault],
  ["straight", ({ isZeroed }) => !isZeroed],
  ["starting", ({ state }) => state === "arming"],
  ["session-motor", ({ experiment, state }) => experiment && !experiment.over && state !== "armed"],
  ["session", ({ experiment }) => experiment && !experiment.over],
  ["session-over", ({ experiment }) => experiment],
  ["results", ({ lesson }) => lesson?.ended],
  ["lesson-motor", ({ lesson, state }) => lesson && state !== "armed"],
  ["lesson-start", ({ lesson }) => lesson && !lesson.began],
  ["lesson-answer", ({ lesson, isAnswered }) => lesson?.blind && !isAnswered],
  ["lesson-next", ({ lesson }) => lesson && lesson.trial < lesson.trials],
  ["lesson-end", ({ lesson }) => lesson],
  ["choose-on", ({ state, isHealthy }) => state === "armed" && isHealthy],
  ["examine", ({ state, feel }) => state === "armed" && feel],
  ["examine-own", ({ state }) => state === "armed"],
  ["choose", ({ isHealthy }) => isHealthy],
  ["ready", () => true],
];

// The words on the buttons, and the part of the page, that a sentence names.
const NAMED = {
  take: "control.take",
  zero: "control.zero",
  on: "control.arm",
  stop: "stop",
  clear: "fault.clear",
  apply: "knee.apply",
  start: "run.start",
  next: "run.next",
  end: "run.end",
  close: "results.close",
  play: "player.play",
  part: "tab.knee",
  session: "tab.experiment",
  leave: "experiment.leave",
};

/** The sentence for these facts. */
export function nextSentence(facts) {
  const [row] = ROWS.find(([, fits]) => fits(facts));
  const named = Object.entries(NAMED).map(([name, key]) => [name, text(key)]);
  return text(`next.${row}`, { ...Object.fromEntries(named), knee: facts.knee, feel: facts.feel });
}
