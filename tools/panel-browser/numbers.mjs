// Frame rate, latency, viewers, and what a long time takes. Not a test of the gate:
//
//   node numbers.mjs                    ten seconds of each
//   node numbers.mjs --minutes 30      and half an hour with 30 viewers, one of them stuck
//   node numbers.mjs --slower 6        instead: 20 s armed, with a page whose thread is so many times slower

import { readFileSync } from "node:fs";
import { WebSocket } from "ws";
import { arm, end, endAll, openControlling, startPanel } from "./harness.mjs";

const option = (name) => Number(process.argv[process.argv.indexOf(name) + 1] ?? 0) || 0;
const minutes = option("--minutes");
const slower = option("--slower");

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

/** How often torque ends on a slow computer, the longest time between two answers, and tasks above 50 ms. */
async function onSlowComputer() {
  const cdp = await page.context().newCDPSession(page);
  await page.evaluate(() => {
    const found = (window.found = { ends: 0, gap_ms: 0, tasks: [] });
    const { send } = WebSocket.prototype;
    let before = Infinity;
    WebSocket.prototype.send = function (data) {
      if (data.startsWith('{"seen"')) {
        found.gap_ms = Math.max(found.gap_ms, performance.now() - before);
        before = performance.now();
      }
      send.call(this, data);
    };
    const state = document.getElementById("state");
    new MutationObserver(() => {
      if (state.dataset.state !== "disarmed") return;
      found.ends++;
      document.getElementById("arm").click();
    }).observe(state, { attributeFilter: ["data-state"] });
    const tasks = (list) => found.tasks.push(...list.getEntries().map(({ duration }) => duration));
    new PerformanceObserver(tasks).observe({ type: "longtask" });
  });
  await cdp.send("Emulation.setCPUThrottlingRate", { rate: slower });
  await page.evaluate(() => Object.assign(window.crepitusStats, { draws: [] }));
  await pause(20_000);
  const { ends, gap_ms, tasks } = await page.evaluate(() => window.found);
  const pictures = await page.evaluate(() => window.crepitusStats.draws.length);
  const load = Number(readFileSync("/proc/loadavg", "utf8").split(" ")[0]);
  return { ends, gap_ms: round(gap_ms), tasks: tasks.length, longest_ms: Math.max(0, ...tasks), pictures, load };
}

if (slower) {
  console.log(`20 s armed, ${slower} times slower`, JSON.stringify(await onSlowComputer()));
  await endAll();
  process.exit();
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
