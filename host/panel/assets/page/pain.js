// Pain at an empty end of the range: nothing resists there, so the patient says where the movement ends.

import { data } from "./data.js";

const SIDES = ["extension", "flexion"];
const of = (values, key) => values.get(data.ids[`range-limit.${key}`]);

/** The states beyond an end of the range. */
const beyond = data.states.reduce(
  (bits, { effect }, bit) => (effect === "range-limit" ? bits | (1 << bit) : bits),
  0,
);

/** Returns whether a leg in these states, at this angle in degrees, hurts. `values` are those of the knee. */
export function hurts(values, states, angle) {
  if (!(states & beyond)) return false;
  const [extension, flexion] = SIDES.map((side) => of(values, `${side}_limit_deg`));
  const side = angle > (extension + flexion) / 2 ? "flexion" : "extension";
  return of(values, `${side}_torque_nm`) === 0;
}
