// STOP on every size of window: in sight, whole, above nothing that cannot be scrolled free of it.

import assert from "node:assert/strict";
import { after, test } from "node:test";
import { arm, end, endAll, folder, openControlling, openLive, startPanel, until, untilState } from "./harness.mjs";

// Both sides of the breakpoints of the style sheet, and the smallest window.
const LONG = (process.env.CREPITUS_LONG ?? "0") !== "0";
const WIDTHS = LONG ? [320, 340, 360, 390, 480, 640, 699, 700, 768, 1024, 1099, 1100, 1280] : [320, 699, 700, 1100];
const HEIGHTS = LONG ? [360, 420, 480, 560, 561, 640, 720, 900] : [360, 560, 561];

after(endAll);

/** What is wrong with the layout of the page as it is now, in text. */
async function look() {
  const frame = () => new Promise(requestAnimationFrame);
  // The height of the header is measured after the layout.
  for (let nth = 0; nth < 2; nth++) await frame();
  const root = document.documentElement;
  const dialog = document.querySelector("dialog[open]");
  const stop = dialog ? dialog.querySelector(".stop") : document.getElementById("stop");
  const inBody = getComputedStyle(root).overflowY === "hidden";
  const scroller = dialog ?? (inBody ? document.body : root);
  const problems = [];
  const nameOf = (node) => (node.id ? `#${node.id}` : `${node.localName}.${node.className} "${node.textContent.trim().slice(0, 20)}"`);
  const cut = (box, { left, top, right, bottom }) => ({
    left: Math.max(box.left, left),
    top: Math.max(box.top, top),
    right: Math.min(box.right, right),
    bottom: Math.min(box.bottom, bottom),
  });
  const overlap = (a, b) => {
    const { left, top, right, bottom } = cut(a, b);
    return right - left > 0.5 && bottom - top > 0.5;
  };
  const isCovered = (node) => {
    const place = stop.getBoundingClientRect();
    let box = node.getBoundingClientRect();
    // Most are somewhere else; of the others, what their ancestors cut off is not seen.
    for (let at = node.parentElement; overlap(box, place) && at !== root; at = at.parentElement) {
      if (getComputedStyle(at).overflowX !== "visible") box = cut(box, at.getBoundingClientRect());
    }
    return overlap(box, place);
  };
  const isInSight = (node) => {
    const { left, top, right, bottom } = node.getBoundingClientRect();
    return left > -0.5 && top > -0.5 && right < innerWidth + 0.5 && bottom < innerHeight + 0.5;
  };
  for (const node of new Set([root, document.body, scroller])) {
    if (node.scrollWidth > node.clientWidth) problems.push(`${node.localName} scrolls sideways`);
  }
  const nodes = [...(dialog ?? document.body).querySelectorAll("*")].filter(
    (node) =>
      !stop.contains(node) &&
      !node.closest("option, svg, .hidden, #message") &&
      (node.matches("a, button, input, select, textarea, summary") ||
        [...node.childNodes].some((child) => child.nodeType === Node.TEXT_NODE && child.data.trim())) &&
      node.checkVisibility(),
  );
  for (const end of [0, scroller.scrollHeight]) {
    scroller.scrollTop = end;
    const { left, top, width, height } = stop.getBoundingClientRect();
    if (!isInSight(stop) || Math.min(width, height) < 40) problems.push("STOP is not whole");
    for (const [x, y] of [[0.5, 0.5], [0.1, 0.2], [0.9, 0.8]]) {
      const hit = document.elementFromPoint(left + x * width, top + y * height);
      if (!stop.contains(hit)) problems.push(`STOP is below ${hit && nameOf(hit)}`);
    }
    for (const node of nodes) {
      if (!isCovered(node)) continue;
      if (!node.closest(".bar, .dialog-head")) node.scrollIntoView({ block: "nearest" });
      if (isCovered(node)) problems.push(`STOP covers ${nameOf(node)}`);
      scroller.scrollTop = end;
    }
    if (dialog) continue;
    for (const id of ["alarm", "message"]) {
      const line = document.getElementById(id);
      const before = [line.hidden, line.textContent];
      line.hidden = false;
      if (id === "message") line.textContent = "the device is not connected: check the cable, then try again";
      if (!isInSight(line)) problems.push(`${id} is out of sight`);
      if (isCovered(line)) problems.push(`STOP covers ${id}`);
      line.hidden = before[0];
      if (id === "message") line.textContent = before[1];
    }
  }
  scroller.scrollTop = 0;
  return problems;
}

/** Looks at every size of window and each of the languages. */
async function lookAround(page, state, languages = ["en", "de"]) {
  const problems = [];
  const size = page.viewportSize();
  for (const language of languages) {
    if (languages.length > 1) await page.evaluate(choose, language);
    await until(page, language, (name) => document.documentElement.lang === name, language);
    for (const width of WIDTHS) {
      for (const height of HEIGHTS) {
        await page.setViewportSize({ width, height });
        for (const problem of await page.evaluate(look)) problems.push(`${width} x ${height} ${language}: ${problem}`);
      }
    }
  }
  await page.setViewportSize(size);
  assert.deepEqual(problems, [], state);
}

// Behind a dialog nothing can be clicked.
const choose = (language) => {
  const select = document.getElementById("language");
  select.value = language;
  select.dispatchEvent(new Event("change"));
};

test("STOP is in sight and covers nothing, from 320 x 360 on", async () => {
  const panel = await startPanel(["--device", "sim", "--sessions", folder()]);
  const page = await openControlling(panel.teacher);
  const viewer = await openLive(panel.viewer);
  const tab = (name) => page.locator(`#tab-${name}`).click();

  await page.locator("#record button").click();
  await page.waitForTimeout(500);
  await page.locator("#record button").click();
  await tab("recordings");
  await until(page, "the recording", () => document.querySelector(".recordings-list button"));
  await page.locator(".recordings-list button").first().click();
  await until(page, "its curves", () => document.querySelector(".player canvas"));
  await lookAround(page, "a recording");

  await tab("knee");
  await page.locator("#drawer > summary").click();
  await page.locator("#drawer .drawer summary").first().click();
  await page.locator("#drawer .drawer input[type=number]").first().fill("1");
  await page.locator(".pending-bar").waitFor();
  await lookAround(page, "parameters");
  await page.locator("#save-preset").click();
  await lookAround(page, "a dialog", ["de"]);
  await page.keyboard.press("Escape");

  await arm(page);
  await lookAround(viewer, "a viewer");
  await tab("lesson");
  await page.locator("#lesson input[value=blind-six]").check({ force: true });
  await page.locator("#students").fill("A\nB");
  await page.locator("#lesson-begin").click();
  await page.locator("#lesson-start").click();
  await page.locator("#torque", { hasText: "verborgen" }).waitFor();
  await lookAround(page, "a blind lesson");

  await end(panel.child, "SIGKILL");
  await untilState(page, "connection-lost");
  await lookAround(page, "no connection", ["de"]);
});
