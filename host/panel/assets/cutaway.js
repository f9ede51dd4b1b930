// A large leg whose knee is cut open: shaft, imaginary object, its spring, and the resistance as an arrow. Behind the
// leg its ghost is where the hand wants it to be.

import { svg } from "./dom.js";
import { KNEE, legText, SHANK, THIGH } from "./leg.js";

const HOUSING = 33;
const RING = 22;
// The object turns by thousandths of a radian before it slips: 0.4 N·m at 400 N·m/rad are shown as 28°.
const MAGNIFIED = 500;
const FARTHEST = 80;
// The resistance of a motor at its limit; the length goes by the square root, so that fine grating is seen, too.
const LONGEST = 58;
const LONGEST_NM = 4.5;
const ARROW = { x: 236, y: 62 };
// A ghost that is nearer is covered by the leg.
const GHOST_FROM = 0.5;

const radians = (degrees) => (degrees * Math.PI) / 180;
const at = (radius, degrees) => {
  const [x, y] = [Math.cos(radians(degrees)), Math.sin(radians(degrees))];
  return `${(KNEE.x + radius * x).toFixed(1)} ${(KNEE.y + radius * y).toFixed(1)}`;
};

/** The coils from the spring's fixed end to the object, which is at this angle of the picture. */
function coils(end) {
  const begin = -205;
  const points = [];
  for (let k = 0; k <= 28; k++) {
    const radius = RING + (k === 0 || k === 28 ? 0 : k % 2 ? 3.5 : -3.5);
    points.push(at(radius, begin + ((end - begin) * k) / 28));
  }
  return `M${points.join(" L")}`;
}

/** An arrow along y from the cuff; a positive length points towards a straight leg. */
function arrow(length) {
  const { x, y } = ARROW;
  const tip = y - length;
  const head = Math.sign(length) * Math.min(9, Math.abs(length));
  return `M${x} ${y} V${tip} M${x - 6} ${tip + head} L${x} ${tip} L${x + 6} ${tip + head}`;
}

const lengthOf = (torque) =>
  Math.sign(torque) * LONGEST * Math.sqrt(Math.min(1, Math.abs(torque) / LONGEST_NM));

/**
 * Draws a leg into a box. The returned function shows a state: `angle` of the leg, `hand` and `object` in degrees,
 * `spring` and `torque` in N·m, NaN for what is not known or not to be seen, and `phase`: 1 stick, 2 slip, else 0.
 */
export function makeCutaway(host) {
  const group = (...parts) => svg("g", null, ...parts);
  const force = svg("path", { class: "resistance" });
  const ghost = group(svg("path", { class: "ghost", d: SHANK }));
  const shank = group(
    svg("path", { class: "skin", d: SHANK }),
    svg("rect", { class: "brace", x: 178, y: 57, width: 62, height: 10, rx: 5 }),
    svg("rect", { class: "cuff", x: 214, y: 40, width: 16, height: 44, rx: 5 }),
    force,
  );
  const shaft = group(
    svg("circle", { class: "shaft", cx: KNEE.x, cy: KNEE.y, r: 13 }),
    svg("path", { class: "key", d: `M${KNEE.x} ${KNEE.y} h13` }),
  );
  const spring = svg("path", { class: "spring" });
  const object = group(
    svg("rect", { class: "object", x: KNEE.x - 7, y: KNEE.y - RING - 7, width: 14, height: 15, rx: 2 }),
  );
  const inside = svg(
    "g",
    { class: "inside" },
    svg("path", { class: "ground", d: `M${at(RING - 7, -205)} L${at(RING + 8, -205)}` }),
    spring,
    object,
  );
  const drawing = svg(
    "svg",
    { viewBox: "0 0 300 212", role: "img", "aria-label": legText(NaN, NaN) },
    svg("path", { class: "bench", d: "M6 100 H112 V204" }),
    svg("path", { class: "skin", d: THIGH }),
    svg("path", { class: "straight", d: `M${KNEE.x} ${KNEE.y} H292` }),
    ghost,
    shank,
    svg("rect", { class: "brace", x: 66, y: 57, width: 60, height: 10, rx: 5 }),
    svg("rect", { class: "cuff", x: 76, y: 28, width: 18, height: 68, rx: 5 }),
    svg("circle", { class: "housing", cx: KNEE.x, cy: KNEE.y, r: HOUSING }),
    shaft,
    inside,
  );
  drawing.classList.add("cutaway");
  host.replaceChildren(drawing);
  // As a style: an attribute would lay out the drawing.
  for (const part of [ghost, shank, shaft, object]) part.style.transformOrigin = `${KNEE.x}px ${KNEE.y}px`;
  const turn = (part, degrees) => (part.style.transform = `rotate(${degrees.toFixed(1)}deg)`);
  const show = (part, is) => part.classList.toggle("off", !is);
  let spokenAt = -Infinity;
  return ({ angle, hand, object: displacement, spring: load, torque, phase }) => {
    const known = Number.isFinite(angle);
    turn(shank, known ? angle : 0);
    turn(shaft, known ? angle : 0);
    const isHeld = known && Number.isFinite(hand) && Math.abs(hand - angle) > GHOST_FROM;
    show(ghost, isHeld);
    if (isHeld) turn(ghost, hand);
    show(force, Math.abs(torque) > 0.01);
    if (Math.abs(torque) > 0.01) force.setAttribute("d", arrow(lengthOf(torque)));
    const hasObject = Number.isFinite(displacement) && phase > 0;
    show(inside, hasObject);
    if (hasObject) {
      const shown = Math.max(-FARTHEST, Math.min(FARTHEST, displacement * MAGNIFIED));
      turn(object, shown);
      spring.setAttribute("d", coils(shown - 90));
      // A loaded spring is thicker.
      spring.setAttribute("stroke-width", (1 + 2.5 * Math.min(1, Math.abs(load))).toFixed(1));
      object.classList.toggle("slips", phase === 2);
    }
    // A name that changed 60 times a second would keep a screen reader busy.
    if (performance.now() - spokenAt < 1000) return;
    spokenAt = performance.now();
    const label = legText(angle, hand);
    if (drawing.getAttribute("aria-label") !== label) drawing.setAttribute("aria-label", label);
  };
}
