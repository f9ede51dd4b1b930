// Sessions of experiments: a threshold and a realism session, each with a reload in the middle, and what is seen of them.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, afterEach, test } from "node:test";
import {
  arm, CREPITUS, end, endAll, endTest, folder, openControlling, openLive, openPage, problemsOf, startPanel,
} from "./harness.mjs";

afterEach(endTest);
after(endAll);

const TORQUE = `title = "Difference of torque"
question = "In which of the two was the resistance higher?"
[threshold]
quantity = "torque"
reference = 1.0
[threshold.constant]
differences = [0.31]
repeats = 4
`;
const REAL = `title = "How real?"
question = "Examine the knee as you would a patient's."
consent = "consent.txt"
[realism]
presets = ["coarse"]
repeats = 1
healthy = 1
features = ["grating"]
`;

/** A folder with these protocols. */
function protocols() {
  const made = folder();
  const files = { "torque.toml": TORQUE, "real.toml": REAL, "consent.txt": "You may stop at any time.\n" };
  for (const [name, text] of Object.entries(files)) writeFileSync(join(made, name), text);
  return made;
}

/** Lines of the one session of a participant. */
function tableOf(made, participant) {
  const own = join(made, "study", participant);
  return readFileSync(join(own, readdirSync(own)[0], "trials.csv"), "utf8").trim().split("\n");
}

/** Notes what the server tells this page of the knee. */
function listen(page) {
  const told = [];
  page.on("websocket", (socket) =>
    socket.on("framereceived", ({ payload }) => typeof payload === "string" && told.push(payload)),
  );
  return told;
}

const isArmed = (page) => page.evaluate(() => document.getElementById("state").dataset.state === "armed");

/** Feels every interval of the trial; where a busy computer ends torque meanwhile, again. */
async function feel(page) {
  // The next one stands out.
  const next = page.locator(".feel-interval.primary");
  for (let attempt = 1; !(await page.getByText("Answer now.").isVisible()); attempt++) {
    if (!(await isArmed(page))) await arm(page);
    await next.first().click({ timeout: 3000 }).catch((error) => assert.ok(attempt < 10, error));
    await page.waitForTimeout(200);
  }
}

async function begin(page, title, participant) {
  await page.getByRole("tab", { name: "Experiment" }).click();
  await page.getByRole("radio", { name: title }).check({ force: true });
  await page.locator("#experiment").getByLabel("Pseudonym").fill(participant);
}

/** Loads the page again, and takes control. */
async function reload(page) {
  await page.reload();
  await page.getByRole("button", { name: "Take control" }).click();
  await page.locator("#holder", { hasText: "you" }).waitFor();
}

/** Whether nothing that was told while a session was held has a level. */
function hidesLevels(told) {
  const from = told.findIndex((text) => text.startsWith('{"experiment":{'));
  assert.ok(from >= 0, "no session was told");
  const parts = told.slice(from).map((text) => JSON.parse(text));
  for (const part of parts.filter(({ parameters }) => parameters)) assert.deepEqual(part.parameters, { hidden: true });
  const sessions = parts.filter(({ experiment }) => experiment);
  assert.ok(sessions.length > 2);
  const keys = new Set(sessions.flatMap(({ experiment }) => [...Object.keys(experiment), ...Object.keys(experiment.trial ?? {})]));
  for (const key of keys) assert.doesNotMatch(key, /differ|comparison|right|level|stimul|preset|knee|interval/, key);
  assert.doesNotMatch(JSON.stringify(sessions), /0\.31|1\.31|coarse|lead-pipe|static/);
}

test("a threshold goes on after a reload and a killed program, by keys and buttons, and shows no level", async () => {
  const made = protocols();
  const args = ["--device", "sim", "--experiments", made];
  let panel = await startPanel(args);
  for (const link of [panel.viewer, panel.student]) {
    const other = await (link === panel.viewer ? openLive(link) : openPage(link));
    assert.equal(await other.getByRole("tab", { name: "Experiment" }).count(), 0);
  }
  let page = await openControlling(panel.teacher);
  await begin(page, "Difference of torque", "Anna");
  await page.getByRole("button", { name: "Begin the session" }).click();
  await page.getByText(/pseudonym with a digit/).waitFor();
  for (const width of [320, 1280]) {
    await page.setViewportSize({ width, height: 900 });
    if (width === 320) await page.getByRole("tab", { name: "Experiment" }).click();
    assert.deepEqual(await problemsOf(page), [], `setup, ${width} px`);
  }
  const told = listen(page);
  await page.reload();
  await page.getByRole("button", { name: "Take control" }).click();
  await begin(page, "Difference of torque", "P01");
  await page.getByRole("button", { name: "Begin the session" }).click();
  await page.getByText("Trial 1 of 4").waitFor();
  await page.locator("#knee-now", { hasText: "hidden" }).waitFor();
  // Nothing is answered before it was felt.
  await page.keyboard.press("1");
  assert.ok(await page.getByRole("button", { name: "Feel 2" }).isDisabled());
  assert.deepEqual(await problemsOf(page), [], "a trial");
  await feel(page);
  await page.keyboard.press("1");
  await page.getByText("Trial 2 of 4").waitFor();
  assert.equal(tableOf(made, "P01").length, 2);
  if (!(await isArmed(page))) await arm(page);
  await page.getByRole("button", { name: "Feel 1" }).click();
  hidesLevels(told);
  await reload(page);
  // The session is there by itself, and nothing of the trial counts as felt.
  await page.getByText("Trial 2 of 4").waitFor();
  assert.ok(await page.getByRole("button", { name: "Feel 2" }).isDisabled());
  await feel(page);
  await page.locator(".alternatives button", { hasText: "2" }).last().click();
  await page.getByText("Trial 3 of 4").waitFor();
  await end(panel.child, "SIGKILL");
  const problems = [...page.problems];
  await page.context().close();
  panel = await startPanel(args);
  page = await openControlling(panel.teacher);
  await page.getByRole("tab", { name: "Experiment" }).click();
  await page.getByRole("button", { name: /^Continue: Difference of torque · P01, 2/ }).click();
  for (const trial of [3, 4]) {
    await page.getByText(`Trial ${trial} of 4`).waitFor();
    await feel(page);
    await page.keyboard.press(String(trial - 2));
  }
  await page.getByText("The session is over: 4 trials").waitFor();
  const table = tableOf(made, "P01");
  assert.deepEqual(table.slice(1).map((line) => line.split(",")[4]), ["1", "2", "1", "2"]);
  assert.deepEqual(await problemsOf(page), [], "the end");
  const [report] = await Promise.all([
    page.context().waitForEvent("page"),
    page.getByRole("button", { name: "Open the results" }).click(),
  ]);
  await report.waitForLoadState();
  assert.match(await report.locator("body").innerText(), /Difference of torque/);
  await page.getByRole("button", { name: "Leave the session" }).click();
  await page.getByRole("button", { name: "Begin the session" }).waitFor();
  // The browser says that the connection was refused while there was no program.
  assert.deepEqual(problems.filter((problem) => !/WebSocket/.test(problem)), []);
  assert.deepEqual(page.problems, []);
});

test("a knee is described, then judged, after consent, in either language, and the judgement stands beside it", async () => {
  const made = protocols();
  const presets = folder();
  const panel = await startPanel(["--device", "sim", "--experiments", made], { CREPITUS_PRESETS: presets });
  const page = await openControlling(panel.teacher);
  await begin(page, "How real?", "K7");
  await page.getByText("You may stop at any time.").waitFor();
  await page.getByRole("button", { name: "Begin the session" }).click();
  await page.getByText(/tick the box/).waitFor();
  await page.getByLabel(/has read this text/).check({ force: true });
  await page.getByRole("button", { name: "Begin the session" }).click();
  await page.getByText("Trial 1 of 2").waitFor();
  await feel(page);
  await page.getByLabel("What do you feel?").fill("it grates\nlike sand");
  await page.getByRole("button", { name: "Save the description" }).click();
  await page.getByText("Described: it grates").waitFor();
  await reload(page);
  await page.getByText("Described: it grates").waitFor();
  for (const width of [390, 1280]) {
    await page.setViewportSize({ width, height: 900 });
    if (width === 390) await page.getByRole("tab", { name: "Experiment" }).click();
    assert.deepEqual(await problemsOf(page), [], `judgement, ${width} px`);
  }
  await feel(page);
  await page.getByRole("button", { name: "Save the judgement" }).click();
  await page.getByText(/fill in every field/).waitFor();
  const judge = async () => {
    for (const group of await page.locator("#experiment-form fieldset").all()) {
      await group.getByRole("radio").nth(3).check({ force: true });
    }
    await page.locator("[name=severity]").selectOption("mild");
    await page.locator("[name=finding]").selectOption("crepitus");
    await page.locator("#experiment-form button").click();
  };
  await judge();
  await page.getByText("Trial 2 of 2").waitFor();
  assert.match(tableOf(made, "K7")[1], /it grates like sand,mild,crepitus,[\d.]+,4,4$/);
  await page.locator("#language").selectOption("de");
  await page.getByText("Durchgang 2 von 2").waitFor();
  await page.locator("#language").selectOption("en");
  await feel(page);
  await page.getByLabel("What do you feel?").fill("nothing");
  await page.getByRole("button", { name: "Save the description" }).click();
  await page.getByText("Described: nothing").waitFor();
  await judge();
  await page.getByText("The session is over: 2 trials").waitFor();
  await page.getByRole("button", { name: "Leave the session" }).click();
  await page.getByRole("button", { name: "Begin the session" }).waitFor();
  assert.deepEqual(page.problems, []);
  const consents = readdirSync(join(made, "study", "consent"));
  assert.equal(consents.length, 1);
  assert.match(consents[0], /^[0-9a-f]{64}\.txt$/);
  const env = { ...process.env, CREPITUS_PRESETS: presets };
  execFileSync(CREPITUS, ["experiment", "evidence", join(made, "study")], { env });
  const again = await startPanel(["--device", "sim"], { CREPITUS_PRESETS: presets });
  const looking = await openLive(again.teacher);
  const card = looking.locator("#knee .card[data-disorder=crepitus]");
  await card.getByRole("radio", { name: "moderate" }).check({ force: true });
  await card.getByText(/Judged: realism .* 1 clinicians, 1 ratings, How real\?/).waitFor();
});
