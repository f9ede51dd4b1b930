// Texts for people: one file a language, English where one lacks a text.

import { store, stored } from "./storage.js";

const LANGUAGES = { en: "English", de: "Deutsch" };
const listeners = [];
let english = {};
let chosen = {};
let language = "en";

const fetched = async (name) => (await fetch(`strings/${name}.json`)).json();
let load = fetched;

/** Returns the text of a key; `{name}` in it stands for `values.name`. */
export function text(key, values = {}) {
  const found = chosen[key] ?? english[key] ?? key;
  return found.replace(/\{(\w+)\}/g, (whole, name) => values[name] ?? whole);
}

/** Returns the text of a key, or else a text that the server sent. */
export const textOr = (key, fallback) => chosen[key] ?? english[key] ?? fallback;

// To make one takes longer than all the rest of a number's text.
const formats = new Map();
function format(digits) {
  const key = `${language} ${digits}`;
  if (!formats.has(key)) {
    const options = { minimumFractionDigits: digits, maximumFractionDigits: digits };
    formats.set(key, new Intl.NumberFormat(language, options));
  }
  return formats.get(key);
}

/** A number as this language writes it. */
export function number(value, digits = 0) {
  if (!Number.isFinite(value)) return "–";
  const scale = 10 ** digits;
  // No "−0.00".
  const rounded = Math.round(value * scale) / scale || 0;
  return format(digits).format(rounded).replace("-", "−");
}

/** A value of any size, with six significant digits at most. */
export function plain(value) {
  if (!Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-3 || size >= 1e6)) return String(Number(value.toPrecision(6)));
  return value.toLocaleString(language, { maximumSignificantDigits: 6, useGrouping: false });
}

/** Fills the static texts of the page. */
function fillTexts() {
  for (const at of document.querySelectorAll("[data-text]")) at.textContent = text(at.dataset.text);
  for (const at of document.querySelectorAll("[data-label]"))
    at.setAttribute("aria-label", text(at.dataset.label));
}

/** Calls this whenever another language is chosen. */
export const onLanguage = (listener) => listeners.push(listener);

async function choose(name) {
  chosen = name === "en" ? english : await load(name);
  language = name;
  document.documentElement.lang = name;
  document.title = text(document.documentElement.dataset.title ?? "title");
  fillTexts();
  for (const listener of listeners) listener();
}

/** Loads the texts, and offers the languages in this `<select>`; those that a page has in itself, or all. */
export async function startStrings(select, own = null) {
  if (own) load = (name) => own[name] ?? {};
  const names = Object.keys(own ?? LANGUAGES);
  const wish = stored("language") ?? navigator.language.slice(0, 2);
  const name = names.includes(wish) ? wish : names[0];
  for (const value of names) select.append(new Option(LANGUAGES[value], value));
  select.hidden = names.length < 2;
  select.value = name;
  select.addEventListener("change", () => {
    store("language", select.value);
    choose(select.value);
  });
  english = await load("en");
  await choose(name);
}
