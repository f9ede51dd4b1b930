// Setting up a lesson: one that ships, or a plan of one's own.

import { classCard } from "./class.js";
import { isTeacher, latest } from "./connection.js";
import { controlReason } from "./control.js";
import { el, field, freshId, setText, tick } from "./dom.js";
import { disorderName, lessonTitle, presets, presetText } from "./names.js";
import { request } from "./report.js";
import { text, textOr } from "./strings.js";

// A pseudonym to begin with, as long as nobody has joined by phone.
const SUGGESTED = "A";

// What was entered stays when the view is built again.
const entered = {
  lesson: undefined,
  students: SUGGESTED,
  seed: "",
  repeats: 1,
  title: "",
  blind: true,
  curves: false,
  feedback: "end",
  knees: [{ preset: "healthy" }, { preset: "mas-2-catch" }],
};
let view = null;

const targetName = (target) => textOr(`target.${target.name}`, target.name);

function presetChoice(chosen) {
  const select = el("select", null, el("option", { value: "healthy" }, text("knee.healthy")));
  const known = latest.hello.disorders.map((disorder) => disorder.name);
  for (const disorder of [...known, ""]) {
    const list = presets().filter((preset) =>
      disorder ? preset.disorder === disorder : !known.includes(preset.disorder),
    );
    if (!list.length) continue;
    const options = list.map((preset) => el("option", { value: preset.name }, presetText(preset, "title")));
    select.append(el("optgroup", { label: disorderName(disorder) }, ...options));
  }
  select.value = chosen;
  return select;
}

function kneeRow(knee, nth) {
  const bind = (input, key, read = (value) => value) => {
    input.addEventListener("input", () => (knee[key] = read(input.value)));
    return input;
  };
  const preset = bind(presetChoice(knee.preset), "preset");
  const instruction = bind(el("input", { value: knee.instruction ?? "", maxlength: 200 }), "instruction");
  const targets = latest.hello.targets.map((target) =>
    el("option", { value: target.name }, targetName(target)),
  );
  const target = bind(
    el("select", null, el("option", { value: "" }, text("target.none")), ...targets),
    "target",
  );
  target.value = knee.target ?? "";
  const time = bind(el("input", { type: "number", min: 5, max: 3600, value: knee.time_s ?? "" }), "time_s");
  const remove = el(
    "button",
    { type: "button", "aria-label": text("plan.remove-nth", { nth: nth + 1 }) },
    text("plan.remove"),
  );
  remove.addEventListener("click", () => {
    entered.knees.splice(nth, 1);
    showKnees();
    view.addKnee.focus();
  });
  remove.disabled = entered.knees.length < 2;
  return el(
    "fieldset",
    { class: "knee-row" },
    el("legend", { class: "hidden" }, text("plan.nth", { nth: nth + 1 })),
    field(text("plan.knee", { nth: nth + 1 }), preset),
    field(text("plan.instruction"), instruction),
    field(text("plan.target"), target),
    field(text("plan.time"), time),
    el("div", { class: "row" }, remove),
  );
}

const showKnees = () => view.knees.replaceChildren(...entered.knees.map(kneeRow));

function planOf() {
  const knees = entered.knees.map((knee) => {
    const one = { preset: knee.preset };
    if (knee.instruction?.trim()) one.instruction = knee.instruction.trim();
    if (knee.target) one.target = knee.target;
    if (Number(knee.time_s) > 0) one.time_s = Number(knee.time_s);
    return one;
  });
  const { blind, curves, feedback } = entered;
  return { title: entered.title.trim() || text("plan.untitled"), blind, curves, feedback, knees };
}

/** The number of students who have joined by phone: the lesson has them besides those entered. */
const joined = () => latest.class?.seats?.length ?? 0;

const isBlind = () =>
  entered.lesson
    ? latest.hello.lessons.find((lesson) => lesson.name === entered.lesson)?.blind
    : entered.blind;

async function begin() {
  const students = [
    ...new Set(
      entered.students
        .split(/[\n,;]+/)
        .map((name) => name.trim())
        .filter(Boolean),
    ),
  ];
  const most = latest.hello.students_max;
  if ((!students.length && !joined() && isBlind()) || students.length > most) {
    return setText(view.problem, text("setup.bad-students", { most }));
  }
  const seed = String(entered.seed).trim();
  if (seed && !/^\d{1,15}$/.test(seed)) return setText(view.problem, text("setup.bad-seed"));
  setText(view.problem, "");
  const what = entered.lesson ? { lesson: entered.lesson } : { plan: planOf() };
  return request("lesson-begin", {
    ...what,
    students,
    seed: seed ? Number(seed) : null,
    repeats: Math.max(1, Math.round(Number(entered.repeats) || 1)),
  });
}

function lessonChoices() {
  const choice = (value, title, about) => {
    const input = el("input", {
      type: "radio",
      name: "lesson",
      value,
      checked: entered.lesson === (value || null),
    });
    input.addEventListener("change", () => {
      entered.lesson = value || null;
      view.plan.hidden = entered.lesson !== null;
    });
    const id = freshId("about");
    input.setAttribute("aria-describedby", id);
    return el("div", null, tick(title, input), el("p", { class: "hint", id }, about));
  };
  const shipped = latest.hello.lessons.map((lesson) => {
    const kind = text(lesson.blind ? "setup.blind" : "setup.open");
    const about = textOr(`lesson.${lesson.name}.description`, lesson.description);
    const knees = text("setup.knees", { count: lesson.knees });
    return choice(lesson.name, lessonTitle(lesson), `${about} ${knees}, ${kind}.`);
  });
  return [...shipped, choice("", text("setup.own"), text("setup.own-about"))];
}

function bound(input, key) {
  input.addEventListener(
    "input",
    () => (entered[key] = input.type === "checkbox" ? input.checked : input.value),
  );
  return input;
}

function planForm() {
  const feedback = el(
    "select",
    { class: "feedback" },
    el("option", { value: "end" }, text("plan.feedback-end")),
    el("option", { value: "each" }, text("plan.feedback-each")),
  );
  feedback.value = entered.feedback;
  view.knees = el("div");
  view.addKnee = el("button", { type: "button" }, text("plan.add"));
  view.addKnee.addEventListener("click", () => {
    entered.knees.push({ ...entered.knees.at(-1), preset: "healthy" });
    showKnees();
    view.knees.lastElementChild.querySelector("select").focus();
  });
  showKnees();
  const wide = field(
    text("plan.title"),
    bound(el("input", { value: entered.title, maxlength: 80 }), "title"),
  );
  wide.classList.add("wide");
  return el(
    "section",
    { class: "card", "aria-labelledby": "plan-heading" },
    el("h3", { id: "plan-heading" }, text("setup.own")),
    wide,
    tick(text("plan.blind"), bound(el("input", { type: "checkbox", checked: entered.blind }), "blind")),
    tick(text("plan.curves"), bound(el("input", { type: "checkbox", checked: entered.curves }), "curves")),
    field(text("plan.feedback"), bound(feedback, "feedback")),
    view.knees,
    el("div", { class: "row" }, view.addKnee),
  );
}

function unfinishedItem(lesson) {
  const { folder, started, trial, trials, students } = lesson;
  const facts = text("setup.continue-facts", { started, trial, trials, students });
  const resume = el("button", { type: "button", onclick: () => request("lesson-resume", { folder }) });
  setText(resume, text("setup.continue"));
  view.resume.push(resume);
  return el("li", null, el("span", { class: "grow" }, lessonTitle(lesson), " · ", facts), resume);
}

/** Offers the lessons that were interrupted. */
async function showUnfinished() {
  const { unfinished } = view;
  const found = latest.hello.stores && isTeacher() ? await request("lessons") : null;
  // Meanwhile the view may have been built again.
  if (unfinished !== view.unfinished) return;
  const lessons = found?.lessons ?? [];
  unfinished.hidden = !lessons.length;
  view.resume = [];
  const title = el("h3", { id: "unfinished-title" }, text("setup.unfinished"));
  unfinished.replaceChildren(title, el("ul", { class: "seats" }, ...lessons.map(unfinishedItem)));
  updateSetup();
}

/** Builds the setup. */
export function showSetup(host) {
  const { lessons, stores } = latest.hello;
  if (entered.lesson === undefined) entered.lesson = lessons[0]?.name ?? null;
  view = {
    why: el("p", { class: "hint" }),
    unfinished: el("section", { class: "card", "aria-labelledby": "unfinished-title", hidden: true }),
    resume: [],
    problem: el("p", { class: "problem", role: "alert" }),
    begin: el(
      "button",
      { type: "button", class: "primary", id: "lesson-begin", onclick: begin },
      text("setup.begin"),
    ),
  };
  view.students = bound(el("textarea", { id: "students", rows: 3 }), "students");
  view.students.value = entered.students;
  view.plan = planForm();
  view.plan.hidden = entered.lesson !== null;
  host.replaceChildren(
    view.unfinished,
    el(
      "section",
      { class: "card" },
      el("h2", null, text("setup.title")),
      el("fieldset", null, el("legend", null, text("setup.which")), ...lessonChoices()),
    ),
    view.plan,
    el(
      "section",
      { class: "card", "aria-labelledby": "setup-students" },
      el("h3", { id: "setup-students" }, text("setup.who")),
      field(text("setup.students"), view.students, text("setup.students-hint")),
      el(
        "div",
        { class: "row" },
        field(
          text("setup.seed"),
          bound(el("input", { inputmode: "numeric", value: entered.seed, size: 12 }), "seed"),
        ),
        field(
          text("setup.repeats"),
          bound(el("input", { type: "number", min: 1, max: 20, value: entered.repeats }), "repeats"),
        ),
      ),
      el("p", { class: "hint" }, text("setup.seed-hint")),
      el(
        "p",
        { class: "hint" },
        stores ? text("setup.stores", { folder: stores }) : text("setup.stores-nothing"),
      ),
      view.problem,
      el("div", { class: "row" }, view.begin),
      view.why,
    ),
    classCard(),
  );
  updateSetup();
  showUnfinished();
}

/** Shows whether a lesson can begin. */
export function updateSetup() {
  const why = controlReason();
  view.begin.disabled = why !== "";
  for (const button of view.resume) button.disabled = why !== "";
  if (joined() && entered.students === SUGGESTED) view.students.value = entered.students = "";
  setText(view.why, why ? text("setup.disabled", { why }) : "");
}
