// The page of one file: a knee that a hand moves, without a program. Everything that is measured about it is in
// `crepitusKnee`.

import { BINS_A_SECOND } from "../bins.js";
import { makeCutaway } from "../cutaway.js";
import { byId, el, setText } from "../dom.js";
import { addFeelSwitch, Feel } from "../feel.js";
import { Inside } from "../inside.js";
import { crepitusOf, scaleOf } from "../joint.js";
import { showSecret } from "../labels.js";
import { makeSoundControls, Sound } from "../sound.js";
import { number, onLanguage, startStrings, text } from "../strings.js";
import { bytesOf, data } from "./data.js";
import { makeExamination, missedOf } from "./examination.js";
import { Grip } from "./grip.js";
import { Knee } from "./knee.js";
import { HEALTHY, makeKnees, titleOf } from "./knees.js";
import { hurts } from "./pain.js";
import { makeQuiz } from "./quiz.js";

// A picture that comes later than this has no more of the knee's time: it would catch up for ever.
const LONGEST_MS = 100;
const WORDS_MS = 200;
// Of the healthy knee beside another one its leg is seen: it has no object.
const BESIDE = { torque: false, states: true };

const stats = { pictures: 0, samples: 0, breaks: 0, peak: 0, states: 0, first: null };

/** The parameters of a knee: all of them, also those that another knee has changed. */
const valuesOf = (preset) => new Map([...data.healthy, ...preset.values]);

async function start() {
  await startStrings(byId("language"), data.texts);
  const module = bytesOf(data.wasm);
  const [knee, healthy] = [await Knee.load(module), await Knee.load(module)];
  const hosts = { leg: byId("leg"), slow: byId("slow"), loop: byId("loop"), flow: byId("flow") };
  const scale = scaleOf((name) => data.brace[name]);
  const inside = new Inside(hosts, scale);
  const showHealthy = makeCutaway(byId("healthy-leg"));
  const sound = new Sound(`data:text/javascript,${encodeURIComponent(data.worklet)}`);
  const feel = new Feel();
  const grip = new Grip(byId("leg"), scale.angle);
  const showExamination = makeExamination(byId("examination"), () => grip.release());
  let preset = HEALTHY;
  let values = valuesOf(preset);
  let masked = { torque: false, states: false };
  let isTouched = false;

  feel.setStates(data.states);
  makeSoundControls(byId("sound"), sound);
  addFeelSwitch(byId("sound"), feel);

  /** Says in one sentence what to do next. */
  function advise() {
    const blind = masked.states;
    const key = !isTouched ? "page.take" : blind ? "quiz.examine" : "page.examine";
    setText(byId("next"), text(key, { knee: titleOf(preset) }));
  }

  function examine(next, { blind, beside }) {
    preset = next;
    values = valuesOf(preset);
    masked = { torque: blind, states: blind };
    knee.begin(values);
    healthy.begin([]);
    grip.begin();
    sound.clear();
    // Whatever adds to the torque: the samples have the spring's own.
    const crepitus = crepitusOf((name) => values.get(data.ids[name]), false);
    inside.setKnee(blind ? null : crepitus, blind);
    byId("choice").hidden = blind;
    byId("healthy").hidden = !beside;
    byId("leg-name").hidden = !beside;
    setText(byId("leg-name"), beside ? titleOf(preset) : "");
    Object.assign(stats, { breaks: 0, peak: 0, states: 0 });
    advise();
  }

  let chosen = makeKnees(byId("knees"), (next) => {
    chosen = next;
    examine(next, { blind: false, beside: false });
  });
  makeQuiz(byId("quiz"), {
    show: (next, how) => examine(next ?? chosen, how),
    missed: (what) => missedOf(knee.engine, what),
  });
  examine(chosen, { blind: false, beside: false });
  onLanguage(advise);

  let wordsAt = 0;
  function showWords(now) {
    if (now - wordsAt < WORDS_MS) return;
    wordsAt = now;
    const { columns, begin, end } = knee.bins;
    const last = end - 1;
    if (last < begin) return;
    let breaks = 0;
    for (let i = Math.max(begin, end - BINS_A_SECOND); i < end; i++) breaks += columns.breaks[i];
    const { angle, torque } = inside.stateAt(columns, last, masked);
    setText(byId("angle"), number(angle, 1));
    setText(byId("speed"), number((columns.speedLow[last] + columns.speedHigh[last]) / 2));
    showSecret(byId("torque"), masked.torque, number(torque, 2));
    showSecret(byId("breaks"), masked.states, number(breaks));
    const pain = hurts(values, columns.states[last], angle) ? text("pain.hurts") : "";
    byId("pain").hidden = pain === "";
    setText(byId("pain"), pain);
    showExamination(knee.engine, preset, masked.states);
  }

  /** What came of the last bins. */
  function take(bins) {
    const { columns, end } = knee.bins;
    for (let i = end - bins; i < end; i++) {
      stats.breaks += columns.breaks[i];
      stats.states |= columns.states[i];
      stats.peak = Math.max(stats.peak, columns.torqueHigh[i], -columns.torqueLow[i]);
      feel.take(columns.breaks[i], columns.states[i]);
    }
  }

  let before = performance.now();
  function picture(now) {
    requestAnimationFrame(picture);
    const ms = Math.min(LONGEST_MS, Math.max(0, now - before));
    before = now;
    const { columns, begin, end } = knee.bins;
    const held = grip.at(now, end > begin ? columns.angleHigh[end - 1] : 0);
    if (grip.isUsed && !isTouched) {
      isTouched = true;
      advise();
    }
    const { samples, bins } = knee.step(ms, held);
    sound.push(knee.torques(samples));
    take(bins);
    inside.draw(now, knee.bins, masked);
    if (!byId("healthy").hidden) {
      healthy.step(ms, held);
      const { columns: others, end: last } = healthy.bins;
      if (last > 0) showHealthy(inside.stateAt(others, last - 1, BESIDE));
    }
    showWords(now);
    stats.pictures++;
    stats.samples += samples;
    stats.first ??= now;
  }
  requestAnimationFrame(picture);
  window.crepitusKnee = { stats, sound: sound.stats, engine: knee.engine, data, valuesOf };
}

start().catch((error) => {
  const line = byId("next");
  line.setAttribute("role", "alert");
  line.replaceChildren(text("page.failed"), " ", el("code", null, error.message));
});
