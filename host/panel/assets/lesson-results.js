// Results of a lesson: a table of students, and a confusion matrix each.

import { isTeacher } from "./connection.js";
import { controlReason } from "./control.js";
import { el } from "./dom.js";
import { disorderName, lessonTitle, levelName } from "./names.js";
import { openOffered, request } from "./report.js";
import { number, text } from "./strings.js";

const LEVELS = ["mild", "moderate", "severe"];

const interval = (kappa) =>
  kappa
    ? text("results.interval", {
        value: number(kappa.value, 2),
        low: number(kappa.low, 2),
        high: number(kappa.high, 2),
      })
    : "–";

const confidence = (value) => (Number.isFinite(value) ? number(value, 1) : "–");

function studentTable(summary) {
  const columns = ["student", "right", "kappa", "level-kappa", "confidence"];
  const row = (part, name) =>
    el(
      "tr",
      null,
      el("th", { scope: "row" }, name),
      el("td", { class: "count" }, text("results.of", { right: part.right, answers: part.answers })),
      el("td", null, interval(part.kappa)),
      el("td", null, interval(part.level_kappa)),
      el(
        "td",
        { class: "count" },
        [part.confidence_right, part.confidence_wrong].map(confidence).join(" / "),
      ),
    );
  return el(
    "div",
    { class: "scroll", tabindex: 0, role: "group", "aria-label": text("results.students") },
    el(
      "table",
      null,
      el("caption", null, text("results.students")),
      el(
        "thead",
        null,
        el("tr", null, ...columns.map((key) => el("th", { scope: "col" }, text(`results.${key}`)))),
      ),
      el(
        "tbody",
        null,
        ...summary.students.map((part) => row(part, part.student)),
        row(summary.all, text("results.all")),
      ),
    ),
  );
}

// Without the explanation behind it: a matrix has little room.
const nameOf = (name) =>
  LEVELS.includes(name) ? levelName(name) : disorderName(name).split(/[:(]/)[0].trim();

function matrix(part, title) {
  const { rows, columns, counts } = part.confusion;
  if (!rows.length) return null;
  const cell = (count, row, column) => {
    const kind = count === 0 ? "" : rows[row] === columns[column] ? " diagonal" : " mistake";
    return el("td", { class: `count${kind}` }, number(count));
  };
  return el(
    "div",
    { class: "scroll", tabindex: 0, role: "group", "aria-label": title },
    el(
      "table",
      { class: "confusion" },
      el("caption", null, title),
      el(
        "thead",
        null,
        el(
          "tr",
          null,
          el("th", { scope: "col" }, text("results.corner")),
          ...columns.map((name) => el("th", { scope: "col" }, el("span", null, nameOf(name)))),
        ),
      ),
      el(
        "tbody",
        null,
        ...rows.map((name, r) =>
          el(
            "tr",
            null,
            el("th", { scope: "row" }, nameOf(name)),
            ...columns.map((_, c) => cell(counts[r][c], r, c)),
          ),
        ),
      ),
    ),
  );
}

const openReport = () => openOffered("report", { language: document.documentElement.lang });

/** Builds the results. */
export function showResults(host, lesson) {
  const { summary } = lesson;
  const why = controlReason();
  const report = el(
    "button",
    { type: "button", class: "primary", id: "report", onclick: openReport },
    text("results.report"),
  );
  const close = el(
    "button",
    { type: "button", id: "lesson-close", onclick: () => request("lesson-close") },
    text("results.close"),
  );
  report.disabled = !isTeacher();
  close.disabled = why !== "";
  const tables = !summary
    ? [el("p", null, text("results.none"))]
    : [
        studentTable(summary),
        el("p", { class: "hint" }, text("results.kappa-hint")),
        el("p", { class: "hint" }, summary.remarks.map((key) => text(`report.${key}`)).join(" ")),
        matrix(summary.all, text("results.matrix", { student: text("results.all") })),
        ...(summary.students.length > 1
          ? [
              el(
                "details",
                null,
                el("summary", null, text("results.each")),
                ...summary.students.map((part) =>
                  matrix(part, text("results.matrix", { student: part.student })),
                ),
              ),
            ]
          : []),
      ];
  host.replaceChildren(
    el(
      "section",
      { class: "card results" },
      el("h2", null, text("results.title", { title: lessonTitle(lesson) })),
      summary &&
        el(
          "p",
          { class: "trial" },
          text("results.total", { right: summary.right, answers: summary.answers }),
        ),
      summary?.all.without_torque > 0 &&
        el("p", { class: "hint" }, text("results.left-out", { count: summary.all.without_torque })),
      el("div", { class: "row" }, report, close),
      lesson.stored && el("p", { class: "hint" }, text("run.stored", { folder: lesson.stored })),
      why && el("p", { class: "hint" }, text("results.disabled", { why })),
      ...tables,
    ),
  );
}
