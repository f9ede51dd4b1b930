// The Experiment tab, loaded where the panel has protocols: the setup, or the session that is held.

import { latest, on } from "./connection.js";
import { byId } from "./dom.js";
import { pressKey, showSession, updateSession } from "./experiment-run.js";
import { loadSetup, showSetup, updateSetup } from "./experiment-setup.js";
import { onLanguage } from "./strings.js";
import { onTab, showTab } from "./tabs.js";

let shown = null;
let hasLooked = false;

/** Shows a session that is held when the page is loaded: it goes on. */
function look() {
  if (hasLooked || !("experiment" in latest)) return;
  hasLooked = true;
  if (latest.experiment) showTab("experiment");
}

/** What is built anew when it changes; all else is updated, so that nothing that was entered is lost. */
function viewOf(session) {
  if (!session) return "setup";
  const { participant, session: number, trial } = session;
  return JSON.stringify([participant, number, trial?.number, trial?.described]);
}

function render(force = false) {
  const session = latest.experiment ?? null;
  const view = viewOf(session);
  const changed = force || view !== shown;
  const follows = shown !== null && shown !== "setup";
  shown = view;
  const host = byId("experiment");
  if (session) changed ? showSession(host, session, follows) : updateSession(session);
  else if (changed) {
    showSetup(host);
    loadSetup(host);
  } else updateSetup();
}

/** Starts the Experiment tab. */
export function startExperiment() {
  for (const kind of ["experiment", "status", "holder", "open", "lost"]) on(kind, () => render());
  on("hello", () => render(!latest.experiment));
  onTab((name) => name === "experiment" && shown === "setup" && loadSetup(byId("experiment")));
  onLanguage(() => render(true));
  addEventListener("keydown", pressKey);
  on("experiment", look);
  render(true);
  look();
}
