// A blind lesson of six knees, examined by pointer, from its choice to its report.

import assert from "node:assert/strict";
import { readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";
import { after, afterEach, test } from "node:test";
import { arm, endAll, endTest, folder, openControlling, openLive, startPanel, until } from "./harness.mjs";
import { takeLeg } from "./pointer.mjs";

// Angles between which the leg is swept, °, and speeds, °/s. At 18° a hand that leans on a severe contracture is below
// what the gear bears for long; a device lets go at 328 °/s.
const ENDS = [18, 100];
const SLOW = 35;
const FAST = 200;

afterEach(endTest);
after(endAll);

/** The knee of a trial, as the lesson's folder has it. */
function truthOf(sessions, trial) {
  const [session] = readdirSync(sessions);
  const { order, knees } = JSON.parse(readFileSync(join(sessions, session, "session.json"), "utf8"));
  return knees[order[trial - 1]];
}

/**
 * Sweeps the leg by pointer, slowly and fast, with the motor on, until the page has ticked both. On a busy computer the
 * motor may go off, or a sweep come too unevenly: then again, as a student would.
 */
async function examine(page) {
  const [straight, bent] = ENDS;
  const isOn = () => page.evaluate(() => document.getElementById("state").dataset.state === "armed");
  const isTicked = async (step) => (await page.getByText(`✓ ${step}`).count()) > 0;
  for (let attempt = 1; attempt <= 4; attempt++) {
    if (!(await isOn())) {
      const clear = page.getByRole("button", { name: "Clear fault" });
      if (await clear.isVisible()) await clear.click();
      await arm(page).catch(async (error) => {
        if (!/outside the range of motion/.test(error.message)) throw error;
        // As the page says.
        const move = await takeLeg(page);
        await move((straight + bent) / 2, SLOW);
        await page.mouse.up();
        await arm(page);
      });
    }
    const move = await takeLeg(page);
    await move(straight, SLOW);
    for (const speed of [SLOW, FAST]) {
      await move(bent, speed);
      await move(straight, speed);
    }
    await page.mouse.up();
    // The page says so five times a second.
    await page.waitForTimeout(1000);
    if ((await isOn()) && (await isTicked("slowly to both ends")) && (await isTicked("fast, 90 °/s or more"))) return;
  }
  throw new Error(`not examined in four attempts: ${await page.locator("#torque-end-text").textContent()}`);
}

/** What the page says after the answers about the movements: nothing was missed, but the end of a bent contracture. */
function missed({ disorder }) {
  if (disorder === "healthy") return null;
  return disorder === "range-deficit" ? /came to (9|10)\d°; it is felt at 11\d°/ : /Nothing was missed/;
}

test("six knees blind, two students, to the printed report", async () => {
  const sessions = folder();
  const panel = await startPanel(["--device", "sim", "--sessions", sessions]);
  const page = await openControlling(panel.teacher);
  const viewer = await openLive(panel.viewer);
  await arm(page);
  await page.locator("#inside > summary").click();
  await page.getByRole("tab", { name: "Lesson" }).click();
  await page.getByRole("radio", { name: /Six knees/ }).check({ force: true });
  await page.getByLabel("Pseudonyms").fill("A\nB");
  await page.getByLabel("Number of the order").fill("7");
  await page.getByRole("button", { name: "Begin the lesson" }).click();
  for (let trial = 1; trial <= 6; trial++) {
    await page.getByText(`Knee ${trial} of 6`).waitFor();
    await page.getByRole("button", { name: "Start this knee" }).click();
    // Neither page shows which knee it is, nor its torque.
    for (const shown of [page, viewer]) {
      await shown.locator("#knee-now", { hasText: "hidden" }).waitFor();
      await shown.locator("#torque", { hasText: "hidden" }).waitFor();
    }
    await page.locator("#inside-loop .masked").waitFor();
    assert.ok(!(await page.locator("#inside-flow .flow").isVisible()));
    const text = await viewer.evaluate(() => document.querySelector("header").innerText);
    assert.ok(!/MAS|UPDRS|crepitus \(|clasp/i.test(text), text);
    await examine(page);
    const truth = truthOf(sessions, trial);
    // No knee of this lesson beats.
    assert.notEqual(truth.disorder, "clonus");
    for (const [student, disorder, level, sure] of [
      ["A", truth.disorder, truth.level, "5"],
      ["B", "clonus", "mild", "1"],
    ]) {
      const form = page.locator("#answer-form");
      await form.getByLabel("Student").selectOption(student);
      await form.getByLabel("Disorder").selectOption(disorder);
      if (level) await form.getByLabel("Severity").selectOption(level);
      await form.getByRole("radio", { name: sure }).check({ force: true });
      await form.getByRole("button", { name: "Save the answer" }).click();
      await until(page, `the answer of ${student}`, (name) =>
        [...document.querySelectorAll(".answers li")].some((line) =>
          line.textContent.startsWith(`${name}:`) && !line.textContent.includes("no answer")), student);
      // Nobody sees what another one has answered.
      if (student === "A") {
        assert.match(await page.locator(".answers").innerText(), /^A: answered\s+B: no answer yet$/);
      }
    }
    // All have answered: now it is told, and what the hand has missed.
    await page.locator(".answers li", { hasText: /^A: .*right$/ }).waitFor();
    await page.locator(".answers li", { hasText: /^B: Clonus.*wrong$/ }).waitFor();
    const about = missed(truth);
    if (about) await page.getByRole("list", { name: "What was missed" }).getByText(about).waitFor();
    await page.getByRole("button", { name: trial < 6 ? "Next knee" : "End the lesson" }).click();
  }
  await page.getByText("6 of 12 answers are right").waitFor();
  const rows = await page.getByRole("table", { name: "By student" }).getByRole("row").allInnerTexts();
  assert.deepEqual(
    rows.slice(1).map((row) => /^\S+\s+\d+ of \d+/.exec(row)?.[0].replace(/\s+/g, " ")),
    ["A 6 of 6", "B 0 of 6", "All 6 of 12"],
  );
  await page.getByRole("table", { name: /Confusion matrix/ }).first().waitFor();
  const counts = await page.evaluate(() =>
    ["diagonal", "mistake"].map((kind) =>
      [...document.querySelector(".confusion").querySelectorAll(`.${kind}`)].reduce(
        (sum, cell) => sum + Number(cell.textContent),
        0,
      ),
    ),
  );
  assert.deepEqual(counts, [6, 6]);
  const [report] = await Promise.all([
    page.context().waitForEvent("page"),
    page.getByRole("button", { name: "Open the report to print" }).click(),
  ]);
  await report.waitForLoadState();
  assert.match(await report.locator("body").innerText(), /kappa/i);
  for (const [student, right, verdict] of [["A", 6, "yes"], ["B", 0, "no"]]) {
    const part = report.locator("section.student", { hasText: `${student}: ${right} of 6` });
    const verdicts = await part.locator(".trials tbody td:last-child").allInnerTexts();
    assert.deepEqual(verdicts, Array(6).fill(verdict), student);
  }
  const pdf = await report.pdf({ format: "A4" });
  const pages = pdf.toString("latin1").match(/\/Type\s*\/Page[^s]/g).length;
  assert.equal(pages, 1, "it prints on one page");
  const [session] = readdirSync(sessions);
  const files = readdirSync(join(sessions, session));
  for (const name of ["session.json", "answers.csv", "report.html"]) assert.ok(files.includes(name), name);
  assert.equal(files.filter((name) => /^trial-0[1-6]\./.test(name)).length, 6);
  const answers = readFileSync(join(sessions, session, "answers.csv"), "utf8").trim().split("\n");
  assert.equal(answers.length, 13);
  assert.deepEqual([...page.problems, ...viewer.problems], []);
});

test("recordings: opened, zoomed to single samples, compared", async () => {
  const sessions = folder();
  const panel = await startPanel(["--device", "sim", "--sessions", sessions]);
  const page = await openControlling(panel.teacher);
  await arm(page);
  for (let nth = 0; nth < 2; nth++) {
    await page.getByRole("button", { name: "Record", exact: true }).click();
    await page.getByRole("button", { name: "Stop recording" }).waitFor();
    await page.waitForTimeout(1500);
    await page.getByRole("button", { name: "Stop recording" }).click();
    await page.getByRole("button", { name: "Record", exact: true }).waitFor();
  }
  await page.keyboard.press("Escape");
  await page.getByRole("tab", { name: "Recordings" }).click();
  await page.getByRole("button", { name: "Refresh" }).click();
  await page.getByRole("button", { name: /^Open / }).first().click();
  await page.getByText(/A point stands for/).waitFor();
  const detail = async () => Number((await page.getByText(/A point stands for/).textContent()).match(/for ([\d.]+) ms/)[1]);
  const coarse = await detail();
  for (let nth = 0; nth < 12; nth++) await page.getByRole("button", { name: "Zoom in" }).click();
  await until(page, "single samples", () => /for 0\.05 ms/.test(document.body.innerText));
  assert.ok((await detail()) < coarse);
  await page.getByRole("button", { name: /^Compare / }).last().click();
  await page.getByText(/dashed/).first().waitFor();
  assert.deepEqual(page.problems, []);
});
