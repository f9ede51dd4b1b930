//! The matrix in brief as one SVG, for a document: the rungs that matter in
//! the precision of the device, legible at the width of a page of text.

use super::columns::{Columns, cell};
use super::look;
use super::scale::{self, Tone};
use crate::stability::{Matrix, Row};
use crepitus_pages::plot::palette::{AXIS, LEVEL, TEXT};
use crepitus_pages::plot::{Drawing, Picture};
use maud::{Markup, html};

/// All in CSS pixels.
const WIDTH: f64 = 820.0;
/// Names of cases.
const NAMES: f64 = 204.0;
/// Gap between conventions.
const GAP: f64 = 8.0;
/// Names of conventions and rungs.
const HEAD: f64 = 148.0;
const LINE: f64 = 21.0;
const LEGEND: f64 = 84.0;
/// A column is never wider.
const WIDEST: f64 = 60.0;

pub(super) fn picture(matrix: &Matrix) -> Picture {
    let columns = Columns::of(matrix).pictured();
    let places = Places::of(&columns);
    let height = HEAD + matrix.rows.len() as f64 * LINE + LEGEND;
    let precision = columns.precisions.first().map_or("", |p| p.name());
    let mut drawing = Drawing::default();
    drawing.push(&html! {
        g font-size="12" fill=(TEXT) {
            text x="8" y=(HEAD - 8.0) fill=(LEVEL) { "case, " (precision) }
            (head(&columns, &places))
            @for (i, row) in matrix.rows.iter().enumerate() {
                (line(row, &columns, &places, HEAD + i as f64 * LINE))
            }
            (legend(height - LEGEND + 14.0))
        }
    });
    let label = format!("Which hard cases hold on which rung, {precision}");
    Picture::new(
        "matrix".to_owned(),
        &drawing.svg((WIDTH, height), &label),
        &[],
        &scale::inks(),
    )
}

/// Positions of the columns: left edges by group, and the width of all.
struct Places {
    left: Vec<Vec<f64>>,
    width: f64,
}

impl Places {
    fn of(columns: &Columns) -> Self {
        let count: usize = columns.groups.iter().map(|group| group.rungs.len()).sum();
        let gaps = columns.groups.len() as f64 * GAP;
        let width = ((WIDTH - NAMES - gaps) / count.max(1) as f64)
            .min(WIDEST)
            .floor();
        let mut x = NAMES;
        let mut left = Vec::new();
        for group in &columns.groups {
            left.push(
                (0..group.rungs.len())
                    .map(|i| x + i as f64 * width)
                    .collect(),
            );
            x += group.rungs.len() as f64 * width + GAP;
        }
        Self { left, width }
    }
}

fn head(columns: &Columns, places: &Places) -> Markup {
    let middle = (0.5 * places.width).floor() + 4.0;
    html! {
        @for (group, edges) in columns.groups.iter().zip(&places.left) {
            @if let (Some(first), Some(last)) = (edges.first(), edges.last()) {
                text x=(first) y="16" font-weight="600" { (group.convention.name()) }
                path d=(format!("M{first} 22H{}", last + places.width - 1.0)) stroke=(AXIS) {}
                @for (rung, x) in group.rungs.iter().zip(edges) {
                    text transform=(format!("translate({} {}) rotate(-90)", x + middle, HEAD - 6.0)) { (rung.name()) }
                }
            }
        }
    }
}

fn line(row: &Row, columns: &Columns, places: &Places, y: f64) -> Markup {
    let middle = y + 14.0;
    let case = &row.case;
    let (width, height) = (places.width - 1.0, LINE - 1.0);
    let precision = columns.precisions.first();
    let groups = columns.groups.iter().zip(&places.left);
    let cells = groups.flat_map(|(group, edges)| {
        let rungs = group.rungs.iter().zip(edges);
        rungs.filter_map(|(rung, x)| Some((cell(row, group.convention, *rung, *precision?)?, *x)))
    });
    html! {
        text x="8" y=(middle) {
            title { (case.title) }
            tspan font-weight="600" { (case.id) } " " (case.name)
        }
        @for (found, x) in cells {
            @let (Tone { ground, text }, short) = look::look(found);
            g fill=(text) {
                title { (case.id) " " (look::words(found)) }
                rect fill=(ground) x=(x) y=(y) width=(width) height=(height) {}
                @if found.must_hold { path d=(format!("M{x} {y}h5l-5 5z")) {} }
                text x=(x + (0.5 * places.width).floor()) y=(middle) font-size="11.5" text-anchor="middle" { (short) }
                @if found.verdict.is_flagged() {
                    text x=(x + width) y=(y + 8.0) font-size="11.5" text-anchor="end" { (look::FLAG) }
                }
                @if found.is_broken() {
                    rect fill="none" stroke=(TEXT) stroke-width="2.5" x=(x) y=(y) width=(width) height=(height) {}
                }
            }
        }
    }
}

/// Three lines: what holds and by how much, then the rest.
fn legend(y: f64) -> Markup {
    let patch = |x: f64, y: f64, Tone { ground, text }: Tone, sign: &str| {
        html! {
            rect fill=(ground) stroke=(AXIS) stroke-width="1" x=(x) y=(y) width="22" height="15" {}
            text fill=(text) font-size="11.5" text-anchor="middle" x=(x + 11.0) y=(y + 12.0) { (sign) }
        }
    };
    let words = |x: f64, y: f64, text: &str| html! { text x=(x) y=(y + 12.0) { (text) } };
    let x = |i: usize| 158.0 + 80.0 * i as f64;
    let must = x(scale::HOLDS.len());
    let below = y + 22.0;
    html! {
        (words(8.0, y, "holds, measured / limit:"))
        @for (i, (tone, text)) in scale::stretches().into_iter().enumerate() {
            (patch(x(i), y, tone, ""))
            (words(x(i) + 28.0, y, &text))
        }
        path d=(format!("M{must} {}h7l-7 7z", y + 3.0)) {}
        (words(must + 14.0, y, "must hold"))
        (patch(8.0, below, scale::DEGRADES, look::DEGRADES))
        (words(36.0, below, "degrades: a number above its limit"))
        (patch(8.0, below + 22.0, scale::FAILS, look::FAILS))
        (words(36.0, below + 22.0, "fails: something else than the joint (events found, ∞ overflow, Ts torque above it)"))
        (words(694.0, y, &format!("{} run warns", look::FLAG)))
    }
}
