// The Knee tab: disorders as cards, severities as choices, and what belongs to
// the whole knee: saving, resetting, the drawer of parameters.

import { latest, on } from "./connection.js";
import { controlReason } from "./control.js";
import { askForm } from "./dialogs.js";
import { byId, el, field, freshId, setText, tick } from "./dom.js";
import { buildDrawer, updateDrawer } from "./drawer.js";
import { evidenceTag } from "./labels.js";
import { disorderName, kneeName, presets, presetText } from "./names.js";
import { request } from "./report.js";
import { onLanguage, text, textOr } from "./strings.js";

const chosen = new Map();
let cards = [];
let view = null;

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
  card.about.replaceChildren(
    el("h4", null, presetText(preset, "title")),
    el("p", { class: "feel" }, text("knee.feel", { feel: presetText(preset, "feel") })),
    el("p", null, presetText(preset, "severity")),
    el(
      "p",
      { class: "hint" },
      evidenceTag(preset.evidence),
      preset.own && el("span", { class: "tag" }, text("knee.own-preset")),
      " ",
      source,
    ),
  );
  card.preset = preset;
}

function makeCard(disorder, list) {
  const name = freshId("severity");
  const card = { disorder, about: el("div", { class: "card-about" }) };
  const first = list.find((preset) => preset.name === chosen.get(disorder)) ?? list[0];
  const choices = list.map((preset) => {
    const input = el("input", { type: "radio", name, value: preset.name, checked: preset === first });
    input.addEventListener("change", () => {
      chosen.set(disorder, preset.name);
      describe(card, preset);
      update();
    });
    return el("label", { class: "severity" }, input, el("span", null, choiceName(preset, list)));
  });
  const title = freshId("disorder");
  card.apply = el("button", { type: "button", class: "primary apply" }, text("knee.apply"));
  card.add = el("button", { type: "button", class: "add" }, text("knee.add"));
  card.apply.addEventListener("click", () => request("apply", { preset: card.preset.name, add: false }));
  card.add.addEventListener("click", () => request("apply", { preset: card.preset.name, add: true }));
  const zero = latest.hello.disorders.find((entry) => entry.name === disorder)?.grade_0;
  card.root = el(
    "section",
    { class: "card", "data-disorder": disorder, "aria-labelledby": title },
    el("h3", { id: title }, disorderName(disorder)),
    zero && el("p", { class: "hint" }, textOr(`grade0.${disorder}`, zero)),
    el(
      "fieldset",
      { class: "severities" },
      el("legend", { class: "hidden" }, text("knee.severity")),
      ...choices,
    ),
    card.about,
    el("div", { class: "row" }, card.apply, card.add),
  );
  describe(card, first);
  return card;
}

function healthyCard() {
  const card = { disorder: "healthy", preset: { name: "healthy" } };
  card.apply = el("button", { type: "button", class: "primary apply" }, text("knee.apply"));
  card.apply.addEventListener("click", () => request("apply", { preset: "healthy", add: false }));
  card.root = el(
    "section",
    { class: "card", "data-disorder": "healthy" },
    el("h3", null, text("knee.healthy")),
    el("p", { class: "feel" }, text("knee.healthy-feel")),
    el("div", { class: "row" }, card.apply),
  );
  return card;
}

async function savePreset() {
  const title = el("input", { name: "title", required: true, maxlength: 80 });
  const name = el("input", {
    name: "name",
    required: true,
    maxlength: 40,
    pattern: "[a-z0-9]+(-[a-z0-9]+)*",
  });
  // The name follows the title until it is written by hand.
  let typed = false;
  name.addEventListener("input", () => (typed = true));
  title.addEventListener("input", () => {
    if (!typed)
      name.value = title.value
        .toLowerCase()
        .replace(/[^a-z0-9]+/g, "-")
        .replace(/^-|-$/g, "")
        .slice(0, 40);
  });
  const disorders = latest.hello.disorders.map(({ name }) =>
    el("option", { value: name }, disorderName(name)),
  );
  const data = await askForm(
    text("preset.save-title"),
    [
      field(text("preset.title"), title),
      field(text("preset.name"), name, text("preset.name-hint")),
      field(
        text("preset.disorder"),
        el("select", { name: "disorder" }, el("option", { value: "" }, disorderName("")), disorders),
      ),
      field(text("preset.severity"), el("input", { name: "severity", maxlength: 120 })),
      field(text("preset.feel"), el("textarea", { name: "feel", rows: 2, maxlength: 300 })),
      field(text("preset.source"), el("input", { name: "source", maxlength: 300 })),
      tick(text("preset.replace"), el("input", { type: "checkbox", name: "replace" })),
    ],
    text("preset.save"),
  );
  if (!data) return;
  const get = (key) => String(data.get(key) ?? "").trim();
  await request(
    "save-preset",
    {
      name: get("name"),
      title: get("title"),
      feel: get("feel"),
      severity: get("severity"),
      source: get("source"),
      disorder: get("disorder") || null,
      replace: data.has("replace"),
    },
    text("preset.saved", { title: get("title") }),
  );
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
  cards = [
    healthyCard(),
    ...groups.filter(([, list]) => list.length).map(([name, list]) => makeCard(name, list)),
  ];
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
    preset: el("button", { type: "button", id: "save-preset", onclick: savePreset }, text("preset.save-as")),
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
  const preset = latest.parameters?.preset;
  for (const card of cards) {
    card.apply.disabled = why !== "";
    if (card.add) card.add.disabled = why !== "";
    const current =
      !hidden &&
      (card.disorder === "healthy"
        ? kneeName() === text("knee.healthy")
        : Boolean(preset) && card.preset.name === preset);
    card.root.classList.toggle("current", current);
    setText(card.apply, text(current ? "knee.applied" : "knee.apply"));
  }
  updateDrawer();
}

/** Starts the Knee tab. */
export function startKnee() {
  on("hello", (hello) => {
    // Presets that were saved before this greeting are in its own list.
    latest.presets = hello.presets;
    build();
  });
  on("presets", build);
  for (const kind of ["parameters", "holder", "status", "open", "lost", "lesson"]) on(kind, update);
  onLanguage(build);
}
