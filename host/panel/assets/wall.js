// The view for a wall: what all may see, large. It is the viewers' page with `?projector` in its address.

import { qrPicture } from "./class.js";
import { latest, on } from "./connection.js";
import { byId, el } from "./dom.js";
import { answeredText, kneeTitle, lessonTitle } from "./names.js";
import { onLanguage, text } from "./strings.js";

function lessonLines(lesson) {
  const { trial, trials, summary } = lesson;
  const knee = !lesson.ended && lesson.knee;
  return [
    el("h2", null, lessonTitle(lesson)),
    el("p", { class: "trial" }, text("run.trial", { trial, trials })),
    lesson.instruction && el("p", { class: "instruction" }, lesson.instruction),
    lesson.blind && el("p", null, answeredText(lesson)),
    knee && el("p", { class: "trial" }, text("run.knee", { knee: kneeTitle(knee) })),
    summary && el("p", { class: "trial" }, text("results.total", summary)),
  ];
}

function invitationLines({ invitation, joined }) {
  return [
    el("h2", null, text("wall.join")),
    qrPicture(invitation, text("class.qr-student")),
    el("p", { class: "link" }, invitation.link),
    el("p", { role: "status" }, text("class.joined", { count: joined })),
  ];
}

function show(host) {
  const lines = [
    ...(latest.lesson ? lessonLines(latest.lesson) : []),
    ...(latest.class?.invitation ? invitationLines(latest.class) : []),
  ];
  host.hidden = !lines.length;
  host.setAttribute("aria-label", text("class.wall"));
  host.replaceChildren(el("div", { class: "card" }, ...lines));
}

/** Starts the view for a wall, if the address asks for it. */
export function startWall() {
  if (!new URLSearchParams(location.search).has("projector")) return;
  document.documentElement.classList.add("projector");
  const host = el("section", { id: "wall" });
  byId("main").prepend(host);
  for (const kind of ["lesson", "class", "presets"]) on(kind, () => show(host));
  onLanguage(() => show(host));
  show(host);
}
