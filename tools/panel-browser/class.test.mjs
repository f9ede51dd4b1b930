// A class: students answer on their phones, the teacher steps with the own phone, a wall shows what all may see.

import assert from "node:assert/strict";
import { after, afterEach, test } from "node:test";
import {
  arm, end, endAll, endTest, folder, openControlling, openLive, openPage, problemsOf, startPanel, until, untilState,
} from "./harness.mjs";

afterEach(endTest);
after(endAll);

const PHONE = { viewport: { width: 390, height: 844 }, hasTouch: true };
const wallOf = (panel) => panel.viewer.replace("/#", "/?projector#");

/** Joins under this pseudonym. */
async function join(link, name, options = {}) {
  const phone = await openPage(link, { ...PHONE, ...options });
  await phone.getByLabel("Your pseudonym").fill(name);
  await phone.getByRole("button", { name: "Join" }).click();
  await phone.getByText(`Welcome, ${name}`).waitFor();
  return phone;
}

/** Answers on a phone. */
async function answer(phone, disorder) {
  await phone.getByLabel("Disorder").selectOption(disorder);
  await phone.getByRole("radio", { name: "3" }).check({ force: true });
  await phone.getByRole("button", { name: "Save the answer" }).click();
  await phone.getByText("Change your answer").or(phone.getByText("Answers to this knee are closed")).waitFor();
}

/** Begins the blind lesson, and its first knee. */
async function begin(page) {
  await page.getByRole("radio", { name: /Six knees/ }).check({ force: true });
  await page.getByLabel("Number of the order").fill("7");
  await page.getByRole("button", { name: "Begin the lesson" }).click();
  await page.getByRole("button", { name: "Start this knee" }).click();
}

async function openClass(panel) {
  const page = await openControlling(panel.teacher);
  await page.getByRole("tab", { name: "Lesson" }).click();
  await page.getByRole("button", { name: "Let students join" }).click();
  await page.getByRole("button", { name: "Let nobody else join" }).waitFor();
  return page;
}

test("two phones join, answer, reload and stop; each shows its own", async () => {
  const panel = await startPanel();
  const page = await openClass(panel);
  const wall = await openLive(wallOf(panel));
  await wall.getByText("Join with your phone").waitFor();
  const quokka = await join(panel.student, "Quokka");
  const wombat = await join(panel.student, "Wombat", { viewport: { width: 320, height: 640 }, colorScheme: "dark" });
  const early = await openPage(panel.student, PHONE);
  await early.getByLabel("Your pseudonym").fill("quokka");
  assert.deepEqual(await problemsOf(early), [], "joining");
  await early.getByRole("button", { name: "Join" }).click();
  await early.getByText(/is taken/).waitFor();
  await page.getByText("2 have joined").waitFor();
  await begin(page);
  await quokka.getByText("Knee 1 of 6").waitFor();
  await answer(quokka, "clonus");
  await wall.getByText("1 of 2 have answered").waitFor();
  for (const shown of [wombat, wall, page]) {
    const text = await shown.evaluate(() => document.body.innerText);
    assert.ok(!/Clonus \(SCATS\), confidence/.test(text), text);
  }
  assert.ok(!(await wombat.evaluate(() => document.body.innerText)).includes("Quokka"));
  // The phone keeps its seat, and the answer is there.
  await quokka.reload();
  await quokka.getByText(/Knee 1: Clonus \(SCATS\), confidence 3/).waitFor();
  assert.ok(!quokka.url().includes("#"), quokka.url());
  for (const [name, shown] of [["answering", wombat], ["answered", quokka], ["the wall", wall]]) {
    assert.deepEqual(await problemsOf(shown), [], name);
  }
  await arm(page);
  await untilState(wombat, "armed");
  await wombat.getByRole("button", { name: "STOP" }).click();
  await untilState(page, "disarmed");
  await page.getByText(/pressed on a student.s phone/).waitFor();
  await answer(wombat, "healthy");
  for (const phone of [quokka, wombat]) {
    await phone.locator(".answers .tag", { hasText: /right|wrong/ }).waitFor();
    await phone.locator(".answers .tag", { hasText: /does not count/ }).waitFor();
    assert.deepEqual(await problemsOf(phone), [], "judged");
  }
  await wall.locator("#wall").getByText(/This knee:/).waitFor();
  const all = [page, wall, quokka, wombat, early].flatMap((shown) => shown.problems);
  assert.deepEqual(all, []);
});

test("a phone whose seat is gone gets the form, and nothing to explain", async () => {
  const panel = await startPanel();
  const phone = await openPage(panel.student, PHONE);
  const name = phone.getByLabel("Your pseudonym");
  await name.waitFor();
  const seat = { name: "Quokka", key: "0123456789abcdef0123456789abcdef" };
  await phone.evaluate((kept) => localStorage.setItem("seat", JSON.stringify(kept)), seat);
  await phone.reload();
  await name.waitFor();
  assert.equal(await name.inputValue(), "Quokka");
  assert.ok(!(await phone.locator("#message").isVisible()));
  // Somebody who asks gets the reason.
  await phone.getByRole("button", { name: "Join" }).click();
  await phone.getByText("the class is closed").waitFor();
  assert.deepEqual(phone.problems, []);
});

test("the remote steps through the lesson and shows the knee to nobody else", async () => {
  const panel = await startPanel();
  const remote = await openPage(panel.remote, PHONE);
  await remote.getByText("No page has control").waitFor();
  assert.ok(await remote.getByRole("button", { name: "Milder" }).isDisabled());
  const page = await openClass(panel);
  const wall = await openLive(wallOf(panel));
  await page.getByRole("tab", { name: "Knee" }).click();
  const spasticity = page.locator("#knee .card", { hasText: "Spasticity (modified" });
  await spasticity.getByRole("radio", { name: /MAS 2.*catch/ }).check({ force: true });
  await spasticity.getByRole("button", { name: "Apply" }).click();
  await remote.getByRole("button", { name: "Worse" }).click();
  await page.locator("#knee-now", { hasText: "MAS 3" }).waitFor();
  await remote.getByLabel("Note at this moment").fill("from afar");
  await remote.getByRole("button", { name: "Add" }).click();
  await page.locator("#note-list li", { hasText: "from afar" }).waitFor();
  await page.getByRole("tab", { name: "Lesson" }).click();
  await page.getByRole("radio", { name: /Six knees/ }).check({ force: true });
  await page.getByLabel("Number of the order").fill("7");
  await page.getByRole("button", { name: "Begin the lesson" }).click();
  await remote.getByRole("button", { name: "Start this knee" }).click();
  await page.locator("#knee-now", { hasText: "hidden" }).waitFor();
  await remote.getByText("Show the knee").click();
  await until(remote, "the knee", () => /^Now: (?!your own values)./m.test(document.body.innerText));
  assert.deepEqual(await problemsOf(remote), [], "the remote");
  const [, knee] = (await remote.evaluate(() => document.body.innerText)).match(/^Now: ([^(]+)/m);
  for (const shown of [wall, page]) {
    const header = await shown.evaluate(() => document.querySelector("header").innerText);
    assert.ok(!header.includes(knee.trim()), header);
  }
  await remote.getByRole("button", { name: "Next knee" }).click();
  await remote.getByText("Knee 2 of 6").waitFor();
  await arm(page);
  await remote.getByRole("button", { name: "STOP" }).click();
  await untilState(page, "disarmed");
  assert.deepEqual([...page.problems, ...wall.problems, ...remote.problems], []);
});

test("over a network the teacher's page and the wall have a code, and a phone that scans it joins", async () => {
  const panel = await startPanel(["--device", "sim", "--lan", "127.0.0.1"]);
  const insecure = { ignoreHTTPSErrors: true };
  const page = await openControlling(panel.teacher, insecure);
  await page.getByRole("tab", { name: "Lesson" }).click();
  assert.ok(!(await page.getByRole("img", { name: "QR code of the students" }).isVisible()));
  await page.getByRole("button", { name: "Let students join" }).click();
  await page.getByRole("img", { name: "QR code of the students" }).waitFor();
  const wall = await openLive(wallOf(panel), insecure);
  await wall.getByRole("img", { name: "QR code of the students" }).waitFor();
  // The code says what stands below it.
  assert.equal(await wall.locator("#wall .link").textContent(), panel.student);
  const phone = await join(panel.student, "Quokka", insecure);
  // The welcome may come before the reply with the key of the seat.
  await phone.waitForFunction(() => localStorage.getItem("seat"));
  // A page of another role is none for this link.
  await phone.goto(new URL("/", panel.student).href);
  // The page sends it on: what is looked for before that belongs to a document that goes.
  await phone.waitForURL("**/student.html");
  await phone.getByText("Welcome, Quokka").waitFor();
  assert.deepEqual([...page.problems, ...wall.problems], []);
});

test("a lesson goes on after its program was killed; its results are whole at 1280 px", async () => {
  const sessions = folder();
  let panel = await startPanel(["--device", "sim", "--sessions", sessions]);
  let page = await openControlling(panel.teacher);
  await page.getByRole("tab", { name: "Lesson" }).click();
  await page.getByLabel("Pseudonyms").fill("A\nB");
  await begin(page);
  const enter = async (student, disorder) => {
    const form = page.locator("#answer-form");
    await form.getByLabel("Student").selectOption(student);
    await form.getByLabel("Disorder").selectOption(disorder);
    await form.getByRole("radio", { name: "3" }).check({ force: true });
    await form.getByRole("button", { name: "Save the answer" }).click();
  };
  await enter("A", "clonus");
  await page.getByText("A: answered").waitFor();
  await end(panel.child, "SIGKILL");
  await page.context().close();
  panel = await startPanel(["--device", "sim", "--sessions", sessions]);
  page = await openControlling(panel.teacher);
  await page.getByRole("tab", { name: "Lesson" }).click();
  await page.getByText("Lessons that were interrupted").waitFor();
  await page.getByRole("button", { name: "Continue" }).click();
  await page.getByText("A: answered").waitFor();
  await arm(page);
  for (let trial = 1; trial <= 6; trial++) {
    await page.getByText(`Knee ${trial} of 6`).waitFor();
    await page.getByRole("button", { name: "Start this knee" }).click();
    await page.waitForTimeout(300);
    for (const student of ["A", "B"]) {
      if (trial === 1 && student === "A") continue;
      await enter(student, ["texture", "rigidity", "cogwheel", "clonus", "end-feel", "crepitus"][trial - 1]);
    }
    await page.locator(".answers .tag").first().waitFor();
    await page.getByRole("button", { name: trial < 6 ? "Next knee" : "End the lesson" }).click();
  }
  await page.getByText(/answers are right/).waitFor();
  // As in the report: what the numbers do not say.
  await page.getByText(/interval is only rough/).waitFor();
  const cut = await page.evaluate(() =>
    [...document.querySelectorAll(".results .scroll")]
      .filter((box) => box.checkVisibility() && box.scrollWidth > box.clientWidth)
      .map((box) => `${box.getAttribute("aria-label")}: ${box.scrollWidth} of ${box.clientWidth}`),
  );
  assert.deepEqual(cut, []);
  // Recordings are named by knee, student and answer.
  await page.getByRole("tab", { name: "Recordings" }).click();
  await page.getByRole("button", { name: "Refresh" }).click();
  await page.locator(".recording", { hasText: /knee 6 of/ }).getByText(/^B: Crepitus/).waitFor();
  assert.deepEqual(page.problems, []);
});
