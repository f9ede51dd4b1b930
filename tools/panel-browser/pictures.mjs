// Pictures of the panel: for the book, and to be looked at.
//
//   node pictures.mjs FOLDER           every part at three widths, light and dark
//   node pictures.mjs --book           those of the book, into docs/images

import { execFileSync } from "node:child_process";
import { mkdirSync } from "node:fs";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { arm, CREPITUS, endAll, folder, openControlling, openPage, startPanel, until } from "./harness.mjs";
import { at, sweep, takeLeg } from "./pointer.mjs";

const isBook = process.argv[2] === "--book";
const out = isBook ? join(import.meta.dirname, "../../docs/images") : resolve(process.argv[2] ?? "out/panel");
mkdirSync(out, { recursive: true });

// The page shows where it stores.
process.chdir(folder());
const panel = await startPanel(["--device", "sim", "--sessions", "my-lessons"]);

async function shown(width, colorScheme, show, options = {}) {
  const height = width > 2000 ? 2160 : width > 1000 ? 900 : 844;
  const page = await openControlling(panel.teacher, { viewport: { width, height }, colorScheme, ...options });
  await arm(page);
  await show(page);
  await page.context().close();
}

/** A picture of the page from the top of one part to the bottom of another. */
async function pictured(page, name, first, last = first) {
  const [top, bottom] = [await page.locator(first).boundingBox(), await page.locator(last).boundingBox()];
  const clip = { x: top.x, y: top.y, width: top.width, height: bottom.y + bottom.height - top.y };
  await page.screenshot({ path: join(out, name), clip });
}

const tab = async (page, name) => {
  const button = page.getByRole("tab", { name });
  if (await button.isVisible()) await button.click();
};

async function apply(page, preset) {
  await tab(page, "Knee");
  const input = `input[value=${preset}]`;
  const card = page.locator("#knee .card", { has: page.locator(input) });
  await card.locator(input).check({ force: true });
  await card.getByRole("button", { name: "Apply" }).click();
  await tab(page, "Live");
}

/** A hand that straightens a severe contracture: the leg stays behind its outline. */
async function hand(page) {
  await apply(page, "contracture-severe");
  const move = await takeLeg(page);
  await move(60, 45);
  await move(14, 45);
  await page.waitForTimeout(500);
  await pictured(page, "panel-hand.png", "#live .now", "#hand");
}

/** Inside a knee with coarse crepitus while it is bent. */
async function inside(page) {
  await apply(page, "coarse");
  await page.locator("#inside > summary").click();
  const move = await takeLeg(page);
  for (const deg of [90, 20]) await move(deg, 45);
  const bent = move(90, 30);
  await page.waitForTimeout(1200);
  await pictured(page, "panel-inside.png", "#inside");
  await bent;
}

/** The page of one file. */
async function kneePage() {
  const file = join(folder(), "knee.html");
  execFileSync(CREPITUS, ["knee", "--out", file]);
  const page = await openPage(pathToFileURL(file).href, { locale: "en-GB" });
  await until(page, "the knee", () => window.crepitusKnee?.stats.samples > 0);
  await page.mouse.move(...(await at(page, 0)));
  await page.mouse.down();
  await sweep(page, 0, 70, 45);
  await sweep(page, 70, 40, 45);
  await page.screenshot({ path: join(out, "knee-page.png") });
  await page.context().close();
}

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
  await shown(640, "light", hand, { viewport: { width: 640, height: 1400 }, deviceScaleFactor: 2 });
  await shown(1280, "light", inside, { viewport: { width: 1280, height: 1800 } });
  await kneePage();
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
    await page.getByRole("button", { name: "Close the lesson" }).click();
    await page.getByRole("button", { name: "Let students join" }).click();
    const phone = await openPage(panel.student, { viewport: { width: 390, height: 844 }, hasTouch: true });
    await phone.getByLabel("Your pseudonym").fill("Quokka");
    await phone.getByRole("button", { name: "Join" }).click();
    await phone.getByText("Welcome, Quokka").waitFor();
    await lesson(page);
    await page.getByRole("button", { name: "Begin the lesson" }).click();
    await page.getByRole("button", { name: "Start this knee" }).click();
    await phone.getByLabel("Disorder").selectOption("spasticity");
    await phone.screenshot({ path: join(out, "panel-phone.png") });
    await phone.context().close();
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
