// Torque as sound: a worklet plays the samples, or where a page may load none, pieces that are scheduled one behind
// the other. Nothing sounds before somebody has asked for it.

import { el, setText } from "./dom.js";
import { RATE_HZ, SoundLaw } from "./sound-law.js";
import { store, stored } from "./storage.js";
import { onLanguage, text } from "./strings.js";

// Between the first torque that comes and its sound; and what waits at most.
const LEAD_S = 0.05;
const MOST_S = 0.15;

async function workletOf(context, module) {
  await context.audioWorklet.addModule(module);
  const samplesOf = (seconds) => Math.round(seconds * RATE_HZ);
  const node = new AudioWorkletNode(context, "torque", {
    numberOfInputs: 0,
    outputChannelCount: [1],
    processorOptions: { lead: samplesOf(LEAD_S), most: samplesOf(MOST_S) },
  });
  return { node, way: "worklet", play: (samples) => node.port.postMessage(samples, [samples.buffer]) };
}

function piecesOf(context) {
  const node = context.createGain();
  let end = 0;
  const play = (samples) => {
    const now = context.currentTime;
    if (end > now + MOST_S) return;
    if (end < now) end = now + LEAD_S;
    const buffer = context.createBuffer(1, samples.length, RATE_HZ);
    buffer.copyToChannel(samples, 0);
    const source = context.createBufferSource();
    source.buffer = buffer;
    source.connect(node);
    source.start(end);
    end += buffer.duration;
  };
  return { node, way: "pieces", play };
}

/** The sound of a torque. `module`: address of the worklet. */
export class Sound {
  constructor(module) {
    this.module = module;
    this.law = new SoundLaw();
    this.output = null;
    this.opening = null;
    this.isOn = false;
    this.volume = 0.7;
    // What a test looks at.
    this.stats = { way: null, samples: 0, peak: 0 };
  }

  /** Begins; only after a click or a key do browsers allow it. */
  async start() {
    this.isOn = true;
    this.law.clear();
    this.opening ??= this.open();
    await this.opening;
    // It may have been switched off meanwhile.
    return this.isOn ? this.context.resume() : this.context.suspend();
  }

  async open() {
    this.context = new AudioContext({ sampleRate: RATE_HZ, latencyHint: "interactive" });
    this.output = await workletOf(this.context, this.module).catch(() => piecesOf(this.context));
    this.stats.way = this.output.way;
    this.gain = this.context.createGain();
    this.output.node.connect(this.gain).connect(this.context.destination);
    this.setVolume(this.volume);
  }

  stop() {
    this.isOn = false;
    this.context?.suspend();
  }

  /** From 0 to 1; half way sounds half as loud. */
  setVolume(volume) {
    this.volume = volume;
    if (this.gain) this.gain.gain.value = volume ** 2;
  }

  /** Another knee: its loudest sample is not known yet. */
  clear() {
    this.law.clear();
  }

  /** Takes torques at 20 kHz, N·m. */
  push(torques) {
    if (!this.isOn || !this.output || !torques.length) return;
    const samples = this.law.push(torques);
    if (!samples.length) return;
    this.stats.samples += samples.length;
    for (const sample of samples) this.stats.peak = Math.max(this.stats.peak, Math.abs(sample));
    this.output.play(samples);
  }
}

/** Button and volume of a sound in a box; `onSwitch(isOn)` is called when it is switched. */
export function makeSoundControls(host, sound, onSwitch = () => {}) {
  sound.setVolume(Number(stored("volume") ?? sound.volume));
  const name = el("span");
  const volume = el("input", { type: "range", min: 0, max: 1, step: 0.05, value: sound.volume });
  const button = el("button", { type: "button", class: "toggle" });
  const show = () => {
    button.setAttribute("aria-pressed", String(sound.isOn));
    setText(button, text("sound"));
    setText(name, text("sound.volume"));
  };
  button.addEventListener("click", async () => {
    if (sound.isOn) sound.stop();
    else await sound.start();
    onSwitch(sound.isOn);
    show();
  });
  volume.addEventListener("input", () => {
    sound.setVolume(Number(volume.value));
    store("volume", volume.value);
  });
  host.replaceChildren(button, el("label", { class: "volume" }, name, volume));
  onLanguage(show);
  show();
}
