// The live view's inside of the joint, its sound and its vibration.

import { latest, on, tell } from "./connection.js";
import { byId } from "./dom.js";
import { Feel } from "./feel.js";
import { makeSoundControls, Sound } from "./sound.js";

const HEADER = 40;
const sound = new Sound("sound-worklet.js");
let inside = null;
let feel = null;

const parameter = (name) => latest.hello.parameters.find((entry) => entry.name === name);

/** The scale of the loop: the range of the device with the stops of the brace, and the largest torque of its motor. */
function scaleOf() {
  const [least, most] = ["range.least_deg", "range.most_deg"].map((name) => parameter(name).default);
  return { angle: [least - 5, most + 5], torque: parameter("limits.torque_nm").max };
}

/** The crepitus of the knee on the device; null without it, and where the knee is hidden. */
function crepitus() {
  const { hello, parameters } = latest;
  if (!parameters?.values) return null;
  const values = new Map(parameters.values);
  const value = (name) => values.get(parameter(name).id);
  if (!value("crepitus.render")) return null;
  const symptoms = hello.groups.filter(({ name, kind }) => kind === "symptom" && name !== "crepitus");
  return {
    stiffness: value("crepitus.stiffness_nm_per_rad"),
    static: value("crepitus.static_torque_nm"),
    kinetic: value("crepitus.kinetic_torque_nm"),
    isAlone: symptoms.every(({ name }) => !value(`${name}.render`)),
  };
}

function showKnee() {
  if (latest.hello) inside?.setKnee(crepitus(), latest.parameters?.hidden === true);
}

/** Draws it, if it is open. */
export function drawInside(now, bins, isStale) {
  if (byId("inside").open) inside?.draw(now, bins, bins.masked, isStale);
}

// Its modules are loaded when it is first opened.
async function open() {
  if (inside || !latest.hello || !byId("inside").open) return;
  const { Inside } = await import("./inside.js");
  const hosts = ["leg", "slow", "loop", "flow"].map((part) => [part, byId(`inside-${part}`)]);
  inside ??= new Inside(Object.fromEntries(hosts), scaleOf());
  showKnee();
}

function build() {
  open();
  feel = new Feel(latest.hello.states);
  // Another connection does not know that this page listens.
  if (sound.isOn) tell({ listen: true });
  showKnee();
}

/** Starts it, with the bins of the live view, which have a frame's before this is called with it. */
export function startInside(bins) {
  window.crepitusSound = sound.stats;
  makeSoundControls(byId("sound"), sound, (isOn) => tell({ listen: isOn }));
  byId("inside").addEventListener("toggle", open);
  on("hello", build);
  on("parameters", () => {
    sound.clear();
    showKnee();
  });
  on("samples", (view) => sound.push(new Float32Array(view.buffer, HEADER, view.getUint16(2, true))));
  on("frame", (view) => {
    if (!sound.isOn) return;
    const { columns, end } = bins;
    for (let i = Math.max(bins.begin, end - view.getUint16(2, true)); i < end; i++) {
      feel?.take(columns.breaks[i], columns.states[i]);
    }
  });
}
