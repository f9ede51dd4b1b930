// The knee of the single page without a page, for the test that compares it with the native one:
//
//   node columns.mjs knee.wasm MEASURES < runs > columns
//
// A run is a line of standard input: [ids, values, ticks, angles], parameters and frames of a hand. Each has a
// knee of its own; of each frame every column is written as it lies in memory, at the end the measures of the
// examination, its steps, the number of its findings and their columns.

import { readFileSync } from "node:fs";

const COLUMNS = [
  "torque_nm",
  "angle_rad",
  "speed_rad_s",
  "hand_rad",
  "object_rad",
  "spring_nm",
  "states",
  "phase",
];

const FINDINGS = ["outcomes", "reached", "needed"];

/** The number of measures. */
const MEASURES = Number(process.argv[3]);

function columnsOf(module, [ids, values, ticks, angles]) {
  const knee = new WebAssembly.Instance(module).exports;
  const accepted = (code, call) => {
    if (code !== 0) throw new Error(`${call} is refused with ${code}`);
  };
  accepted(knee.begin(), "begin");
  ids.forEach((id, k) => accepted(knee.set(id, values[k]), `parameter ${id}`));
  accepted(knee.commit(), "commit");
  const frames = ticks.map((count, frame) => {
    knee.hand(angles[frame], 1);
    const made = knee.advance(count);
    const column = (name) => Buffer.from(knee.memory.buffer, knee[name](), 4 * made);
    // A copy: the next frame lies in the same place.
    return Buffer.concat(COLUMNS.map(column));
  });
  const measures = Buffer.from(knee.memory.buffer, knee.examination(), 4 * MEASURES);
  const numbers = Buffer.alloc(8);
  numbers.writeInt32LE(knee.steps(), 0);
  numbers.writeInt32LE(knee.findings(), 4);
  const findings = FINDINGS.map((name) => Buffer.from(knee.memory.buffer, knee[name](), 4 * knee.findings()));
  return Buffer.concat([...frames, measures, numbers, ...findings]);
}

const module = new WebAssembly.Module(readFileSync(process.argv[2]));
const runs = readFileSync(0, "utf8").trim().split("\n").map((line) => JSON.parse(line));
for (const run of runs) {
  const done = process.stdout.write(columnsOf(module, run));
  if (!done) await new Promise((drained) => process.stdout.once("drain", drained));
}
