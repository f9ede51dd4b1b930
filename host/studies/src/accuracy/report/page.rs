//! The page of the study.

use crate::accuracy::{Point, Study as Results};
use maud::{Markup, html};

use super::curve::{FLOOR, unfit};
use super::diagram::side_by_side;
use super::measure::Measure;
use super::pair::{Pair, Study};
use super::{left_out, studied_tables, target, tick_table};
use crate::{Paper, StudyText};
use crepitus_pages::plot::{Chart, Figure, page};

const LAYOUT: &str = include_str!("page.css");

pub(crate) fn html(results: &Results, text: &StudyText) -> String {
    let study = &Study::new(&results.points);
    let shown: Vec<_> = study
        .pairs
        .iter()
        .map(|pair| (pair, diagrams(study, pair)))
        .collect();
    let full = study.in_full();
    let body = html! {
        header {
            p.kicker { "Crepitus · what accuracy costs in time" }
            h1 { (text.title) }
            @if !text.intro.is_empty() { p.description { (text.intro) } }
        }
        main {
            @if shown.is_empty() { p { "There are no points to draw." } }
            @for (pair, diagrams) in shown.iter().take(full) {
                section.pair {
                    h2 { (pair.title()) }
                    (diagrams)
                }
            }
            @if shown.len() > full {
                h2.others { "Other scenes and conventions" }
                @for (pair, diagrams) in shown.iter().skip(full) {
                    details.pair {
                        summary { (pair.title()) }
                        (diagrams)
                    }
                }
            }
            (studied_tables::symptoms(&results.symptoms))
            (studied_tables::actuator(&results.actuator))
            @if let Some(on) = &results.target { (studied_tables::target(on)) }
            (page::tables(&text.tables))
            (page::notes(&text.notes))
        }
        (page::footer(&text.footer))
    };
    page::document(&text.title, LAYOUT, &[], &body)
}

/// The diagrams, the table of the device's tick, and what is in none.
fn diagrams(study: &Study, pair: &Pair) -> Markup {
    let figures = Measure::ALL
        .into_iter()
        .map(|measure| figure(study, pair, measure));
    let figures = figures.chain(target::figure(study, pair));
    html! {
        @for figure in figures { (page::figure(&figure)) }
        (tick_table::table(study, pair))
        (left_out::table(study, pair))
    }
}

fn figure(study: &Study, pair: &Pair, measure: Measure) -> Figure {
    let diagrams = side_by_side(study, pair, measure, Paper::Screen);
    // What one view has, the other has too, but for wrong points.
    let legend = diagrams
        .iter()
        .map(|diagram| &diagram.legend)
        .max_by_key(|legend| legend.len())
        .cloned()
        .unwrap_or_default();
    let caption = if diagrams.is_empty() {
        "Not drawn: no point has this error.".to_owned()
    } else {
        caption(pair, measure)
    };
    let charts = diagrams
        .into_iter()
        .map(|diagram| Chart {
            heading: Some(diagram.view.name()),
            svg: diagram.svg,
            half: true,
        })
        .collect();
    Figure {
        name: measure.name(),
        title: measure.title(),
        legend,
        charts,
        caption,
    }
}

fn caption(pair: &Pair, measure: Measure) -> String {
    let nothing = pair
        .points()
        .any(|point| unfit(point, measure).is_none() && measure.of(point) < FLOOR);
    let arrow = if nothing {
        " A sign with an arrow down: the error is 0, or below 10⁻¹⁷."
    } else {
        ""
    };
    let behind = if pair.points().all(Point::is_exact) {
        ""
    } else {
        " Encoder: the rung has counts of the device's encoder, 36 µrad each, and the velocity estimated from them."
    };
    let gaps = if pair.points().any(|point| unfit(point, measure).is_some()) {
        " A curve is broken, or ends, where a point is left out; these are listed below."
    } else {
        ""
    };
    format!(
        "{} Down is more accurate, left is cheaper; along a curve the step shrinks from left to \
         right. A bar through a sign spans the quartiles of the timings.{behind}{arrow}{gaps}",
        measure.caption()
    )
}
