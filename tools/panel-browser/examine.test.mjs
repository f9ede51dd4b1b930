// A teacher opens the panel, chooses a knee, arms, looks, and stops.

import assert from "node:assert/strict";
import { join } from "node:path";
import { after, afterEach, test } from "node:test";
import {
  arm, endAll, endTest, openControlling, openLive, quickest, startPanel, until, untilState,
} from "./harness.mjs";

afterEach(endTest);
after(endAll);

/** Largest torque of the last second on the screen. */
const largestTorque = async (page, seconds = 3) => {
  let largest = 0;
  const last = Date.now() + seconds * 1000;
  while (Date.now() < last) {
    const shown = Number((await page.locator("#torque").textContent()).replace("−", "-"));
    largest = Math.max(largest, Math.abs(shown));
    await page.waitForTimeout(100);
  }
  return largest;
};

test("choose MAS 2, arm, see the torque follow, stop by key", async () => {
  const panel = await startPanel(["--device", "sim", "--scene", join(import.meta.dirname, "quick-hand.toml")]);
  const page = await openControlling(panel.teacher);
  const spasticity = page.locator("#knee .card", { hasText: "Spasticity (modified" });
  await spasticity.getByRole("radio", { name: /MAS 2.*catch/ }).check({ force: true });
  await spasticity.getByRole("button", { name: "Apply" }).click();
  await page.locator("#knee-now", { hasText: "MAS 2" }).waitFor();
  await arm(page);
  // The simulated examiner stretches it at up to 110 °/s.
  const spastic = await largestTorque(page, 5);
  assert.ok(spastic > 0.2, `${spastic} N·m`);
  // A field that has the focus does not keep the key.
  const took = await quickest(500, async () => {
    if ((await page.locator("#state").getAttribute("data-state")) !== "armed") await arm(page);
    await page.locator("#note").focus();
    const pressed = Date.now();
    await page.keyboard.press("Escape");
    await untilState(page, "disarmed");
    return Date.now() - pressed;
  });
  assert.ok(took < 500, `${took} ms`);
  // What is shown is the largest of the last tenth of a second, and the compensation acted until then.
  await page.waitForTimeout(300);
  assert.ok((await largestTorque(page, 1)) < 0.01);
  assert.deepEqual(page.problems, []);
});

test("parameters: changes are collected, sent as one, and marked", async () => {
  const panel = await startPanel();
  const page = await openControlling(panel.teacher);
  await page.getByText("All parameters").click();
  await page.getByLabel("Search parameters").fill("kinetic_torque");
  const field = page.locator('[data-parameter="crepitus.kinetic_torque_nm"] input');
  await field.fill("0.3");
  await page.getByRole("button", { name: "Apply changes (1)" }).click();
  await page.getByText("● differs from the default").first().waitFor();
  const viewer = await openLive(panel.viewer);
  await viewer.getByText("All parameters").click();
  await viewer.getByLabel("Search parameters").fill("kinetic_torque");
  await until(viewer, "the value", () =>
    [...document.querySelectorAll("input[type=number]")].some((input) => input.value === "0.3"),
  );
  assert.deepEqual([...page.problems, ...viewer.problems], []);
});

test("friction compensation that is off is said, with what it costs, to those who can switch it on", async () => {
  const panel = await startPanel();
  const page = await openControlling(panel.teacher);
  const viewer = await openLive(panel.viewer);
  await page.getByText("All parameters").click();
  await page.getByLabel("Search parameters").fill("friction-compensation.render");
  assert.equal(await page.locator("#friction").textContent(), "");
  await page.locator('[data-parameter="friction-compensation.render"] select').selectOption("off");
  await page.getByRole("button", { name: "Apply changes (1)" }).click();
  await page.locator("#friction", { hasText: "about 0.50 N·m, is felt besides the knee" }).waitFor();
  assert.equal(await viewer.locator("#friction").textContent(), "");
});

test("a target speed is shown, and a simulated examiner is not scored", async () => {
  const panel = await startPanel();
  const page = await openControlling(panel.teacher);
  await page.locator("#target select").first().selectOption("slow");
  await page.getByRole("button", { name: "Start scoring" }).click();
  await page.getByText("nothing is judged or scored").waitFor();
  await arm(page);
  await page.waitForTimeout(4500);
  await page.getByRole("button", { name: "Stop scoring" }).click();
  assert.doesNotMatch(await page.locator("#target").innerText(), /Score \d/);
  assert.deepEqual(page.problems, []);
});

test("a simulated examiner stretches MAS 1 fast, and the page measures the catch", async () => {
  const panel = await startPanel();
  const page = await openControlling(panel.teacher);
  const spasticity = page.locator("#knee .card", { hasText: "Spasticity (modified" });
  await spasticity.getByRole("radio", { name: /MAS 1 .*catch/ }).check({ force: true });
  await spasticity.getByRole("button", { name: "Apply" }).click();
  await page.locator("#knee-now", { hasText: "MAS 1" }).waitFor();
  const examination = page.locator("#examination");
  await examination.getByText("○ Spasticity: the leg was hardly moved").waitFor();
  await arm(page);
  await examination.getByText("✓ Spasticity: you made the movement that shows it").waitFor({ timeout: 20000 });
  await until(page, "its angle", () =>
    [...document.querySelectorAll("#examination dt")].some((name) =>
      name.textContent === "Catch angle (R1)" && /^\d+°$/.test(name.nextSibling.textContent)), null, 20000);
  await examination.getByRole("button", { name: "Begin again" }).click();
  assert.deepEqual(page.problems, []);
});

test("another language is one file away", async () => {
  const panel = await startPanel();
  const page = await openControlling(panel.teacher);
  await page.locator("#language").selectOption("de");
  await page.getByRole("tab", { name: "Aufzeichnungen" }).waitFor();
  assert.equal(await page.evaluate(() => document.documentElement.lang), "de");
  await page.reload();
  await page.getByRole("tab", { name: "Aufzeichnungen" }).waitFor();
  // Every text has a translation: no key is left on the page.
  const text = await page.evaluate(() => document.body.innerText);
  assert.ok(!/\b(control|knee|lesson|target|chart|state)\.[a-z-]+/.test(text), text);
});

test("the first curve comes within a second, and frames join", async () => {
  const panel = await startPanel();
  let page = null;
  const opened = await quickest(1000, async () => {
    await page?.close();
    page = await openLive(panel.teacher);
    await until(page, "a picture", () => window.crepitusStats.first !== null);
    return page.evaluate(() => window.crepitusStats.first);
  });
  assert.ok(opened < 1000, `${opened} ms`);
  await page.waitForTimeout(2000);
  const stats = await page.evaluate(() => window.crepitusStats);
  assert.equal(stats.missing, 0);
  assert.ok(stats.bins > 300, `${stats.bins} bins`);
});

test("inside the joint: object, loop and slow motion; its sound", async () => {
  const panel = await startPanel();
  const page = await openControlling(panel.teacher);
  await page.locator("#inside > summary").click();
  await arm(page);
  await page.getByRole("button", { name: "Sound" }).click();
  await until(page, "sound", () => window.crepitusSound.way === "worklet" && window.crepitusSound.samples > 20_000);
  await until(page, "the object", () => !document.querySelector("#inside-leg .inside").classList.contains("off"));
  await page.getByRole("button", { name: "The last second" }).click();
  const seek = page.getByRole("slider", { name: "Time in the last second" });
  const begun = await seek.inputValue();
  await page.waitForTimeout(500);
  assert.notEqual(await seek.inputValue(), begun);
  await page.getByRole("button", { name: "Back to now" }).click();
  await page.getByRole("button", { name: "Freeze" }).click();
  await page.locator("#inside-loop [role=slider]").focus();
  await page.keyboard.press("ArrowRight");
  await page.locator("#inside-loop .hint", { hasText: "bending" }).waitFor();
  assert.deepEqual(page.problems, []);
});
