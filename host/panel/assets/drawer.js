// The drawer: every parameter with range, unit, meaning and default. Edits
// collect here and go to the device as one commit.

import { latest } from "./connection.js";
import { controlReason } from "./control.js";
import { el, field, freshId, setText } from "./dom.js";
import { request } from "./report.js";
import { plain, text, textOr } from "./strings.js";

const edits = new Map();
let rows = [];
let view = null;

// The key without its unit, which stands behind the field.
const UNIT = /_(nms?_per_rad2?|nm_per_[as]|n_per_a|nm|deg|deg_s|rad_s|kg_m2|hz|ohm|mm|[ghjmsvwa])$/;
const label = (parameter) => parameter.key.replace(UNIT, "").replaceAll("_", " ");
const shown = (parameter, value) => (parameter.choices ? (parameter.choices[value] ?? "–") : plain(value));

function describe(parameter) {
  const unit = parameter.unit ? ` ${parameter.unit}` : "";
  const range = parameter.choices
    ? parameter.choices.join(", ")
    : text("drawer.range", { min: plain(parameter.min), max: plain(parameter.max) + unit });
  return `${parameter.meaning} · ${range} · ${text("drawer.default", { value: shown(parameter, parameter.default) + unit })}`;
}

function makeRow(parameter) {
  const id = freshId("parameter");
  const input = parameter.choices
    ? el("select", { id }, ...parameter.choices.map((choice, i) => el("option", { value: i }, choice)))
    : el("input", { id, type: "number", min: parameter.min, max: parameter.max, step: "any" });
  input.setAttribute("aria-describedby", `${id}-about ${id}-mark`);
  const mark = el("span", { id: `${id}-mark`, class: "hint" });
  const root = el(
    "div",
    { class: "parameter", "data-parameter": parameter.name },
    el("label", { for: id }, label(parameter)),
    el("span", { class: "value" }, input, el("span", { class: "unit" }, parameter.unit ?? "")),
    el(
      "p",
      { class: "hint", id: `${id}-about` },
      describe(parameter),
      el("br"),
      el("code", null, parameter.name),
      " ",
      mark,
    ),
  );
  input.addEventListener("input", () => {
    const value = parameter.choices ? Number(input.value) : input.valueAsNumber;
    const now = valueOf(parameter.id);
    if (value === now) edits.delete(parameter.id);
    else edits.set(parameter.id, value);
    updateDrawer();
  });
  const words =
    `${parameter.name} ${label(parameter)} ${parameter.meaning} ${textOr(`group.${parameter.group}`, "")}`.toLowerCase();
  return { parameter, input, mark, root, words };
}

let source = null;
let values = new Map();
const valueOf = (id) => values.get(id);

function search() {
  const wanted = view.search.value.trim().toLowerCase();
  for (const group of view.groups) {
    let found = 0;
    for (const row of group.rows) {
      row.root.hidden = !row.words.includes(wanted);
      if (!row.root.hidden) found++;
    }
    group.root.hidden = found === 0;
    if (wanted) group.root.open = found > 0;
  }
  const total = rows.filter((row) => !row.root.hidden).length;
  setText(view.found, wanted ? text("drawer.found", { count: total }) : "");
}

async function send() {
  const changes = [...edits];
  if (!(await request("set", { changes }, text("drawer.applied", { count: changes.length })))) return;
  // What was typed meanwhile stays an edit.
  for (const [id, value] of changes) if (edits.get(id) === value) edits.delete(id);
  updateDrawer();
}

/** Builds the drawer into a box. */
export function buildDrawer(host) {
  const { groups, parameters } = latest.hello;
  const search_ = el("input", { type: "search", value: view?.search.value ?? "", oninput: search });
  rows = [];
  const made = groups.map((group) => {
    const own = parameters.filter((parameter) => parameter.group === group.name).map(makeRow);
    rows.push(...own);
    const count = el("span", { class: "hint" });
    const title = textOr(`group.${group.name}`, group.name);
    const root = el(
      "details",
      { "data-group": group.name },
      el("summary", null, title, " ", el("span", { class: "tag" }, text(`kind.${group.kind}`)), " ", count),
      ...own.map((row) => row.root),
    );
    return { rows: own, root, count };
  });
  view = {
    search: search_,
    found: el("p", { class: "hint", role: "status" }),
    groups: made.filter((group) => group.rows.length),
    apply: el("button", { type: "button", class: "primary", id: "apply-edits", onclick: send }),
    discard: el("button", {
      type: "button",
      onclick: () => {
        edits.clear();
        updateDrawer();
      },
    }),
    problem: el("span", { class: "problem" }),
  };
  view.bar = el("div", { class: "pending-bar" }, view.apply, view.discard, view.problem);
  host.replaceChildren(
    field(text("drawer.search"), view.search),
    view.found,
    ...view.groups.map((group) => group.root),
    view.bar,
  );
  search();
  updateDrawer();
}

function updateRow(row, why, armed) {
  const { parameter, input, mark, root } = row;
  const value = valueOf(parameter.id);
  const pending = edits.has(parameter.id);
  const known = value !== undefined;
  // What is being typed stays as it is.
  const show = String(pending ? edits.get(parameter.id) : known ? tidy(value) : "");
  if (document.activeElement !== input && input.value !== show && !(pending && show === "NaN"))
    input.value = show;
  const locked = parameter.only_disarmed && armed;
  input.disabled = why !== "" || locked || !known;
  const differs = known && tidy(value) !== tidy(parameter.default);
  root.classList.toggle("differs", differs && !pending);
  root.classList.toggle("pending", pending);
  const words = [];
  if (pending) words.push(text("drawer.pending", { value: shown(parameter, value) }));
  else if (differs) words.push(text("drawer.differs"));
  if (locked) words.push(text("drawer.locked"));
  else if (parameter.only_disarmed) words.push(text("drawer.only-disarmed"));
  setText(mark, words.join(" · "));
  return { differs, pending };
}

// The device computes with single precision: 0.1 comes back as 0.10000000149.
const tidy = (value) => Number(value.toPrecision(7));

/** Shows the newest values; edits that are pending stay. */
export function updateDrawer() {
  if (!view) return;
  const parameters = latest.parameters;
  if (parameters?.hidden) {
    values = new Map();
    edits.clear();
    source = parameters;
  } else if (parameters && parameters !== source) {
    values = new Map(parameters.values);
    source = parameters;
  }
  const why = controlReason();
  const state = latest.status?.state;
  const armed = state === "armed" || state === "arming";
  for (const group of view.groups) {
    let differ = 0;
    let pending = 0;
    for (const row of group.rows) {
      const is = updateRow(row, why, armed);
      if (is.differs) differ++;
      if (is.pending) pending++;
    }
    const words = [];
    if (differ) words.push(text("drawer.count-differs", { count: differ }));
    if (pending) words.push(text("drawer.count-pending", { count: pending }));
    setText(group.count, words.join(", "));
  }
  const bad = rows.filter(({ parameter, input }) => edits.has(parameter.id) && !input.checkValidity());
  const empty = [...edits.values()].some((value) => !Number.isFinite(value));
  view.bar.hidden = edits.size === 0;
  setText(view.apply, text("drawer.apply", { count: edits.size }));
  setText(view.discard, text("drawer.discard"));
  view.apply.disabled = why !== "" || bad.length > 0 || empty;
  const problem = bad.length
    ? text("drawer.bad", { name: label(bad[0].parameter) })
    : empty
      ? text("drawer.empty")
      : why;
  setText(view.problem, problem);
}
