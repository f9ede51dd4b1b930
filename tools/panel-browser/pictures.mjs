// Pictures of the panel: for the book, and to be looked at.
//
//   node pictures.mjs FOLDER           every part at three widths, light and dark
//   node pictures.mjs --book           those of the book, into docs/images

import { mkdirSync } from "node:fs";
import { join, resolve } from "node:path";
import { arm, endAll, folder, openControlling, startPanel } from "./harness.mjs";

const isBook = process.argv[2] === "--book";
const out = isBook ? join(import.meta.dirname, "../../docs/images") : resolve(process.argv[2] ?? "out/panel");
mkdirSync(out, { recursive: true });

// The page shows where it stores.
process.chdir(folder());
const panel = await startPanel(["--device", "sim", "--sessions", "my-lessons"]);

async function shown(width, colorScheme, show) {
  const height = width > 2000 ? 2160 : width > 1000 ? 900 : 844;
  const page = await openControlling(panel.teacher, { viewport: { width, height }, colorScheme });
  await arm(page);
  await show(page);
  await page.context().close();
}

const tab = async (page, name) => {
  const button = page.getByRole("tab", { name });
  if (await button.isVisible()) await button.click();
};

async function lesson(page) {
  await tab(page, "Lesson");
  await page.getByRole("radio", { name: /Six knees/ }).check({ force: true });
  await page.getByLabel("Pseudonyms").fill("A\nB");
  await page.getByLabel("Number of the order").fill("7");
}

if (isBook) {
  await shown(1280, "light", async (page) => {
    await page.locator("#target select").first().selectOption("medium");
    await page.waitForTimeout(8000);
    await page.screenshot({ path: join(out, "panel-live.png") });
  });
  await shown(1280, "light", async (page) => {
    await lesson(page);
    await page.screenshot({ path: join(out, "panel-lesson.png") });
    await page.getByRole("button", { name: "Begin the lesson" }).click();
    await page.getByRole("button", { name: "Start this knee" }).click();
    await page.waitForTimeout(4000);
    await page.screenshot({ path: join(out, "panel-blind.png") });
    const answer = page.locator("#answer-form");
    for (let trial = 1; trial <= 6; trial++) {
      if (trial > 1) await page.getByRole("button", { name: "Start this knee" }).click();
      for (const student of ["A", "B"]) {
        await answer.getByLabel("Student").selectOption(student);
        const named = student === "A" || trial % 2 ? "spasticity" : "crepitus";
        await answer.getByLabel("Disorder").selectOption(named);
        await answer.getByRole("radio", { name: "3" }).dispatchEvent("click");
        await answer.getByRole("button", { name: "Save the answer" }).click();
        await page.waitForTimeout(150);
      }
      await page.getByRole("button", { name: trial < 6 ? "Next knee" : "End the lesson" }).click();
    }
    await page.getByText(/of 12 answers are right/).waitFor();
    await page.screenshot({ path: join(out, "panel-results.png") });
  });
} else {
  for (const width of [390, 1280, 3840]) {
    for (const colorScheme of ["light", "dark"]) {
      await shown(width, colorScheme, async (page) => {
        await page.waitForTimeout(3000);
        for (const name of ["Live", "Knee", "Lesson", "Recordings"]) {
          await tab(page, name);
          await page.waitForTimeout(300);
          await page.screenshot({ path: join(out, `${name.toLowerCase()}-${width}-${colorScheme}.png`) });
        }
      });
    }
  }
}
await endAll();
