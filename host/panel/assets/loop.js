// Torque over angle of the last seconds, on scales that stay: what a hand feels there and back. A healthy knee's loop
// is the line behind it, since its motor gives nothing.

import { indexAt } from "./bins.js";
import { el, setText } from "./dom.js";
import { Colours } from "./paint.js";
import { number, onLanguage, text } from "./strings.js";

const SECONDS = 10;
const ENLARGED = 5;
const READ_MS = 250;
// Around the cursor, in degrees.
const NEAR = 1;
const STEPS = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1, PageDown: -10, PageUp: 10 };
const COLUMNS = ["t", "angleLow", "angleHigh", "speedLow", "speedHigh", "torqueLow", "torqueHigh"];

const rootSize = () => Number.parseFloat(getComputedStyle(document.documentElement).fontSize);
const clamp = (value, low, high) => Math.max(low, Math.min(high, value));

/** The bins of the last seconds, as they are now. */
function copyOf({ columns, begin, end }) {
  const copies = COLUMNS.map((name) => [name, columns[name].slice(begin, end)]);
  return { columns: Object.fromEntries(copies), begin: 0, end: end - begin };
}

/** The loop in a box. `scale`: `angle` is [least, most] in degrees, `torque` the most in N·m. */
export class Loop {
  constructor(host, scale) {
    this.scale = scale;
    this.colours = new Colours();
    this.cursor = (scale.angle[0] + scale.angle[1]) / 2;
    this.frozen = null;
    this.enlarged = false;
    this.masked = false;
    this.bins = { columns: null, begin: 0, end: 0 };
    this.readAt = 0;
    this.measure();
    this.build(host);
    onLanguage(() => this.name());
    new ResizeObserver(() => this.resize()).observe(this.box);
    this.name();
  }

  build(host) {
    const toggle = (act) => {
      const button = el("button", { type: "button", class: "toggle", "aria-pressed": "false" });
      button.addEventListener("click", () => {
        const on = button.getAttribute("aria-pressed") !== "true";
        button.setAttribute("aria-pressed", String(on));
        act(on);
        this.paint();
      });
      return button;
    };
    this.freeze = toggle((on) => (this.frozen = on && this.bins.columns ? copyOf(this.recent()) : null));
    this.enlarge = toggle((on) => (this.enlarged = on));
    this.title = el("h3");
    this.canvas = el("canvas");
    this.hidden = el("p", { class: "masked", hidden: true });
    const [low, high] = this.scale.angle;
    this.box = el(
      "div",
      { class: "loop-box", role: "slider", tabindex: 0, "aria-valuemin": low, "aria-valuemax": high },
      this.canvas,
      this.hidden,
    );
    this.box.addEventListener("keydown", (event) => this.key(event));
    this.box.addEventListener("pointermove", (event) => this.point(event));
    this.read = el("p", { class: "hint" });
    this.knee = el("span");
    this.healthy = el("span");
    const swatch = (kind) => el("i", { class: `line ${kind}`, "aria-hidden": "true" });
    const legend = el(
      "ul",
      { class: "legend" },
      el("li", null, swatch("knee"), this.knee),
      el("li", null, swatch("healthy dashed"), this.healthy),
    );
    const buttons = el("div", { class: "row" }, this.freeze, this.enlarge);
    host.replaceChildren(this.title, this.box, legend, this.read, buttons);
  }

  /** Texts in the chosen language. */
  name() {
    setText(this.title, text("loop.title"));
    setText(this.freeze, text("loop.freeze"));
    setText(this.enlarge, text("loop.enlarge", { factor: ENLARGED }));
    setText(this.hidden, text("hidden"));
    setText(this.knee, text("loop.knee"));
    setText(this.healthy, text("loop.healthy"));
    this.box.setAttribute("aria-label", text("loop.label"));
    this.move(this.cursor);
  }

  /** Shows the newest of these bins, unless it is frozen; nothing where torques are hidden. */
  draw(bins, masked) {
    this.bins = bins;
    this.masked = masked;
    this.paint();
    if (performance.now() - this.readAt > READ_MS) this.readOut();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.box;
    if (!width) return;
    this.canvas.width = Math.round(width * devicePixelRatio);
    this.canvas.height = Math.round(height * devicePixelRatio);
    this.measure();
    this.paint();
  }

  // Asked for in every picture it would lay out the page.
  measure() {
    this.rem = rootSize();
  }

  key(event) {
    const [low, high] = this.scale.angle;
    const to = { Home: low, End: high }[event.key] ?? this.cursor + (STEPS[event.key] ?? NaN);
    if (Number.isNaN(to) || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    event.stopPropagation();
    this.move(to);
    this.paint();
  }

  point(event) {
    const { left } = this.box.getBoundingClientRect();
    this.move(Math.round(this.map().angle((event.clientX - left) * devicePixelRatio)));
    this.paint();
  }

  move(to) {
    this.cursor = clamp(to, ...this.scale.angle);
    this.box.setAttribute("aria-valuenow", this.cursor);
    this.readOut();
  }

  /** The last seconds, or those that were frozen. */
  recent() {
    if (this.frozen) return this.frozen;
    const { columns, begin, end } = this.bins;
    if (end <= begin) return { columns, begin, end };
    return { columns, begin: indexAt(columns.t, begin, end, columns.t[end - 1] - SECONDS), end };
  }

  /** The torques at the cursor, there and back, in words. */
  readOut() {
    this.readAt = performance.now();
    this.measure();
    const { columns, begin, end } = this.recent();
    let bending = NaN;
    let stretching = NaN;
    for (let i = begin; i < end && !this.masked; i++) {
      if (Math.abs((columns.angleLow[i] + columns.angleHigh[i]) / 2 - this.cursor) > NEAR) continue;
      const bends = columns.speedLow[i] + columns.speedHigh[i] > 0;
      if (bends && !(columns.torqueHigh[i] <= bending)) bending = columns.torqueHigh[i];
      if (!bends && !(columns.torqueLow[i] >= stretching)) stretching = columns.torqueLow[i];
    }
    const values = { bending: number(bending, 2), stretching: number(stretching, 2) };
    const words = this.masked
      ? text("hidden")
      : text("loop.cursor", { angle: number(this.cursor), ...values });
    setText(this.read, words);
    this.box.setAttribute("aria-valuetext", words);
  }

  /** From degrees and N·m to pixels, and back. */
  map() {
    const { width, height } = this.canvas;
    const scale = devicePixelRatio;
    const [low, high] = this.scale.angle;
    const most = this.scale.torque / (this.enlarged ? ENLARGED : 1);
    const left = 3 * this.rem * scale;
    const right = width - 8 * scale;
    const top = 8 * scale;
    const bottom = height - 1.6 * this.rem * scale;
    const kx = (right - left) / (high - low);
    const ky = (bottom - top) / (2 * most);
    return {
      left,
      right,
      top,
      bottom,
      most,
      scale,
      x: (angle) => left + (angle - low) * kx,
      y: (torque) => (top + bottom) / 2 - torque * ky,
      angle: (x) => low + (x - left) / kx,
    };
  }

  paint() {
    const ctx = this.canvas.getContext("2d");
    const map = this.map();
    ctx.clearRect(0, 0, this.canvas.width, this.canvas.height);
    this.hidden.hidden = !this.masked;
    this.paintAxes(ctx, map);
    if (this.masked) return;
    ctx.save();
    ctx.beginPath();
    ctx.rect(map.left, map.top, map.right - map.left, map.bottom - map.top);
    ctx.clip();
    this.paintTrace(ctx, map);
    ctx.restore();
    ctx.strokeStyle = this.colours.get("--text");
    ctx.lineWidth = map.scale;
    line(ctx, map.x(this.cursor), map.top, map.x(this.cursor), map.bottom);
  }

  paintAxes(ctx, map) {
    const [low, high] = this.scale.angle;
    const size = Math.round(this.rem * 0.875 * map.scale);
    ctx.font = `${size}px system-ui, sans-serif`;
    ctx.fillStyle = this.colours.get("--axis-text");
    ctx.strokeStyle = this.colours.get("--grid");
    ctx.lineWidth = map.scale;
    ctx.textAlign = "right";
    ctx.textBaseline = "middle";
    for (const share of [-1, -0.5, 0, 0.5, 1]) {
      const y = map.y(share * map.most);
      line(ctx, map.left, y, map.right, y);
      // The ends would be cut off.
      const inside = clamp(y, map.top + size / 2, map.bottom - size / 2);
      ctx.fillText(number(share * map.most, 2), map.left - 5 * map.scale, inside);
    }
    ctx.textAlign = "center";
    ctx.textBaseline = "top";
    for (let angle = Math.ceil(low / 30) * 30; angle <= high; angle += 30) {
      line(ctx, map.x(angle), map.top, map.x(angle), map.bottom);
      ctx.fillText(`${number(angle)}°`, map.x(angle), map.bottom + 4 * map.scale);
    }
    ctx.strokeStyle = this.colours.get("--good");
    ctx.lineWidth = 2 * map.scale;
    ctx.setLineDash([7 * map.scale, 4 * map.scale]);
    line(ctx, map.x(low), map.y(0), map.x(high), map.y(0));
    ctx.setLineDash([]);
  }

  // Through the lowest and the highest torque of each bin: no spike is lost.
  paintTrace(ctx, map) {
    const { columns, begin, end } = this.recent();
    ctx.strokeStyle = this.colours.get("--torque");
    ctx.lineWidth = 1.5 * map.scale;
    ctx.lineJoin = "bevel";
    ctx.beginPath();
    let isOpen = false;
    for (let i = begin; i < end; i++) {
      const x = map.x((columns.angleLow[i] + columns.angleHigh[i]) / 2);
      const [first, second] = [map.y(columns.torqueLow[i]), map.y(columns.torqueHigh[i])];
      if (Number.isNaN(first + x)) {
        isOpen = false;
        continue;
      }
      if (isOpen) ctx.lineTo(x, first);
      else ctx.moveTo(x, first);
      if (second !== first) ctx.lineTo(x, second);
      isOpen = true;
    }
    ctx.stroke();
  }
}

function line(ctx, x1, y1, x2, y2) {
  ctx.beginPath();
  ctx.moveTo(x1, y1);
  ctx.lineTo(x2, y2);
  ctx.stroke();
}
