// Dialogs. A modal dialog covers the page's stop button, so each has its own;
// Escape stops, too, and closes it.

import { el, freshId } from "./dom.js";
import { text } from "./strings.js";
import { stop } from "./stop.js";

/** Shows a form in a dialog; resolves with its data, or with null when it is dismissed. */
export function askForm(title, fields, accept) {
  return new Promise((resolve) => {
    const id = freshId("dialog");
    const form = el(
      "form",
      { method: "dialog" },
      el(
        "div",
        { class: "dialog-head" },
        el("h2", { id }, title),
        el("button", { type: "button", class: "stop", onclick: stop }, text("stop")),
      ),
      ...fields,
      el(
        "div",
        { class: "row end" },
        el("button", { value: "cancel", formnovalidate: true }, text("cancel")),
        el("button", { value: "accept", class: "primary" }, accept),
      ),
    );
    const dialog = el("dialog", { "aria-labelledby": id }, form);
    // Enter in a field takes the first button of a form, which is not the one to accept.
    form.addEventListener("keydown", (event) => {
      if (event.key !== "Enter" || event.target.tagName !== "INPUT") return;
      event.preventDefault();
      form.requestSubmit(form.querySelector("[value=accept]"));
    });
    dialog.addEventListener("close", () => {
      const data = dialog.returnValue === "accept" ? new FormData(form) : null;
      dialog.remove();
      resolve(data);
    });
    document.body.append(dialog);
    dialog.showModal();
  });
}

/** Asks a question; resolves with whether it was confirmed. */
export const confirmed = async (question) =>
  (await askForm(text("confirm"), [el("p", null, question)], text("yes"))) !== null;
