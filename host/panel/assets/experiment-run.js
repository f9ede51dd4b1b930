// A session: feel the intervals, answer. The page gets no level, and cannot show one.

import { choice, scale } from "./answer-form.js";
import { latest } from "./connection.js";
import { controlReason } from "./control.js";
import { confirmed } from "./dialogs.js";
import { byId, el, field, setText } from "./dom.js";
import { resultsCard } from "./experiment-setup.js";
import { disorderName, levelName } from "./names.js";
import { request } from "./report.js";
import { text } from "./strings.js";

let view = null;

const isArmed = () => latest.status?.state === "armed";
const intervalName = (session, place) =>
  session.kind === "realism"
    ? text("experiment.knee")
    : session.kind === "abx"
      ? "ABX"[place]
      : String(place + 1);

/** Sends a step; until it is answered nothing else can be pressed. */
async function send(step, more) {
  if (view.isBusy) return null;
  view.isBusy = true;
  updateSession(latest.experiment);
  const done = await request("experiment", { step, trial: latest.experiment.trial?.number, ...more });
  if (view) view.isBusy = false;
  if (latest.experiment) updateSession(latest.experiment);
  return done;
}

async function feel(interval) {
  view.follows = interval;
  if (!(await send("feel", { interval }))) view.follows = 0;
}

async function leave() {
  const { over } = latest.experiment;
  if (over || (await confirmed(text("experiment.leave-early")))) await send("leave");
}

/** Buttons of a choice, and the key of each. */
function alternatives(session) {
  const isAbx = session.kind === "abx";
  view.choices = ["1", "2"].map((number, place) => {
    const key = isAbx ? "AB"[place] : number;
    const label = isAbx ? [`${text("experiment.x-is", { name: key })} `, el("kbd", null, key)] : key;
    const button = el(
      "button",
      { type: "button", "aria-keyshortcuts": key, onclick: () => send("choose", { answer: place + 1 }) },
      label,
    );
    return { key, button };
  });
  return el(
    "section",
    { class: "card", "aria-labelledby": "experiment-answer" },
    el("h3", { id: "experiment-answer" }, session.question ?? text("answer.title")),
    el("div", { class: "row alternatives" }, view.choices.map(({ button }) => button)),
  );
}

/** A form whose button sends what `read` returns, unless it is null. */
function form(title, parts, button, step, read) {
  const problem = el("p", { class: "problem", role: "alert" });
  view.send = el("button", { class: "primary" }, button);
  const submit = (event) => {
    event.preventDefault();
    const more = read();
    setText(problem, more ? "" : text("experiment.incomplete"));
    if (more) send(step, more);
  };
  return el(
    "form",
    { class: "card", id: "experiment-form", onsubmit: submit, novalidate: true },
    el("h3", null, title),
    ...parts,
    problem,
    el("div", { class: "row" }, view.send),
  );
}

function describeForm() {
  const words = el("textarea", { rows: 4, maxlength: 1000 });
  const read = () => words.value.trim() && { text: words.value };
  const part = field(text("experiment.describe"), words, text("experiment.describe-hint"));
  return form(text("experiment.describe-title"), [part], text("experiment.describe-send"), "describe", read);
}

function rateForm({ features, severities, trial }) {
  const ends = [text("experiment.not-real"), text("experiment.real")];
  const scales = [text("experiment.whole"), ...features].map((name, place) =>
    scale(`realism-${place}`, text("experiment.realism", { name }), ends),
  );
  const none = text("answer.choose");
  const gradeName = (name) => (name === "none" ? text("experiment.severity-none") : levelName(name));
  const severity = choice("severity", severities, gradeName, none);
  const types = ["healthy", ...latest.hello.disorders.map(({ name }) => name)];
  const finding = choice("finding", types, disorderName, none);
  const read = () => {
    const realism = scales.map((one) => one.read());
    const isWhole = realism.every(Boolean) && severity.value && finding.value;
    return isWhole ? { realism, severity: severity.value, finding: finding.value } : null;
  };
  const parts = [
    el("p", null, text("experiment.described", { description: trial.described })),
    ...scales.map(({ root }) => root),
    el(
      "div",
      { class: "row" },
      field(text("answer.level"), severity),
      field(text("answer.disorder"), finding),
    ),
  ];
  return form(text("experiment.rate-title"), parts, text("experiment.rate-send"), "rate", read);
}

const answerPart = (session) =>
  session.kind !== "realism"
    ? alternatives(session)
    : session.trial.described === null
      ? describeForm()
      : rateForm(session);

/** Builds the view of a trial, or of the end. */
export function showSession(host, session, follows) {
  const { title, question, kind, participant, trial, answered, folder } = session;
  const hadFocus = follows && (host.contains(document.activeElement) || document.activeElement === document.body);
  view = {
    isBusy: false,
    // The interval that was asked for: once it is felt, the next one has the focus.
    follows: 0,
    intervals: [],
    choices: [],
    send: null,
    why: el("p", { class: "hint", role: "status" }),
    leave: el("button", { type: "button", id: "experiment-leave", onclick: leave }, text("experiment.leave")),
  };
  const facts = el("p", { class: "hint" }, text("experiment.facts", { participant, folder }));
  if (!trial) {
    view.leave.classList.add("primary");
    const over = text("experiment.over", { count: answered });
    host.replaceChildren(
      el(
        "section",
        { class: "card" },
        el("h2", null, title),
        el("p", { class: "trial", role: "status" }, over),
        el("div", { class: "row" }, view.leave),
        facts,
      ),
      resultsCard(latest.experiment.study),
    );
    return updateSession(session);
  }
  view.intervals = trial.felt.map((_, place) =>
    el(
      "button",
      { type: "button", class: "feel-interval", onclick: () => feel(place + 1) },
      text("experiment.feel", { name: intervalName(session, place) }),
    ),
  );
  const progress = el("progress", { "aria-label": text("experiment.progress"), max: trial.of });
  progress.value = answered;
  const number = text(session.at_most ? "experiment.trial-at-most" : "experiment.trial", trial);
  host.replaceChildren(
    el(
      "section",
      { class: "card" },
      el("h2", null, title),
      el("p", { class: "trial", role: "status" }, number),
      progress,
      kind === "realism" && question && el("p", { class: "instruction" }, question),
      el("div", { class: "row alternatives" }, ...view.intervals),
      view.why,
    ),
    answerPart(session),
    el("section", { class: "card" }, el("div", { class: "row" }, view.leave), facts),
  );
  updateSession(session);
  const first = trial.described === null ? view.intervals[0] : byId("experiment-form").querySelector("input");
  if (hadFocus) first.focus();
  return null;
}

/** Shows what can be done now. */
export function updateSession(session) {
  const { kind, trial } = session;
  const why = controlReason();
  view.leave.disabled = why !== "" || view.isBusy;
  if (!trial) return;
  const { felt, on_device: onDevice } = trial;
  const canFeel = why === "" && isArmed() && !view.isBusy;
  for (const [place, button] of view.intervals.entries()) {
    // In 2IFC each is felt once, one after the other.
    const isNext = kind !== "2ifc" || place === felt.indexOf(false);
    button.disabled = !canFeel || !isNext;
    button.setAttribute("aria-pressed", String(onDevice === place + 1));
    button.classList.toggle("primary", place === felt.indexOf(false));
  }
  if (felt[view.follows - 1]) {
    view.follows = 0;
    view.intervals[felt.indexOf(false)]?.focus();
  }
  const isFelt = felt.every(Boolean);
  const canAnswer = canFeel && isFelt;
  for (const { button } of view.choices) button.disabled = !canAnswer;
  if (view.send) view.send.disabled = !canAnswer;
  const key = !isArmed() ? "experiment.no-torque" : isFelt ? "experiment.answer-now" : "experiment.feel-first";
  setText(view.why, why ? text("experiment.disabled", { why }) : text(key));
}

/** Answers by key: 1 and 2, or A and B. */
export function pressKey(event) {
  const isTyping = event.target.closest?.("input:not([type=checkbox]), textarea, select, dialog");
  const isOther = event.repeat || event.ctrlKey || event.metaKey || event.altKey;
  if (isTyping || isOther || byId("experiment").hidden || !latest.experiment) return;
  const pressed = view?.choices.find(({ key }) => key === event.key.toUpperCase());
  if (!pressed || pressed.button.disabled) return;
  event.preventDefault();
  pressed.button.click();
}
