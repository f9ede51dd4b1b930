// The page's law of sound beside that of `--wav`: no browser is needed for it.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { after, test } from "node:test";
import { CREPITUS, endAll, folder } from "./harness.mjs";

// As a module, whatever an older Node takes a `.js` for.
const law = readFileSync(join(import.meta.dirname, "../../host/panel/assets/sound-law.js"));
const { RATE_HZ, SoundLaw, TICKS_HZ } = await import(`data:text/javascript;base64,${law.toString("base64")}`);

after(endAll);

const largest = (list) => list.reduce((most, value) => Math.max(most, Math.abs(value)), 0);

test("the law is that of the program, sample by sample", () => {
  const file = join(import.meta.dirname, "../../host/pages/tests/golden/sound.json");
  const { ticks, every, peak, above_30_hz_nm: golden } = JSON.parse(readFileSync(file, "utf8"));
  const torque = (i) => (0.4 * (i % 629)) / 629 + (0.05 * ((i * 7919) % 1000)) / 1000;
  const torques = Float64Array.from({ length: ticks }, (_, i) => torque(i));
  const whole = new SoundLaw().filter(torques);
  // The last samples wait for what comes behind them.
  assert.ok(whole.length > (ticks * RATE_HZ) / TICKS_HZ - 200, `${whole.length} samples`);
  const errors = golden.slice(0, Math.ceil(whole.length / every)).map((nm, i) => whole[i * every] - nm);
  assert.ok(largest(errors) < 1e-6, `${largest(errors)} N·m`);
  // However the torques come.
  const piecewise = new SoundLaw();
  const pieces = [];
  for (let i = 0; i < ticks; i += 7) pieces.push(...piecewise.filter(torques.subarray(i, i + 7)));
  assert.deepEqual(pieces, [...whole]);
  const loud = new SoundLaw().push(torques.map((nm) => 100 * nm));
  assert.ok(largest(loud) <= peak + 1e-6 && largest(loud) > 0.99 * peak, `${largest(loud)}`);
});

test("a constant is silence, and the rest of a quiet knee stays quiet", () => {
  assert.equal(largest(new SoundLaw().push(new Float32Array(4000).fill(0.25))) < 1e-9, true);
  const quiet = Float64Array.from({ length: 4000 }, (_, i) => 1e-4 * Math.sin(0.1 * i));
  assert.ok(largest(new SoundLaw().push(quiet)) < 1e-3);
});

test("the worklet begins with a lead, and of too many samples the oldest are left out", () => {
  const script = readFileSync(join(import.meta.dirname, "../../host/panel/assets/sound-worklet.js"), "utf8");
  let Player = null;
  const run = new Function("registerProcessor", "AudioWorkletProcessor", script);
  run((_, kind) => (Player = kind), class { port = {}; });
  const player = new Player({ processorOptions: { lead: 4, most: 8 } });
  const send = (...samples) => player.port.onmessage({ data: Float32Array.from(samples) });
  const play = () => {
    const out = new Float32Array(2);
    player.process([], [[out]]);
    return [...out];
  };
  send(1, 2, 3);
  assert.deepEqual(play(), [0, 0]);
  send(4);
  assert.deepEqual([play(), play(), play()], [[1, 2], [3, 4], [0, 0]]);
  send(1, 2, 3, 4, 5, 6, 7, 8, 9);
  assert.deepEqual(play(), [6, 7]);
});

test("samples are those of a file of --wav", () => {
  const home = folder();
  const wav = join(home, "knee.wav");
  const printed = execFileSync(
    CREPITUS,
    ["run", "slow-examination", "--set", "duration_s=1", "--set", "output.trace_step_s=5e-5"].concat(
      ["--wav", wav, "--out", join(home, "run"), "--json"],
    ),
    { encoding: "utf8", maxBuffer: 1 << 26 },
  );
  const { full_scale_nm: fullScale } = JSON.parse(printed).sound;
  const [header, ...rows] = readFileSync(join(home, "run/trace.csv"), "utf8").trim().split("\n");
  const column = header.split(",").indexOf("torque_nm");
  const torques = Float64Array.from(rows, (row) => Number(row.split(",")[column]));
  const bytes = readFileSync(wav);
  const begin = bytes.indexOf("data") + 8;
  const samples = new SoundLaw().filter(torques);
  assert.ok(samples.length > 0.98 * RATE_HZ, `${samples.length} samples`);
  const errors = samples.map((nm, i) => (nm / fullScale) * 32767 - bytes.readInt16LE(begin + 2 * i));
  // Half a step of 16 bits, and what the program's table of the kernel leaves.
  assert.ok(largest(errors) < 1, `${largest(errors)} of 32767`);
});
