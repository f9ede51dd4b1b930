// One recording, or two over each other: charts that ask the server for what
// is in sight with as many points as there are pixels, and playback.

import { decodeTrace, indexAt } from "./bins.js";
import { Charts } from "./charts.js";
import { ask, latest } from "./connection.js";
import { el, field, setText } from "./dom.js";
import { makeLeg } from "./leg.js";
import { makeLegend } from "./live.js";
import { recordingTitle } from "./names.js";
import { errorText, say } from "./report.js";
import { shadesIn, shadesOf } from "./states.js";
import { number, text } from "./strings.js";

const WAIT_MS = 80;
const LEAST_S = 0.002;

/** Charts and playback of recordings in a box. */
export class Player {
  constructor(host) {
    this.host = host;
    this.first = null;
    this.second = null;
    this.offset = 0;
    this.timer = null;
    this.busy = false;
    this.again = false;
    this.playing = false;
    this.at = 0;
  }

  /** Shows a recording, and a second one over it or null. */
  show(first, second) {
    const another = this.first?.id !== first?.id;
    this.first = first;
    this.second = second;
    if (!first) return;
    if (another || !this.charts) {
      this.at = first.begin_s;
      this.playing = false;
    }
    if (!this.charts) this.build();
    if (another) this.view = { from: first.begin_s, to: first.end_s };
    if (!second) this.charts.layers = this.charts.layers.slice(0, 1);
    this.describe();
    this.request();
  }

  build() {
    const button = (key, label, act) =>
      el(
        "button",
        { type: "button", class: "icon", "aria-label": text(key), title: text(key), onclick: act },
        label,
      );
    this.title = el("h2");
    this.about = el("p", { class: "hint" });
    this.legLine = el("div", { class: "leg" });
    this.play = el("button", { type: "button", class: "primary", onclick: () => this.toggle() });
    this.position = el("p", { class: "time-left" });
    this.values = el("p");
    this.seek = el("input", { type: "range", step: 0.001, "aria-label": text("player.seek") });
    this.seek.addEventListener("input", () => this.moveTo(Number(this.seek.value)));
    this.offsetInput = el("input", { type: "number", step: 0.1, value: this.offset });
    this.offsetInput.addEventListener("input", () => {
      this.offset = this.offsetInput.valueAsNumber || 0;
      this.request();
    });
    this.offsetField = field(text("player.offset"), this.offsetInput);
    this.box = el("div", {
      class: "charts",
      tabindex: 0,
      role: "group",
      "aria-label": text("player.charts"),
      "aria-describedby": "player-keys",
    });
    this.states = el("ul", { class: "legend", "aria-label": text("legend") });
    this.names = el("ul", { class: "legend", "aria-label": text("player.names") });
    this.range = el("p", { class: "hint", role: "status" });
    this.parameters = el("div");
    this.notes = el("div");
    this.host.replaceChildren(
      el("div", { class: "card" }, this.title, this.about, this.names),
      el(
        "div",
        { class: "row" },
        this.play,
        button("player.in", "+", () => this.zoom(0.5)),
        button("player.out", "−", () => this.zoom(2)),
        button("player.left", "◀", () => this.pan(-0.25)),
        button("player.right", "▶", () => this.pan(0.25)),
        button("player.all", "↔", () => this.all()),
        this.offsetField,
      ),
      this.seek,
      this.box,
      el("p", { class: "hint", id: "player-keys" }, text("player.keys")),
      this.range,
      this.states,
      el("div", { class: "now" }, this.legLine, el("div", null, this.position, this.values)),
      this.notes,
      this.parameters,
    );
    this.turn = makeLeg(this.legLine);
    this.charts = new Charts(this.box, { live: false, onRange: (from, to) => this.look(from, to) });
    this.shades = this.charts.shades = shadesOf(latest.hello.states);
    this.legend = makeLegend(this.states, this.shades);
    this.charts.retitle();
    this.box.addEventListener("keydown", (event) => this.key(event));
    this.box.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    // More pixels show more detail.
    new ResizeObserver(() => this.request()).observe(this.box);
  }

  key(event) {
    const act = {
      ArrowLeft: () => this.pan(-0.1),
      ArrowRight: () => this.pan(0.1),
      "+": () => this.zoom(0.5),
      "=": () => this.zoom(0.5),
      "-": () => this.zoom(2),
      Home: () => this.all(),
      " ": () => this.toggle(),
    }[event.key];
    if (!act || event.ctrlKey || event.metaKey || event.altKey || event.target !== this.box) return;
    event.preventDefault();
    act();
  }

  wheel(event) {
    const over = this.box.querySelector(".u-over").getBoundingClientRect();
    if (event.clientX < over.left || event.clientX > over.right) return;
    event.preventDefault();
    const share = (event.clientX - over.left) / over.width;
    this.zoom(Math.exp(Math.max(-1, Math.min(1, event.deltaY / 300))), share);
  }

  zoom(factor, share = 0.5) {
    const { from, to } = this.view;
    const centre = from + share * (to - from);
    this.look(centre - (centre - from) * factor, centre + (to - centre) * factor);
  }

  pan(share) {
    const by = share * (this.view.to - this.view.from);
    this.look(this.view.from + by, this.view.to + by);
  }

  all() {
    this.look(...this.extent());
  }

  extent() {
    const { begin_s: begin, end_s: end } = this.first;
    if (!this.second) return [begin, end];
    return [
      Math.min(begin, this.second.begin_s + this.offset),
      Math.max(end, this.second.end_s + this.offset),
    ];
  }

  /** Looks at a range: what is there at once, full detail when it has arrived. */
  look(from, to) {
    const [least, most] = this.extent();
    const span = Math.min(most - least, Math.max(LEAST_S, to - from));
    const begin = Math.max(least, Math.min(most - span, (from + to - span) / 2));
    this.view = { from: begin, to: begin + span };
    this.charts.draw(begin, begin + span);
    this.request();
  }

  request() {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.fetch(), WAIT_MS);
  }

  // One request at a time; what changed meanwhile is asked for afterwards.
  async fetch() {
    if (!this.first || !this.host.isConnected || !this.box.clientWidth) return;
    if (this.busy) {
      this.again = true;
      return;
    }
    this.busy = true;
    const { from, to } = this.view;
    const wanted = [[this.first, 0], ...(this.second ? [[this.second, this.offset]] : [])];
    try {
      const answers = wanted.map(([recording, offset]) => this.trace(recording, from - offset, to - offset));
      const traces = await Promise.all(answers);
      const layers = traces.map((bins, i) => ({ bins, offset: wanted[i][1] }));
      // The second may have been put away meanwhile.
      this.charts.layers = this.second ? layers : layers.slice(0, 1);
      this.charts.draw(this.view.from, this.view.to);
      this.showStates();
      this.showPosition();
      const { length } = traces[0];
      const rate =
        length > 0 ? text("player.detail", { ms: number(length * 1000, length < 0.001 ? 2 : 1) }) : "";
      setText(
        this.range,
        `${text("player.range", { from: number(this.view.from, 2), to: number(this.view.to, 2) })} ${rate}`,
      );
    } catch (error) {
      say(errorText(error), true);
    }
    this.busy = false;
    if (this.again) {
      this.again = false;
      this.request();
    }
  }

  async trace(recording, from, to) {
    const begin = Math.max(recording.begin_s, from);
    const end = Math.min(recording.end_s, to);
    if (!(end > begin))
      return { columns: decodeTrace(new DataView(new ArrayBuffer(40))).columns, begin: 0, end: 0, length: 0 };
    const share = (end - begin) / (to - from);
    const points = Math.max(2, Math.ceil(this.charts.pixels() * share));
    return decodeTrace(await ask("trace", { recording: recording.id, from_s: begin, to_s: end, points }));
  }

  showStates() {
    const bins = this.charts.layers[0].bins;
    let present = 0;
    for (let i = bins.begin; i < bins.end; i++)
      present |= shadesIn(this.shades, bins.columns.states[i], bins.columns.marks[i]);
    this.legend.show(present);
  }

  toggle() {
    this.playing = !this.playing;
    setText(this.play, text(this.playing ? "player.pause" : "player.play"));
    if (!this.playing) return;
    if (this.at >= this.first.end_s - 0.01) this.at = this.first.begin_s;
    this.clock = performance.now();
    requestAnimationFrame((now) => this.step(now));
  }

  step(now) {
    if (!this.playing || !this.host.isConnected) return;
    const at = this.at + Math.max(0, now - this.clock) / 1000;
    this.clock = now;
    if (at >= this.first.end_s) this.toggle();
    // The view follows the playhead by whole pages, not by sliding.
    const span = this.view.to - this.view.from;
    if (at > this.view.to || at < this.view.from) this.look(at, at + span);
    this.moveTo(Math.min(at, this.first.end_s));
    requestAnimationFrame((next) => this.step(next));
  }

  moveTo(at) {
    this.at = at;
    this.charts.playhead = at;
    this.charts.refresh();
    this.showPosition();
  }

  showPosition() {
    this.charts.playhead = this.at;
    this.seek.value = this.at;
    setText(this.position, text("player.at", { seconds: number(this.at, 2) }));
    const { columns, begin, end } = this.charts.layers[0]?.bins ?? { begin: 0, end: 0 };
    const i = Math.min(end - 1, columns ? indexAt(columns.t, begin, end, this.at) : -1);
    if (i < begin) return;
    const middle = (low, high) => (columns[low][i] + columns[high][i]) / 2;
    const angle = middle("angleLow", "angleHigh");
    this.turn(angle);
    setText(
      this.values,
      text("player.values", {
        angle: number(angle, 1),
        speed: number(middle("speedLow", "speedHigh")),
        torque: number(middle("torqueLow", "torqueHigh"), 2),
      }),
    );
  }

  describe() {
    const { first, second } = this;
    const titles = [first, second].map((one) => one && recordingTitle(one));
    setText(this.title, second ? text("player.two", { first: titles[0], second: titles[1] }) : titles[0]);
    const facts = (one) =>
      text("player.about", {
        device: one.device ?? "–",
        seconds: number(one.seconds, 1),
        rows: number(one.rows),
        missing: number(one.missing),
        events: number(one.events),
      });
    setText(this.about, facts(first));
    const name = (one, quantities, dashed) =>
      el(
        "li",
        null,
        ...quantities.map((colour) => {
          const line = el("i", { class: `line${dashed ? " dashed" : ""}`, "aria-hidden": "true" });
          line.style.borderTopColor = `var(${colour})`;
          return line;
        }),
        el("span", null, text(dashed ? "player.dashed" : "player.solid", { name: recordingTitle(one) })),
      );
    this.names.hidden = !second;
    if (second) {
      this.names.replaceChildren(
        name(first, ["--torque", "--speed", "--angle"], false),
        name(second, ["--second-torque", "--second-speed", "--second-angle"], true),
      );
    }
    this.offsetField.hidden = !second;
    this.seek.min = first.begin_s;
    this.seek.max = first.end_s;
    this.seek.value = this.at;
    setText(this.play, text(this.playing ? "player.pause" : "player.play"));
    this.charts.notes = first.notes ?? [];
    this.showNotes();
    this.showParameters();
  }

  showNotes() {
    const notes = this.first.notes ?? [];
    const items = notes.map((note) =>
      el(
        "li",
        null,
        el(
          "button",
          { type: "button", class: "quiet", onclick: () => this.moveTo(note.time_s) },
          `${number(note.time_s, 1)} s · ${note.text}`,
        ),
      ),
    );
    this.notes.replaceChildren(
      ...(notes.length ? [el("h3", null, text("notes.title")), el("ul", { class: "plain" }, ...items)] : []),
    );
  }

  showParameters() {
    const left = new Map(this.first.parameters);
    const right = new Map(this.second?.parameters ?? []);
    const names = [...new Set([...left.keys(), ...right.keys()])].sort();
    if (!names.length)
      return this.parameters.replaceChildren(el("p", { class: "hint" }, text("player.defaults")));
    const value = (map, name) => map.get(name) ?? text("player.default");
    const head = ["player.parameter", ...(this.second ? [] : ["player.value"])].map((key) =>
      el("th", { scope: "col" }, text(key)),
    );
    const titles = this.second
      ? [recordingTitle(this.first), recordingTitle(this.second), text("player.same")].map((name) =>
          el("th", { scope: "col" }, name),
        )
      : [];
    const row = (name) => {
      const differs = this.second && value(left, name) !== value(right, name);
      const more = this.second
        ? [
            el("td", null, value(right, name)),
            el("td", null, text(differs ? "player.differs" : "player.equal")),
          ]
        : [];
      return el(
        "tr",
        { class: differs ? "differs" : null },
        el("th", { scope: "row" }, el("code", null, name)),
        el("td", null, value(left, name)),
        ...more,
      );
    };
    const title = text(this.second ? "player.parameters-two" : "player.parameters");
    // The heading says which knees these are; the numbers behind that are for those who ask.
    const open = this.parameters.firstChild?.open ?? false;
    return this.parameters.replaceChildren(
      el(
        "details",
        { open },
        el("summary", null, title),
        el(
          "div",
          { class: "scroll", tabindex: 0, role: "group", "aria-label": title },
          el(
            "table",
            null,
            el("thead", null, el("tr", null, ...head, ...titles)),
            el("tbody", null, ...names.map(row)),
          ),
        ),
      ),
    );
  }
}
