// Setting up a session: protocol, pseudonym, consent; sessions that were interrupted; results.

import { latest } from "./connection.js";
import { controlReason } from "./control.js";
import { el, field, freshId, setText, tick } from "./dom.js";
import { openOffered, request } from "./report.js";
import { text } from "./strings.js";

// What was entered stays when the view is built again.
const entered = { file: null, participant: "" };
let list = null;
let view = null;

const chosen = () => list.protocols.find((protocol) => protocol.file === entered.file && !protocol.error);

async function begin(file, participant, consented) {
  const begun = await request("experiment", { step: "begin", file, participant, consented });
  if (begun) entered.participant = "";
}

function submit(event) {
  event.preventDefault();
  const protocol = chosen();
  const participant = entered.participant.trim();
  const isPseudonym = /^(?=.*\d)[a-z\d][a-z\d-]{0,23}$/i.test(participant);
  const problem = !protocol
    ? "experiment.no-protocol"
    : !isPseudonym
      ? "experiment.bad-participant"
      : protocol.consent && !view.consented.checked
        ? "experiment.no-consent"
        : "";
  setText(view.problem, problem && text(problem));
  if (!problem) begin(protocol.file, participant, protocol.consent?.sha256 ?? null);
}

function showConsent() {
  const consent = chosen()?.consent;
  view.consent.hidden = !consent;
  setText(view.consentText, consent?.text ?? "");
  view.consented.checked = false;
}

function protocolChoice(protocol) {
  const { file, title, kind, question, error } = protocol;
  if (error) return el("p", { class: "problem" }, error);
  const id = freshId("about");
  const input = el("input", {
    type: "radio",
    name: "protocol",
    value: file,
    checked: entered.file === file,
    "aria-describedby": id,
  });
  input.addEventListener("change", () => {
    entered.file = file;
    showConsent();
  });
  const about = [text(`experiment.kind-${kind}`), question, file].filter(Boolean).join(" · ");
  return el("div", null, tick(title, input), el("p", { class: "hint", id }, about));
}

function unfinishedItem({ file, title, participant, answered }) {
  const facts = text("experiment.unfinished-facts", { title, participant, answered });
  const resume = el("button", { type: "button", onclick: () => begin(file, participant, null) });
  setText(resume, text("setup.continue"));
  resume.setAttribute("aria-label", `${text("setup.continue")}: ${facts}`);
  if (file) view.resume.push(resume);
  const gone = el("span", { class: "hint" }, text("experiment.protocol-gone"));
  return el("li", null, el("span", { class: "grow" }, facts), file ? resume : gone);
}

/** The part on results: for those who run the study, never while a session is going on. */
export function resultsCard(study) {
  return el(
    "section",
    { class: "card", "aria-labelledby": "experiment-results-title" },
    el("h3", { id: "experiment-results-title" }, text("experiment.results")),
    el("p", { class: "hint" }, text("experiment.results-hint")),
    el(
      "div",
      { class: "row" },
      el(
        "button",
        { type: "button", id: "experiment-results", onclick: () => openOffered("experiment-results") },
        text("experiment.open-results"),
      ),
    ),
    el("p", { class: "hint" }, text("experiment.data", { study })),
  );
}

/** Builds the setup from the list of protocols, once it is here. */
export function showSetup(host) {
  if (!list) return host.replaceChildren(el("p", { class: "hint" }, text("recordings.loading")));
  const { protocols, unfinished, problem, folder, study } = list;
  entered.file ??= protocols.find(({ error }) => !error)?.file ?? null;
  view = {
    resume: [],
    why: el("p", { class: "hint" }),
    problem: el("p", { class: "problem", role: "alert" }),
    begin: el("button", { class: "primary", id: "experiment-begin" }, text("experiment.begin")),
    consentText: el("div", { class: "consent", tabindex: 0, role: "group", "aria-label": text("experiment.consent") }),
    consented: el("input", { type: "checkbox", id: "experiment-consented" }),
  };
  const participant = el("input", { value: entered.participant, maxlength: 24, autocomplete: "off" });
  participant.addEventListener("input", () => (entered.participant = participant.value));
  view.consent = el("div", null, view.consentText, tick(text("experiment.consented"), view.consented));
  const items = unfinished.map(unfinishedItem);
  host.replaceChildren(
    el(
      "section",
      { class: "card", "aria-labelledby": "experiment-unfinished", hidden: !items.length && !problem },
      el("h3", { id: "experiment-unfinished" }, text("experiment.unfinished")),
      problem && el("p", { class: "problem" }, problem),
      el("ul", { class: "seats" }, ...items),
    ),
    el(
      "form",
      { class: "card", id: "experiment-setup", onsubmit: submit, novalidate: true },
      el("h2", null, text("experiment.title")),
      protocols.length
        ? el("fieldset", null, el("legend", null, text("experiment.protocol")), ...protocols.map(protocolChoice))
        : el("p", null, text("experiment.none", { folder })),
      field(text("experiment.participant"), participant, text("experiment.participant-hint")),
      view.consent,
      view.problem,
      el("div", { class: "row" }, view.begin),
      view.why,
    ),
    resultsCard(study),
  );
  showConsent();
  return updateSetup();
}

/** Reads the list of protocols again. */
export async function loadSetup(host) {
  const found = await request("experiments");
  // Another list, or a session meanwhile.
  if (!found || JSON.stringify(found) === JSON.stringify(list)) return;
  list = found;
  if (!latest.experiment) showSetup(host);
}

/** Shows whether a session can begin. */
export function updateSetup() {
  if (!view) return;
  const why = controlReason();
  for (const button of [view.begin, ...view.resume]) button.disabled = why !== "";
  setText(view.why, why && text("experiment.disabled", { why }));
}
