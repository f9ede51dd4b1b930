// The reports that the tool writes, on a desk and on a phone: the answer and a picture first, nothing cut.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { after, afterEach, before, test } from "node:test";
import { CREPITUS, endAll, endTest, folder, openPage } from "./harness.mjs";

afterEach(endTest);
after(endAll);

const REPORTS = {
  demo: ["demo"],
  run: ["run", "fig8", "--set", "duration_s=0.6"],
  effects: ["effects", "fig8", "--set", "duration_s=0.6"],
  stability: ["stability", "--case", "H01", "--case", "H05", "--pictures"],
  accuracy: ["accuracy", "--quick", "--scene", "fig6-ideal-cycle", "--steps", "1e-4,5e-5"],
  laws: ["laws", "--quick", "--law", "frozen", "--law", "karnopp", "--task", "grating", "--task", "creep"],
  vibration: ["vibration", "--speeds", "1"],
};
let home;

before(() => {
  home = folder();
  for (const [name, words] of Object.entries(REPORTS)) {
    execFileSync(CREPITUS, [...words, "--out", join(home, name)], { stdio: "pipe" });
  }
});

for (const name of Object.keys(REPORTS)) {
  for (const width of [1280, 390]) {
    test(`${name} at ${width} px`, async () => {
      const page = await openPage(pathToFileURL(join(home, name, "report.html")).href, {
        viewport: { width, height: 900 },
      });
      const found = await page.evaluate(() => {
        const boxes = [...document.querySelectorAll(".box")].filter((box) => box.checkVisibility());
        const cut = boxes.filter((box) => box.scrollWidth > box.clientWidth + 1);
        const said = (box) => box.nextElementSibling?.matches(".sideways") && box.nextElementSibling.checkVisibility();
        const seen = (query) => [...document.querySelectorAll(query)].find((part) => part.checkVisibility());
        const top = (query) => seen(query)?.getBoundingClientRect().top ?? Infinity;
        return {
          wide: document.documentElement.scrollWidth - innerWidth,
          cut: cut.map((box) => `${box.getAttribute("aria-label")}: ${box.scrollWidth} of ${box.clientWidth}`),
          silent: cut.filter((box) => !said(box)).length,
          answer: document.querySelector("header .description")?.textContent.trim() ?? "",
          pictureFirst: top(".figure svg") < top("main table"),
        };
      });
      assert.ok(found.wide <= 0, `the page is ${found.wide} px too wide`);
      if (width === 1280) assert.deepEqual(found.cut, [], "cut");
      else assert.equal(found.silent, 0, `cut, and nothing says so: ${found.cut}`);
      assert.ok(found.answer.length > 40 && found.answer.includes("."), found.answer);
      assert.ok(found.pictureFirst, "a table comes before the first picture");
    });
  }
}
