// Torque, speed and angle over one time axis. uPlot makes axes, grid, cursor
// and the selection by dragging; the curves are painted here from bins.

import uPlot from "./vendor/uPlot.esm.js";
import { indexAt, MARK } from "./bins.js";
import { el, setText } from "./dom.js";
import { Colours, paintEnvelope, paintMark, paintShades } from "./paint.js";
import { shadesIn } from "./states.js";
import { number, text } from "./strings.js";

/** The colours of every chart of the page. */
export const colours = new Colours();

// `ranges` are those of the live view, each inside the next: an axis takes the first that its curves fit into.
const PANES = [
  {
    name: "torque",
    unit: "N·m",
    least: 1,
    ranges: [
      [-1, 1],
      [-2.5, 2.5],
      [-7, 7],
    ],
    curves: [
      // Below the commanded torque, and wider: where both agree it is a rim.
      { low: "modelLow", high: "modelHigh", colour: "--model", fill: 0.15, width: 3.5 },
      { low: "torqueLow", high: "torqueHigh", colour: "--torque", fill: 0.35, width: 1.25 },
    ],
  },
  {
    name: "speed",
    unit: "°/s",
    least: 40,
    ranges: [
      [-130, 130],
      [-360, 360],
    ],
    curves: [{ low: "speedLow", high: "speedHigh", colour: "--speed", fill: 0.35, width: 1.5 }],
  },
  {
    name: "angle",
    unit: "°",
    least: 20,
    ranges: [
      [-10, 130],
      [-40, 190],
    ],
    curves: [{ low: "angleLow", high: "angleHigh", colour: "--angle", fill: 0.35, width: 2 }],
  },
];

// The second of two recordings: other colours, and dashes.
const SECOND = { torque: "--second-torque", speed: "--second-speed", angle: "--second-angle" };

/** Stretches of bins with the motor on and off; each reaches to the first bin of the next one. */
function stretches(marks, from, to) {
  const found = [];
  for (let i = from; i < to; i++) {
    // A gap draws nothing.
    const isOn = (marks[i] & (MARK.energised | MARK.gap)) !== 0;
    const last = found.at(-1);
    if (last) last.to = i + 1;
    if (last?.isOn !== isOn) found.push({ from: i, to: i + 1, isOn });
  }
  return found;
}

const rootSize = () => Number.parseFloat(getComputedStyle(document.documentElement).fontSize);

/** Decimals that a step needs: 0.25 two, 0.5 one. */
function decimals(step) {
  for (let count = 0; count < 6; count++) {
    const scaled = step * 10 ** count;
    if (Math.abs(scaled - Math.round(scaled)) < 1e-6 * scaled) return count;
  }
  return 6;
}

/** Charts of bins that share a time axis. */
export class Charts {
  /**
   * `live`: times count back from the right edge, and axes do not follow the curves.
   * `onRange(from, to)`: a range was dragged.
   */
  constructor(host, { live, onRange = null }) {
    this.host = host;
    this.live = live;
    this.onRange = onRange;
    this.view = { from: -10, to: 0 };
    this.layers = [];
    this.shades = [];
    this.band = null;
    this.notes = [];
    this.playhead = null;
    this.since = -Infinity;
    this.masked = { torque: false, states: false };
    this.panes = PANES.map((pane, i) => this.makePane(pane, i === PANES.length - 1));
    new ResizeObserver(() => this.resize()).observe(host);
    addEventListener("resize", () => this.resize());
    // uPlot keeps the colours of its axes: make it read them again.
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.refresh());
  }

  makePane(pane, last) {
    const title = el("h3", { class: `chart-title ${pane.name}` });
    const masked = el("p", { class: "masked", hidden: true });
    const box = el("div", { class: "chart" }, masked);
    this.host.append(el("div", { class: "pane" }, title, box));
    const font = () => `${Math.round(rootSize() * 0.875)}px system-ui, sans-serif`;
    const axis = {
      stroke: () => colours.get("--axis-text"),
      font: font(),
      ticks: { stroke: () => colours.get("--grid"), size: 4 },
      grid: { stroke: () => colours.get("--grid"), width: 1 },
    };
    const state = { ...pane, title, masked, box, low: NaN, high: NaN, rung: 0 };
    state.plot = new uPlot(
      {
        width: 300,
        height: 150,
        pxAlign: false,
        padding: [6, rootSize(), 0, 0],
        legend: { show: false },
        cursor: this.onRange
          ? { y: false, points: { show: false }, drag: { x: true, y: false, setScale: false } }
          : { show: false },
        scales: { x: { time: false }, y: { auto: false } },
        axes: [
          {
            ...axis,
            show: true,
            size: last ? rootSize() * 1.6 : 8,
            space: rootSize() * 5,
            splits: this.live ? () => this.liveSplits() : undefined,
            values: (_, splits) => splits.map((t) => (last ? this.timeLabel(t, splits) : "")),
          },
          {
            ...axis,
            size: rootSize() * 3.6,
            space: rootSize() * 1.5,
            values: (_, s) => s.map((v) => this.valueLabel(v, s)),
          },
        ],
        series: [{}, { paths: () => null, points: { show: false }, auto: false }],
        hooks: {
          drawClear: [(u) => this.paintBehind(u, state)],
          draw: [(u) => this.paintFront(u, state)],
          setSelect: [(u) => this.selected(u)],
        },
      },
      [
        [0, 1],
        [null, null],
      ],
      box,
    );
    return state;
  }

  selected(u) {
    if (!this.onRange || u.select.width < 8) return;
    const from = u.posToVal(u.select.left, "x");
    const to = u.posToVal(u.select.left + u.select.width, "x");
    u.setSelect({ left: 0, width: 0, top: 0, height: 0 }, false);
    this.onRange(from, to);
  }

  liveSplits() {
    const span = this.view.to - this.view.from;
    const step = span > 15 ? 5 : span > 6 ? 2 : 1;
    const splits = [];
    for (let back = Math.floor(span / step) * step; back >= 0; back -= step) splits.push(this.view.to - back);
    return splits;
  }

  timeLabel(t, splits) {
    const step = splits.length > 1 ? splits[1] - splits[0] : 1;
    if (this.live) return `${number(Math.round(t - this.view.to) || 0)} s`;
    return `${number(t, decimals(step))} s`;
  }

  valueLabel(v, splits) {
    const step = splits.length > 1 ? splits[1] - splits[0] : 1;
    return number(v, decimals(step));
  }

  /** Texts in the chosen language. */
  retitle() {
    for (const pane of this.panes) {
      setText(pane.title, text(`chart.${pane.name}`));
      setText(pane.masked, text("hidden"));
    }
    this.refresh();
  }

  // Height for the plots of the live view where it stands beside the tabs: what others leave of the window.
  room() {
    const top = Number.parseFloat(document.documentElement.style.getPropertyValue("--top")) || 0;
    const plots = this.panes.reduce((sum, { box }) => sum + box.offsetHeight, 0);
    const titles = this.host.offsetHeight - plots;
    // The time axis, and the legend below.
    return innerHeight - top - this.host.offsetTop - titles - rootSize() * 5;
  }

  /** Gives the plots the size that there is for them. */
  resize() {
    const width = Math.floor(this.host.clientWidth);
    if (width < 50) return;
    const beside = this.live && matchMedia("(min-width: 1100px)").matches;
    const room = beside ? this.room() / this.panes.length : innerHeight * 0.16;
    const height = Math.round(Math.max(rootSize() * (beside ? 5.5 : 7), Math.min(room, rootSize() * 22)));
    for (const pane of this.panes) {
      const extra = pane === this.panes.at(-1) ? rootSize() : 0;
      pane.plot.setSize({ width, height: height + extra });
    }
    this.refresh();
  }

  /** Draws again what is there. */
  refresh() {
    this.draw(this.view.from, this.view.to);
  }

  /** Draws a range of time, in all panes or in the nth, counted round; done after the next microtask. */
  draw(from, to, nth = null) {
    if (!(to > from) || !this.host.clientWidth) return;
    this.view = { from, to };
    for (const layer of this.layers) {
      const { columns, begin, end } = layer.bins;
      const offset = layer.offset ?? 0;
      // One bin more on either side: curves reach the edges.
      layer.from = Math.max(begin, indexAt(columns.t, begin, end, from - offset) - 1);
      layer.to = Math.min(end, indexAt(columns.t, begin, end, to - offset) + 1);
    }
    const panes = nth === null ? this.panes : [this.panes[nth % this.panes.length]];
    for (const pane of panes) {
      setHidden(pane.masked, !(pane.name === "torque" && this.masked.torque));
      this.rangeOf(pane);
      pane.plot.batch(() => {
        pane.plot.setScale("y", { min: pane.low, max: pane.high });
        pane.plot.setScale("x", { min: from, max: to });
      });
    }
  }

  /** Begins with the narrowest axes: what is after this time decides how wide they become. */
  settle(time) {
    this.since = time;
    for (const pane of this.panes) pane.rung = 0;
  }

  rangeOf(pane) {
    let low = Infinity;
    let high = -Infinity;
    for (const layer of this.layers) {
      const { columns, begin, end } = layer.bins;
      // Times begin again where the device does.
      const isPast = end > begin && this.since <= columns.t[end - 1];
      const from = isPast ? Math.max(layer.from, indexAt(columns.t, begin, end, this.since)) : layer.from;
      for (const curve of pane.curves) {
        const lows = columns[curve.low];
        const highs = columns[curve.high];
        for (let i = from; i < layer.to; i++) {
          if (lows[i] < low) low = lows[i];
          if (highs[i] > high) high = highs[i];
        }
      }
    }
    // The target band is in sight before the hand reaches it.
    const reach = pane.name === "speed" && this.band ? this.band.low_deg_per_s * 1.2 : NaN;
    if (reach > 0) {
      low = Math.min(low, -reach);
      high = Math.max(high, reach);
    }
    if (this.live) return this.widen(pane, low, high);
    if (low > high) {
      low = -pane.least / 2;
      high = pane.least / 2;
    }
    const span = Math.max(pane.least, (high - low) * 1.12);
    const middle = (high + low) / 2;
    pane.low = middle - span / 2;
    pane.high = middle + span / 2;
  }

  // An axis that moved while one watches could not be read: it takes the next range at once, and none before.
  widen(pane, low, high) {
    const isOutside = ([least, most]) => low < least || high > most;
    while (pane.rung < pane.ranges.length - 1 && isOutside(pane.ranges[pane.rung])) pane.rung++;
    const [least, most] = pane.ranges[pane.rung];
    pane.low = Math.min(least, low);
    pane.high = Math.max(most, high);
  }

  mapOf(u) {
    const { left, top, width, height } = u.bbox;
    const { min, max } = u.scales.y;
    const kx = width / (this.view.to - this.view.from);
    const ky = height / (max - min);
    const from = this.view.from;
    return { x: (t) => left + (t - from) * kx, y: (v) => top + height - (v - min) * ky };
  }

  clip(u, paint) {
    const { ctx, bbox } = u;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    paint(ctx, bbox, this.mapOf(u));
    ctx.restore();
  }

  paintBehind(u, pane) {
    if (!this.layers.length) return;
    this.clip(u, (ctx, box, map) => {
      const { bins, from, to, offset = 0 } = this.layers[0];
      const { t, states, marks } = bins.columns;
      const shades = this.shades;
      if (!this.masked.states && pane.name === "torque") {
        const shifted = offset ? { ...map, x: (time) => map.x(time + offset) } : map;
        const found = (i) => shadesIn(shades, states[i], marks[i]);
        const fill = (k) => colours.shade(ctx, shades[k].colour, shades[k].pattern);
        paintShades(ctx, shifted, box, t, bins.length, from, to, shades.length, found, fill);
      }
      if (pane.name === "speed" && this.band) this.paintBand(ctx, box, map);
      ctx.strokeStyle = colours.get("--axis");
      ctx.lineWidth = devicePixelRatio;
      const zero = Math.round(map.y(0)) + 0.5;
      ctx.beginPath();
      ctx.moveTo(box.left, zero);
      ctx.lineTo(box.left + box.width, zero);
      ctx.stroke();
    });
  }

  // The examiner's speed counts in either direction.
  paintBand(ctx, box, map) {
    const { low_deg_per_s: low, high_deg_per_s: high } = this.band;
    if (!Number.isFinite(low)) return;
    for (const sign of [1, -1]) {
      const a = map.y(sign * low);
      const b = Number.isFinite(high) ? map.y(sign * high) : sign > 0 ? box.top : box.top + box.height;
      ctx.globalAlpha = 0.22;
      ctx.fillStyle = colours.get("--band");
      ctx.fillRect(box.left, Math.min(a, b), box.width, Math.abs(a - b));
      ctx.globalAlpha = 0.9;
      ctx.fillRect(box.left, a - devicePixelRatio / 2, box.width, devicePixelRatio);
      ctx.fillRect(box.left, b - devicePixelRatio / 2, box.width, devicePixelRatio);
    }
    ctx.globalAlpha = 1;
  }

  paintFront(u, pane) {
    this.clip(u, (ctx, box, map) => {
      const scale = devicePixelRatio;
      this.layers.forEach(({ bins, from, to, offset = 0 }, nth) => {
        const { columns } = bins;
        const shifted = offset ? { ...map, x: (time) => map.x(time + offset) } : map;
        const parts =
          pane.name === "torque" ? stretches(columns.marks, from, to) : [{ from, to, isOn: true }];
        for (const curve of pane.curves) {
          if (nth > 0 && curve.low === "modelLow") continue;
          const look = {
            colour: colours.get(nth > 0 ? SECOND[pane.name] : curve.colour),
            fill: nth > 0 ? 0.12 : curve.fill,
            width: curve.width * scale,
            dash: nth > 0 ? [7 * scale, 4 * scale] : null,
          };
          // Torque that nobody feels is thin and dashed; that of a motor that is off is 0.
          const unfelt = { ...look, fill: 0, width: scale, dash: [2 * scale, 3 * scale] };
          for (const part of parts) {
            if (!part.isOn && curve.low !== "modelLow") continue;
            const [low, high] = [columns[curve.low], columns[curve.high]];
            paintEnvelope(ctx, shifted, columns.t, low, high, part.from, part.to, part.isOn ? look : unfelt);
          }
        }
      });
      for (const note of this.notes) {
        if (note.time_s < this.view.from || note.time_s > this.view.to) continue;
        const head =
          pane.name === "torque" ? (note.text.length > 24 ? `${note.text.slice(0, 23)}…` : note.text) : "";
        paintMark(
          ctx,
          map.x(note.time_s),
          box,
          colours.get("--note"),
          scale,
          head,
          rootSize() * 0.875 * scale,
        );
      }
      if (this.playhead !== null) paintMark(ctx, map.x(this.playhead), box, colours.get("--text"), scale);
    });
  }

  /** The width of the plots in device pixels. */
  pixels() {
    return Math.max(50, Math.round(this.panes[0].plot.bbox.width));
  }
}

function setHidden(element, hidden) {
  if (element.hidden !== hidden) element.hidden = hidden;
}
