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
