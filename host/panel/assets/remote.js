// The teacher's own phone: next knee, milder, worse, a note, stop; and the knee, which no other page has in
// a blind trial. It gives no torque and takes no control.

import { connect, latest, on } from "./connection.js";
import { byId, el, field, setText } from "./dom.js";
import { answeredText, kneeTitle, lessonTitle } from "./names.js";
import { startPhone } from "./phone.js";
import { request } from "./report.js";
import { text } from "./strings.js";

let view = null;

function build() {
  const button = (id, act) => el("button", { type: "button", id, onclick: act });
  const step = () => request(latest.lesson?.began ? "lesson-next" : "lesson-start");
  const severity = (worse) => () => request("severity", { worse });
  view = {
    title: el("h2"),
    trial: el("p", { class: "trial", role: "status" }),
    answered: el("p"),
    step: button("step", step),
    milder: button("milder", severity(false)),
    worse: button("worse", severity(true)),
    why: el("p", { class: "hint" }),
    now: el("p"),
    next: el("p"),
    note: el("input", { maxlength: 200, autocomplete: "off" }),
  };
  setText(view.milder, text("remote.milder"));
  setText(view.worse, text("remote.worse"));
  const note = async (event) => {
    event.preventDefault();
    const words = view.note.value.trim();
    if (words && (await request("note", { text: words }, text("remote.noted")))) view.note.value = "";
  };
  byId("main").replaceChildren(
    el(
      "section",
      { class: "card" },
      view.title,
      view.trial,
      view.answered,
      view.step,
      el("div", { class: "pair" }, view.milder, view.worse),
      view.why,
    ),
    el(
      "details",
      { class: "card" },
      el("summary", null, text("remote.knee")),
      view.now,
      view.next,
    ),
    el(
      "form",
      { class: "card", onsubmit: note },
      field(text("notes.field"), view.note),
      el("button", null, text("notes.add")),
    ),
  );
  update();
}

function update() {
  if (!view) return;
  const { lesson, knee, holder } = latest;
  const runs = Boolean(lesson) && !lesson.ended;
  const isLast = runs && lesson.began && lesson.trial >= lesson.trials;
  setText(view.title, runs ? lessonTitle(lesson) : text("remote.no-lesson"));
  setText(view.trial, runs ? text("run.trial", { trial: lesson.trial, trials: lesson.trials }) : "");
  setText(view.answered, runs && lesson.blind ? answeredText(lesson) : "");
  setText(view.step, text(runs && lesson.began ? "run.next" : "run.start"));
  const why = holder?.taken ? "" : text("remote.no-control");
  view.step.disabled = Boolean(why) || !runs || isLast;
  // In a blind trial the answers are to this knee and to no other.
  view.milder.disabled = view.worse.disabled = Boolean(why) || (runs && lesson.blind && !lesson.knee);
  setText(view.why, why || (isLast ? text("remote.last") : ""));
  const name = (one) => (one ? kneeTitle(one) : text("knee.own"));
  setText(view.now, text("knee.now", { knee: name(knee?.now) }));
  setText(view.next, knee?.next ? text("remote.next", { knee: name(knee.next) }) : "");
}

await startPhone(() => latest.hello && build());
on("hello", build);
for (const kind of ["lesson", "knee", "holder", "status"]) on(kind, update);
connect();
