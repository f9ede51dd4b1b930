// A running lesson: instruction, time left, answers. What is hidden comes as
// null from the server; the page has nothing to keep secret.

import { makeAnswer, outcome } from "./answer-form.js";
import { classCard } from "./class.js";
import { latest } from "./connection.js";
import { controlReason } from "./control.js";
import { confirmed } from "./dialogs.js";
import { el, field, freshId, setText } from "./dom.js";
import { findingText, missed, setLines } from "./measures.js";
import { answerOf, kneeText, kneeTitle, lessonTitle } from "./names.js";
import { liveTime } from "./live.js";
import { request } from "./report.js";
import { number, text, textOr } from "./strings.js";

let view = null;
let trialShown = null;
let timer = null;

async function answer(event) {
  event.preventDefault();
  const given = view.parts.read();
  setText(view.problem, given ? "" : text("answer.incomplete"));
  if (!given) return;
  const answered = view.student.value;
  const { lesson } = latest;
  const due = lesson.students.find((student) => student !== answered && !answerOf(lesson, student));
  // At once: the next student may type before the reply is here.
  view.parts.fill(null);
  if (due) view.student.value = due;
  (due ? view.student : view.next).focus();
  if (await request("lesson-answer", { student: answered, ...given })) return;
  // Nothing that was typed is lost.
  view.student.value = answered;
  view.parts.fill(given);
}

async function end() {
  const { lesson } = latest;
  const left =
    lesson.trial < lesson.trials ||
    (lesson.blind && lesson.students.some((student) => !answerOf(lesson, student)));
  if (left && !(await confirmed(text("run.end-early")))) return;
  await request("lesson-end", { language: document.documentElement.lang });
}

function answerForm(lesson) {
  view.student = el("select", { name: "student" });
  view.parts = makeAnswer(lesson.choices);
  view.send = el("button", { class: "primary" }, text("answer.send"));
  view.problem = el("p", { class: "problem", role: "alert" });
  view.form = el(
    "form",
    { id: "answer-form", class: "card", onsubmit: answer, novalidate: true },
    el("h3", null, text("answer.title")),
    el("div", { class: "row" }, field(text("answer.student"), view.student), ...view.parts.fields),
    view.parts.confidence,
    view.problem,
    el("div", { class: "row" }, view.send),
  );
  return view.form;
}

/** Builds the view of a running lesson. */
export function showRun(host, lesson) {
  view = {
    trial: el("p", { class: "trial", role: "status" }),
    progress: el("progress", { "aria-label": text("run.progress"), max: lesson.trials }),
    instruction: el("p", { class: "instruction" }),
    facts: el("p"),
    knee: el("p"),
    missed: el("ul", { class: "lines", "aria-label": text("run.missed") }),
    compare: [
      ["run.again", () => latest.lesson.knee.preset],
      ["run.healthy", () => "healthy"],
    ].map(([key, preset]) =>
      el(
        "button",
        { type: "button", onclick: () => request("apply", { preset: preset(), add: false }) },
        text(key),
      ),
    ),
    time: el("p", { class: "time-left" }),
    start: el(
      "button",
      { type: "button", id: "lesson-start", class: "primary", onclick: () => request("lesson-start") },
      text("run.start"),
    ),
    next: el(
      "button",
      { type: "button", id: "lesson-next", onclick: () => request("lesson-next") },
      text("run.next"),
    ),
    end: el("button", { type: "button", id: "lesson-end", onclick: end }, text("run.end")),
    why: el("p", { class: "hint" }),
    answers: el("ul", { class: "answers" }),
  };
  view.answerCard = el("section", { class: "card" }, el("h3", null, text("run.answers")), view.answers);
  trialShown = null;
  const about = [
    text(lesson.blind ? "setup.blind" : "setup.open"),
    lesson.blind && text(lesson.curves ? "run.curves" : "run.no-curves"),
    lesson.blind && lesson.seed !== null && text("run.seed", { seed: lesson.seed }),
    lesson.stored && text("run.stored", { folder: lesson.stored }),
  ];
  const title = freshId("lesson");
  host.replaceChildren(
    el(
      "section",
      { class: "card", "aria-labelledby": title },
      el("h2", { id: title }, lessonTitle(lesson)),
      view.trial,
      view.progress,
      view.instruction,
      view.facts,
      view.knee,
      view.missed,
      el("div", { class: "row" }, view.compare),
      view.time,
      el("div", { class: "row" }, view.start, view.next, view.end),
      view.why,
    ),
    answerForm(lesson),
    view.answerCard,
    classCard(),
    el("p", { class: "hint" }, about.filter(Boolean).join(" · ")),
  );
  clearInterval(timer);
  timer = setInterval(showTime, 500);
  updateRun(lesson);
}

function showTime() {
  const { lesson } = latest;
  if (!view || !lesson || lesson.ended) return clearInterval(timer);
  const left = lesson.began && lesson.time_s ? lesson.time_s - (liveTime() - lesson.began_s) : null;
  if (left === null) return setText(view.time, "");
  const seconds = Math.max(0, Math.ceil(left));
  const clock = `${Math.floor(seconds / 60)}:${String(seconds % 60).padStart(2, "0")}`;
  return setText(view.time, seconds > 0 ? text("run.left", { clock }) : text("run.over"));
}

/** Shows where the lesson is. */
export function updateRun(lesson) {
  const trial = `${lesson.trial} ${lesson.began} ${lesson.students}`;
  if (trial !== trialShown) {
    trialShown = trial;
    view.student.replaceChildren(...lesson.students.map((name) => el("option", { value: name }, name)));
    view.student.value = lesson.students[0] ?? "";
  }
  const why = controlReason();
  setText(view.trial, text("run.trial", { trial: lesson.trial, trials: lesson.trials }));
  view.progress.value = lesson.trial - (lesson.began ? 0 : 1);
  setText(view.instruction, lesson.instruction ?? "");
  view.instruction.hidden = !lesson.instruction;
  const target = lesson.target
    ? text("run.target", { target: textOr(`target.${lesson.target}`, lesson.target) })
    : "";
  const time = lesson.time_s ? text("run.time", { seconds: number(lesson.time_s) }) : "";
  setText(view.facts, [target, time].filter(Boolean).join(" · "));
  const knee = lesson.knee;
  setText(
    view.knee,
    text("run.knee", {
      knee: knee ? kneeTitle(knee) : text("hidden"),
    }),
  );
  // An open lesson is shown, not answered.
  const all = lesson.blind ? lesson.students.every((student) => answerOf(lesson, student)) : lesson.began;
  view.form.hidden = view.answerCard.hidden = !lesson.blind;
  view.start.disabled = why !== "" || lesson.began;
  view.next.disabled = why !== "" || lesson.trial >= lesson.trials;
  view.end.disabled = why !== "";
  view.send.disabled = why !== "" || !lesson.began;
  view.next.classList.toggle("primary", all && lesson.trial < lesson.trials);
  view.end.classList.toggle("primary", all && lesson.trial >= lesson.trials);
  setText(
    view.why,
    why
      ? text("run.disabled", { why })
      : lesson.began
        ? all && lesson.blind
          ? text("run.all-answered")
          : latest.status?.state === "armed"
            ? ""
            : text("run.no-torque")
        : text("run.not-begun"),
  );
  showAnswers(lesson);
  showTime();
  updateMissed();
}

/** Shows what was missed of a knee that is known now, and offers to feel it again beside a healthy one. */
export function updateMissed() {
  const { lesson, examination } = latest;
  const revealed = Boolean(lesson?.began && lesson.knee && !lesson.ended);
  for (const button of view.compare) {
    button.hidden = !revealed;
    button.disabled = controlReason() !== "";
  }
  // Those of the answer: the knee may have been felt again since.
  const kept = revealed && lesson.blind ? examination?.of_answer : null;
  const findings = kept?.trial === lesson.trial ? kept.findings : [];
  const left = missed(findings).map(findingText);
  const nothing = () => text(kept.by_person ? "run.missed-nothing" : "run.missed-machine");
  setLines(view.missed, left.length || !findings.length ? left : [nothing()]);
}

function showAnswers(lesson) {
  view.answers.replaceChildren(
    ...lesson.students.map((student) => {
      const given = answerOf(lesson, student);
      if (!given) return el("li", null, text("answer.none", { student }));
      // The server hides it until all have answered: they judge without each other.
      const shown = given.disorder
        ? text("answer.line", {
            student,
            knee: kneeText(given.disorder, given.level),
            confidence: given.confidence,
          })
        : text("answer.given", { student });
      const uncounted = text("answer.uncounted", { share: number(100 * given.torque_share, 0) });
      return el(
        "li",
        null,
        shown,
        " ",
        given.counts ? outcome(given.right) : el("span", { class: "tag no" }, uncounted),
      );
    }),
  );
}
