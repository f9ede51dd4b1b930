// What is shaded behind the curves: the phases of the effects, slip, limits,
// time without torque, gaps. Each has a name in text and a pattern of its own.

import { MARK } from "./bins.js";
import { text, textOr } from "./strings.js";

const MARKS = [
  { mark: MARK.slip, key: "slip", colour: "--slip", pattern: "solid" },
  { mark: MARK.limited, key: "limited", colour: "--limited", pattern: "rising" },
  { mark: MARK.settling, key: "settling", colour: "--settling", pattern: "upright" },
  { mark: MARK.late, key: "late", colour: "--limited", pattern: "upright" },
  { mark: MARK.energised, absent: true, key: "off", colour: "--off", pattern: "falling" },
  { mark: MARK.gap, key: "gap", colour: "--gap", pattern: "crossed" },
];

const HUES = ["--effect-1", "--effect-2", "--effect-3", "--effect-4", "--effect-5", "--effect-6"];
const PATTERNS = ["solid", "rising", "falling", "crossed", "upright"];

/** All that can be shaded, for these states of the server's hello, in which none is at rest. */
export function shadesOf(states) {
  const effects = [...new Set(states.map((state) => state.effect))];
  const seen = new Map();
  const shades = [];
  states.forEach(({ effect, phase }, bit) => {
    // Effects that share a hue have the next patterns.
    const hue = HUES[effects.indexOf(effect) % HUES.length];
    const nth = seen.get(hue) ?? 0;
    seen.set(hue, nth + 1);
    shades.push({
      bit: 1 << bit,
      effect,
      phase,
      colour: hue,
      pattern: PATTERNS[nth % PATTERNS.length],
    });
  });
  return [...shades, ...MARKS];
}

/** The name of a shade. */
export const shadeName = (shade) =>
  shade.effect
    ? `${textOr(`group.${shade.effect}`, shade.effect)}: ${textOr(`state.${shade.effect}.${shade.phase}`, shade.phase)}`
    : text(`shade.${shade.key}`);

/** Which shades a bin has, as bits in the order of the list. */
export function shadesIn(shades, states, marks) {
  let found = 0;
  for (let k = 0; k < shades.length; k++) {
    const shade = shades[k];
    const is = shade.bit ? states & shade.bit : marks & shade.mark;
    // A gap has neither torque nor none.
    if (shade.absent ? !is && !(marks & MARK.gap) : is) found |= 1 << k;
  }
  return found;
}
