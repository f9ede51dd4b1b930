// The header: state, who controls, what to do next, control buttons with the reason why
// one is disabled, stop, faults.

import { ask, isController, isReplay, isTeacher, keyFault, latest, on } from "./connection.js";
import { byId, el, setText } from "./dom.js";
import { confirmed } from "./dialogs.js";
import { request, say } from "./report.js";
import { startStop } from "./stop.js";
import { number, onLanguage, text, textOr } from "./strings.js";
import { answerOf, kneeName, presetOf, presetText } from "./names.js";
import { nextSentence } from "./next.js";

let link = "connecting";
let lastMessage = null;
let silentFor = 0;
let dismissed = 0;

function stateName() {
  if (link !== "open") return link;
  if (isReplay()) return "replay";
  const status = latest.status;
  if (!status) return "connecting";
  return status.link === "lost" ? "device-lost" : status.state;
}

/** Why a control is disabled, as a key of the texts; null if it is enabled. */
function reason(name) {
  const status = latest.status;
  const state = stateName();
  if (link !== "open") return "why.no-connection";
  if (!isTeacher()) return "why.viewer";
  if (name === "take") return null;
  if (!isController()) return "why.no-control";
  if (!status || status.link === "lost") return "why.no-device";
  const torque = state === "armed" || state === "arming";
  if (name === "disarm") return torque ? null : "why.no-torque";
  if (torque) return name === "zero" ? "why.armed" : "why.armed-already";
  if (name === "arm" && status.faults.some((fault) => !fault.coil)) return "why.fault";
  if (name === "arm" && !status.zeroed) return "why.zero-first";
  return null;
}

/** Why this page cannot change the knee or run a lesson now, in text; "" if it can. */
export function controlReason() {
  const key =
    link !== "open"
      ? "why.no-connection"
      : !isTeacher()
        ? "why.viewer"
        : isController()
          ? null
          : "why.no-control";
  return key ? text(key) : "";
}

/** What the brace's own friction adds to the knee, as long as its compensation is off. */
function frictionHint() {
  const { hello, parameters } = latest;
  if (!hello || !parameters?.values || isReplay() || !isTeacher()) return "";
  const values = new Map(parameters.values);
  const value = (key) => values.get(hello.parameters.find(({ name }) => name === `friction-compensation.${key}`)?.id);
  if (value("render") !== 0) return "";
  return text("control.friction", { friction: number(value("friction_nm"), 2) });
}

function showControls() {
  byId("controls").hidden = isReplay();
  const grouped = new Map();
  for (const name of ["take", "zero", "arm", "disarm"]) {
    const key = reason(name);
    byId(name).disabled = key !== null;
    if (key) grouped.set(key, [...(grouped.get(key) ?? []), text(`control.${name}`)]);
  }
  const lines = [...grouped].map(([key, names]) => `${names.join(", ")}: ${text(key)}.`);
  setText(byId("why"), lines.join(" "));
  setText(byId("take"), text(isController() ? "control.release" : "control.take"));
  setText(byId("friction"), frictionHint());
  const holder = latest.holder;
  const who = isController() ? "holder.you" : holder?.taken ? "holder.other" : "holder.nobody";
  const other = latest.status?.other;
  setText(byId("holder"), link !== "open" ? "–" : other ? text("holder.program", { name: other }) : text(who));
}

function showNext() {
  const { status, lesson, experiment, parameters } = latest;
  const preset = presetOf(parameters?.preset);
  const facts = {
    state: stateName(),
    isTeacher: isTeacher(),
    isController: isController(),
    other: Boolean(status?.other),
    hasFault: status?.faults?.some((fault) => !fault.coil),
    isZeroed: status?.zeroed,
    lesson,
    experiment,
    isAnswered: lesson?.students.every((student) => answerOf(lesson, student)),
    isHealthy: parameters?.preset === "healthy",
    knee: kneeName(),
    feel: preset && presetText(preset, "feel"),
  };
  setText(byId("next"), nextSentence(facts));
}

// In one line; what the system says about it is for those who ask.
function showLoss() {
  const isLost = stateName() === "device-lost";
  byId("lost").hidden = !isLost;
  setText(byId("lost-detail"), isLost ? (latest.status.message ?? "") : "");
}

function showState() {
  const name = stateName();
  const chip = byId("state");
  setText(chip, textOr(`device.state.${name}`, name).replace("{seconds}", number(silentFor, 1)));
  chip.dataset.state = name;
  byId("stop").classList.toggle("live", name === "armed" || name === "arming");
  const source = latest.hello?.source;
  setText(
    byId("device"),
    !source
      ? "–"
      : isReplay()
        ? text("header.file")
        : source.simulated
          ? text("header.simulated")
          : [source.name, source.serial].filter(Boolean).join(" · "),
  );
  setText(byId("knee-now"), kneeName());
  showControls();
}

/** The fault's page of the book, read when it is opened. */
function bookPage(code) {
  const inside = el("div");
  const load = async () => {
    if (inside.childElementCount) return;
    const page = await ask("fault", { code }).catch((error) => say(error.message, true));
    if (!page) return;
    const rows = page.rows.map(([name, value]) => el("div", null, el("dt", null, name), el("dd", null, value)));
    const paragraphs = page.paragraphs.map((paragraph) => el("p", null, paragraph));
    inside.replaceChildren(el("dl", { class: "facts" }, ...rows), ...paragraphs);
  };
  return el("details", { ontoggle: load }, el("summary", null, text("fault.more")), inside);
}

let faultsShown = "";
function showFaults() {
  const faults = latest.status?.faults ?? [];
  const shown = JSON.stringify([faults, isController(), document.documentElement.lang]);
  if (shown === faultsShown) return;
  faultsShown = shown;
  const items = faults.map(({ code, coil }) => {
    const table = coil ? latest.hello?.coil_faults : latest.hello?.faults;
    const fault = table?.find((entry) => entry.code === code) ?? { code, name: "?", cause: "", remedy: "" };
    // The command of the terminal is a button here.
    const remedy = fault.remedy.replace("clear-fault", text("fault.clear-named"));
    return el(
      "div",
      { class: "fault" },
      el("strong", null, text(coil ? "fault.coil-title" : "fault.title", fault)),
      el("p", null, text("fault.cause", fault)),
      el("p", null, text("fault.remedy", { remedy })),
      coil ? null : bookPage(code),
    );
  });
  if (items.length && isController()) {
    items.push(
      el(
        "button",
        { type: "button", id: "clear-fault", onclick: () => request("clear-fault") },
        text("fault.clear"),
      ),
    );
  }
  byId("faults").replaceChildren(...items);
}

async function take() {
  if (isController()) return request("release");
  if (latest.holder?.taken && !(await confirmed(text("control.take-over")))) return null;
  return request("take");
}

function showMessage() {
  const message = latest.status?.message ?? null;
  if (message && message !== lastMessage && stateName() !== "device-lost") say(message);
  lastMessage = message;
}

// Until the next arming: a message that fades is not seen by somebody who looks at the leg.
function showTorqueEnd() {
  const end = latest.status?.torque_end;
  const isShown = Boolean(end) && end.unix_ms !== dismissed;
  byId("torque-end").hidden = !isShown;
  if (!isShown) return;
  const time = new Date(end.unix_ms).toLocaleTimeString(document.documentElement.lang);
  const fault = latest.hello?.faults.find((entry) => entry.code === end.code)?.name ?? "";
  const why = text(`ended.${end.cause}`, { code: end.code, fault, name: end.name });
  setText(byId("torque-end-text"), text("ended", { time, why }));
}

function update() {
  showState();
  showNext();
  showLoss();
  showTorqueEnd();
  showFaults();
}

/** Starts the header. */
export function startControl() {
  startStop();
  byId("torque-end-dismiss").addEventListener("click", () => {
    dismissed = latest.status?.torque_end?.unix_ms ?? 0;
    showTorqueEnd();
  });
  byId("take").addEventListener("click", take);
  for (const name of ["zero", "arm", "disarm"]) byId(name).addEventListener("click", () => request(name));
  on("open", () => {
    link = "open";
    update();
  });
  on("lost", () => {
    link = "connection-lost";
    update();
  });
  on("silent", (seconds) => {
    link = "silent";
    // In halves of a second: it is read aloud, too.
    silentFor = Math.max(0.5, Math.floor(seconds * 2) / 2);
    update();
  });
  on("heard", () => {
    link = "open";
    update();
  });
  on("refused", () => {
    link = "refused";
    update();
    byId("faults").replaceChildren(el("div", { class: "fault" }, el("strong", null, text(`refused.${keyFault()}`))));
  });
  for (const kind of ["hello", "status", "holder", "parameters", "presets", "lesson", "experiment"]) on(kind, update);
  on("status", showMessage);
  onLanguage(() => {
    faultsShown = "";
    update();
  });
  update();
}
