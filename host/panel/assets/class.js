// The class: students who have joined by phone, and the links for phones and a wall.

import { isTeacher, latest, on } from "./connection.js";
import { el, setText, svg } from "./dom.js";
import { request } from "./report.js";
import { onLanguage, text } from "./strings.js";

let card = null;
let view = null;
let shown = "";

/** The picture of a link for a phone's camera; null where no phone reaches this computer. */
export function qrPicture({ qr }, label) {
  if (!qr) return null;
  const { size, path } = qr;
  return svg(
    "svg",
    { class: "qr", viewBox: `0 0 ${size} ${size}`, role: "img", "aria-label": label },
    svg("rect", { width: size, height: size, fill: "#fff" }),
    svg("path", { d: path, fill: "#000" }),
  );
}

const invitation = (link, label) => [
  qrPicture(link, label),
  el("a", { class: "link", href: link.link, target: "_blank", rel: "noopener" }, link.link),
];

function seatItem({ name, here, free }) {
  const state = free ? "class.free" : here ? "class.here" : "class.away";
  return el(
    "li",
    null,
    el("span", { class: "grow" }, name),
    el("span", { class: "hint" }, text(state)),
    el(
      "button",
      {
        type: "button",
        "aria-label": text("class.free-name", { name }),
        onclick: () => request("free-seat", { student: name }),
      },
      text("class.free-seat"),
    ),
  );
}

function build() {
  const { student, remote, projector } = latest.hello.links;
  view = {
    open: el("button", { type: "button", id: "class-open" }),
    invitation: el("div", { class: "invitation" }, ...invitation(student, text("class.qr-student"))),
    count: el("p", { role: "status" }),
    seats: el("ul", { class: "seats" }),
  };
  view.open.addEventListener("click", () => request("class", { open: !latest.class?.open }));
  const part = (title, about, link, label) =>
    el(
      "details",
      null,
      el("summary", null, text(title)),
      el("p", { class: "hint" }, text(about)),
      el("div", { class: "invitation" }, ...invitation(link, label)),
    );
  card.replaceChildren(
    el("h3", { id: "class-title" }, text("class.title")),
    el("p", { class: "hint" }, text(student.qr ? "class.about" : "class.no-lan")),
    el("div", { class: "row" }, view.open),
    view.invitation,
    view.count,
    view.seats,
    part("class.remote", "class.remote-about", remote, text("class.qr-remote")),
    part("class.wall", "class.wall-about", projector, ""),
  );
  shown = "";
}

function update() {
  if (!card) return;
  card.hidden = !isTeacher() || !latest.hello?.links;
  if (card.hidden) return;
  if (!view) build();
  const { open = false, seats = [] } = latest.class ?? {};
  const state = JSON.stringify([open, seats]);
  if (state === shown) return;
  shown = state;
  setText(view.open, text(open ? "class.close" : "class.open"));
  view.open.setAttribute("aria-pressed", String(open));
  view.invitation.hidden = !open;
  setText(view.count, seats.length ? text("class.joined", { count: seats.length }) : "");
  view.seats.replaceChildren(...seats.map(seatItem));
}

function rebuild() {
  view = null;
  update();
}

/** The part of the lesson's views on the class: one element, wherever it is shown. */
export function classCard() {
  card ??= el("section", { class: "card", "aria-labelledby": "class-title" });
  update();
  return card;
}

/** Starts the class. */
export function startClass() {
  on("hello", rebuild);
  on("class", update);
  onLanguage(rebuild);
}
