// Stop: torque off, whatever the page shows, from every page.

import { request, say } from "./report.js";
import { text } from "./strings.js";

/** Turns the torque off. */
export async function stop() {
  if (await request("stop")) say(text("stop.done"));
}
