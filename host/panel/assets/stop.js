// Stop: torque off, whatever the page shows, from every page.

import { ask, latest, on } from "./connection.js";
import { byId, setText } from "./dom.js";
import { errorText, say } from "./report.js";
import { text } from "./strings.js";

// A person who has pressed STOP looks whether it has worked: this page says by then that it has not.
const CONFIRMED_WITHIN_MS = 450;

function alarm(reason) {
  byId("alarm").hidden = false;
  setText(byId("alarm-reason"), reason);
}

function confirm(message) {
  byId("alarm").hidden = true;
  say(message);
}

/** Turns the torque off; says loudly if that is not confirmed. */
export async function stop() {
  const unconfirmed = setTimeout(() => alarm(text("stop.unanswered")), CONFIRMED_WITHIN_MS);
  try {
    await ask("stop");
    confirm(text("stop.done"));
  } catch (error) {
    alarm(errorText(error));
  }
  clearTimeout(unconfirmed);
}

/** Starts what belongs to the stop. */
export function startStop() {
  byId("stop").addEventListener("click", stop);
  // Captured at the window: no dialog, field or list keeps the key for itself.
  addEventListener("keydown", (event) => event.key === "Escape" && !event.repeat && stop(), {
    capture: true,
  });
  // Without the stop's own answer, the device's state confirms it.
  on("status", () => {
    if (!byId("alarm").hidden && latest.status.state === "disarmed") confirm(text("stop.confirmed"));
  });
}
