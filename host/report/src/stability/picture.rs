//! The matrix in brief as one SVG, for a document: the rungs that matter in
//! the precision of the device, legible at the width of a page of text.

use std::fmt::Write as _;

use crepitus_study::stability::{Matrix, Row};

use super::columns::{Columns, cell};
use super::look::{self, Look};
use super::scale;
use crate::escape::escaped;
use crate::palette;

/// All in CSS pixels.
const WIDTH: u32 = 800;
/// Names of cases.
const NAMES: u32 = 184;
/// Between conventions.
const GAP: u32 = 8;
/// Names of conventions and rungs.
const HEAD: u32 = 148;
const LINE: u32 = 21;
const LEGEND: u32 = 62;
/// A column is never wider.
const WIDEST: u32 = 60;

const STYLE: &str = "svg{font-family:system-ui,-apple-system,\"Segoe UI\",Roboto,\"Noto Sans\",\
sans-serif;font-size:12px;font-variant-numeric:tabular-nums}text{fill:var(--text)}\
.soft{fill:var(--level)}.bold{font-weight:600}.cell{font-size:11px;text-anchor:middle}\
.flag{font-size:7.5px;text-anchor:end}.broken{fill:none;stroke:var(--text);stroke-width:2.5}\
.rule{stroke:var(--axis)}.rim{stroke:var(--axis);stroke-width:0.5}";

pub(super) fn svg(matrix: &Matrix) -> String {
    let columns = Columns::of(matrix).pictured();
    let places = places(&columns);
    let rows = matrix.rows.iter().fold(0, |n, _| n + 1);
    let height = HEAD + rows * LINE + LEGEND;
    let precision = columns.precisions.first().map_or("", |p| p.name());
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" aria-label=\"Which hard cases hold on \
         which rung, {precision}\" viewBox=\"0 0 {WIDTH} {height}\" width=\"{WIDTH}\" \
         height=\"{height}\">\n<style>{}</style>\n\
         <rect width=\"100%\" height=\"100%\" fill=\"{}\"/>\n",
        palette::picture_style(&(scale::rules() + STYLE), &scale::variables()),
        palette::PAPER.hex()
    );
    // Writing to a String cannot fail.
    let _ = writeln!(
        out,
        "<text class=\"soft\" x=\"8\" y=\"{}\">case, {precision}</text>",
        HEAD - 8
    );
    head(&mut out, &columns, &places);
    let mut y = HEAD;
    for row in &matrix.rows {
        line(&mut out, row, &columns, &places, y);
        y += LINE;
    }
    legend(&mut out, y + 14);
    out.push_str("</svg>\n");
    out
}

/// Where the columns stand: left edges by group, and the width of all.
struct Places {
    left: Vec<Vec<u32>>,
    width: u32,
}

fn places(columns: &Columns) -> Places {
    let count = columns.groups.iter().flat_map(|group| &group.rungs);
    let count = count.fold(0_u32, |n, _| n + 1).max(1);
    let gaps = columns.groups.iter().fold(0, |sum, _| sum + GAP);
    let width = ((WIDTH - NAMES - gaps) / count).min(WIDEST);
    let mut x = NAMES;
    let mut left = Vec::new();
    for group in &columns.groups {
        let mut edges = Vec::new();
        for _ in &group.rungs {
            edges.push(x);
            x += width;
        }
        left.push(edges);
        x += GAP;
    }
    Places { left, width }
}

fn head(out: &mut String, columns: &Columns, places: &Places) {
    for (group, edges) in columns.groups.iter().zip(&places.left) {
        let (Some(first), Some(last)) = (edges.first(), edges.last()) else {
            continue;
        };
        let _ = writeln!(
            out,
            "<text class=\"bold\" x=\"{first}\" y=\"16\">{}</text>\
             <path class=\"rule\" d=\"M{first} 22H{}\"/>",
            group.convention.name(),
            last + places.width - 1
        );
        for (rung, x) in group.rungs.iter().zip(edges) {
            let _ = writeln!(
                out,
                "<text transform=\"translate({} {}) rotate(-90)\">{}</text>",
                x + places.width / 2 + 4,
                HEAD - 6,
                rung.name()
            );
        }
    }
}

fn line(out: &mut String, row: &Row, columns: &Columns, places: &Places, y: u32) {
    let middle = y + LINE / 2 + 4;
    let case = &row.case;
    let _ = writeln!(
        out,
        "<text x=\"8\" y=\"{middle}\"><title>{}</title><tspan class=\"bold\">{}</tspan> {}</text>",
        escaped(case.title),
        escaped(case.id),
        escaped(case.name)
    );
    let Some(precision) = columns.precisions.first() else {
        return;
    };
    for (group, edges) in columns.groups.iter().zip(&places.left) {
        for (rung, x) in group.rungs.iter().zip(edges) {
            let Some(found) = cell(row, group.convention, *rung, *precision) else {
                continue;
            };
            let look = Look::of(found);
            let (width, height) = (places.width - 1, LINE - 1);
            let class = look.tone.class;
            let _ = write!(
                out,
                "<g><title>{} {}</title><rect class=\"{class}\" x=\"{x}\" y=\"{y}\" width=\"{width}\" \
                 height=\"{height}\"/>",
                escaped(case.id),
                escaped(&look::words(found))
            );
            if look.must_hold {
                let _ = write!(out, "<path class=\"on-{class}\" d=\"M{x} {y}h5l-5 5z\"/>");
            }
            let _ = write!(
                out,
                "<text class=\"cell on-{class}\" x=\"{}\" y=\"{middle}\">{}</text>",
                x + places.width / 2,
                look.short
            );
            if look.flagged {
                let _ = write!(
                    out,
                    "<text class=\"flag on-{class}\" x=\"{}\" y=\"{}\">{}</text>",
                    x + width,
                    y + 8,
                    look::FLAG
                );
            }
            if look.broken {
                let _ = write!(
                    out,
                    "<rect class=\"broken\" x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"/>"
                );
            }
            out.push_str("</g>\n");
        }
    }
}

/// Two lines: what holds and by how much, then the rest.
fn legend(out: &mut String, y: u32) {
    let patch = |out: &mut String, x: u32, y: u32, class: &str, sign: &str| {
        let _ = write!(
            out,
            "<rect class=\"{class} rim\" x=\"{x}\" y=\"{y}\" width=\"22\" height=\"15\"/>\
             <text class=\"cell on-{class}\" x=\"{}\" y=\"{}\">{sign}</text>",
            x + 11,
            y + 12
        );
    };
    let words = |out: &mut String, x: u32, y: u32, text: &str| {
        let _ = writeln!(out, "<text x=\"{x}\" y=\"{}\">{text}</text>", y + 12);
    };
    words(out, 8, y, "holds, measured / limit:");
    let mut x = 158;
    for (tone, text) in scale::stretches() {
        patch(out, x, y, tone.class, "");
        words(out, x + 28, y, &text);
        x += 80;
    }
    let _ = write!(
        out,
        "<path fill=\"{}\" d=\"M{x} {}h7l-7 7z\"/>",
        palette::TEXT.hex(),
        y + 3
    );
    words(out, x + 14, y, "must hold");
    let below = y + 22;
    patch(out, 8, below, scale::DEGRADES.class, look::DEGRADES);
    words(out, 36, below, "degrades: a number above its limit");
    patch(out, 258, below, scale::FAILS.class, look::FAILS);
    words(
        out,
        286,
        below,
        "fails: something else than the joint (events found, ∞ overflow, Ts torque above it)",
    );
    words(out, 694, y, &format!("{} run warns", look::FLAG));
}
