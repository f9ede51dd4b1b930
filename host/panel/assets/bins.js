// Bins of samples: the lowest and the highest value of each quantity in a
// short time, so that no spike is lost. Decoded from frames, kept in columns.

/** Marks of a bin. */
export const MARK = {
  stick: 1,
  slip: 2,
  limited: 4,
  energised: 8,
  settling: 16,
  lost: 32,
  late: 64,
  gap: 128,
  hurts: 256,
};

/** Bytes of a frame before its bins or samples. */
export const HEADER = 40;
/** Bins of the live view. */
export const BINS_A_SECOND = 200;

const DEGREES = 180 / Math.PI;
const VALUES = [
  "torqueLow",
  "torqueHigh",
  "modelLow",
  "modelHigh",
  "speedLow",
  "speedHigh",
  "angleLow",
  "angleHigh",
  // Where a hand wants the leg; NaN without one.
  "handLow",
  "handHigh",
];
// Bytes of a bin before its states.
const REST = 4 * VALUES.length;

function emptyColumns(room) {
  const columns = { t: new Float64Array(room), states: new Uint32Array(room), breaks: new Uint16Array(room) };
  columns.marks = new Uint16Array(room);
  for (const name of VALUES) columns[name] = new Float32Array(room);
  return columns;
}

// Angles and speeds in degrees from here on; the middle of a bin is its time.
function decode(view, columns, at) {
  const count = view.getUint16(2, true);
  if (count === 0) return 0;
  const stride = Math.floor((view.byteLength - HEADER) / count);
  const begin = view.getFloat64(16, true);
  const length = view.getFloat64(24, true);
  for (let i = 0; i < count; i++) {
    const from = HEADER + i * stride;
    columns.t[at + i] = begin + (i + 0.5) * length;
    for (let k = 0; k < VALUES.length; k++) {
      columns[VALUES[k]][at + i] = view.getFloat32(from + 4 * k, true) * (k < 4 ? 1 : DEGREES);
    }
    columns.states[at + i] = view.getUint32(from + REST, true);
    columns.breaks[at + i] = view.getUint16(from + REST + 4, true);
    columns.marks[at + i] = view.getUint16(from + REST + 6, true);
  }
  return count;
}

/** The answer to a `trace` request as columns. */
export function decodeTrace(view) {
  const columns = emptyColumns(view.getUint16(2, true));
  return { columns, begin: 0, end: decode(view, columns, 0), length: view.getFloat64(24, true) };
}

/** The torques of a frame of samples, N·m. */
export const torquesOf = (view) => new Float32Array(view.buffer, HEADER, view.getUint16(2, true));

/** The last seconds of the live bins; always one piece of each column. */
export class RecentBins {
  constructor(room) {
    this.room = room;
    this.columns = emptyColumns(2 * room);
    this.clear();
  }

  clear() {
    this.begin = 0;
    this.end = 0;
    this.arrived = 0;
    this.length = 1 / BINS_A_SECOND;
    this.masked = { torque: false, states: false };
  }

  /** Moves what is kept to the front if so many bins more do not fit behind it. */
  makeRoom(count) {
    if (this.end + count <= 2 * this.room) return;
    for (const column of Object.values(this.columns)) column.copyWithin(0, this.begin, this.end);
    this.end -= this.begin;
    this.begin = 0;
  }

  /** Appends a frame; returns how many bins it had and how many samples were missing before it. */
  push(view) {
    const count = view.getUint16(2, true);
    const flags = view.getUint32(36, true);
    this.masked = { torque: (flags & 1) !== 0, states: (flags & 2) !== 0 };
    if (count > this.room) return { count: 0, missing: 0 };
    // A time before what is there: the device or the file began again.
    if (count && this.end > this.begin && view.getFloat64(16, true) < this.columns.t[this.end - 1] - 0.1) {
      this.begin = this.end = 0;
    }
    this.makeRoom(count);
    this.end += decode(view, this.columns, this.end);
    this.begin = Math.max(this.begin, this.end - this.room);
    if (count) {
      this.arrived = view.getFloat64(8, true);
      this.length = view.getFloat64(24, true);
    }
    return { count, missing: view.getUint32(32, true) };
  }

  /** The index of the first bin at or after a time. */
  indexAt(time) {
    return indexAt(this.columns.t, this.begin, this.end, time);
  }
}

/** The first index in `begin..end` whose time is at or after one. */
export function indexAt(times, begin, end, time) {
  let low = begin;
  let high = end;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] < time) low = middle + 1;
    else high = middle;
  }
  return low;
}
