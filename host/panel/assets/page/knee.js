// A knee of the page: the model under a leg, the hand that moves it, and the bins of what came of it.

import { Engine, TICKS_A_MS } from "./engine.js";
import { SampleBins } from "./sample-bins.js";

const SECONDS = 12;

/** A knee. */
export class Knee {
  static async load(bytes) {
    return new Knee(await Engine.load(bytes));
  }

  constructor(engine) {
    this.engine = engine;
    this.bins = new SampleBins(SECONDS);
  }

  /** Begins with a knee of these parameters, `[id, value]` each. */
  begin(values) {
    this.engine.begin(values);
    this.bins.clear();
  }

  /** Goes on by some milliseconds with a hand; returns how many samples and bins that made. */
  step(ms, { angle, holds }) {
    this.engine.hand(angle, holds);
    const samples = this.engine.advance(Math.round(ms * TICKS_A_MS));
    return { samples, bins: this.bins.take(this.engine.columns, samples) };
  }

  /** The torques of the last step, N·m. */
  torques(samples) {
    return this.engine.columns.torque.subarray(0, samples);
  }
}
