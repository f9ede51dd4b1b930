// Frame rate, latency, viewers, and what a long time takes. Not a test of the gate:
//
//   node numbers.mjs                    ten seconds of each
//   node numbers.mjs --minutes 30      and half an hour with 30 viewers, one of them stuck
//   node numbers.mjs --slower 6        instead: 20 s armed, with a page whose thread is so many times slower

import { readFileSync } from "node:fs";
import { cpu, memory, pause, round, screen, viewer } from "./figures.mjs";
import { arm, end, endAll, openControlling, startPanel } from "./harness.mjs";

const option = (name) => Number(process.argv[process.argv.indexOf(name) + 1] ?? 0) || 0;
const minutes = option("--minutes");
const slower = option("--slower");

const panel = await startPanel();
const page = await openControlling(panel.teacher);
await arm(page);

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

console.log("one page", JSON.stringify(await screen(page, panel.child.pid), null, 1));
const viewers = Array.from({ length: 30 }, () => viewer(panel.viewer));
await pause(1500);
// It takes nothing any more.
viewers[0].socket._socket.pause();
const before = viewers.map(({ frames }) => frames);
console.log("with 30 viewers, one stuck", JSON.stringify(await screen(page, panel.child.pid), null, 1));
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
