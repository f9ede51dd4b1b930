// A student's phone: join under a pseudonym, answer, stop. The server sends nothing of the others.

import { makeAnswer, outcome } from "./answer-form.js";
import { ask, connect, latest, on } from "./connection.js";
import { byId, el, field, setText } from "./dom.js";
import { kneeText, kneeTitle, lessonTitle } from "./names.js";
import { startPhone } from "./phone.js";
import { request } from "./report.js";
import { store, stored } from "./storage.js";
import { number, text } from "./strings.js";

let shown = null;

// Name and key of an earlier time: after a reload this phone has the same seat.
const seat = () => JSON.parse(stored("seat") ?? "null");

async function join(own, send = request) {
  const given = await send("join", own);
  if (given) return store("seat", JSON.stringify(given));
  latest.own = null;
  return render();
}

function joinForm() {
  const name = el("input", {
    value: seat()?.name ?? "",
    maxlength: 20,
    autocomplete: "off",
    autocapitalize: "none",
    required: true,
  });
  const submit = (event) => {
    event.preventDefault();
    join({ name: name.value.trim(), key: seat()?.key ?? null });
  };
  return el(
    "form",
    { class: "card", id: "join-form", onsubmit: submit },
    el("h2", null, text("join.title")),
    field(text("join.name"), name, text("setup.students-hint")),
    el("button", { class: "primary" }, text("join.join")),
  );
}

function answerForm(lesson, given) {
  const parts = makeAnswer(lesson.choices);
  const problem = el("p", { class: "problem", role: "alert" });
  const submit = async (event) => {
    event.preventDefault();
    const answer = parts.read();
    setText(problem, answer ? "" : text("answer.incomplete"));
    if (answer) await request("answer", { trial: lesson.trial, ...answer }, text("own.sent"));
  };
  if (given) parts.fill(given);
  return el(
    "form",
    { class: "card", id: "answer-form", onsubmit: submit, novalidate: true },
    el("h3", null, text(given ? "own.change" : "answer.title")),
    ...parts.fields,
    parts.confidence,
    problem,
    el("button", { class: "primary" }, text("answer.send")),
  );
}

function answerItem(answer) {
  const { trial, knee, disorder, level, confidence, counts, right, torque_share: share } = answer;
  const answered = kneeText(disorder, level);
  const uncounted = text("answer.uncounted", { share: number(100 * share, 0) });
  return el(
    "li",
    null,
    el("p", null, text("own.answer", { trial, knee: answered, confidence }), " ", outcome(right)),
    knee && el("p", null, text("run.knee", { knee: kneeTitle(knee) })),
    !counts && el("p", null, el("span", { class: "tag no" }, uncounted)),
  );
}

function stateText({ ended, blind, began, takes_answer: takes, scores }) {
  if (ended) return scores ? text("results.total", scores) : text("own.over");
  if (!began) return text("own.next");
  return takes || !blind ? "" : text("own.closed");
}

function lessonView({ name, lesson }) {
  const { trial, trials, knee, answers } = lesson;
  const state = stateText(lesson);
  const given = answers.find((one) => one.trial === trial);
  return [
    el(
      "section",
      { class: "card", "aria-labelledby": "own-title" },
      el("h2", { id: "own-title" }, lessonTitle(lesson)),
      el("p", { class: "hint" }, text("own.name", { name })),
      !lesson.ended && el("p", { class: "trial", role: "status" }, text("run.trial", { trial, trials })),
      !lesson.ended && lesson.instruction && el("p", { class: "instruction" }, lesson.instruction),
      !lesson.ended && knee && el("p", null, text("run.knee", { knee: kneeTitle(knee) })),
      state && el("p", { class: "trial" }, state),
    ),
    lesson.takes_answer && answerForm(lesson, given),
    answers.length > 0 &&
      el(
        "section",
        { class: "card", "aria-labelledby": "own-answers" },
        el("h3", { id: "own-answers" }, text("own.answers")),
        el("ul", { class: "answers" }, ...answers.map(answerItem).reverse()),
      ),
  ];
}

const waiting = ({ name }) =>
  el(
    "section",
    { class: "card" },
    el("h2", null, text("own.welcome", { name })),
    el("p", { role: "status" }, text("own.wait")),
  );

// What is being entered stays, unless there is something new.
function render() {
  const { hello, own } = latest;
  if (!hello) return;
  const now = JSON.stringify([own ?? null, document.documentElement.lang]);
  if (now === shown) return;
  shown = now;
  const parts = !own ? joinForm() : own.lesson ? lessonView(own) : waiting(own);
  byId("main").replaceChildren(...[parts].flat().filter(Boolean));
}

// Nobody has pressed anything: where the seat is gone there is the form, and nothing to explain.
const rejoin = () => join(seat(), (what, more) => ask(what, more).catch(() => null));

await startPhone(render);
on("hello", () => (seat() ? rejoin() : render()));
on("own", render);
connect();
