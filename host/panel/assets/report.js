// What a request came to, in words: a line for the eye and a live region.

import { ask } from "./connection.js";
import { byId, setText } from "./dom.js";
import { text } from "./strings.js";

let until = null;

/** Shows a text for a while; errors stay longer. */
export function say(message, isError = false) {
  const line = byId("message");
  line.hidden = false;
  line.classList.toggle("error", isError);
  setText(line, message);
  clearTimeout(until);
  until = setTimeout(() => (line.hidden = true), isError ? 12000 : 5000);
}

/** The text of an error. */
export const errorText = (error) =>
  error.message === "not-connected" ? text("error.not-connected") : error.message;

/** Opens a page that the server offers once, in a tab of its own. */
export async function openOffered(what, more) {
  const ok = await request(what, more);
  if (!ok) return;
  // A path of this server, never an address that a message could bring in.
  if (!/^\/report\/[\w-]+$/.test(ok.path)) return say(text("results.bad-report"), true);
  window.open(ok.path, "_blank", "noopener");
}

/** Sends a request and reports an error; resolves with `ok`, or with null. */
export async function request(what, more, done) {
  try {
    const ok = await ask(what, more);
    if (done) say(done);
    return ok ?? {};
  } catch (error) {
    say(errorText(error), true);
    return null;
  }
}
