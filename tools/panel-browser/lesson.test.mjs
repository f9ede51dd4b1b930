// A blind lesson of six knees, from its choice to its report.

import assert from "node:assert/strict";
import { readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";
import { after, afterEach, test } from "node:test";
import { arm, endAll, endTest, folder, openControlling, openLive, startPanel, until } from "./harness.mjs";

afterEach(endTest);
after(endAll);

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
    for (const student of ["A", "B"]) {
      const form = page.locator("#answer-form");
      await form.getByLabel("Student").selectOption(student);
      await form.getByLabel("Disorder").selectOption(trial % 2 ? "spasticity" : "healthy");
      await form.getByRole("radio", { name: "3" }).check({ force: true });
      await form.getByRole("button", { name: "Save the answer" }).click();
      await until(page, `the answer of ${student}`, (name) =>
        [...document.querySelectorAll(".answers li")].some((line) =>
          line.textContent.startsWith(`${name}:`) && !line.textContent.includes("no answer")), student);
      // Nobody sees what another one has answered.
      if (student === "A") assert.ok(!/spasticity|healthy/i.test(await page.locator(".answers").innerText()));
    }
    // All have answered: now it is told.
    await page.locator(".answers .tag").first().waitFor();
    await page.getByRole("button", { name: trial < 6 ? "Next knee" : "End the lesson" }).click();
  }
  await page.getByText(/of 12 answers are right/).waitFor();
  await page.getByRole("table", { name: /Confusion matrix/ }).first().waitFor();
  const [report] = await Promise.all([
    page.context().waitForEvent("page"),
    page.getByRole("button", { name: "Open the report to print" }).click(),
  ]);
  await report.waitForLoadState();
  assert.match(await report.locator("body").innerText(), /kappa/i);
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
