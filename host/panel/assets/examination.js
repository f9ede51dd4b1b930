// The examination of the knee on the device, in the live view.

import { isReplay, latest, on } from "./connection.js";
import { controlReason } from "./control.js";
import { byId, el, setText } from "./dom.js";
import { makeMeasures } from "./measures.js";
import { request } from "./report.js";
import { onLanguage, text } from "./strings.js";

let view = null;

function build() {
  const part = byId("examination");
  part.parentElement.hidden = isReplay();
  if (!latest.hello || isReplay()) return;
  const lists = el("div");
  view = {
    show: makeMeasures(lists, latest.hello.measures),
    by: el("p", { class: "hint" }),
    again: el("button", { type: "button", onclick: () => request("examine") }, text("examination.again")),
  };
  part.replaceChildren(view.by, lists, el("div", { class: "row" }, view.again));
  update();
}

function update() {
  const state = latest.examination;
  if (!view || !state) return;
  view.show(state);
  view.again.disabled = controlReason() !== "";
  setText(view.by, state.by_person ? "" : text("examination.by-machine"));
}

/** Starts the examination's part of the live view. */
export function startExamination() {
  on("hello", build);
  for (const kind of ["examination", "holder", "open", "lost"]) on(kind, update);
  onLanguage(build);
}
