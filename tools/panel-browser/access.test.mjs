// For everybody: axe-core, keyboard alone, sizes from a phone to 4K, light and dark.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { endAll, openControlling, openLive, problemsOf, startPanel, until, untilState } from "./harness.mjs";

// Widths in px, and how many times the size; 1280 px at 200 % are 640 px of twice the size.
const SIZES = [[320, 1], [390, 1], [1280, 1], [1920, 1], [3840, 1], [640, 2]];
let panel;

before(async () => {
  panel = await startPanel();
});
after(endAll);

for (const [width, scale] of SIZES) {
  test(`axe finds nothing: ${width} px, ${100 * scale} %, light and dark`, async () => {
    const viewport = { width, height: width > 2000 ? 2160 : 844 };
    const options = { viewport, deviceScaleFactor: scale, reducedMotion: "reduce" };
    const page = await openControlling(panel.teacher, options);
    await page.locator("#inside > summary").click();
    for (const tab of ["Live", "Knee", "Lesson", "Recordings"]) {
      const button = page.getByRole("tab", { name: tab });
      // Beside the other parts, live has no tab.
      if (await button.isVisible()) await button.click();
      if (tab === "Knee") await page.getByText("All parameters").click();
      for (const colorScheme of ["light", "dark"]) {
        await page.emulateMedia({ colorScheme });
        assert.deepEqual(await problemsOf(page), [], `${tab}, ${colorScheme}`);
      }
    }
    await page.context().close();
  });
}

test("everything can be done without a mouse", async () => {
  const page = await openLive(panel.teacher);
  const press = async (name) => {
    for (let nth = 0; nth < 60; nth++) {
      await page.keyboard.press("Tab");
      const focused = await page.evaluate(() => document.activeElement?.textContent.trim() ?? "");
      if (focused.startsWith(name)) {
        const outline = await page.evaluate(() => getComputedStyle(document.activeElement).outlineStyle);
        assert.notEqual(outline, "none", `the focus of ${name} is not visible`);
        await page.keyboard.press("Enter");
        return;
      }
    }
    assert.fail(`${name} is not reached with Tab`);
  };
  await press("Take control");
  await page.locator("#holder", { hasText: "you" }).waitFor();
  await page.evaluate(() => document.activeElement.blur());
  await press("Motor on");
  await untilState(page, "armed");
  await page.keyboard.press("n");
  await page.keyboard.type("caught at half");
  await page.keyboard.press("Enter");
  await page.locator("#note-list li", { hasText: "caught at half" }).waitFor();
  await page.keyboard.press("Escape");
  await untilState(page, "disarmed");
  await page.locator("#tab-knee").focus();
  await page.keyboard.press("ArrowRight");
  await until(page, "the next tab", () => document.activeElement.id === "tab-lesson");
  await page.context().close();
});

test("state and faults are announced", async () => {
  const page = await openLive(panel.viewer);
  assert.equal(await page.locator("#state").getAttribute("role"), "status");
  assert.equal(await page.locator("#faults").getAttribute("role"), "alert");
  await page.context().close();
});

test("with reduced motion nothing is animated", async () => {
  const page = await openLive(panel.viewer, { reducedMotion: "reduce" });
  const animated = await page.evaluate(() => document.getAnimations().length);
  assert.equal(animated, 0);
  await page.context().close();
});
