// The patient says that it hurts, where an end of the range has no resistance: in words on every page, and aloud on
// the one that controls.

import { MARK } from "./bins.js";
import { isController } from "./connection.js";
import { byId, setText } from "./dom.js";
import { text } from "./strings.js";

// After so long without pain it is said again, and its words go.
const QUIET_MS = 2000;

let hurtAt = -Infinity;
let timer = null;

// A browser may have no voice, or not be allowed to use it: then there are the words.
function cry(words) {
  if (!isController() || !("speechSynthesis" in window)) return;
  const said = new SpeechSynthesisUtterance(words);
  said.lang = document.documentElement.lang;
  speechSynthesis.cancel();
  speechSynthesis.speak(said);
}

/** Takes the newest bins of the device. */
export function feelPain({ columns, end }, count) {
  if (!columns.marks.subarray(end - count, end).some((marks) => marks & MARK.hurts)) return;
  const line = byId("pain");
  const now = performance.now();
  if (now - hurtAt > QUIET_MS) {
    setText(line, text("pain.hurts"));
    line.hidden = false;
    cry(line.textContent);
  }
  hurtAt = now;
  clearTimeout(timer);
  timer = setTimeout(() => (line.hidden = true), QUIET_MS);
}
