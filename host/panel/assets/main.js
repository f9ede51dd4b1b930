// Starts the parts of the page, then connects.

import { connect, on } from "./connection.js";
import { startControl } from "./control.js";
import { byId } from "./dom.js";
import { startKnee } from "./knee.js";
import { startLesson } from "./lesson.js";
import { startLive } from "./live.js";
import { startNotes } from "./notes.js";
import { startRecordings } from "./recordings.js";
import { startStrings } from "./strings.js";
import { setReplay, startTabs } from "./tabs.js";
import { startTarget } from "./target.js";

// What is scrolled to must not end up below the header, which stays in sight.
const top = document.querySelector(".top");
new ResizeObserver(() => {
  document.documentElement.style.setProperty("--top", `${Math.ceil(top.getBoundingClientRect().height)}px`);
}).observe(top);

await startStrings(byId("language"));
startTabs();
startControl();
startLive();
startTarget();
startNotes();
startKnee();
startLesson();
startRecordings();
on("hello", (hello) => setReplay(hello.source.kind === "replay"));
connect();
