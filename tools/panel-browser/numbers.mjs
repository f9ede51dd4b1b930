// Frame rate, latency, viewers, and what a long time takes. Not a test of the gate:
//
//   node numbers.mjs                    ten seconds of each
//   node numbers.mjs --minutes 30      and half an hour with 30 viewers, one of them stuck

import { readFileSync } from "node:fs";
import { WebSocket } from "ws";
import { arm, end, endAll, openControlling, startPanel, untilState } from "./harness.mjs";

const at = process.argv.indexOf("--minutes");
const minutes = at < 0 ? 0 : Number(process.argv[at + 1]);

const cpu = (pid) => {
  const fields = readFileSync(`/proc/${pid}/stat`, "utf8").split(") ")[1].split(" ");
  return (Number(fields[11]) + Number(fields[12])) / 100;
};
const memory = (pid) => Number(readFileSync(`/proc/${pid}/status`, "utf8").match(/VmRSS:\s+(\d+)/)[1]) / 1000;
const quantile = (list, share) => [...list].sort((a, b) => a - b)[Math.floor(share * (list.length - 1))];
const pause = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
const round = (number) => Math.round(number * 10) / 10;

/** A viewer without a browser: counts what it gets, and answers. */
function viewer(link) {
  const { host, origin, hash } = new URL(link);
  const socket = new WebSocket(`ws://${host}/ws`, { origin });
  const seen = { socket, frames: 0, status: null };
  socket.on("open", () => socket.send(JSON.stringify({ token: hash.slice(1) })));
  socket.on("message", (data, isBinary) => {
    if (isBinary) {
      seen.frames++;
      socket.send(`{"seen":${data.readUInt32LE(4)}}`);
    } else {
      seen.status = JSON.parse(data).status ?? seen.status;
    }
  });
  return seen;
}

const panel = await startPanel();
const page = await openControlling(panel.teacher);
await arm(page);

/** Ten seconds on the screen. */
async function screen() {
  await page.evaluate(() => Object.assign(window.crepitusStats, { frames: 0, paints: 0, latencies: [], draws: [] }));
  const [began, before] = [performance.now(), cpu(panel.child.pid)];
  await pause(10_000);
  const stats = await page.evaluate(() => window.crepitusStats);
  const seconds = (performance.now() - began) / 1000;
  return {
    paints_per_s: round(stats.paints / seconds),
    frames_per_s: round(stats.frames / seconds),
    latency_ms: { median: round(quantile(stats.latencies, 0.5)), p95: round(quantile(stats.latencies, 0.95)) },
    drawing_ms: { median: round(quantile(stats.draws, 0.5)), p95: round(quantile(stats.draws, 0.95)) },
    missing: stats.missing,
    panel_and_device_cpu_percent: round(((cpu(panel.child.pid) - before) / seconds) * 100),
    panel_memory_mb: round(memory(panel.child.pid)),
  };
}

console.log("one page", JSON.stringify(await screen(), null, 1));
const viewers = Array.from({ length: 30 }, () => viewer(panel.viewer));
await pause(1500);
// It takes nothing any more.
viewers[0].socket._socket.pause();
const before = viewers.map(({ frames }) => frames);
console.log("with 30 viewers, one stuck", JSON.stringify(await screen(), null, 1));
const rates = viewers.slice(1).map(({ frames }, nth) => (frames - before[nth + 1]) / 10);
console.log(`frames a second at the viewers: ${round(Math.min(...rates))} to ${round(Math.max(...rates))}`);

for (let minute = 1; minute <= minutes; minute++) {
  const [began, used] = [performance.now(), cpu(panel.child.pid)];
  await pause(60_000);
  const share = ((cpu(panel.child.pid) - used) / (performance.now() - began)) * 100_000;
  const heap = await page.evaluate(() => performance.memory?.usedJSHeapSize / 1e6);
  const { produced, received, dropped, lost, state } = viewers[1].status;
  console.log(
    `minute ${minute}: ${state}; panel and device ${round(share)} % of a core, ${round(memory(panel.child.pid))} MB; ` +
      `page's heap ${round(heap)} MB; ${produced} produced = ${received} received + ${dropped} dropped + ${lost} lost` +
      `${produced === received + dropped + lost ? "" : ": DOES NOT ADD UP"}`,
  );
}
for (const { socket } of viewers) socket.terminate();
await end(panel.child);
await endAll();
