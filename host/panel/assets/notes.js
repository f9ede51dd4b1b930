// Notes on the time line, and recording: what a teacher keeps of a session.

import { isController, isTeacher, latest, on } from "./connection.js";
import { byId, el, setText } from "./dom.js";
import { setNotes } from "./live.js";
import { request } from "./report.js";
import { number, onLanguage, text } from "./strings.js";
import { showTab } from "./tabs.js";

const KEPT = 200;
let notes = [];

function showNotes() {
  setNotes(notes);
  byId("note-list").replaceChildren(
    ...notes
      .slice(-20)
      .reverse()
      .map((note) =>
        el(
          "li",
          null,
          el("time", null, `${number(note.time_s, 1)} s`),
          el("span", null, note.text),
          note.by === "lesson" && el("small", null, text("notes.by-lesson")),
        ),
      ),
  );
  byId("note-form").hidden = !isTeacher();
}

function showRecord() {
  const host = byId("record");
  const stores = latest.hello?.stores ?? null;
  const recording = latest.status?.recording ?? null;
  host.hidden = !isController() || stores === null;
  if (!host.firstChild) {
    host.append(
      el("button", {
        type: "button",
        id: "record-button",
        onclick: () => {
          const running = !latest.status?.recording;
          const name = new Date().toISOString().slice(0, 19).replace(/[T:]/g, "-");
          request("record", running ? { running, name } : { running });
        },
      }),
      el("span", { class: "hint" }),
    );
  }
  setText(host.firstChild, text(recording ? "record.stop" : "record.start"));
  const words = recording
    ? text("record.running", { file: recording.file, seconds: number(recording.seconds) })
    : "";
  setText(host.lastChild, words);
}

/** Starts notes and recording. */
export function startNotes() {
  byId("note-form").addEventListener("submit", async (event) => {
    event.preventDefault();
    const input = byId("note");
    if (input.value.trim() && (await request("note", { text: input.value.trim() }))) input.value = "";
  });
  addEventListener("keydown", (event) => {
    const typing = event.target.closest?.(
      "input:not([type=checkbox], [type=radio]), textarea, select, dialog",
    );
    if (
      event.key.toLowerCase() !== "n" ||
      typing ||
      event.ctrlKey ||
      event.metaKey ||
      event.altKey ||
      !isTeacher()
    )
      return;
    event.preventDefault();
    if (byId("live").hidden) showTab("live");
    byId("note").focus();
  });
  on("note", (note) => {
    notes = [...notes, note].slice(-KEPT);
    showNotes();
  });
  on("hello", () => {
    notes = [];
    showNotes();
    showRecord();
  });
  for (const kind of ["status", "holder"]) on(kind, showRecord);
  onLanguage(() => {
    showNotes();
    showRecord();
  });
}
