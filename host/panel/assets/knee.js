// The Knee tab: disorders as cards, severities as choices, and what belongs to
// the whole knee: saving, resetting, the drawer of parameters.

import { latest, on } from "./connection.js";
import { controlReason } from "./control.js";
import { byId, el, freshId, setText } from "./dom.js";
import { buildDrawer, updateDrawer } from "./drawer.js";
import { evidenceTag, FIRST_DISORDER, judgedLines } from "./labels.js";
import { disorderName, kneeName, presets, presetText } from "./names.js";
import { request } from "./report.js";
import { saveKnee } from "./save-knee.js";
import { onLanguage, text, textOr } from "./strings.js";

const chosen = new Map();
let cards = [];
let view = null;
let onDevice = null;

const LEVELS = [null, "mild", "moderate", "severe"];
const grade = (preset) => presetText(preset, "severity").split(":")[0];

// Where all presets are grades of one scale, the grade is enough of a name; the
// variant tells apart two of the same grade.
function choiceName(preset, all) {
  if (preset.own || all.some((other) => !other.own && !other.level)) return presetText(preset, "title");
  const twice = all.some((other) => other !== preset && grade(other) === grade(preset));
  const variant = preset.name.split("-").at(-1);
  return twice ? `${grade(preset)} · ${textOr(`variant.${variant}`, variant)}` : grade(preset);
}

// Mild before severe; the order of the scale stays within a level.
const byLevel = (a, b) => LEVELS.indexOf(a.level) - LEVELS.indexOf(b.level);

function describe(card, preset) {
  const source = preset.source ? text("knee.source", { source: preset.source }) : "";
  const feel = presetText(preset, "feel");
  card.about.replaceChildren(
    el("h4", null, presetText(preset, "title")),
    el("p", { class: "feel" }, feel && text("knee.feel", { feel })),
    el("p", null, presetText(preset, "severity")),
    el(
      "p",
      { class: "hint" },
      evidenceTag(preset.evidence),
      preset.own && el("span", { class: "tag" }, text("knee.own-preset")),
      " ",
      source,
    ),
    ...judgedLines(preset),
  );
  card.preset = preset;
}

function choose(card, preset) {
  chosen.set(card.disorder, preset.name);
  describe(card, preset);
}

const deviceTag = () => el("span", { class: "tag yes", hidden: true }, text("knee.on-device"));

function makeCard(disorder, list) {
  const name = freshId("severity");
  const card = { disorder, about: el("div", { class: "card-about" }) };
  const first = list.find((preset) => preset.name === chosen.get(disorder)) ?? list[0];
  card.choices = list.map((preset) => {
    const input = el("input", { type: "radio", name, value: preset.name, checked: preset === first });
    input.addEventListener("change", () => {
      choose(card, preset);
      update();
    });
    const root = el("label", { class: "severity" }, input, el("span", null, choiceName(preset, list)));
    return { preset, input, root };
  });
  const title = freshId("disorder");
  card.tag = deviceTag();
  card.apply = el("button", { type: "button", class: "apply" }, text("knee.apply"));
  card.add = el("button", { type: "button", class: "add" }, text("knee.add"));
  card.apply.addEventListener("click", () => request("apply", { preset: card.preset.name, add: false }));
  card.add.addEventListener("click", () => request("apply", { preset: card.preset.name, add: true }));
  const zero = latest.hello.disorders.find((entry) => entry.name === disorder)?.grade_0;
  card.root = el(
    "section",
    { class: "card", "data-disorder": disorder, "aria-labelledby": title },
    el("div", { class: "card-head" }, el("h3", { id: title }, disorderName(disorder)), card.tag),
    zero && el("p", { class: "hint" }, textOr(`grade0.${disorder}`, zero)),
    el(
      "fieldset",
      { class: "severities" },
      el("legend", { class: "hidden" }, text("knee.severity")),
      ...card.choices.map(({ root }) => root),
    ),
    card.about,
    el("div", { class: "row" }, card.apply, card.add),
  );
  describe(card, first);
  return card;
}

function healthyCard() {
  const preset = { name: "healthy" };
  const card = { disorder: "healthy", preset, choices: [], tag: deviceTag() };
  card.apply = el("button", { type: "button", class: "apply" }, text("knee.apply"));
  card.apply.addEventListener("click", () => request("apply", { preset: "healthy", add: false }));
  card.root = el(
    "section",
    { class: "card", "data-disorder": "healthy" },
    el("div", { class: "card-head" }, el("h3", null, text("knee.healthy")), card.tag),
    el("p", { class: "feel" }, text("knee.healthy-feel")),
    el("div", { class: "row" }, card.apply),
  );
  return card;
}

/** Builds the drawer when it is open: a hundred parameters take a tenth of the time until the first curve. */
function fillDrawer() {
  if (byId("drawer").open && !view.drawer.hasChildNodes()) buildDrawer(view.drawer);
}

function build() {
  if (!latest.hello) return;
  const open = byId("drawer")?.open ?? false;
  const known = latest.hello.disorders.map((disorder) => disorder.name);
  const groups = known.map((name) => [
    name,
    presets()
      .filter((preset) => preset.disorder === name)
      .sort(byLevel),
  ]);
  groups.push(["", presets().filter((preset) => !known.includes(preset.disorder))]);
  const [first, others] = [true, false].map((isFirst) =>
    groups
      .filter(([name, list]) => list.length && (name === FIRST_DISORDER) === isFirst)
      .map(([name, list]) => makeCard(name, list)),
  );
  cards = [...first, healthyCard(), ...others];
  onDevice = null;
  view = {
    why: el("p", { class: "hint" }),
    now: el("p"),
    reset: el(
      "button",
      { type: "button", onclick: () => request("reset", {}, text("knee.reset-done")) },
      text("knee.reset"),
    ),
    save: el(
      "button",
      { type: "button", onclick: () => request("save", {}, text("knee.saved")) },
      text("knee.save"),
    ),
    preset: el("button", { type: "button", id: "save-preset", onclick: saveKnee }, text("preset.save-as")),
    drawer: el("div", { class: "drawer" }),
  };
  const drawer = el(
    "details",
    { id: "drawer", open, ontoggle: fillDrawer },
    el("summary", null, text("drawer.title")),
    view.drawer,
  );
  byId("knee").replaceChildren(
    el(
      "div",
      { class: "card" },
      el("h2", null, text("knee.title")),
      view.now,
      el("div", { class: "row" }, view.reset, view.save, view.preset),
      view.why,
    ),
    drawer,
    el("div", { class: "cards" }, ...cards.map((card) => card.root)),
  );
  fillDrawer();
  update();
}

function update() {
  if (!view) return;
  const hidden = latest.parameters?.hidden === true;
  const why = controlReason() || (hidden ? text("why.blind") : "");
  setText(view.why, why ? text("knee.disabled", { why }) : "");
  const unsaved = latest.parameters?.saved === false ? ` · ${text("knee.unsaved")}` : "";
  setText(view.now, text("knee.now", { knee: kneeName() }) + unsaved);
  for (const button of [view.reset, view.save, view.preset]) button.disabled = why !== "";
  const preset = (!hidden && latest.parameters?.preset) || null;
  const isOther = preset !== onDevice;
  onDevice = preset;
  for (const card of cards) {
    card.apply.disabled = why !== "";
    if (card.add) card.add.disabled = why !== "";
    // The card of the knee that comes onto the device shows it; what is chosen on the others waits.
    for (const choice of card.choices) {
      const isCurrent = choice.preset.name === preset;
      choice.root.classList.toggle("current", isCurrent);
      if (isCurrent && isOther) {
        choice.input.checked = true;
        choose(card, choice.preset);
      }
    }
    const isShown = preset !== null && card.preset.name === preset;
    const current = isShown || card.choices.some((choice) => choice.preset.name === preset);
    card.root.classList.toggle("current", current);
    card.tag.hidden = !current;
    setText(card.apply, text(isShown ? "knee.applied" : "knee.apply"));
  }
  updateDrawer();
}

/** Starts the Knee tab. */
export function startKnee() {
  for (const kind of ["hello", "presets"]) on(kind, build);
  for (const kind of ["parameters", "holder", "status", "open", "lost", "lesson"]) on(kind, update);
  onLanguage(build);
}
