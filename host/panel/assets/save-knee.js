// The dialog that saves the knee on the device: a name is enough, the rest has a default or is left out.

import { latest } from "./connection.js";
import { askForm } from "./dialogs.js";
import { el, field, tick } from "./dom.js";
import { disorderName, presetOf, presets } from "./names.js";
import { request, say } from "./report.js";
import { text } from "./strings.js";

/** The disorder of the knee on the device: that of its preset, or of its first effect. */
function likelyDisorder() {
  const { hello, parameters } = latest;
  const preset = presetOf(parameters.preset);
  if (preset?.disorder) return preset.disorder;
  const values = new Map(parameters.values);
  const switches = hello.parameters.filter(({ key, id }) => key === "render" && values.get(id));
  const on = switches.map(({ group }) => group);
  const similar = presets().find(({ own, effects }) => !own && on.includes(effects[0]));
  return similar?.disorder ?? "";
}

/** The saved knee of this title; of several the first, whose name has no number. */
function named(title) {
  const same = presets().filter((preset) => preset.own && preset.title === title.trim());
  return same.sort((a, b) => a.name.length - b.name.length)[0];
}

/** Asks for a name, and saves the knee; its file is named by the program. */
export async function saveKnee() {
  const title = el("input", { name: "title", required: true, maxlength: 60, autocomplete: "off" });
  const replace = el("input", { type: "checkbox", name: "replace" });
  const replaceLine = tick(text("preset.replace"), replace);
  replaceLine.hidden = true;
  title.addEventListener("input", () => (replaceLine.hidden = !named(title.value)));
  const disorders = latest.hello.disorders.map(({ name }) =>
    el("option", { value: name }, disorderName(name)),
  );
  const disorder = el(
    "select",
    { name: "disorder" },
    disorders,
    el("option", { value: "" }, text("preset.no-disorder")),
  );
  disorder.value = likelyDisorder();
  const data = await askForm(
    text("preset.save-title"),
    [
      field(text("preset.title"), title),
      replaceLine,
      field(text("preset.disorder"), disorder),
      el(
        "details",
        null,
        el("summary", null, text("preset.more")),
        field(text("preset.severity"), el("input", { name: "severity", maxlength: 100 })),
        field(text("preset.feel"), el("textarea", { name: "feel", rows: 2, maxlength: 120 })),
        field(text("preset.source"), el("input", { name: "source", maxlength: 200 })),
      ),
    ],
    text("preset.save"),
  );
  if (!data) return;
  const get = (key) => String(data.get(key) ?? "").trim();
  const before = data.has("replace") && named(get("title"));
  const saved = await request("save-preset", {
    name: before ? before.name : "",
    title: get("title"),
    feel: get("feel"),
    severity: get("severity"),
    source: get("source"),
    disorder: get("disorder") || null,
    replace: Boolean(before),
  });
  if (saved) say(text("preset.saved", { title: get("title"), file: `${saved.name}.toml` }));
}
