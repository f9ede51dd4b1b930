// Starts the panel, a simulated device and a browser; ends them all.

import { spawn } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { chromium } from "playwright-core";

const here = import.meta.dirname;
export const CREPITUS = process.env.CREPITUS ?? join(here, "../../target/debug/crepitus");
const CHROMIUM = process.env.CHROMIUM ?? "/usr/bin/chromium";

const FLAGS = [
  "--no-sandbox",
  "--disable-gpu",
  "--disable-quic",
  "--no-first-run",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
  // As somebody who does name-server tricks would have it.
  "--host-resolver-rules=MAP rebound.example 127.0.0.1",
];

const children = new Set();
const folders = [];
let browser = null;

/** A folder that is removed at the end. */
export function folder() {
  const made = mkdtempSync(join(tmpdir(), "crepitus-panel-"));
  folders.push(made);
  return made;
}

/** Starts the program; resolves when its output has what is waited for. */
export function start(args, pattern, env = {}) {
  if (!existsSync(CREPITUS)) throw new Error(`${CREPITUS}: build it first, or set CREPITUS`);
  const child = spawn(CREPITUS, args, {
    stdio: ["ignore", "pipe", "inherit"],
    env: { ...process.env, ...env },
  });
  children.add(child);
  child.on("exit", () => children.delete(child));
  return new Promise((resolve, reject) => {
    let text = "";
    child.stdout.on("data", (data) => {
      text += data;
      const found = text.match(pattern);
      if (found) resolve({ child, found });
    });
    child.on("exit", (code) => reject(new Error(`crepitus ${args.join(" ")} ended with ${code}: ${text}`)));
  });
}

/** The panel, and its links. */
export async function startPanel(args = ["--device", "sim"], env = {}) {
  const own = { CREPITUS_PRESETS: folder(), ...env };
  const { child, found } = await start(["panel", "--json", ...args], /\{[\s\S]*\n\}/, own);
  return { child, ...JSON.parse(found[0]) };
}

/** A simulated device in a process of its own. */
export async function startDevice(home, args = []) {
  const env = { XDG_RUNTIME_DIR: home };
  const { child } = await start(["serve-sim", "--name", "knee", "--json", ...args], /"port"/, env);
  return child;
}

/** Ends a process and waits for it. */
export function end(child, signal = "SIGINT") {
  return new Promise((resolve) => {
    if (child.exitCode !== null || child.signalCode !== null) return resolve(child.exitCode);
    child.on("exit", resolve);
    return child.kill(signal);
  });
}

/** The one browser of a test file. */
export async function browserOf() {
  browser ??= await chromium.launch({ executablePath: CHROMIUM, args: FLAGS });
  return browser;
}

/**
 * Repeats what is timed, in ms, until it is below the limit, five times at most; returns the least. Times include
 * the browser's own work, which on a busy computer takes as long again.
 */
export async function quickest(limit, timed) {
  const all = [];
  while (all.length < 5 && !(Math.min(...all) < limit)) all.push(await timed());
  console.log(`${all.map(Math.round)} ms of ${limit}`);
  return Math.min(...all);
}

const AXE = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

/** What axe-core finds on a page, what is too wide, and text below 14 px: in text, nothing where all is well. */
export async function problemsOf(page) {
  // Playwright's own evaluation is not bound by the page's policy.
  await page.evaluate(AXE);
  const { violations } = await page.evaluate(() => window.axe.run());
  const found = violations.map(({ id, nodes }) => `${id}: ${nodes[0].html}`);
  const [wide, small] = await page.evaluate(() => {
    const sizes = [...document.querySelectorAll("body *")]
      .filter((node) => node.checkVisibility() && [...node.childNodes].some((c) => c.nodeType === 3 && c.data.trim()))
      .map((node) => [parseFloat(getComputedStyle(node).fontSize), node.outerHTML.slice(0, 80)]);
    return [document.documentElement.scrollWidth - innerWidth, sizes.filter(([size]) => size < 14)];
  });
  if (wide > 0) found.push(`${wide} px too wide`);
  return [...found, ...small.map(([size, html]) => `text of ${size} px: ${html}`)];
}

/** A page of its own context, with its errors in `page.problems`. */
export async function openPage(link, options = {}) {
  const context = await (await browserOf()).newContext({ viewport: { width: 1280, height: 900 }, ...options });
  const page = await context.newPage();
  page.problems = [];
  page.on("console", (message) => message.type() === "error" && page.problems.push(message.text()));
  page.on("pageerror", (error) => page.problems.push(error.message));
  await page.goto(link);
  return page;
}

/** A page that has its first curves. */
export async function openLive(link, options) {
  const page = await openPage(link, options);
  await until(page, "the first bins", () => window.crepitusStats?.bins > 0);
  return page;
}

/** A page that has control. */
export async function openControlling(link, options) {
  const page = await openLive(link, options);
  await page.getByRole("button", { name: "Take control" }).click();
  await page.locator("#holder", { hasText: "you" }).waitFor();
  return page;
}

/** Waits until this holds in the page: its policy forbids what Playwright injects for that. */
export async function until(page, what, condition, argument, timeout = 20_000) {
  const last = Date.now() + timeout;
  while (!(await page.evaluate(condition, argument).catch(() => false))) {
    if (Date.now() > last) {
      const said = (id) => page.locator(id).textContent({ timeout: 1000 }).catch(() => "nothing");
      throw new Error(`waited for ${what}; state ${await said("#state")}, message ${await said("#message")}`);
    }
    await new Promise((resolve) => setTimeout(resolve, 10));
  }
}

/** Arms. On a busy computer the page may answer too late once: then it is armed again, as a person would. */
export async function arm(page) {
  for (let attempt = 1; ; attempt++) {
    await page.locator("#arm").click();
    try {
      return await until(page, "armed", () => document.getElementById("state").dataset.state === "armed", null, 3000);
    } catch (error) {
      const said = await page.locator("#message").textContent();
      if (attempt === 5 || !/200 ms|quickly enough/.test(said)) throw error;
    }
  }
}

/** Waits for a state of the device. */
export function untilState(page, state) {
  const shows = (wanted) => document.getElementById("state").dataset.state === wanted;
  return until(page, state, shows, state);
}

/** Ends the programs and pages of a test: simulated devices would slow the next one. */
export async function endTest() {
  await Promise.all(browser?.contexts().map((context) => context.close()) ?? []);
  await Promise.all([...children].map((child) => end(child, "SIGKILL")));
}

/** Ends everything. */
export async function endAll() {
  await endTest();
  await browser?.close();
  browser = null;
  for (const made of folders) rmSync(made, { recursive: true, force: true });
}
