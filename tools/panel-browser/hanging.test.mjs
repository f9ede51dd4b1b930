// A connection that hangs, a browser that stores nothing, and links that are old.

import assert from "node:assert/strict";
import { connect, createServer } from "node:net";
import { after, afterEach, test } from "node:test";
import {
  arm, endAll, endTest, folder, openControlling, openLive, openPage, quickest, startPanel, until, untilState,
} from "./harness.mjs";

afterEach(endTest);
after(endAll);

/** A proxy that can hang both ways, and later goes on. */
async function startTunnel() {
  const sockets = new Set();
  const server = createServer((page) => {
    page.once("data", (first) => {
      const [, method, target] = /^(\S+) (\S+)/.exec(first.toString("latin1"));
      const { hostname, port } = new URL(method === "CONNECT" ? `http://${target}` : target);
      const panel = connect(Number(port), hostname);
      for (const socket of [page, panel]) {
        sockets.add(socket);
        socket.on("error", () => {});
        socket.on("close", () => [page, panel].forEach((end) => sockets.delete(end) && end.destroy()));
      }
      if (method === "CONNECT") page.write("HTTP/1.1 200 OK\r\n\r\n");
      else panel.write(first);
      page.on("data", (data) => panel.write(data));
      panel.on("data", (data) => page.write(data));
      for (const socket of [page, panel]) if (hangs) socket.pause();
    });
    if (hangs) page.pause();
  });
  let hangs = false;
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  return {
    proxy: { server: `http://127.0.0.1:${server.address().port}`, bypass: "<-loopback>" },
    hang(is) {
      hangs = is;
      for (const socket of sockets) is ? socket.pause() : socket.resume();
    },
    end: () => server.close(),
  };
}

const shows = (id) => document.getElementById(id).textContent;

test("a connection that hangs: numbers and states are blank within half a second, and a stop says so", async () => {
  const panel = await startPanel();
  const tunnel = await startTunnel();
  const page = await openControlling(panel.teacher, { proxy: tunnel.proxy });
  const viewer = await openLive(panel.viewer);
  const blank = await quickest(500, async () => {
    tunnel.hang(false);
    await untilState(page, "disarmed");
    await until(page, "an angle", () => document.getElementById("angle").textContent !== "–");
    if (!(await page.evaluate(shows, "holder")).includes("you")) await page.locator("#take").click();
    await until(page, "control", () => document.getElementById("holder").textContent === "you");
    await arm(page);
    const began = Date.now();
    tunnel.hang(true);
    await untilState(page, "silent");
    await until(page, "no angle", () => document.getElementById("angle").textContent === "–");
    return Date.now() - began;
  });
  assert.ok(blank < 500, `${blank} ms`);
  assert.match(await page.evaluate(shows, "state"), /no connection for [\d.]+ s/);
  assert.equal(await page.evaluate(shows, "holder"), "–");
  await untilState(viewer, "disarmed");
  assert.match(await viewer.evaluate(shows, "torque-end-text"), /did not answer for 200 ms/);
  const began = Date.now();
  await page.keyboard.press("Escape");
  await until(page, "the alarm", () => !document.getElementById("alarm").hidden);
  assert.ok(Date.now() - began < 900, "as long as a busy computer may take");
  assert.match(await page.evaluate(shows, "alarm"), /NOT CONFIRMED[\s\S]*stop in the hand/);
  tunnel.hang(false);
  await until(page, "the confirmation", () => document.getElementById("alarm").hidden);
  await untilState(page, "disarmed");
  tunnel.end();
});

test("a browser that stores nothing shows the page all the same", async () => {
  const panel = await startPanel();
  const page = await openPage("about:blank");
  await page.context().addInitScript(() => {
    for (const name of ["localStorage", "sessionStorage"]) {
      Object.defineProperty(window, name, {
        get() {
          throw new DOMException("blocked", "SecurityError");
        },
      });
    }
  });
  await page.goto(panel.teacher);
  await until(page, "bins", () => window.crepitusStats?.bins > 0);
  await page.locator("#language").selectOption("de");
  await page.getByRole("button", { name: "Steuerung übernehmen" }).waitFor();
  await page.reload();
  await until(page, "bins again", () => window.crepitusStats?.bins > 0);
  assert.deepEqual(page.problems, []);
});

test("a link that is old, cut off or without its key says so", async () => {
  const panel = await startPanel();
  for (const [key, words] of [
    ["#0123456789abcdef0123456789abcdef", "This link is old"],
    [`#${panel.teacher.split("#")[1].slice(0, 20)}`, "This link is cut off"],
    ["", "This address has no key"],
  ]) {
    const page = await openPage(panel.teacher.replace(/#.*/, key));
    await page.getByText(words).waitFor();
    await page.close();
  }
});

test("a recording has the date of today", async () => {
  const panel = await startPanel(["--device", "sim", "--sessions", folder()]);
  const page = await openControlling(panel.teacher);
  await page.locator("#record button").click();
  await page.waitForTimeout(500);
  await page.locator("#record button").click();
  await page.locator("#tab-recordings").click();
  await until(page, "the list", () => document.querySelector(".recordings-list li"));
  const listed = await page.evaluate(() => document.querySelector(".recordings-list").textContent);
  assert.ok(listed.includes(String(new Date().getFullYear())), listed);
});
