// Names of what a preset is, in the chosen language, without a server.

import { el } from "./dom.js";
import { text, textOr } from "./strings.js";

/** A text of a preset: `title`, `feel` or `severity`. */
export const presetText = (preset, what) =>
  preset.own ? preset[what] : textOr(`preset.${preset.name}.${what}`, preset[what]);

/** The name of a severity. */
export const levelName = (level) => (level ? textOr(`level.${level}`, level) : "–");

/** A tag that says how well the numbers of a preset are known. */
export const evidenceTag = (evidence) =>
  evidence && el("span", { class: `tag ${evidence}` }, text(`evidence.${evidence}`));
