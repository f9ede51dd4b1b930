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
  await examination.getByText("✓ Spasticity: the movement that shows it was made").waitFor({ timeout: 20000 });
  await until(page, "its angle", () =>
    [...document.querySelectorAll("#examination dt")].some((name) =>
      name.textContent === "Catch angle (R1)" && /^\d+°$/.test(name.nextSibling.textContent)), null, 20000);
  await examination.getByRole("button", { name: "Begin again" }).click();
  assert.deepEqual(page.problems, []);
});

test("after an answer a lesson says what was missed, also by the simulated examiner", async () => {
  const panel = await startPanel();
  const page = await openControlling(panel.teacher);
  await page.getByRole("tab", { name: "Lesson" }).click();
  await page.getByRole("radio", { name: /Six knees/ }).check({ force: true });
  await page.getByRole("button", { name: "Begin the lesson" }).click();
  await page.getByRole("button", { name: "Start this knee" }).click();
  await page.locator("#answer-form").getByRole("button", { name: "Save the answer" }).waitFor();
  await until(page, "the trial", async () => (await import("/connection.js")).latest.lesson?.began);
  // What the server tells once this knee is known.
  const said = (of_answer) =>
    page.evaluate(async (kept) => {
      const { latest } = await import("/connection.js");
      const { updateMissed } = await import("/lesson-run.js");
      const { lesson, examination } = latest;
      latest.lesson = { ...lesson, knee: { preset: "mas-1-catch", disorder: "spasticity", level: "mild" } };
      latest.examination = { ...examination, findings: [], of_answer: kept };
      updateMissed();
      const shown = [...document.querySelectorAll("#lesson .card > .lines li")].map((line) => line.textContent);
      Object.assign(latest, { lesson, examination });
      return shown;
    }, of_answer);
  const finding = (outcome, reached, needed) => ({ effect: "spasticity", step: "fast", outcome, reached, needed });
  const slow = [finding("too-slow", 45, 90)];
  const shown = [finding("shown", null, null)];
  const missed = ["○ Spasticity: the leg never exceeded 45 °/s; it appears from 90 °/s"];
  for (const by_person of [true, false]) {
    assert.deepEqual(await said({ trial: 1, by_person, findings: slow }), missed);
    // Of a healthy knee, and of another trial, there is nothing to say.
    assert.deepEqual(await said({ trial: 1, by_person, findings: [] }), []);
    assert.deepEqual(await said({ trial: 2, by_person, findings: slow }), []);
    const [line] = await said({ trial: 1, by_person, findings: shown });
    assert.match(line, by_person ? /^✓ Nothing was missed/ : /^A simulated examiner moved the leg, and missed nothing/);
  }
  assert.deepEqual(await said(null), []);
  assert.deepEqual(page.problems, []);
});

test("a sentence says what to do next, from the first look to the examination", async () => {
  const panel = await startPanel();
  const viewer = await openLive(panel.viewer);
  await viewer.locator("#next", { hasText: "Watch. “STOP” and Esc" }).waitFor();
  const page = await openLive(panel.teacher);
  const next = (words) => page.locator("#next", { hasText: words }).waitFor();
  await next("Press “Take control”");
  await page.getByRole("button", { name: "Take control" }).click();
  await next("“Coarse crepitus” is on the device. Press “Motor on”");
  await arm(page);
  await next("Feel for: coarse grating");
  await page.locator('[data-disorder="healthy"]').getByRole("button", { name: "Apply" }).click();
  await next("the knee is healthy: choose another one in “Knee”");
  await page.keyboard.press("Escape");
  await next("Choose a knee in “Knee”, press “Apply”, then “Motor on”");
  await page.locator("#language").selectOption("de");
  await next("Wählen Sie in „Knie“ ein Knie");
  assert.deepEqual([...page.problems, ...viewer.problems], []);
});

test("the knee on the device is named, and its card alone says so", async () => {
  const panel = await startPanel();
  const page = await openControlling(panel.teacher);
  const current = () =>
    page.evaluate(() => [...document.querySelectorAll(".card.current")].map((card) => card.dataset.disorder));
  await page.locator("#knee-now", { hasText: "Coarse crepitus" }).waitFor();
  assert.equal(await page.locator(".cards > .card").first().getAttribute("data-disorder"), "crepitus");
  const spasticity = page.locator('[data-disorder="spasticity"]');
  await spasticity.getByRole("radio", { name: /MAS 3.*reflex/ }).check({ force: true });
  assert.deepEqual(await current(), ["crepitus"]);
  await spasticity.getByRole("button", { name: "Apply" }).click();
  await spasticity.getByText("on the device").waitFor();
  assert.deepEqual(await current(), ["spasticity"]);
  // One number of one's own.
  await page.getByText("All parameters").click();
  await page.getByLabel("Search parameters").fill("spasticity.threshold_deg");
  const threshold = page.locator('[data-parameter="spasticity.threshold_deg"] input');
  const before = await threshold.inputValue();
  for (const [value, name] of [["61", "your own values"], [before, "MAS 3"]]) {
    await threshold.fill(value);
    await page.getByRole("button", { name: "Apply changes (1)" }).click();
    await page.locator("#knee-now", { hasText: name }).waitFor();
  }
});

test("a number that is typed while others are applied stays an edit", async () => {
  const panel = await startPanel();
  const page = await openControlling(panel.teacher);
  await page.getByText("All parameters").click();
  await page.getByLabel("Search parameters").fill("spasticity.threshold_deg");
  const threshold = page.locator('[data-parameter="spasticity.threshold_deg"] input');
  await threshold.fill("61");
  const apply = page.locator("#apply-edits");
  // No reply comes in between.
  await threshold.evaluate((input) => {
    document.querySelector("#apply-edits").click();
    input.value = "62";
    input.dispatchEvent(new Event("input"));
  });
  await page.locator('[data-parameter="spasticity.threshold_deg"]', { hasText: "not applied yet, now 61" }).waitFor();
  await page.waitForTimeout(300);
  await apply.click();
  await apply.waitFor({ state: "hidden" });
  assert.equal(await threshold.inputValue(), "62");
});

test("a knee is saved with a name alone, and a blind lesson takes it", async () => {
  const panel = await startPanel();
  const page = await openControlling(panel.teacher);
  const save = async (file, replaces) => {
    await page.locator("#save-preset").click();
    const dialog = page.getByRole("dialog");
    assert.equal(await dialog.getByLabel("Disorder").inputValue(), "crepitus");
    await dialog.getByLabel("Name of the knee").fill("Raues Knie für Übung 2");
    const replace = dialog.getByLabel("replace the saved knee");
    assert.equal(await replace.isVisible(), replaces !== null);
    if (replaces) await replace.check();
    await dialog.getByRole("button", { name: "Save" }).click();
    await page.locator("#message", { hasText: `in the file ${file}.toml` }).waitFor();
  };
  await save("raues-knie-fuer-uebung-2", null);
  await save("raues-knie-fuer-uebung-2-2", false);
  await save("raues-knie-fuer-uebung-2", true);
  await page.getByRole("tab", { name: "Lesson" }).click();
  await page.getByRole("radio", { name: "A lesson of your own" }).check({ force: true });
  await page.getByLabel("Knee 1", { exact: true }).selectOption("raues-knie-fuer-uebung-2");
  await page.getByRole("button", { name: "Begin the lesson" }).click();
  await page.getByRole("button", { name: "Start this knee" }).waitFor();
  assert.deepEqual(page.problems, []);
});

test("axes widen in steps while the leg moves, and never narrow; torque that nobody feels is dashed", async () => {
  const panel = await startPanel();
  const page = await openControlling(panel.teacher);
  await page.evaluate(() => {
    const { prototype } = CanvasRenderingContext2D;
    const { setLineDash } = prototype;
    window.dashes = 0;
    prototype.setLineDash = function (dash) {
      if (dash.length) window.dashes++;
      setLineDash.call(this, dash);
    };
  });
  const dashes = async () => {
    await page.evaluate(() => (window.dashes = 0));
    await page.waitForTimeout(500);
    return page.evaluate(() => window.dashes);
  };
  await page.getByRole("radio", { name: "5 s", exact: true }).check({ force: true });
  assert.ok((await dashes()) > 0);
  await arm(page);
  const seen = [];
  for (let nth = 0; nth < 70; nth++) {
    const ranges = await page.evaluate(() => window.crepitusStats.ranges);
    if (JSON.stringify(ranges) !== JSON.stringify(seen.at(-1))) seen.push(ranges);
    await page.waitForTimeout(100);
  }
  assert.equal(seen[0].length, 3);
  seen.slice(1).forEach((ranges, nth) => {
    const isWithin = ([least, most], pane) => ranges[pane][0] <= least && most <= ranges[pane][1];
    assert.ok(seen[nth].every(isWithin), JSON.stringify(seen));
  });
  // An axis that followed its curve would have taken dozens.
  assert.ok(seen.length <= 5, JSON.stringify(seen));
  assert.equal(await dashes(), 0);
});

test("an empty end-feel says that it hurts, in words on every page and aloud on the one that controls", async () => {
  const panel = await startPanel();
  const page = await openControlling(panel.teacher);
  const viewer = await openLive(panel.viewer);
  for (const one of [page, viewer]) {
    await one.evaluate(() => {
      window.said = [];
      speechSynthesis.speak = ({ text }) => window.said.push(text);
    });
  }
  const endFeel = page.locator('[data-disorder="end-feel"]');
  await endFeel.getByRole("radio", { name: "Empty end-feel" }).check({ force: true });
  await endFeel.getByRole("button", { name: "Apply" }).click();
  await page.getByText("All parameters").click();
  await page.getByLabel("Search parameters").fill("flexion_limit");
  await page.locator('[data-parameter="range-limit.flexion_limit_deg"] input').fill("60");
  await page.getByRole("button", { name: "Apply changes (1)" }).click();
  await page.locator("#knee-now", { hasText: "your own values" }).waitFor();
  assert.ok(!(await page.locator("#pain").isVisible()), "the motor is off");
  await arm(page);
  await Promise.all([page, viewer].map((one) => one.locator("#pain", { hasText: "That hurts" }).waitFor()));
  assert.deepEqual(await viewer.evaluate(() => window.said), []);
  assert.match(String(await page.evaluate(() => window.said)), /^Ouch! That hurts/);
  // It is heard once while the leg stays there, and the words go.
  await page.keyboard.press("Escape");
  await until(page, "quiet", () => document.getElementById("pain").hidden);
  assert.deepEqual([...page.problems, ...viewer.problems], []);
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
  assert.ok(!/\b(control|knee|lesson|next|target|chart|state)\.[a-z-]+/.test(text), text);
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
  await until(page, "a phase that is lit", () =>
    [...document.querySelectorAll("#inside-flow .phase")].some(
      (phase) => Number.parseInt(phase.style.getPropertyValue("--share"), 10) > 50,
    ));
  const arrow = await page.locator("#inside-leg .resistance").getAttribute("d");
  await until(page, "another resistance", (before) =>
    document.querySelector("#inside-leg .resistance").getAttribute("d") !== before, arrow);
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
