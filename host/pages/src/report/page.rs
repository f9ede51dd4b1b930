//! The report of a run.

use crate::plot::{Figure, Paper, Picture, page};
use maud::{Markup, html};

use crate::report::balance_table;
use crate::report::collector::Figures;
use crate::report::overlay;
use crate::report::text::Text;
use crate::report::{
    chart_energy, chart_hand, chart_motion, chart_orbit, chart_plant, chart_spectrum,
    chart_symptoms, chart_torque, chart_zoom, examiner_notes,
};

/// The report as one HTML page, complete in itself.
pub fn html(text: &Text, figures: &Figures) -> String {
    let balance = figures.balance.as_ref().and_then(balance_table::table);
    let mut sections = overlay::sections(&figures.comparisons);
    sections.extend(examiner_notes::sections(figures));
    sections.extend(text.sections.iter().cloned());
    let warned = if text.warnings.len() == 1 {
        "Warning"
    } else {
        "Warnings"
    };
    let body = html! {
        header {
            p.kicker { "Crepitus · report of a run" }
            h1 { (text.title) }
            @if let Some(description) = &text.description {
                p.description { (description) }
            }
        }
        (page::warnings(warned, &text.warnings))
        main {
            @if figures.rows < 2 {
                p { "There are too few rows to draw anything." }
            }
            (page::figures(|paper| draw(figures, paper)))
            (left_out(figures))
            @if let Some(table) = &balance { (table) }
            (page::tables(&sections))
        }
        (page::footer(&text.footer))
    };
    let style = if balance.is_some() {
        balance_table::STYLE
    } else {
        ""
    };
    page::document(&text.title, style, &[], &body)
}

/// Every chart of the report as a file, laid out for this paper, with its legend.
pub fn pictures(figures: &Figures, paper: Paper) -> Vec<Picture> {
    crate::plot::pictures(&draw(figures, paper))
}

/// The figures that these data make.
fn draw(figures: &Figures, paper: Paper) -> Vec<Figure> {
    // One row makes no line.
    if figures.rows < 2 {
        return Vec::new();
    }
    let motion = chart_motion::figure(figures, paper);
    let others = [
        chart_torque::figure(figures, paper),
        chart_hand::figure(figures, paper),
        chart_zoom::figure(figures, paper),
        chart_orbit::figure(figures, paper),
        chart_spectrum::figure(figures, paper),
        chart_plant::figure(figures, paper),
        chart_energy::figure(figures),
    ];
    let symptoms = chart_symptoms::figures(figures, paper);
    let others = others.into_iter().flatten();
    let overlay = overlay::figure(&figures.comparisons, paper);
    let first = overlay.into_iter().chain(motion);
    first.chain(symptoms).chain(others).collect()
}

fn left_out(figures: &Figures) -> Markup {
    let broken = figures.broken_rows;
    html! {
        @if broken > 0 {
            p.note {
                (crate::plot::number::count(broken))
                @if broken == 1 { " row holds" } @else { " rows hold" }
                " values that are not finite; these values are left out of the figures."
            }
        }
    }
}
