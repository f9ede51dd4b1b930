// The live view's inside of the joint, its sound and its vibration.

import { torquesOf } from "./bins.js";
import { latest, on, tell } from "./connection.js";
import { byId } from "./dom.js";
import { addFeelSwitch, Feel } from "./feel.js";
import { crepitusOf, scaleOf } from "./joint.js";
import { makeSoundControls, Sound } from "./sound.js";

const sound = new Sound("sound-worklet.js");
const feel = new Feel();
let inside = null;

const parameter = (name) => latest.hello.parameters.find((entry) => entry.name === name);

/** The crepitus of the knee on the device; null without it, and where the knee is hidden. */
function crepitus() {
  const { hello, parameters } = latest;
  if (!parameters?.values) return null;
  const values = new Map(parameters.values);
  const value = (name) => values.get(parameter(name).id);
  const others = hello.groups.filter(({ name, kind }) => kind === "symptom" && name !== "crepitus");
  const isAlone = others.every(({ name }) => !value(`${name}.render`));
  return crepitusOf(value, isAlone);
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
  const scale = scaleOf((name) => parameter(name).default);
  inside ??= new Inside(Object.fromEntries(hosts), scale);
  showKnee();
}

function build() {
  open();
  feel.setStates(latest.hello.states);
  // Another connection does not know that this page listens.
  if (sound.isOn) tell({ listen: true });
  showKnee();
}

/** Starts it, with the bins of the live view, which have a frame's before this is called with it. */
export function startInside(bins) {
  window.crepitusSound = sound.stats;
  makeSoundControls(byId("sound"), sound, (isOn) => tell({ listen: isOn }));
  addFeelSwitch(byId("sound"), feel);
  byId("inside").addEventListener("toggle", open);
  on("hello", build);
  on("parameters", () => {
    sound.clear();
    showKnee();
  });
  on("samples", (view) => sound.push(torquesOf(view)));
  on("frame", (view) => {
    const { columns, end } = bins;
    for (let i = Math.max(bins.begin, end - view.getUint16(2, true)); i < end; i++) {
      feel.take(columns.breaks[i], columns.states[i]);
    }
  });
}
