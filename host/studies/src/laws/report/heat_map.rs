//! Law × quantity, a colour a cell: the worst error over the joints; once for the model, once for
//! the numbers.

use super::scale;
use super::share::{Share, Which};
use crate::laws::ranking::Answer;
use crate::laws::words::numbers::percent;
use crate::laws::words::rows_table::by_quantity;
use crate::laws::words::scores_table::{in_order, short_name};
use crate::laws::{LawStudy, Quantity, Row, Use};
use crepitus_pages::plot::palette::{AXIS, LEVEL, TEXT};
use crepitus_pages::plot::{Anchor, Chart, Drawing, Figure, Paper, Svg};
use maud::html;

/// All in CSS pixels. Names of uses and quantities.
const HEAD: f64 = 168.0;
const LINE: f64 = 21.0;
const MARGIN: f64 = 8.0;
/// A column is never wider.
const WIDEST: f64 = 34.0;
/// Gap between uses.
const GAP: f64 = 7.0;
const WIDTH: f64 = 880.0;

/// One heat map for each of the errors.
pub(super) fn figures(study: &LawStudy, answers: &[Answer], paper: Paper) -> Vec<Figure> {
    if study.rows.is_empty() {
        return Vec::new();
    }
    let figure = |which, name, title, caption: &str| Figure {
        name,
        title,
        legend: scale::legend(),
        charts: vec![Chart::full(map(study, answers, which, paper))],
        caption: caption.to_owned(),
    };
    vec![
        figure(
            Which::Model,
            "model-errors",
            "What a law cannot do, however fine the step",
            "Model error: the law converged, in f64 at ever finer steps, against what the task demands; the worst of the \
             joints, as a share of the scale of the number. Laws by the mean of their scores, the best above.",
        ),
        figure(
            Which::Numerical,
            "numerical-errors",
            "What the tick of 50 µs adds",
            "Numerical error: the law at 20 kHz in f32 against itself converged; the worst of the joints. A cell without a \
             colour: converged the law cannot do it either.",
        ),
    ]
}

/// A column: a quantity, and where it begins.
struct Column<'s> {
    quantity: &'s Quantity,
    rows: Vec<&'s Row>,
    x: f64,
}

fn map(study: &LawStudy, answers: &[Answer], which: Which, paper: Paper) -> Svg {
    let laws = in_order(study, answers);
    let names = laws.iter().map(|law| Drawing::label_width(law));
    let left = names.fold(0.0, f64::max) + 2.0 * MARGIN;
    let (columns, width) = columns(study, left, paper.wide(WIDTH));
    let end = columns.last().map_or(left, |column| column.x + width);
    let height = HEAD + laws.len() as f64 * LINE + MARGIN;
    let mut drawing = Drawing::default();
    head(&mut drawing, &columns, width);
    for (place, law) in laws.iter().enumerate() {
        let y = HEAD + place as f64 * LINE;
        drawing.label((left - MARGIN, y + 0.5 * LINE), Anchor::End, TEXT, law);
        for column in &columns {
            let rows = column.rows.iter().copied().filter(|row| row.law == *law);
            let share = which.worst(rows);
            let Some((ground, ink, sign)) = scale::tone(share) else {
                continue;
            };
            let (x, middle) = (column.x, column.x + 0.5 * (width - 1.0));
            drawing.push(&html! {
                g {
                    title { (law) ", " (column.quantity.name) ": " (words(share)) }
                    rect x=(x) y=(y) width=(width - 1.0) height=(LINE - 1.0) fill=(ground) {}
                    @if !sign.is_empty() {
                        text x=(middle) y=(y + 15.0) font-size="13" text-anchor="middle" fill=(ink) { (sign) }
                    }
                }
            });
        }
    }
    let what = match which {
        Which::Model => "model error",
        Which::Numerical => "numerical error",
    };
    let label = format!("The {what} of each law in each number, as a share of its scale");
    drawing.svg((end.max(left + 1.0) + MARGIN, height), &label)
}

/// The columns by use, and their width.
fn columns(study: &LawStudy, left: f64, total: f64) -> (Vec<Column<'_>>, f64) {
    let mut quantities = by_quantity(study);
    // Stable: in the order of the tasks.
    quantities.sort_by_key(|(_, quantity, _)| quantity.of);
    let mut uses: Vec<Use> = quantities
        .iter()
        .map(|(_, quantity, _)| quantity.of)
        .collect();
    uses.dedup();
    let gaps = GAP * uses.len() as f64;
    let width = ((total - left - gaps - MARGIN) / quantities.len().max(1) as f64)
        .min(WIDEST)
        .floor();
    let (mut x, mut last) = (left, uses.first().copied());
    let columns = quantities.into_iter().map(|(_, quantity, rows)| {
        if last != Some(quantity.of) {
            x += GAP;
            last = Some(quantity.of);
        }
        let column = Column { quantity, rows, x };
        x += width;
        column
    });
    (columns.collect(), width)
}

/// Names of uses, then of quantities, upright.
fn head(drawing: &mut Drawing, columns: &[Column<'_>], width: f64) {
    for group in columns.chunk_by(|a, b| a.quantity.of == b.quantity.of) {
        let (Some(first), Some(last)) = (group.first(), group.last()) else {
            continue;
        };
        drawing.push(&html! {
            text x=(first.x) y="14" font-size="13" font-weight="600" fill=(TEXT) { (short_name(first.quantity.of)) }
            path d=(format!("M{} 20H{}", first.x, last.x + width - 1.0)) stroke=(AXIS) {}
        });
        for column in group {
            let at = format!(
                "translate({} {}) rotate(-90)",
                column.x + 0.5 * width + 4.0,
                HEAD - 5.0
            );
            drawing.push(&html! {
                text transform=(at) font-size="13" fill=(LEVEL) {
                    title { (column.quantity.title) }
                    (column.quantity.name)
                }
            });
        }
    }
}

fn words(share: Share) -> String {
    match share {
        Share::Of(share) => format!("{} % of the scale", percent(share)),
        Share::Cannot => "cannot do it".to_owned(),
        Share::Unknown => String::new(),
    }
}
