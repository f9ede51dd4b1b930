// The person's hand on the leg of the page: where it wants the leg, and whether it holds it.

import { makeHand } from "../hand.js";
import { angleAt, legText } from "../leg.js";
import { onLanguage, text } from "../strings.js";

// A screen reader hears of it once a second.
const ANNOUNCE_MS = 1000;

/** The hand on the leg that is drawn in a box. `range`: [least, most] in degrees. */
export class Grip {
  constructor(host, [least, most]) {
    this.host = host;
    this.isUsed = false;
    this.leg = 0;
    this.announcedAt = -Infinity;
    this.begin();
    this.hand = makeHand(host, {
      angleAt: (x, y) => angleAt(host, x, y),
      angle: () => (this.holds ? this.angle : this.leg),
      send: (angle) => this.take(angle),
    });
    this.hand.enable({ least, most });
    const name = () => host.setAttribute("aria-label", text("page.hand"));
    onLanguage(name);
    name();
  }

  /** Holds a leg that is straight. */
  begin() {
    this.angle = 0;
    this.holds = true;
  }

  take(angle) {
    this.angle = angle;
    this.holds = true;
    this.isUsed = true;
  }

  /** Lets go of the leg, until it is taken again. */
  release() {
    this.holds = false;
  }

  /** What the hand does at a picture's time; `leg` is the angle of the leg, in degrees. */
  at(now, leg) {
    this.leg = leg;
    if (now - this.announcedAt > ANNOUNCE_MS) {
      this.announcedAt = now;
      this.hand.announce(leg, legText(leg, this.holds ? this.angle : NaN));
    }
    return { angle: this.angle, holds: this.holds };
  }
}
