// Names of what a preset is, and values that may be hidden, in the chosen language, without a server.

import { el, setText } from "./dom.js";
import { text, textOr } from "./strings.js";

/** The disorder that is offered first: the project is named for it. */
export const FIRST_DISORDER = "crepitus";

/** A text of a preset: `title`, `feel` or `severity`; one of the user's own need not have any. */
export const presetText = (preset, what) =>
  preset.own
    ? (preset[what] ?? (what === "title" ? preset.name : ""))
    : textOr(`preset.${preset.name}.${what}`, preset[what]);

/** The name of a severity. */
export const levelName = (level) => (level ? textOr(`level.${level}`, level) : "–");

/** A tag that says how well the numbers of a preset are known. */
export const evidenceTag = (evidence) =>
  evidence && el("span", { class: `tag ${evidence}` }, text(`evidence.${evidence}`));

/** Shows a value, or that it is hidden. */
export function showSecret(output, isSecret, value) {
  output.classList.toggle("secret", isSecret);
  setText(output, isSecret ? text("hidden") : value);
}

/** What clinicians found about a preset, a line a study. */
export const judgedLines = (preset) =>
  (preset.judged ?? []).map((judged) => el("p", { class: "hint" }, text("knee.judged", { judged })));
