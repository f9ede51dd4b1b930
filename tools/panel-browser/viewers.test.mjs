// 30 viewers beside the page in control: frames and pictures a second, and from the pointer to the picture.

import assert from "node:assert/strict";
import { after, afterEach, test } from "node:test";
import { pause, quantile, round, screen, viewer } from "./figures.mjs";
import { arm, endAll, endTest, openControlling, startPanel } from "./harness.mjs";
import { delaysOf, grab, watchDelays } from "./pointer.mjs";

const VIEWERS = 30;
const MOVES = 8;
// 60 pictures a second and 60 ms are aimed at; the gate shares its cores.
const LEAST_PER_S = 30;
const MOST_MS = 100;

afterEach(endTest);
after(endAll);

test("with 30 viewers a hand is followed as soon, all get their frames, and no sample is missing", async () => {
  const panel = await startPanel();
  const page = await openControlling(panel.teacher);
  await arm(page);
  await grab(page, 40);
  await watchDelays(page);
  const viewers = Array.from({ length: VIEWERS }, () => viewer(panel.viewer));
  for (let nth = 0; nth < 100 && viewers.some(({ frames }) => frames === 0); nth++) await pause(50);

  const measure = async () => {
    const [began, before] = [performance.now(), viewers.map(({ frames }) => frames)];
    const [shown, delays] = await Promise.all([screen(page, panel.child.pid, 5000), delaysOf(page, MOVES)]);
    const seconds = (performance.now() - began) / 1000;
    const rates = viewers.map(({ frames }, nth) => (frames - before[nth]) / seconds);
    return {
      ...shown,
      moves_seen: delays.length,
      pointer_to_picture_ms: { median: round(quantile(delays, 0.5)), p95: round(quantile(delays, 0.95)) },
      viewers_frames_per_s: { least: round(Math.min(...rates)), most: round(Math.max(...rates)) },
    };
  };
  const isQuick = ({ frames_per_s, pictures_per_s, moves_seen, pointer_to_picture_ms, viewers_frames_per_s }) =>
    Math.min(frames_per_s, pictures_per_s, viewers_frames_per_s.least) > LEAST_PER_S &&
    moves_seen > MOVES / 2 &&
    pointer_to_picture_ms.median < MOST_MS;

  let found = await measure();
  const all = [found];
  while (!isQuick(found) && all.length < 3) all.push((found = await measure()));
  for (const { socket } of viewers) socket.terminate();
  for (const figures of all) console.log(JSON.stringify(figures));
  assert.ok(isQuick(found), JSON.stringify(found));
  for (const { missing } of all) assert.equal(missing, 0);
  assert.deepEqual(
    viewers.map(({ missing }) => missing),
    Array(VIEWERS).fill(0),
  );
  assert.deepEqual(page.problems, []);
});
