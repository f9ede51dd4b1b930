// The quiz: a knee whose name, curves and inside are hidden; an answer; then what it was, and the same knee again
// beside a healthy one.

import { el, field } from "../dom.js";
import { onLanguage, text } from "../strings.js";
import { data } from "./data.js";
import { describe, disorderOf, disorders, HEALTHY, titleOf } from "./knees.js";

const any = (list) => list[Math.floor(Math.random() * list.length)];

/** A knee: each disorder is as likely as a healthy knee. */
function drawn() {
  const disorder = any([HEALTHY.disorder, ...disorders()]);
  const list = data.presets.filter((preset) => preset.disorder === disorder);
  return disorder === HEALTHY.disorder ? HEALTHY : any(list);
}

/**
 * The quiz in a box. `show(preset, how)` is called with what is to be examined: `blind`, or `beside` a healthy knee;
 * with null at the end. `missed(preset)` says what the examination has missed, as elements.
 */
export function makeQuiz(host, { show, missed }) {
  let knee = null;
  let answer = null;
  let lacks = [];
  let asked = 0;
  let right = 0;

  const button = (key, act, kind = null) =>
    el("button", { type: "button", class: kind, onclick: act }, text(key));

  function next() {
    knee = drawn();
    answer = null;
    show(knee, { blind: true, beside: false });
    paint();
    host.querySelector("select").focus();
  }

  function give(name) {
    answer = name;
    asked++;
    if (answer === knee.disorder) right++;
    // Before the examination begins anew.
    lacks = missed(knee);
    show(knee, { blind: false, beside: true });
    paint();
    host.querySelector("h3").focus();
  }

  function end() {
    knee = null;
    show(null, { blind: false, beside: false });
    paint();
  }

  const invitation = () => [
    el("p", null, text("quiz.about")),
    el("div", { class: "row" }, button("quiz.start", next, "primary")),
  ];

  function question() {
    const option = (name) => el("option", { value: name }, disorderOf(name));
    const select = el("select", null, el("option", { value: "" }, text("answer.choose")));
    select.append(...[HEALTHY.disorder, ...disorders()].map(option));
    select.value = answer ?? "";
    const send = button("quiz.answer", () => give(select.value), "primary");
    send.disabled = true;
    select.addEventListener("change", () => (send.disabled = select.value === ""));
    return [
      el("p", { class: "instruction" }, text("quiz.examine")),
      el("div", { class: "row" }, field(text("quiz.which"), select), send, button("quiz.end", end)),
    ];
  }

  function result() {
    const isRight = answer === knee.disorder;
    const verdict = text(isRight ? "answer.right" : "answer.wrong");
    return [
      el(
        "h3",
        { tabindex: -1 },
        el("span", { class: `tag ${isRight ? "yes" : "no"}` }, verdict),
        " ",
        text("quiz.was", { knee: titleOf(knee) }),
      ),
      isRight ? null : el("p", null, text("quiz.said", { answer: disorderOf(answer) })),
      ...describe(knee),
      ...lacks,
      el("p", null, text("quiz.beside")),
      el("p", { role: "status" }, text("quiz.score", { right, asked })),
      el("div", { class: "row" }, button("quiz.next", next, "primary"), button("quiz.end", end)),
    ];
  }

  function paint() {
    const parts = knee === null ? invitation() : answer === null ? question() : result();
    host.replaceChildren(el("h2", null, text("quiz.title")), ...parts.filter(Boolean));
  }

  onLanguage(paint);
  paint();
}
