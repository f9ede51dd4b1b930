// Tabs after the ARIA pattern: arrow keys, Home, End. On a wide screen the
// live part stands beside them and is no tab.

import { byId } from "./dom.js";

const NAMES = ["live", "knee", "lesson", "experiment", "recordings"];
const wide = matchMedia("(min-width: 1100px)");
let chosen = "knee";
let replay = false;
let experiments = false;
const listeners = [];

const tabOf = (name) => byId(`tab-${name}`);
const offered = () =>
  NAMES.filter(
    (name) =>
      !(name === "live" && (wide.matches || replay)) &&
      !(name === "experiment" && !experiments) &&
      !(replay && name !== "recordings"),
  );

/** Calls this with the name of a tab that is shown. */
export const onTab = (listener) => listeners.push(listener);

function update() {
  const names = offered();
  const shown = names.includes(chosen) ? chosen : names[0];
  for (const name of NAMES) {
    const tab = tabOf(name);
    const panel = byId(name);
    tab.hidden = !names.includes(name);
    tab.setAttribute("aria-selected", String(name === shown));
    tab.tabIndex = name === shown ? 0 : -1;
    if (name === "live") {
      const beside = wide.matches && !replay;
      panel.hidden = replay || !(beside || shown === "live");
      panel.setAttribute("role", beside ? "region" : "tabpanel");
      panel.setAttribute("aria-labelledby", "tab-live");
    } else {
      panel.hidden = name !== shown;
    }
  }
  document.body.classList.toggle("replay", replay);
  for (const listener of listeners) listener(shown);
}

/** Shows a tab. */
export function showTab(name) {
  chosen = name;
  update();
}

/** Offers the tab for experiments, or not. */
export function setExperiments(has) {
  experiments = has;
  update();
}

/** With a file instead of a device there are only recordings. */
export function setReplay(is) {
  replay = is;
  if (is) chosen = "recordings";
  update();
}

/** Starts the tabs; the live one is first on a narrow screen. */
export function startTabs() {
  chosen = wide.matches ? "knee" : "live";
  for (const name of NAMES) tabOf(name).addEventListener("click", () => showTab(name));
  document.querySelector("[role=tablist]").addEventListener("keydown", (event) => {
    const names = offered();
    const at = names.findIndex((name) => tabOf(name) === event.target);
    const to = { ArrowRight: at + 1, ArrowLeft: at - 1, Home: 0, End: names.length - 1 }[event.key];
    if (at < 0 || to === undefined) return;
    event.preventDefault();
    const name = names[(to + names.length) % names.length];
    showTab(name);
    tabOf(name).focus();
  });
  wide.addEventListener("change", update);
  byId("enlarge").addEventListener("click", () => {
    const on = document.body.classList.toggle("enlarged");
    byId("enlarge").setAttribute("aria-pressed", String(on));
  });
  update();
}
