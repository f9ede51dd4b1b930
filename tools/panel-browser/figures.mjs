// Figures of a panel under way: what the page draws, what viewers get, and what the program takes for it.

import { existsSync, readdirSync, readFileSync } from "node:fs";
import { WebSocket } from "ws";

/** CPU time that a process has taken, s. */
export const cpu = (pid) => {
  const fields = readFileSync(`/proc/${pid}/stat`, "utf8").split(") ")[1].split(" ");
  return (Number(fields[11]) + Number(fields[12])) / 100;
};

/** CPU time of the main threads of the browser's pages by process, ms; empty where the system does not tell. */
export function pagesCpu() {
  const pages = new Map();
  const names = existsSync("/proc/self/schedstat") ? readdirSync("/proc") : [];
  for (const pid of names.filter((name) => /^\d+$/.test(name))) {
    try {
      if (!readFileSync(`/proc/${pid}/cmdline`, "utf8").includes("--type=renderer")) continue;
      pages.set(pid, Number(readFileSync(`/proc/${pid}/task/${pid}/schedstat`, "utf8").split(" ")[0]) / 1e6);
    } catch {
      // It has ended meanwhile.
    }
  }
  return pages;
}

/** Memory of a process, MB. */
export const memory = (pid) => Number(readFileSync(`/proc/${pid}/status`, "utf8").match(/VmRSS:\s+(\d+)/)[1]) / 1000;

export const quantile = (list, share) => [...list].sort((a, b) => a - b)[Math.floor(share * (list.length - 1))];
export const pause = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
export const round = (number) => Math.round(number * 10) / 10;

/** A viewer without a browser: counts what it gets, and answers. */
export function viewer(link) {
  const { host, origin, hash } = new URL(link);
  const socket = new WebSocket(`ws://${host}/ws`, { origin });
  const seen = { socket, frames: 0, missing: 0, status: null };
  socket.on("open", () => socket.send(JSON.stringify({ token: hash.slice(1) })));
  socket.on("message", (data, isBinary) => {
    if (isBinary) {
      seen.frames++;
      seen.missing += data.readUInt32LE(32);
      socket.send(`{"seen":${data.readUInt32LE(4)}}`);
    } else {
      seen.status = JSON.parse(data).status ?? seen.status;
    }
  });
  return seen;
}

/** What a page shows for so long, and what the panel, the process `pid`, takes meanwhile. */
export async function screen(page, pid, ms = 10_000) {
  await page.evaluate(() =>
    Object.assign(window.crepitusStats, { frames: 0, paints: 0, missing: 0, latencies: [], draws: [] }),
  );
  const [began, before] = [performance.now(), cpu(pid)];
  await pause(ms);
  const stats = await page.evaluate(() => window.crepitusStats);
  const seconds = (performance.now() - began) / 1000;
  return {
    paints_per_s: round(stats.paints / seconds),
    frames_per_s: round(stats.frames / seconds),
    pictures_per_s: round(stats.draws.length / seconds),
    latency_ms: { median: round(quantile(stats.latencies, 0.5)), p95: round(quantile(stats.latencies, 0.95)) },
    drawing_ms: { median: round(quantile(stats.draws, 0.5)), p95: round(quantile(stats.draws, 0.95)) },
    missing: stats.missing,
    panel_and_device_cpu_percent: round(((cpu(pid) - before) / seconds) * 100),
    panel_memory_mb: round(memory(pid)),
  };
}
