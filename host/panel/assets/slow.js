// Slow motion of the last second, from its bins.

import { indexAt } from "./bins.js";
import { el, setText } from "./dom.js";
import { number, onLanguage, text } from "./strings.js";

const SECONDS = 1;
const SLOWER = 10;

/** The controls of a slow motion in a box. */
export class Slow {
  constructor(host) {
    this.wanted = false;
    this.bins = null;
    this.plays = false;
    this.at = 0;
    this.button = el("button", { type: "button", onclick: () => (this.wanted = !this.bins) });
    this.seek = el("input", { type: "range", min: 0, max: SECONDS, step: 0.005, value: 0, disabled: true });
    this.seek.addEventListener("input", () => {
      this.plays = false;
      this.at = Number(this.seek.value);
    });
    host.replaceChildren(this.button, this.seek);
    onLanguage(() => this.name());
    this.name();
  }

  /** Texts in the chosen language. */
  name() {
    setText(this.button, text(this.bins ? "slow.end" : "slow.start", { factor: number(SLOWER) }));
    this.seek.setAttribute("aria-label", text("slow.seek"));
  }

  /** Shows the present again, as with another knee. */
  end() {
    this.wanted = false;
    this.bins = null;
    this.seek.disabled = true;
    this.seek.value = 0;
    this.name();
  }

  // All columns, also those that only one page has.
  begin({ columns, begin, end }) {
    const from = indexAt(columns.t, begin, end, columns.t[end - 1] - SECONDS);
    const copies = Object.entries(columns).map(([name, column]) => [name, column.slice(from, end)]);
    this.bins = { columns: Object.fromEntries(copies), begin: 0, end: end - from };
    this.at = 0;
    this.plays = true;
    this.seek.disabled = false;
    this.name();
  }

  /** The bins, and the index in them, that are to be shown at a picture's time; of the present its newest bin. */
  step(now, bins) {
    const passed = Math.min(0.1, (now - (this.before ?? now)) / 1000);
    this.before = now;
    if (this.wanted && !this.bins && bins.end > bins.begin) this.begin(bins);
    if (!this.wanted && this.bins) this.end();
    if (!this.bins) return { bins, index: bins.end - 1, isSlow: false };
    if (this.plays) {
      this.at += passed / SLOWER;
      // From the front again: once is over before one has looked.
      if (this.at > SECONDS) this.at = 0;
      this.seek.value = this.at;
    }
    const { columns, begin, end } = this.bins;
    const index = indexAt(columns.t, begin, end, columns.t[begin] + this.at);
    return { bins: this.bins, index: Math.min(index, end - 1), isSlow: true };
  }
}
