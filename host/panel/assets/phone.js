// The header of a phone's page: state and stop, and what is wrong with its link.

import { keyFault, latest, on } from "./connection.js";
import { byId, el, setText } from "./dom.js";
import { startStop } from "./stop.js";
import { number, onLanguage, startStrings, text, textOr } from "./strings.js";

let link = "connecting";
let silentFor = 0;

function showState() {
  const { status } = latest;
  const device = status?.link === "lost" ? "device-lost" : (status?.state ?? "connecting");
  const name = link === "open" ? device : link;
  const chip = byId("state");
  setText(chip, textOr(`device.state.${name}`, name).replace("{seconds}", number(silentFor, 1)));
  chip.dataset.state = name;
  byId("stop").classList.toggle("live", name === "armed" || name === "arming");
}

function setLink(name) {
  link = name;
  showState();
}

/** Starts the page of a phone; `render` shows all that is below the header. */
export async function startPhone(render) {
  await startStrings(byId("language"));
  startStop();
  on("open", () => setLink("open"));
  on("heard", () => setLink("open"));
  on("lost", () => setLink("connection-lost"));
  on("silent", (seconds) => {
    silentFor = Math.max(0.5, Math.floor(seconds * 2) / 2);
    setLink("silent");
  });
  on("refused", () => {
    setLink("refused");
    byId("main").replaceChildren(el("p", { class: "fault", role: "alert" }, text(`refused.${keyFault()}`)));
  });
  on("status", showState);
  onLanguage(() => {
    showState();
    render();
  });
  showState();
}
