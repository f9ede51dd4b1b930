// Bins of the page's own samples, in the columns of those of a frame, with the imaginary object besides.

import { BINS_A_SECOND, MARK, RecentBins } from "../bins.js";
import { TICKS_HZ } from "../sound-law.js";

const SAMPLE_S = 1 / TICKS_HZ;
const SAMPLES = TICKS_HZ / BINS_A_SECOND;
const DEGREES = 180 / Math.PI;

function widen(low, high, at, value) {
  if (value < low[at]) low[at] = value;
  if (value > high[at]) high[at] = value;
}

/** The last seconds. */
export class SampleBins extends RecentBins {
  constructor(seconds) {
    super(seconds * BINS_A_SECOND);
    for (const name of ["object", "spring"]) this.columns[name] = new Float32Array(2 * this.room);
    this.ticks = 0;
    this.lastPhase = 1;
  }

  clear() {
    super.clear();
    this.open = 0;
  }

  /** Appends samples of an engine; returns how many bins they have completed. */
  take(samples, count) {
    let completed = 0;
    for (let i = 0; i < count; i++) {
      if (this.open === 0) this.beginBin();
      this.add(samples, i);
      this.ticks++;
      if (++this.open < SAMPLES) continue;
      this.open = 0;
      this.end++;
      this.begin = Math.max(this.begin, this.end - this.room);
      completed++;
    }
    return completed;
  }

  // The bin behind the last complete one.
  beginBin() {
    this.makeRoom(1);
    const { columns, end } = this;
    columns.t[end] = (this.ticks + SAMPLES / 2) * SAMPLE_S;
    for (const name of ["torque", "speed", "angle", "hand"]) {
      columns[`${name}Low`][end] = Infinity;
      columns[`${name}High`][end] = -Infinity;
    }
    columns.states[end] = columns.breaks[end] = 0;
    columns.marks[end] = MARK.energised;
  }

  add({ torque, angle, speed, hand, object, spring, states, phase }, i) {
    const { columns, end } = this;
    widen(columns.torqueLow, columns.torqueHigh, end, torque[i]);
    widen(columns.speedLow, columns.speedHigh, end, speed[i] * DEGREES);
    widen(columns.angleLow, columns.angleHigh, end, angle[i] * DEGREES);
    widen(columns.handLow, columns.handHigh, end, hand[i] * DEGREES);
    columns.object[end] = object[i] * DEGREES;
    columns.spring[end] = spring[i];
    columns.states[end] |= states[i];
    const slips = phase[i] === 2;
    columns.marks[end] |= slips ? MARK.slip : MARK.stick;
    if (slips && this.lastPhase !== 2) columns.breaks[end]++;
    this.lastPhase = phase[i];
  }
}
