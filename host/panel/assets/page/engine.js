// The device's own model under a simulated leg: WebAssembly, 20,000 steps a second. The exports are those of
// `sim/knee/src/page.rs`.

import { TICKS_HZ } from "../sound-law.js";

/** Most steps at once. */
const ROOM = 2048;
/** Steps a millisecond. */
export const TICKS_A_MS = TICKS_HZ / 1000;

const DEGREES = 180 / Math.PI;
const COLUMNS = {
  torque: ["torque_nm", Float32Array],
  angle: ["angle_rad", Float32Array],
  speed: ["speed_rad_s", Float32Array],
  hand: ["hand_rad", Float32Array],
  object: ["object_rad", Float32Array],
  spring: ["spring_nm", Float32Array],
  states: ["states", Uint32Array],
  phase: ["phase", Uint32Array],
};

/** A knee. */
export class Engine {
  /** Makes one of the module's bytes. */
  static async load(bytes) {
    const { instance } = await WebAssembly.instantiate(bytes, {});
    return new Engine(instance.exports);
  }

  constructor(exports) {
    this.exports = exports;
    this.views = null;
    this.begin([]);
  }

  /** Begins with a knee of these parameters, `[id, value]` each: the leg straight, nothing measured. */
  begin(values) {
    if (this.exports.begin() !== 0) throw new Error("the knee does not begin");
    for (const [id, value] of values) {
      if (this.exports.set(id, value) !== 0) throw new Error(`there is no parameter ${id}`);
    }
    const refused = this.exports.commit();
    if (refused !== 0) throw new Error(`parameter ${refused - 1} is out of its range`);
  }

  /** Where the hand wants the leg, in degrees, and whether it holds it. */
  hand(angle, holds) {
    this.exports.hand(angle / DEGREES, holds ? 1 : 0);
  }

  /** Goes on by steps of 50 µs, `ROOM` at most; returns how many samples are in the columns. */
  advance(ticks) {
    return this.exports.advance(Math.min(ticks, ROOM));
  }

  /** The samples of the last advance, in SI units. */
  get columns() {
    const { buffer } = this.exports.memory;
    // Memory that has grown is another buffer.
    if (this.views?.torque.buffer !== buffer) {
      const views = Object.entries(COLUMNS).map(([name, [pointer, Kind]]) => [
        name,
        new Kind(buffer, this.exports[pointer](), ROOM),
      ]);
      this.views = Object.fromEntries(views);
    }
    return this.views;
  }

  /** The measures of the examination so far, `count` of them; NaN where there is none. */
  measures(count) {
    return new Float32Array(this.exports.memory.buffer, this.exports.examination(), count);
  }

  /** The signs of the knee: outcome by number, what was reached and what it takes, NaN where there is none. */
  findings() {
    const { memory, findings, outcomes, reached, needed } = this.exports;
    const count = findings();
    const numbers = [reached, needed].map((column) => new Float32Array(memory.buffer, column(), count));
    return Array.from(new Uint32Array(memory.buffer, outcomes(), count), (outcome, i) => ({
      outcome,
      reached: numbers[0][i],
      needed: numbers[1][i],
    }));
  }

  /** The steps of the examination that were done, a bit each. */
  steps() {
    return this.exports.steps();
  }
}
