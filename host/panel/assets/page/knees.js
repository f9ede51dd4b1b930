// The choice of a knee: presets by name, in the order in which they are taught, with what is to be felt and how well
// its numbers are known.

import { el, freshId, setText } from "../dom.js";
import { evidenceTag, FIRST_DISORDER, judgedLines, presetText } from "../labels.js";
import { onLanguage, text, textOr } from "../strings.js";
import { data } from "./data.js";

/** A knee without a disorder. */
export const HEALTHY = { name: "healthy", disorder: "healthy", values: [], effects: [], signs: [] };

const START = "coarse";

/** The name of a knee. */
export const titleOf = (preset) =>
  preset === HEALTHY ? text("knee.healthy") : presetText(preset, "title");

/** The heading of a disorder. */
export function disorderOf(name) {
  if (name === HEALTHY.disorder) return text("knee.healthy");
  const heading = data.disorders.find((disorder) => disorder.name === name)?.heading;
  return textOr(`disorder.${name}`, heading ?? name);
}

/** The disorders, in the order in which they are offered. */
export function disorders() {
  const names = data.disorders.map(({ name }) => name);
  return [FIRST_DISORDER, ...names.filter((name) => name !== FIRST_DISORDER)];
}

/** What a knee is, in words. */
export function describe(preset) {
  if (preset === HEALTHY) return [el("p", { class: "feel" }, text("page.healthy"))];
  return [
    el("p", { class: "feel" }, text("knee.feel", { feel: presetText(preset, "feel") })),
    el("p", null, presetText(preset, "severity")),
    el(
      "p",
      { class: "hint" },
      evidenceTag(preset.evidence),
      " ",
      text("knee.source", { source: preset.source }),
    ),
    ...judgedLines(preset),
  ];
}

/** The choice in a box. `choose(preset)` is called with each; the one at the start is returned. */
export function makeKnees(host, choose) {
  const id = freshId("knee");
  const label = el("label", { for: id });
  const select = el("select", { id });
  const about = el("div", { class: "card-about" });
  const presetOf = (name) => data.presets.find((preset) => preset.name === name) ?? HEALTHY;
  const offer = (chosen) => {
    const option = (preset) => el("option", { value: preset.name }, titleOf(preset));
    const groups = disorders().map((name) => {
      const list = data.presets.filter((preset) => preset.disorder === name);
      return el("optgroup", { label: disorderOf(name) }, ...list.map(option));
    });
    select.replaceChildren(option(HEALTHY), ...groups);
    select.value = chosen;
    setText(label, text("page.knee"));
    about.replaceChildren(...describe(presetOf(chosen)));
  };
  select.addEventListener("change", () => {
    about.replaceChildren(...describe(presetOf(select.value)));
    choose(presetOf(select.value));
  });
  host.replaceChildren(el("div", { class: "field wide" }, label, select), about);
  onLanguage(() => offer(select.value));
  offer(START);
  return presetOf(START);
}
