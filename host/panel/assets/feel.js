// Breaks and snaps as vibration of a phone. Elsewhere nothing happens.

const VIBRATION_MS = 12;
const SNAPS = ["spasticity.caught", "clasp-knife.fallen", "cogwheel.high"];

/** Vibrates with what a hand would feel; `states` are those of the server's hello. */
export class Feel {
  constructor(states) {
    this.snaps = states.reduce(
      (bits, { effect, phase }, bit) => (SNAPS.includes(`${effect}.${phase}`) ? bits | (1 << bit) : bits),
      0,
    );
    this.before = 0;
  }

  /** Takes the breaks of a short time, and the states in it. */
  take(breaks, states) {
    const begun = states & ~this.before & this.snaps;
    this.before = states;
    if (!breaks && !begun) return;
    // A page that nobody has touched may not vibrate, and browsers complain.
    if (navigator.userActivation?.hasBeenActive) navigator.vibrate?.(VIBRATION_MS);
  }
}
