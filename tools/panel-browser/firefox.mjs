// Firefox as it is installed, by WebDriver BiDi: enough to open a page and to look at it.

import { spawn } from "node:child_process";
import { existsSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { WebSocket } from "ws";

const PLACES = [process.env.FIREFOX, "/usr/bin/firefox", "/usr/bin/firefox-esr"];

/** Where it is, or undefined. */
export const FIREFOX = PLACES.find((place) => place && existsSync(place));

/** Without a network: all goes to a proxy at a port where nobody listens. */
const OFFLINE = [
  ["network.proxy.type", 1],
  ["network.proxy.socks", "127.0.0.1"],
  ["network.proxy.socks_port", 9],
  ["network.proxy.socks_remote_dns", true],
];

/** Opens a page with a new profile in this folder; `look` is called with a function that evaluates an expression. */
export async function inFirefox(link, profile, look) {
  const lines = OFFLINE.map(([name, value]) => `user_pref("${name}", ${JSON.stringify(value)});\n`);
  writeFileSync(join(profile, "user.js"), lines.join(""));
  const args = ["--headless", "--no-remote", "--profile", profile, "--remote-debugging-port", "0", "about:blank"];
  const child = spawn(FIREFOX, args, { stdio: ["ignore", "ignore", "pipe"] });
  try {
    const address = await new Promise((resolve, reject) => {
      let text = "";
      child.stderr.on("data", (data) => {
        text += data;
        const found = text.match(/WebDriver BiDi listening on (ws:\S+)/);
        if (found) resolve(found[1]);
      });
      child.on("exit", (code) => reject(new Error(`Firefox ended with ${code}: ${text}`)));
    });
    const socket = new WebSocket(`${address}/session`);
    await new Promise((resolve, reject) => socket.on("open", resolve).on("error", reject));
    const waiting = new Map();
    const problems = [];
    socket.on("message", (data) => {
      const message = JSON.parse(data);
      if (message.method === "log.entryAdded" && message.params.level === "error") problems.push(message.params.text);
      waiting.get(message.id)?.(message);
    });
    let serial = 0;
    const send = (method, params) =>
      new Promise((resolve, reject) => {
        const id = ++serial;
        waiting.set(id, ({ result, error, message }) => (error ? reject(new Error(message)) : resolve(result)));
        socket.send(JSON.stringify({ id, method, params }));
      });
    await send("session.new", { capabilities: {} });
    await send("session.subscribe", { events: ["log.entryAdded"] });
    const { context } = await send("browsingContext.create", { type: "tab" });
    await send("browsingContext.navigate", { context, url: link, wait: "complete" });
    const evaluate = async (expression) => {
      const target = { context };
      // As after a click of a person: without one there is no sound.
      const params = { expression, target, awaitPromise: true, userActivation: true };
      const { result, exceptionDetails } = await send("script.evaluate", params);
      if (exceptionDetails) throw new Error(exceptionDetails.text);
      return result.value;
    };
    await look(evaluate);
    return problems;
  } finally {
    const ended = new Promise((resolve) => child.once("exit", resolve));
    if (child.exitCode === null) {
      child.kill("SIGKILL");
      await ended;
    }
  }
}
