// The Recordings tab: the list, and which recordings are open in the player.

import { outcome } from "./answer-form.js";
import { isReplay, isTeacher, on } from "./connection.js";
import { byId, el, setText } from "./dom.js";
import { kneeText, recordingTitle } from "./names.js";
import { request } from "./report.js";
import { number, onLanguage, text } from "./strings.js";
import { onTab } from "./tabs.js";

let view = null;
let player = null;
let files = null;
let first = null;
let second = null;

function size(bytes) {
  return bytes >= 1e6 ? `${number(bytes / 1e6, 1)} MB` : `${number(bytes / 1e3)} kB`;
}

function when(seconds) {
  const date = new Date(Number.isFinite(seconds) && seconds > 0 ? seconds * 1000 : NaN);
  return Number.isNaN(date.getTime())
    ? ""
    : date.toLocaleString(document.documentElement.lang);
}

/** Shows what is open, by a player that is loaded with the first recording. */
async function play() {
  const { Player } = await import("./player.js");
  player ??= new Player(view.player);
  player.show(first, second);
}

async function open(file, asSecond) {
  const opened = await request("open", { recording: file.id });
  if (!opened) return;
  if (asSecond) second = opened;
  else {
    first = opened;
    if (second?.id === opened.id) second = null;
  }
  view.player.hidden = false;
  await play();
  showList();
  if (!asSecond) view.player.scrollIntoView({ block: "start" });
}

function close(file) {
  if (second?.id === file.id) second = null;
  play();
  showList();
}

/** The answers to the trial of a recording. */
const answersOf = ({ lesson }) =>
  (lesson?.answers ?? []).map(({ student, disorder, level, right }) =>
    el("li", null, `${student}: ${kneeText(disorder, level)} `, outcome(right)),
  );

function row(file) {
  const title = recordingTitle(file);
  const answers = answersOf(file);
  const isFirst = first?.id === file.id;
  const isSecond = second?.id === file.id;
  const facts = [
    title === file.name ? null : file.name,
    Number.isFinite(file.seconds) ? text("recordings.seconds", { seconds: number(file.seconds, 1) }) : null,
    Number.isFinite(file.rows) ? text("recordings.rows", { rows: number(file.rows) }) : null,
    Number.isFinite(file.size) ? size(file.size) : null,
    when(file.when),
  ];
  const openButton = el(
    "button",
    {
      type: "button",
      class: "open",
      disabled: isFirst,
      "aria-label": text("recordings.open-name", { name: title }),
      onclick: () => open(file, false),
    },
    text("recordings.open"),
  );
  const compare = el(
    "button",
    {
      type: "button",
      class: "compare",
      disabled: !first || isFirst,
      "aria-label": text(isSecond ? "recordings.apart-name" : "recordings.compare-name", { name: title }),
      onclick: () => (isSecond ? close(file) : open(file, true)),
    },
    text(isSecond ? "recordings.apart" : "recordings.compare"),
  );
  const shown = isFirst ? text("recordings.first") : isSecond ? text("recordings.second") : null;
  return el(
    "li",
    { class: "recording", "data-recording": file.id },
    el(
      "div",
      null,
      el("strong", null, title),
      " ",
      shown && el("span", { class: "tag" }, shown),
      answers.length > 0 && el("ul", { class: "plain" }, ...answers),
      el("p", { class: "hint" }, facts.filter(Boolean).join(" · ")),
    ),
    el("div", { class: "row" }, openButton, compare),
  );
}

function showList() {
  if (!view) return;
  // The buttons are made again: keep the focus where it was.
  const focused = document.activeElement?.closest?.("[data-recording]")?.dataset.recording;
  const kind = document.activeElement?.classList.contains("compare") ? ".compare" : ".open";
  view.list.replaceChildren(...(files ?? []).map(row));
  if (focused) {
    const again = view.list.querySelector(`[data-recording="${CSS.escape(focused)}"]`);
    const button = again?.querySelector(kind);
    (button?.disabled ? (again.querySelector("button:not(:disabled)") ?? view.refresh) : button)?.focus();
  }
  const words = !isTeacher()
    ? text("recordings.viewer")
    : files === null
      ? text("recordings.loading")
      : files.length
        ? ""
        : text("recordings.none");
  setText(view.words, words);
  view.refresh.disabled = !isTeacher();
}

async function load() {
  if (!isTeacher()) return showList();
  const ok = await request("recordings");
  if (ok) files = ok.files ?? [];
  showList();
  // A page that replays one file shows it at once.
  if (isReplay() && files?.length && !first) await open(files[0], false);
  return null;
}

function build() {
  const wasOpen = view !== null && !view.player.hidden;
  view = {
    list: el("ul", { class: "recordings-list" }),
    words: el("p", { class: "hint", role: "status" }),
    refresh: el("button", { type: "button", onclick: load }, text("recordings.refresh")),
    player: el("div", { class: "player", hidden: !wasOpen }),
  };
  byId("recordings").replaceChildren(
    el(
      "section",
      { class: "card", "aria-labelledby": "recordings-title" },
      el(
        "div",
        { class: "dialog-head" },
        el("h2", { id: "recordings-title" }, text("recordings.title")),
        view.refresh,
      ),
      view.words,
      view.list,
    ),
    view.player,
  );
  player = null;
  if (wasOpen && first) play();
  showList();
}

/** Starts the Recordings tab. */
export function startRecordings() {
  build();
  on("hello", () => {
    files = null;
    build();
    if (!byId("recordings").hidden || isReplay()) load();
  });
  onTab((name) => {
    if (name === "recordings" && files === null) load();
  });
  onLanguage(build);
}
