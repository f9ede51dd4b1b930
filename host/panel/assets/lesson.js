// The Lesson tab: which of its three views is shown (setup, a running lesson,
// its results), and the views' common parts.

import { latest, on } from "./connection.js";
import { byId } from "./dom.js";
import { showRun, updateMissed, updateRun } from "./lesson-run.js";
import { showResults } from "./lesson-results.js";
import { showSetup, updateSetup } from "./lesson-setup.js";
import { onLanguage } from "./strings.js";

let shown = null;
let stateShown = null;

function viewOf(lesson) {
  if (!lesson) return "setup";
  return lesson.ended ? "results" : "run";
}

function render(force) {
  if (!latest.hello) return;
  const lesson = latest.lesson ?? null;
  const view = viewOf(lesson);
  const host = byId("lesson");
  const changed = force || view !== shown;
  shown = view;
  if (view === "results") showResults(host, lesson);
  else if (view === "run") changed ? showRun(host, lesson) : updateRun(lesson);
  else changed ? showSetup(host) : updateSetup();
}

/** Starts the Lesson tab. */
export function startLesson() {
  on("hello", () => render(true));
  on("presets", () => shown === "setup" && render(true));
  on("class", () => shown === "setup" && render(false));
  on("lesson", () => render(false));
  on("examination", () => shown === "run" && updateMissed());
  on("status", () => {
    const state = latest.status?.state;
    if (state === stateShown) return;
    stateShown = state;
    if (shown === "run") render(false);
  });
  for (const kind of ["holder", "open", "lost"]) on(kind, () => render(shown === "results"));
  onLanguage(() => render(true));
}
