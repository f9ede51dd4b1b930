// What a view into the joint has to know of a brace and of its knee, from parameters by name.

/** The scale of the loop: the range of the brace with its stops in degrees, and the largest torque of its motor, N·m. */
export function scaleOf(value) {
  const beyond = value("range.fade_deg");
  return {
    angle: [value("range.least_deg") - beyond, value("range.most_deg") + beyond],
    torque: value("limits.torque_nm"),
  };
}

/** The crepitus of a knee, null without it; `isAlone`: nothing else adds to its torque. */
export function crepitusOf(value, isAlone) {
  if (!value("crepitus.render")) return null;
  return {
    stiffness: value("crepitus.stiffness_nm_per_rad"),
    static: value("crepitus.static_torque_nm"),
    kinetic: value("crepitus.kinetic_torque_nm"),
    isAlone,
  };
}
