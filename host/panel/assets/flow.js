// The flow chart of the model, as in the paper's Fig. 7: stick, slip, and the two questions between them. The phase
// that is on is lit by its share of the last moments: a lamp at the pitch of crepitus would flicker.

import { el, setText } from "./dom.js";
import { number, onLanguage, text } from "./strings.js";

// The share of what was before that is left after a picture.
const LEFT = 0.9;
const PHASES = { stick: 1, slip: 2 };

/** The chart in a box. */
export class Flow {
  constructor(host) {
    this.title = el("h3");
    this.hint = el("p", { class: "hint" });
    const part = (kind, name) => {
      const words = el("span");
      const yes = kind === "question" && el("span", { class: "yes" });
      const no = kind === "question" && el("span", { class: "no" });
      return { name, words, yes, no, root: el("li", { class: kind }, words, no, yes) };
    };
    this.parts = [
      part("phase", "stick"),
      part("question", "breaks"),
      part("phase", "slip"),
      part("question", "matches"),
    ];
    this.shares = { stick: 0, slip: 0 };
    this.knee = null;
    this.list = el("ol", { class: "flow" }, ...this.parts.map(({ root }) => root));
    host.replaceChildren(this.title, this.hint, this.list);
    onLanguage(() => this.name());
    this.name();
  }

  /** The crepitus of the knee: its `static` and `kinetic` torque in N·m; null if it has none or is hidden. */
  setKnee(knee, isHidden) {
    this.knee = knee;
    this.isHidden = isHidden;
    this.name();
  }

  /** Texts in the chosen language. */
  name() {
    const torques = { static: number(this.knee?.static, 2), kinetic: number(this.knee?.kinetic, 2) };
    setText(this.title, text("flow.title"));
    setText(this.hint, this.knee ? text("flow.hint") : text(this.isHidden ? "hidden" : "flow.none"));
    for (const { name, words, yes, no } of this.parts) {
      setText(words, text(`flow.${name}`, torques));
      if (yes) setText(yes, text("flow.yes"));
      if (no) setText(no, text("flow.no"));
    }
    this.list.classList.toggle("off", !this.knee);
  }

  /** Takes the phase of a picture: 1 stick, 2 slip, 0 neither; at once where time passes slowly. */
  take(phase, isSlow) {
    for (const name of Object.keys(PHASES)) {
      const now = this.knee && PHASES[name] === phase ? 1 : 0;
      this.shares[name] = isSlow ? now : LEFT * this.shares[name] + (1 - LEFT) * now;
    }
  }

  /** Lights the phases. */
  show() {
    for (const part of this.parts) {
      if (!(part.name in PHASES)) continue;
      const percent = Math.round(100 * this.shares[part.name]);
      if (percent === part.percent) continue;
      part.percent = percent;
      part.root.style.setProperty("--share", `${percent}%`);
    }
  }
}
