// Starts the parts of the page, then connects.

import { startClass } from "./class.js";
import { connect, isTeacher, on } from "./connection.js";
import { startControl } from "./control.js";
import { byId } from "./dom.js";
import { startExamination } from "./examination.js";
import { startGuide } from "./guide.js";
import { startKnee } from "./knee.js";
import { startLesson } from "./lesson.js";
import { startLive } from "./live.js";
import { startNotes } from "./notes.js";
import { startRecordings } from "./recordings.js";
import { startStrings } from "./strings.js";
import { setExperiments, setReplay, startTabs } from "./tabs.js";
import { startTarget } from "./target.js";
import { startWall } from "./wall.js";

// What is scrolled to must not end up below the part of the header that stays in sight.
const headers = [".top", ".bar"].map((part) => document.querySelector(part));
const measure = () => {
  const header = headers.find((part) => getComputedStyle(part).position === "sticky");
  const height = Math.ceil(header?.getBoundingClientRect().height ?? 0);
  document.documentElement.style.setProperty("--top", `${height}px`);
};
const resized = new ResizeObserver(measure);
for (const part of headers) resized.observe(part);
addEventListener("resize", measure);

await startStrings(byId("language"));
startTabs();
startControl();
startLive();
startGuide();
startTarget();
startExamination();
startNotes();
startKnee();
startClass();
startLesson();
startRecordings();
startWall();
let experiment = null;
on("hello", (hello) => {
  setReplay(hello.source.kind === "replay");
  const has = hello.experiments && isTeacher();
  setExperiments(has);
  // Few panels have it.
  if (has) experiment ??= import("./experiment.js").then(({ startExperiment }) => startExperiment());
});
connect();
