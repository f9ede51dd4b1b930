// A leg with a brace, seen from the side: the thigh lies, the lower leg turns.
// 0° is straight, and the angle grows as the knee bends.

import { svg } from "./dom.js";
import { number, text } from "./strings.js";

/** The axis of the knee in the drawing, and the outlines of thigh and lower leg at 0°. */
export const KNEE = { x: 150, y: 62 };
export const THIGH =
  "M8 30 C50 24 110 34 150 38 C166 40 174 52 173 62 C172 76 162 86 150 86 C110 92 50 100 8 98 Z";
export const SHANK =
  "M150 40 C185 42 215 44 250 48 L254 50 C268 38 276 30 284 26 C292 27 292 38 288 50 L280 76 C270 80 262 78 252 76 C215 80 185 86 150 84 Z";
// Closer to the leg a hand is not drawn: its outline would flicker.
const APART = 1;

/** The angle about the knee of a leg that is drawn in `host`, in degrees, of a point on the screen. */
export function angleAt(host, x, y) {
  const drawing = host.querySelector("svg");
  const at = new DOMPoint(x, y).matrixTransform(drawing.getScreenCTM().inverse());
  return (Math.atan2(at.y - KNEE.y, at.x - KNEE.x) * 180) / Math.PI;
}

/** What is drawn, in words. */
export function legText(angle, hand) {
  const known = Number.isFinite(angle) ? number(angle) : "–";
  return Number.isFinite(hand)
    ? text("leg.label-hand", { angle: known, hand: number(hand) })
    : text("leg.label", { angle: known });
}

/**
 * Draws a leg into a box; the returned function turns it to an angle in degrees, and shows where a hand wants it,
 * if there is one.
 */
export function makeLeg(host) {
  const shank = svg(
    "g",
    null,
    svg("path", { class: "skin", d: SHANK }),
    svg("rect", { class: "brace", x: 156, y: 57, width: 74, height: 10, rx: 5 }),
    svg("rect", { class: "cuff", x: 205, y: 40, width: 16, height: 44, rx: 5 }),
  );
  const ghost = svg("path", { class: "ghost", d: SHANK, visibility: "hidden" });
  const arc = svg("path", { class: "arc" });
  const drawing = svg(
    "svg",
    { viewBox: "0 0 300 212", role: "img" },
    svg("path", { class: "bench", d: "M6 100 H122 V204" }),
    svg("path", { class: "skin", d: THIGH }),
    svg("path", { class: "straight", d: "M150 62 H292" }),
    ghost,
    shank,
    svg("rect", { class: "brace", x: 66, y: 57, width: 78, height: 10, rx: 5 }),
    svg("rect", { class: "cuff", x: 76, y: 28, width: 18, height: 68, rx: 5 }),
    arc,
    svg("circle", { class: "motor", cx: KNEE.x, cy: KNEE.y, r: 17 }),
    svg("circle", { class: "axle", cx: KNEE.x, cy: KNEE.y, r: 5 }),
  );
  host.replaceChildren(drawing);
  const turned = (angle) => `rotate(${Math.round(angle * 10) / 10} ${KNEE.x} ${KNEE.y})`;
  let shown = null;
  let spoken = null;
  return (angle, hand = NaN) => {
    const at = Number.isFinite(angle) ? Math.round(angle * 10) / 10 : 0;
    if (shown !== at) {
      shown = at;
      shank.setAttribute("transform", turned(at));
      const end = (at * Math.PI) / 180;
      const sweep = at >= 0 ? 1 : 0;
      const [x, y] = [KNEE.x + 46 * Math.cos(end), KNEE.y + 46 * Math.sin(end)];
      arc.setAttribute("d", `M${KNEE.x + 46} ${KNEE.y} A46 46 0 0 ${sweep} ${x.toFixed(1)} ${y.toFixed(1)}`);
    }
    const apart = Math.abs(hand - angle) >= APART;
    ghost.setAttribute("visibility", apart ? "visible" : "hidden");
    if (apart) ghost.setAttribute("transform", turned(hand));
    const label = legText(angle, hand);
    // A name that changed 60 times a second would keep a screen reader busy.
    if (spoken === null || performance.now() - spoken.at > 1000) {
      if (spoken?.label !== label) drawing.setAttribute("aria-label", label);
      spoken = { at: performance.now(), label };
    }
  };
}
