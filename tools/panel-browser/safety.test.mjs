// What must not go wrong: who sees and steers, and when torque ends.

import assert from "node:assert/strict";
import { once } from "node:events";
import { after, afterEach, test } from "node:test";
import { connect } from "node:tls";
import {
  arm, end, endAll, endTest, folder, openControlling, openLive, openPage, quickest, startDevice, startPanel, until,
  untilState,
} from "./harness.mjs";

afterEach(endTest);
after(endAll);

/** Milliseconds until another page sees that torque is off. */
const offAfter = async (page, began) => {
  await until(page, "torque off", () => document.getElementById("state").dataset.state !== "armed");
  return Date.now() - began;
};

test("a wrong key shows nothing", async () => {
  const panel = await startPanel();
  const page = await openPage(panel.teacher.replace(/#.*/, "#0123456789abcdef0123456789abcdef"));
  await page.locator("#next", { hasText: "Open the link that the program printed" }).waitFor();
  assert.equal(await page.evaluate(() => window.crepitusStats.frames), 0);
});

test("the key leaves the address, and a reload keeps it", async () => {
  const panel = await startPanel();
  const page = await openLive(panel.teacher);
  assert.ok(!page.url().includes("#"), page.url());
  await page.reload();
  await until(page, "bins", () => window.crepitusStats?.bins > 0);
  // Nothing of it is where another site or a later visitor could find it.
  assert.deepEqual(await page.context().cookies(), []);
  assert.ok(!(await page.evaluate(() => JSON.stringify(localStorage))).includes(panel.teacher.split("#")[1]));
});

test("another name for this computer, and pages of other sites, are refused", async () => {
  const panel = await startPanel();
  const { port } = new URL(panel.teacher);
  const key = panel.teacher.split("#")[1];
  const page = await openPage("about:blank");
  const answer = await page.goto(`http://rebound.example:${port}/#${key}`);
  assert.equal(answer.status(), 421);
  // A page of another port of this computer, which the browser calls the same site.
  const other = await startPanel(["--device", "sim"]);
  const foreign = await openLive(other.teacher);
  // Its own policy would not let it; without it, the server refuses.
  const attacker = await openPage("about:blank", { bypassCSP: true });
  await attacker.goto(new URL(other.teacher).origin);
  const outcome = await attacker.evaluate(
    ([url, token]) =>
      new Promise((resolve) => {
        const socket = new WebSocket(url);
        socket.onopen = () => socket.send(JSON.stringify({ token }));
        socket.onmessage = () => resolve("answered");
        socket.onerror = () => resolve("refused");
      }),
    [`ws://127.0.0.1:${port}/ws`, key],
  );
  assert.equal(outcome, "refused");
  await foreign.close();
});

test("two pages: one controls, taking over disarms, a viewer stops", async () => {
  const panel = await startPanel();
  const first = await openControlling(panel.teacher);
  const second = await openLive(panel.teacher);
  const viewer = await openLive(panel.viewer);
  await arm(first);
  assert.ok(await second.locator("#arm").isDisabled());
  assert.ok(await viewer.locator("#arm").isDisabled());
  assert.ok(await viewer.locator("#take").isDisabled());
  await second.getByRole("button", { name: "Take control" }).click();
  await second.getByRole("dialog").getByRole("button", { name: "Yes" }).click();
  await untilState(first, "disarmed");
  await first.locator("#holder", { hasText: "another page" }).waitFor();
  await arm(second);
  await viewer.keyboard.press("Escape");
  await untilState(second, "disarmed");
  assert.deepEqual([...first.problems, ...second.problems, ...viewer.problems], []);
});

test("torque ends when the controlling page closes, reloads or hangs", async () => {
  const panel = await startPanel();
  const viewer = await openLive(panel.viewer);
  const ends = {
    closes: (page) => page.close(),
    reloads: (page) => page.reload(),
    hangs: (page) => {
      page.evaluate(() => { const last = Date.now() + 1500; while (Date.now() < last); }).catch(() => {});
    },
  };
  // The browser itself takes a while to close; what hangs is known after 200 ms.
  for (const [what, end] of Object.entries(ends)) {
    const took = await quickest(500, async () => {
      const page = await openControlling(panel.teacher);
      await arm(page);
      await untilState(viewer, "armed");
      const began = Date.now();
      // A page that is loaded again takes its time.
      const ended = end(page);
      const off = await offAfter(viewer, began);
      await ended;
      await page.close();
      return off;
    });
    assert.ok(took < 500, `${what}: ${took} ms`);
  }
});

test("pictures that take too long cost pictures, not the torque", async () => {
  const panel = await startPanel();
  const page = await openControlling(panel.teacher);
  // 250 ms for a picture of five curves: torque before the motor was on is one of its own. Only curves are paths.
  await page.evaluate(() => {
    const { prototype } = CanvasRenderingContext2D;
    const { stroke } = prototype;
    prototype.stroke = function (...path) {
      const last = performance.now() + (path.length ? 50 : 0);
      while (performance.now() < last);
      stroke.apply(this, path);
    };
  });
  let kept = false;
  for (let attempt = 0; attempt < 3 && !kept; attempt++) {
    // The page has to notice that it is late.
    await page.waitForTimeout(1000);
    await page.locator("#arm").click();
    await page.waitForTimeout(3000);
    kept = (await page.locator("#state").getAttribute("data-state")) === "armed";
  }
  assert.ok(kept, await page.locator("#torque-end").textContent());
  const drawn = await page.evaluate(() => window.crepitusStats.draws.length);
  await until(page, "further pictures", (before) => window.crepitusStats.draws.length > before + 3, drawn);
});

test("a hidden tab keeps control: it still answers", async () => {
  const panel = await startPanel();
  const page = await openControlling(panel.teacher);
  await arm(page);
  const cover = await page.context().newPage();
  await cover.goto("about:blank");
  await cover.bringToFront();
  // Timers of hidden tabs are throttled to one a second: they would fail every time.
  let kept = false;
  for (let attempt = 0; attempt < 3 && !kept; attempt++) {
    if (attempt > 0) await page.evaluate(() => document.getElementById("arm").click());
    await new Promise((resolve) => setTimeout(resolve, 3000));
    kept = (await page.locator("#state").getAttribute("data-state")) === "armed";
  }
  await page.bringToFront();
  assert.ok(kept);
});

test("a killed server is said, and the page comes back", async () => {
  const home = folder();
  await startDevice(home);
  const env = { XDG_RUNTIME_DIR: home };
  const panel = await startPanel(["--device", "knee"], env);
  const page = await openLive(panel.teacher);
  await end(panel.child, "SIGKILL");
  await untilState(page, "connection-lost");
  const { port } = new URL(panel.teacher);
  // Another run has another key: the page says what to do.
  await startPanel(["--device", "knee", "--port", port], env);
  await untilState(page, "refused");
  await page.locator("#next", { hasText: "Open the link that the program printed" }).waitFor();
});

test("a page that connects again still has its knees", async () => {
  const panel = await startPanel();
  const page = await openPage("about:blank");
  const sockets = [];
  await page.routeWebSocket(/\/ws$/, (socket) => {
    const isFirst = sockets.push(socket) === 1;
    const server = socket.connectToServer();
    // The second time the list does not come behind the greeting.
    server.onMessage((message) => {
      if (isFirst || !String(message).startsWith('{"presets"')) socket.send(message);
    });
  });
  await page.goto(panel.teacher);
  await until(page, "the knees", () => document.querySelectorAll("#knee .cards > .card").length > 5);
  await untilState(page, "disarmed");
  const count = () => page.locator("#knee .cards > .card").count();
  const before = await count();
  await sockets[0].close();
  await untilState(page, "connection-lost");
  await untilState(page, "disarmed");
  assert.equal(sockets.length, 2);
  assert.equal(await count(), before);
});

test("a device that is killed or unplugged is said, and found again", async () => {
  const home = folder();
  const env = { XDG_RUNTIME_DIR: home };
  let device = await startDevice(home);
  const panel = await startPanel(["--device", "knee"], env);
  const page = await openControlling(panel.teacher);
  await page.locator("#zero").click();
  await arm(page);
  for (const signal of ["SIGKILL", "SIGINT"]) {
    await end(device, signal);
    await untilState(page, "device-lost");
    assert.ok(await page.locator("#arm").isDisabled());
    // In a line, with what the system says behind it.
    await page.getByText("is its cable plugged in").waitFor();
    const detail = page.locator("#lost-detail");
    assert.ok(!(await detail.isVisible()));
    await page.locator("#lost > summary").click();
    assert.match(await detail.textContent(), /connection to .*knee.* lost|not open/);
    await page.locator("#lost > summary").click();
    device = await startDevice(home);
    await untilState(page, "disarmed");
  }
  await until(page, "bins again", () => window.crepitusStats.bins > 0);
});

test("a fault says what to do, shows its page of the book, and can be cleared", async () => {
  const panel = await startPanel();
  const page = await openControlling(panel.teacher);
  await arm(page);
  // A leg that was led from straight goes on without torque.
  await page.waitForTimeout(500);
  await page.keyboard.press("Escape");
  await untilState(page, "disarmed");
  await page.waitForTimeout(1500);
  // Zeroed while the leg is bent, it is outside its range when it is straight.
  await until(page, "a bent leg", () => Number(document.getElementById("angle").textContent) > 60);
  await page.locator("#zero").click();
  await arm(page).catch(() => {});
  await page.getByText(/What to do:/).first().waitFor();
  await page.getByText("Read about it").click();
  await page.getByText("noticed by").waitFor();
  await page.getByRole("button", { name: "Clear fault" }).click();
});

test("for other computers it is served with TLS, and with the same rules", async () => {
  const panel = await startPanel(["--device", "sim", "--lan", "127.0.0.1"]);
  assert.match(panel.teacher, /^https:/);
  const { hostname, port } = new URL(panel.teacher);
  const socket = connect({ host: hostname, port, rejectUnauthorized: false });
  await once(socket, "secureConnect");
  assert.equal(socket.getPeerCertificate().fingerprint256, panel.certificate);
  socket.destroy();
  // Without TLS nothing is answered.
  await assert.rejects(fetch(`http://${hostname}:${port}/`));
  const page = await openControlling(panel.teacher, { ignoreHTTPSErrors: true });
  await arm(page);
  const rebound = await openPage("about:blank", { ignoreHTTPSErrors: true });
  const answer = await rebound.goto(`https://rebound.example:${port}/`);
  assert.equal(answer.status(), 421);
  await page.keyboard.press("Escape");
  await untilState(page, "disarmed");
});
