// Breaks and snaps as vibration of a phone, once somebody has asked for it. Elsewhere there is nothing to switch on.

import { el, setText } from "./dom.js";
import { store, stored } from "./storage.js";
import { onLanguage, text } from "./strings.js";

const VIBRATION_MS = 12;
const SNAPS = ["spasticity.caught", "clasp-knife.fallen", "cogwheel.high"];

/** Vibrates with what a hand would feel. */
export class Feel {
  constructor() {
    this.isOn = stored("vibration") === "on";
    this.setStates([]);
  }

  /** The states of symptoms, in the order of their bits. */
  setStates(states) {
    this.snaps = states.reduce(
      (bits, { effect, phase }, bit) => (SNAPS.includes(`${effect}.${phase}`) ? bits | (1 << bit) : bits),
      0,
    );
    this.before = 0;
  }

  /** Takes the breaks of a short time, and the states in it. */
  take(breaks, states) {
    const begun = states & ~this.before & this.snaps;
    this.before = states;
    if (!this.isOn || (!breaks && !begun)) return;
    // A page that nobody has touched may not vibrate, and browsers complain.
    if (navigator.userActivation?.hasBeenActive) navigator.vibrate?.(VIBRATION_MS);
  }
}

/** Adds the switch to a box, where the browser can vibrate. */
export function addFeelSwitch(host, feel) {
  if (!navigator.vibrate) return;
  const button = el("button", { type: "button", class: "toggle" });
  const show = () => {
    button.setAttribute("aria-pressed", String(feel.isOn));
    setText(button, text("vibration"));
  };
  button.addEventListener("click", () => {
    feel.isOn = !feel.isOn;
    store("vibration", feel.isOn ? "on" : "off");
    show();
  });
  host.append(button);
  onLanguage(show);
  show();
}
