// What is inside the joint: a leg that is cut open, the last second slowly, the torque–angle loop and the flow chart.
// The panel's live view shows it of frames, the page of one file of samples of its own.

import { MARK } from "./bins.js";
import { makeCutaway } from "./cutaway.js";
import { Flow } from "./flow.js";
import { Loop } from "./loop.js";
import { Slow } from "./slow.js";

const DEGREES = 180 / Math.PI;
// Thirty times a second are enough for what changes slowly. Where pictures come late it leaves its time to the leg.
const BESIDE_MS = 32;
const USUAL_MS = 18;
const YIELD = 15;
const LONGEST_MS = 200;

const middle = (low, high) => (low + high) / 2;
const larger = (low, high) => (Math.abs(high) >= Math.abs(low) ? high : low);

/** All of it in boxes: `leg`, `slow`, `loop`, `flow`. `scale` is that of the loop. */
export class Inside {
  constructor(hosts, scale) {
    this.showLeg = makeCutaway(hosts.leg);
    this.slow = new Slow(hosts.slow);
    this.loop = new Loop(hosts.loop, scale);
    this.flow = new Flow(hosts.flow);
    this.knee = null;
    this.spacing = USUAL_MS;
    this.before = 0;
    this.besideAt = 0;
  }

  /**
   * The crepitus of the knee: `stiffness` in N·m/rad, `static` and `kinetic` torque, and `isAlone`, whether nothing
   * else adds to the torque; null without crepitus, or where the knee is hidden.
   */
  setKnee(knee, isHidden = false) {
    this.knee = knee;
    this.flow.setKnee(knee, isHidden);
    this.slow.end();
  }

  /** Draws the newest bins, or the last second while that is shown slowly. */
  draw(now, bins, masked, isStale = false) {
    if (bins.end <= bins.begin) return;
    const { bins: shown, index, isSlow } = this.slow.step(now, bins);
    const state = this.stateAt(shown.columns, index, masked);
    if (isStale && !isSlow) state.angle = state.hand = state.torque = NaN;
    this.showLeg(state);
    this.flow.take(state.phase, isSlow);
    this.spacing += 0.1 * (Math.min(LONGEST_MS, now - this.before) - this.spacing);
    this.before = now;
    const wait = BESIDE_MS + YIELD * Math.max(0, this.spacing - USUAL_MS);
    if (now - this.besideAt < Math.min(LONGEST_MS, wait)) return;
    this.besideAt = now;
    this.flow.show();
    this.loop.draw(bins, masked.torque);
  }

  /** The state of the cutaway in a bin. */
  stateAt(columns, i, masked) {
    const isKnown = this.knee && !masked.states && !masked.torque;
    const phase = !isKnown ? 0 : columns.marks[i] & MARK.slip ? 2 : 1;
    const spring = isKnown ? this.springAt(columns, i, phase) : NaN;
    const object = columns.object?.[i] ?? (spring / this.knee?.stiffness) * DEGREES;
    return {
      angle: middle(columns.angleLow[i], columns.angleHigh[i]),
      // NaN without a hand.
      hand: middle(columns.handLow[i], columns.handHigh[i]),
      torque: masked.torque ? NaN : larger(columns.torqueLow[i], columns.torqueHigh[i]),
      phase,
      spring,
      object,
    };
  }

  // Frames of a device do not have the object's angle. In a stick the model's torque is the spring's, kr·θ; in a slip
  // it is Tk, and the object swings about Tk/kr. Where something else adds to the torque, neither is known.
  springAt(columns, i, phase) {
    if (columns.spring) return columns.spring[i];
    if (!this.knee.isAlone) return NaN;
    const torque = larger(columns.modelLow[i], columns.modelHigh[i]);
    return phase === 1 ? torque : Math.sign(torque) * this.knee.kinetic;
  }
}
