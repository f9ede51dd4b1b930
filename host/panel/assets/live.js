// The live part: each frame of the screen shows the newest bins as curves,
// numbers and a leg. Everything that is measured about it is in `crepitusStats`.

import { BINS_A_SECOND, RecentBins } from "./bins.js";
import { Charts, colours } from "./charts.js";
import { isReplay, latest, on } from "./connection.js";
import { byId, el, setText, tick } from "./dom.js";
import { showSecret } from "./labels.js";
import { latenessOf } from "./lateness.js";
import { makeLeg } from "./leg.js";
import { drawInside, startInside } from "./live-inside.js";
import { feelPain } from "./pain.js";
import { shadeName, shadesIn, shadesOf } from "./states.js";
import { store, stored } from "./storage.js";
import { number, onLanguage, text } from "./strings.js";

const WINDOWS = [5, 10, 30];
const KEPT = 2000;
// Numbers that are older than this are not shown: they would be taken for what is now.
const STALE_AFTER_MS = 400;
// Torque ends when this page answers 200 ms late, and pictures are most of its work. So a page that is late draws
// when it has caught up, or at last after DRAW_AFTER_MS; and one chart at a time, until it was not late for a while.
const LATE_MS = 40;
const DRAW_AFTER_MS = 400;
const CAREFUL_MS = 10_000;

const stats = { frames: 0, bins: 0, paints: 0, missing: 0, first: null, latencies: [], draws: [], ranges: [] };
window.crepitusStats = stats;

const bins = new RecentBins(32 * BINS_A_SECOND);
let charts = null;
let turnLeg = null;
let seconds = 10;
let dirty = false;
let lateMs = 0;
let lateAt = -Infinity;
let drawnAt = -Infinity;
let nextPane = 0;
let wordsAt = 0;
let binsAt = 0;
let isStale = true;
let shades = [];
let kneeShown = null;

function keep(list, value) {
  if (list.length >= KEPT) list.shift();
  list.push(value);
}

/** A legend of shades and curves, in text; returns a function that marks what is present. */
export function makeLegend(host, list) {
  const items = list.map((shade) => {
    const swatch = el("i", { class: "swatch", "aria-hidden": "true" });
    const name = el("span");
    const item = el("li", { hidden: true }, swatch, name);
    return { shade, swatch, name, item };
  });
  const paint = () => {
    for (const { shade, swatch, name } of items) {
      setText(name, shadeName(shade));
      swatch.style.backgroundImage = `url(${colours.tile(shade.colour, shade.pattern).toDataURL()})`;
    }
  };
  host.replaceChildren(...items.map(({ item }) => item));
  paint();
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => requestAnimationFrame(paint));
  return {
    paint,
    show(present, now = 0) {
      items.forEach(({ item }, k) => {
        item.hidden = !(present & (1 << k));
        item.classList.toggle("current", (now & (1 << k)) !== 0);
      });
    },
  };
}

let legend = null;

/** The middle of a bin's range, or NaN. */
const middle = (low, high) => (low + high) / 2;

// Numbers for people: five times a second is what can be read.
function showWords(now) {
  if (now - wordsAt < 200) return;
  wordsAt = now;
  const { columns, begin, end } = bins;
  // Older ones are still curves, but no numbers and no states.
  const last = isStale ? begin - 1 : end - 1;
  const from = Math.max(begin, end - 20);
  let torque = NaN;
  let breaks = 0;
  for (let i = Math.max(begin, end - BINS_A_SECOND); i < end && !isStale; i++) breaks += columns.breaks[i];
  // The largest torque of the last tenth of a second, with its sign: a catch is short.
  for (let i = from; i < end && !isStale; i++) {
    for (const value of [columns.torqueLow[i], columns.torqueHigh[i]]) {
      if (!(Math.abs(value) <= Math.abs(torque))) torque = Number.isNaN(value) ? torque : value;
    }
  }
  setText(
    byId("angle"),
    last < begin ? "–" : number(middle(columns.angleLow[last], columns.angleHigh[last]), 1),
  );
  setText(
    byId("speed"),
    last < begin ? "–" : number(middle(columns.speedLow[last], columns.speedHigh[last])),
  );
  showSecret(byId("torque"), bins.masked.torque, number(torque, 2));
  showSecret(byId("breaks"), bins.masked.states, isStale ? "–" : number(breaks));
  if (!legend) return;
  let present = 0;
  if (!bins.masked.states) {
    for (let i = bins.indexAt(charts.view.from); i < end; i++) {
      present |= shadesIn(shades, columns.states[i], columns.marks[i]);
    }
  }
  const current =
    last < begin || bins.masked.states ? 0 : shadesIn(shades, columns.states[last], columns.marks[last]);
  legend.show(present, current);
}

function paint(now) {
  requestAnimationFrame(paint);
  stats.paints++;
  const noBins = performance.now() - binsAt > STALE_AFTER_MS || latest.status?.link === "lost";
  if (noBins !== isStale) {
    isStale = noBins;
    lateMs = 0;
    byId("live").classList.toggle("stale", isStale);
    wordsAt = 0;
    dirty = true;
  }
  const began = performance.now();
  if (!dirty || isReplay() || (lateMs > LATE_MS && began - drawnAt < DRAW_AFTER_MS)) return;
  dirty = false;
  drawnAt = began;
  const { columns, begin, end } = bins;
  if (end > begin) {
    const to = columns.t[end - 1] + bins.length / 2;
    charts.masked = bins.masked;
    const isCareful = began - lateAt < CAREFUL_MS;
    if (isCareful) charts.draw(to - seconds, to, nextPane++);
    else charts.draw(to - seconds, to);
    if (!isCareful || nextPane % 3 === 0) drawInside(now, bins, isStale);
    const { angle, hand } = legNow();
    turnLeg(angle, hand);
  }
  showWords(now);
  const arrived = bins.arrived;
  // uPlot draws in a microtask; after it the pixels are there.
  queueMicrotask(() => {
    // Since the navigation began.
    if (end > begin) stats.first ??= performance.now();
    keep(stats.draws, performance.now() - began);
    stats.ranges = charts.panes.map(({ low, high }) => [low, high]);
    if (arrived) keep(stats.latencies, performance.timeOrigin + performance.now() - arrived);
  });
}

function offerWindows() {
  const host = byId("window-choice");
  const wish = Number(stored("window"));
  if (WINDOWS.includes(wish)) seconds = wish;
  const labels = WINDOWS.map((value) => {
    const input = el("input", { type: "radio", name: "window", value, checked: value === seconds });
    input.addEventListener("change", () => {
      seconds = value;
      store("window", value);
      dirty = true;
    });
    return tick(`${value} s`, input);
  });
  host.append(...labels);
}

function showCounters() {
  const status = latest.status;
  if (!status) return;
  // A device that is lost has no supply and no temperature.
  const facts = [
    ["produced", number(status.produced)],
    ["received", number(status.received)],
    ["dropped", number(status.dropped)],
    ["lost", number(status.lost)],
    ["missing", number(stats.missing)],
    ["supply", Number.isFinite(status.supply_v) ? `${number(status.supply_v, 1)} V` : "–"],
    ["motor", Number.isFinite(status.motor_c) ? `${number(status.motor_c)} °C` : "–"],
  ];
  const host = byId("counters");
  if (host.childElementCount !== facts.length) {
    host.replaceChildren(...facts.map(() => el("div", null, el("dt"), el("dd"))));
  }
  facts.forEach(([key, value], i) => {
    setText(host.children[i].children[0], text(`counters.${key}`));
    setText(host.children[i].children[1], value);
  });
}

/** The newest angles of leg and hand, in degrees; NaN where there are none. */
export function legNow() {
  const { columns, begin, end } = bins;
  if (isStale || end <= begin) return { angle: NaN, hand: NaN };
  const last = end - 1;
  return {
    angle: middle(columns.angleLow[last], columns.angleHigh[last]),
    hand: middle(columns.handLow[last], columns.handHigh[last]),
  };
}

/** The end of the live time line, s. */
export const liveTime = () => (bins.end > bins.begin ? bins.columns.t[bins.end - 1] : 0);

/** The charts' target band. */
export function setBand(band) {
  charts.band = band;
  dirty = true;
}

/** The notes that the charts mark. */
export function setNotes(notes) {
  charts.notes = notes;
  dirty = true;
}

/** Starts the live part. */
export function startLive() {
  charts = new Charts(byId("charts"), { live: true });
  charts.layers = [{ bins }];
  turnLeg = makeLeg(byId("leg"));
  turnLeg(NaN);
  offerWindows();
  on("frame", (view) => {
    const { count, missing } = bins.push(view);
    lateMs = latenessOf(view.getFloat64(8, true));
    if (lateMs > LATE_MS) lateAt = performance.now();
    stats.frames++;
    stats.bins += count;
    if (count > 0) binsAt = performance.now();
    feelPain(bins, count);
    stats.missing += missing;
    dirty = true;
  });
  on("hello", (hello) => {
    shades = charts.shades = shadesOf(hello.states);
    legend = makeLegend(byId("legend"), shades);
    bins.clear();
  });
  // After the listener that puts a frame into the bins.
  startInside(bins);
  // Another knee may be a hundred times weaker: now the axes may change.
  on("parameters", ({ hidden, revision }) => {
    const knee = hidden ? "hidden" : revision;
    if (knee !== kneeShown) charts.settle(liveTime());
    kneeShown = knee;
  });
  on("status", showCounters);
  // Where others above them grow, the charts have less room.
  const above = new ResizeObserver(() => charts.resize());
  for (const part of [document.querySelector(".top"), byId("leg"), byId("target")]) above.observe(part);
  onLanguage(() => {
    charts.retitle();
    legend?.paint();
    showCounters();
    wordsAt = 0;
  });
  charts.retitle();
  requestAnimationFrame(paint);
}
