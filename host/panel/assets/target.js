// The target speed of an examination: choice, feedback while moving, score,
// and a metronome to see and, if wanted, to hear.

import { latest, on } from "./connection.js";
import { controlReason } from "./control.js";
import { byId, el, field, setText } from "./dom.js";
import { setBand } from "./live.js";
import { request } from "./report.js";
import { number, onLanguage, text, textOr } from "./strings.js";

const view = {};
let spokenAt = 0;
let spoken = "";
let audio = null;
let lastBeat = -1;
let beatsBegan = 0;

const targetName = (target) => textOr(`target.${target.name}`, target.name);

function limits(target) {
  if (target.kind === "metronome") return text("target.beats", { beats: number(target.beats_per_min) });
  const low = number(target.low_deg_per_s);
  return Number.isFinite(target.high_deg_per_s)
    ? text("target.range", { low, high: number(target.high_deg_per_s) })
    : text("target.above", { low });
}

async function choose() {
  const value = view.choice.value;
  view.own.hidden = value !== ":speed";
  view.beats.hidden = value !== ":metronome";
  if (value === ":speed" || value === ":metronome") return;
  await request("target", { target: value || null });
}

function applyOwn() {
  const speed = view.choice.value === ":speed";
  const low = view.low.valueAsNumber;
  const high = view.high.valueAsNumber;
  if (speed ? !(high > low) : !(view.rate.valueAsNumber > 0)) {
    return setText(view.problem, text(speed ? "target.bad-range" : "target.bad-rate"));
  }
  setText(view.problem, "");
  const target = speed
    ? { low_deg_per_s: low, high_deg_per_s: high }
    : { beats_per_min: view.rate.valueAsNumber };
  return request("target", { target });
}

function build() {
  const targets = latest.hello?.targets ?? [];
  const kept = view.choice?.value ?? "";
  view.choice = el(
    "select",
    { onchange: choose },
    el("option", { value: "" }, text("target.none")),
    ...targets.map((target) =>
      el("option", { value: target.name }, `${targetName(target)} · ${limits(target)}`),
    ),
    el("option", { value: ":speed" }, text("target.own")),
    el("option", { value: ":metronome" }, text("target.own-metronome")),
  );
  view.choice.value = kept;
  view.low = el("input", { type: "number", min: 1, max: 600, value: view.low?.value ?? 20 });
  view.high = el("input", { type: "number", min: 1, max: 600, value: view.high?.value ?? 60 });
  view.rate = el("input", { type: "number", min: 10, max: 240, value: view.rate?.value ?? 60 });
  view.set = [0, 1].map(() => el("button", { type: "button", onclick: applyOwn }, text("target.set")));
  view.own = el(
    "div",
    { class: "row", hidden: kept !== ":speed" },
    field(text("target.low"), view.low),
    field(text("target.high"), view.high),
    view.set[0],
  );
  view.beats = el(
    "div",
    { class: "row", hidden: kept !== ":metronome" },
    field(text("target.rate"), view.rate),
    view.set[1],
  );
  view.problem = el("p", { class: "problem", role: "alert" });
  view.beat = el("span", { class: "beat", "aria-hidden": "true", hidden: true });
  view.click = el("input", { type: "checkbox", checked: view.click?.checked ?? false, onchange: startAudio });
  view.clickLabel = el(
    "label",
    { class: "tick", hidden: true },
    view.click,
    el("span", null, text("target.click")),
  );
  view.word = el("p", { class: "verdict", "aria-hidden": "true" });
  view.score = el("p", { class: "score" });
  view.run = el("button", {
    type: "button",
    onclick: () => request("score", { running: !latest.target?.running }),
  });
  view.why = el("p", { class: "hint" });
  byId("target").replaceChildren(
    el("h3", { id: "target-title", class: "hidden" }, text("target.title")),
    el(
      "div",
      { class: "target-line" },
      field(text("target.title"), view.choice),
      view.beat,
      view.word,
      view.run,
      view.clickLabel,
    ),
    view.own,
    view.beats,
    view.problem,
    view.score,
    view.why,
  );
  update();
}

function startAudio() {
  if (view.click.checked) audio ??= new AudioContext();
  audio?.resume();
}

function click() {
  if (!audio || !view.click.checked) return;
  const gain = audio.createGain();
  const tone = audio.createOscillator();
  gain.gain.setValueAtTime(0.25, audio.currentTime);
  gain.gain.exponentialRampToValueAtTime(0.001, audio.currentTime + 0.05);
  tone.frequency.value = 1000;
  tone.connect(gain).connect(audio.destination);
  tone.start();
  tone.stop(audio.currentTime + 0.06);
}

function beat(now) {
  requestAnimationFrame(beat);
  const target = latest.target?.target;
  if (target?.kind !== "metronome" || !(target.beats_per_min > 0)) return;
  const period = 60000 / target.beats_per_min;
  const nth = Math.floor((now - beatsBegan) / period);
  view.beat.classList.toggle("on", (now - beatsBegan) % period < Math.min(150, period / 2));
  if (nth === lastBeat) return;
  lastBeat = nth;
  click();
}

function scoreText(state) {
  if (!state || !(state.seconds > 0)) return "";
  const percent = (share) => number(100 * (share ?? 0));
  const parts = [
    text("target.shares", {
      right: percent(state.share_right),
      slow: percent(state.share_slow),
      fast: percent(state.share_fast),
      seconds: number(state.seconds),
    }),
  ];
  if (state.strokes) parts.push(text("target.strokes", { strokes: number(state.strokes) }));
  if (state.beats)
    parts.push(text("target.hits", { hit: number(state.beats_hit), beats: number(state.beats) }));
  return parts.join(" · ");
}

function update() {
  if (!view.choice) return;
  const state = latest.target;
  const target = state?.target ?? null;
  setBand(target?.kind === "speed" ? target : null);
  const metronome = target?.kind === "metronome";
  view.beat.hidden = view.clickLabel.hidden = !metronome;
  const why = controlReason();
  for (const control of [view.choice, view.low, view.high, view.rate, ...view.set])
    control.disabled = why !== "";
  view.run.disabled = why !== "" || !target;
  setText(view.run, text(state?.running ? "target.stop" : "target.start"));
  const judged = state?.by_person !== false;
  const about = target ? (judged ? "" : text("target.machine")) : text("target.hint");
  setText(view.why, why || about);
  const verdict = target && judged && state.verdict ? state.verdict : "none";
  view.word.dataset.verdict = verdict;
  setText(view.word, verdict === "none" ? "" : text(`verdict.${verdict}`));
  const scored = target && !state.running && Number.isFinite(state.score);
  const score = scored ? `${text("target.score", { score: number(state.score) })} · ` : "";
  setText(view.score, target ? score + scoreText(state) : "");
  speak(verdict);
}

// A screen reader gets one word in two seconds at most, and only a new one.
function speak(verdict) {
  const now = performance.now();
  if (verdict === spoken || verdict === "none" || verdict === "rest" || now - spokenAt < 2000) return;
  spoken = verdict;
  spokenAt = now;
  setText(byId("spoken"), text(`verdict.${verdict}`));
}

/** Starts the target. */
export function startTarget() {
  build();
  on("hello", build);
  let named = null;
  on("target", (state) => {
    const name = state.target?.name ?? "";
    if (JSON.stringify(state.target) !== named) {
      named = JSON.stringify(state.target);
      beatsBegan = performance.now();
      const known = [...view.choice.options].some((option) => option.value === name);
      const own = state.target?.kind === "metronome" ? ":metronome" : ":speed";
      if (document.activeElement !== view.choice) view.choice.value = known ? name : state.target ? own : "";
    }
    update();
  });
  for (const kind of ["holder", "open", "lost"]) on(kind, update);
  onLanguage(build);
  requestAnimationFrame(beat);
}
