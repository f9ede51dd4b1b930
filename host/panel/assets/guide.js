// The person's hand on the leg of a simulated device: who may move it, and how it is given back.

import { isController, isTeacher, latest, on, tell } from "./connection.js";
import { byId, setText } from "./dom.js";
import { makeHand } from "./hand.js";
import { angleAt, legText } from "./leg.js";
import { legNow } from "./live.js";
import { onLanguage, text } from "./strings.js";

// A screen reader hears of it once a second.
const ANNOUNCE_MS = 1000;
let hand = null;
let announced = { at: -Infinity, text: "" };

// There is no reply.
const moveHand = (angle, holds) => tell({ hand: angle, holds });

/** The angles that a hand can reach; null where no hand can move the leg. */
const reach = () => latest.hello?.source.hand ?? null;

function update() {
  const { angle, hand: held } = legNow();
  const isMine = reach() !== null && isController() && Number.isFinite(angle);
  hand.enable(isMine ? { least: reach().least_deg, most: reach().most_deg } : null);
  byId("hand").hidden = reach() === null || !isTeacher();
  byId("hand-release").hidden = !isMine || !Number.isFinite(held);
  setText(byId("hand-hint"), text(isController() ? "hand.hint" : "hand.take-control"));
  const leg = byId("leg");
  if (!isMine) {
    leg.removeAttribute("aria-label");
    leg.removeAttribute("aria-describedby");
    announced = { at: -Infinity, text: "" };
    return;
  }
  leg.setAttribute("aria-label", text("hand.label"));
  leg.setAttribute("aria-describedby", "hand-hint");
  const words = legText(angle, held);
  if (words === announced.text || performance.now() - announced.at < ANNOUNCE_MS) return;
  announced = { at: performance.now(), text: words };
  hand.announce(angle, words);
}

/** Starts the hand. */
export function startGuide() {
  const leg = byId("leg");
  hand = makeHand(leg, {
    angleAt: (x, y) => angleAt(leg, x, y),
    angle: () => {
      const now = legNow();
      return Number.isFinite(now.hand) ? now.hand : now.angle;
    },
    send: (angle) => moveHand(angle, true),
  });
  byId("hand-release").addEventListener("click", () => {
    moveHand(0, false);
    leg.focus({ preventScroll: true });
  });
  for (const kind of ["hello", "holder", "status", "frame", "lost", "silent"]) on(kind, update);
  onLanguage(update);
  update();
}
