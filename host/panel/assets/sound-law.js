// How a torque becomes sound: the law of `--wav` (host/pages/src/sound), sample by sample. Nothing of a browser is
// used here.
//
//   torque at 20 kHz ─ windowed sinc ─> 48 kHz ─ high-pass ─> from 30 Hz on ─ level ─> −1 to 1

/** Torques a second. */
export const TICKS_HZ = 20_000;
/** Samples of sound a second. */
export const RATE_HZ = 48_000;

const HIGH_PASS_HZ = 30;
// Of full scale, as in a file of `--wav`: −1 dB.
const PEAK = 0.891;
// A file knows its loudest sample before it is written. Here the loudest so far counts, and at least so many N·m:
// what is left of a knee without a symptom is not made loud.
const LEAST_PEAK_NM = 0.2;

// The kernel: 64 zero crossings of the sinc on either side under a Kaiser window, its cutoff at 0.475 of the slower rate.
const CROSSINGS = 64;
const BETA = 8.96;
const CROSSINGS_A_TICK = 2 * 0.475;
const REACH = Math.ceil(CROSSINGS / CROSSINGS_A_TICK);
// 48 kHz and 20 kHz are 12 to 5: a sample has one of 12 places between two ticks.
const PLACES = 12;
const STEP = 5;
const TAPS = 2 * REACH;

const sinc = (x) => (x === 0 ? 1 : Math.sin(Math.PI * x) / (Math.PI * x));

/** The modified Bessel function I₀. */
function bessel(x) {
  let sum = 1;
  let term = 1;
  for (let k = 1; k < 60; k++) {
    term *= ((0.5 * x) / k) ** 2;
    sum += term;
  }
  return sum;
}

/** The kernel at a distance in ticks. */
function kernel(distance) {
  const x = distance * CROSSINGS_A_TICK;
  const end = x / CROSSINGS;
  if (end > 1) return 0;
  return (sinc(x) * bessel(BETA * Math.sqrt(1 - end * end))) / bessel(BETA);
}

/** The weights of the ticks around each place; their sum is 1, so that a constant stays one. */
function weights() {
  return Array.from({ length: PLACES }, (_, place) => {
    const taps = new Float64Array(TAPS);
    for (let k = 0; k < TAPS; k++) taps[k] = kernel(Math.abs(place / PLACES + REACH - 1 - k));
    const sum = taps.reduce((all, one) => all + one, 0);
    return taps.map((one) => one / sum);
  });
}

/** From 20 kHz to 48 kHz. Before the first torque it was always that. */
class Resampler {
  constructor() {
    this.weights = weights();
    this.clear();
  }

  clear() {
    this.kept = null;
    this.place = 0;
  }

  /** Appends torques; returns the samples that are complete. */
  push(torques) {
    if (!torques.length) return new Float64Array(0);
    const kept = this.kept ?? new Float64Array(REACH - 1).fill(torques[0]);
    const all = new Float64Array(kept.length + torques.length);
    all.set(kept);
    all.set(torques, kept.length);
    const out = new Float64Array(Math.ceil((all.length * PLACES) / STEP));
    let count = 0;
    let first = 0;
    while (first + TAPS <= all.length) {
      const taps = this.weights[this.place];
      let sum = 0;
      for (let k = 0; k < TAPS; k++) sum += taps[k] * all[first + k];
      out[count++] = sum;
      this.place += STEP;
      first += Math.floor(this.place / PLACES);
      this.place %= PLACES;
    }
    this.kept = all.slice(first);
    return out.subarray(0, count);
  }
}

/** The second-order Butterworth filter, in transposed direct form II. */
class HighPass {
  constructor() {
    const omega = (2 * Math.PI * HIGH_PASS_HZ) / RATE_HZ;
    const alpha = Math.sin(omega) * Math.SQRT1_2;
    const scale = 1 + alpha;
    this.b = (0.5 * (1 + Math.cos(omega))) / scale;
    this.a1 = (-2 * Math.cos(omega)) / scale;
    this.a2 = (1 - alpha) / scale;
    this.clear();
  }

  clear() {
    this.state = null;
  }

  /** The filter begins in the steady state of its first value. */
  next(x) {
    const { b } = this;
    this.state ??= [-b * x, b * x];
    const y = b * x + this.state[0];
    this.state[0] = -2 * b * x - this.a1 * y + this.state[1];
    this.state[1] = b * x - this.a2 * y;
    return y;
  }
}

/** Torques in, samples of sound out. */
export class SoundLaw {
  constructor() {
    this.resampler = new Resampler();
    this.highPass = new HighPass();
    this.clear();
  }

  /** Begins anew, as with another knee. */
  clear() {
    this.resampler.clear();
    this.highPass.clear();
    this.peak = LEAST_PEAK_NM;
  }

  /** What is above 30 Hz in these torques, N·m, at 48 kHz. */
  filter(torques) {
    return this.resampler.push(torques).map((x) => this.highPass.next(x));
  }

  /** The sound of these torques: as loud as the loudest so far allows. */
  push(torques) {
    return Float32Array.from(this.filter(torques), (y) => {
      this.peak = Math.max(this.peak, Math.abs(y));
      return (PEAK * y) / this.peak;
    });
  }
}
