// Elements without innerHTML: whatever comes from the server stays text.

/** Returns the element with this id. */
export const byId = (id) => document.getElementById(id);

const SVG = "http://www.w3.org/2000/svg";

function fill(element, props, children) {
  for (const [name, value] of Object.entries(props ?? {})) {
    if (value === null || value === undefined || value === false) continue;
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (name === "value" || name === "checked" || name === "disabled") element[name] = value;
    else element.setAttribute(name, value === true ? "" : value);
  }
  element.append(...children.flat(3).filter((c) => c !== null && c !== undefined && c !== false));
  return element;
}

/** Makes an element: attributes, `on…` listeners, children (elements or text). */
export const el = (tag, props, ...children) => fill(document.createElement(tag), props, children);

/** Makes an SVG element. */
export const svg = (tag, props, ...children) => fill(document.createElementNS(SVG, tag), props, children);

/** Sets a text only where it differs, so that live regions do not repeat it. */
export function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

let serial = 0;
/** Returns an id that is used nowhere else. */
export const freshId = (stem) => `${stem}-${++serial}`;

/** A label over its field. */
export function field(label, input, hint) {
  input.id ||= freshId("field");
  const note = hint && el("small", { id: `${input.id}-hint` }, hint);
  if (note) input.setAttribute("aria-describedby", note.id);
  return el("div", { class: "field" }, el("label", { for: input.id }, label), input, note);
}

/** A check box or a radio button before its label. */
export const tick = (label, input) => el("label", { class: "tick" }, input, el("span", null, label));
