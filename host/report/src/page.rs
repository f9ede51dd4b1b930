//! The report of a run.

use maud::{Markup, html};

use crate::ReportError;
use crate::collector::Figures;
use crate::figure::Figure;
use crate::text::Text;
use crate::{balance_table, frame};
use crate::{
    chart_energy, chart_hand, chart_motion, chart_orbit, chart_plant, chart_spectrum, chart_torque,
    chart_zoom,
};

/// The report as one HTML page, complete in itself.
///
/// # Errors
/// [`ReportError::Draw`] if the drawing library refuses a chart.
pub fn html(text: &Text, figures: &Figures) -> Result<String, ReportError> {
    let drawn = draw(figures)?;
    let balance = figures.balance.as_ref().and_then(balance_table::table);
    let style = if balance.is_some() {
        balance_table::STYLE
    } else {
        ""
    };
    let body = html! {
        header {
            p.kicker { "Crepitus · report of a run" }
            h1 { (text.title) }
            @if let Some(description) = &text.description {
                p.description { (description) }
            }
        }
        (warnings(&text.warnings))
        main {
            @if drawn.is_empty() {
                p { "There are too few rows to draw anything." }
            }
            @for drawn in &drawn { (frame::figure(drawn)) }
            (left_out(figures))
            @if let Some(table) = &balance { (table) }
            (frame::tables(&text.sections))
        }
        (frame::footer(&text.footer))
    };
    Ok(frame::document(&text.title, style, &body))
}

/// The figures that these data make.
pub(crate) fn draw(figures: &Figures) -> Result<Vec<Figure>, ReportError> {
    // One row makes no line.
    if figures.rows < 2 {
        return Ok(Vec::new());
    }
    let drawn = [
        chart_motion::figure(figures)?,
        chart_torque::figure(figures)?,
        chart_hand::figure(figures)?,
        chart_zoom::figure(figures)?,
        chart_orbit::figure(figures)?,
        chart_spectrum::figure(figures)?,
        chart_plant::figure(figures)?,
        chart_energy::figure(figures)?,
    ];
    Ok(drawn.into_iter().flatten().collect())
}

fn warnings(warnings: &[String]) -> Markup {
    html! {
        @if !warnings.is_empty() {
            aside.warnings role="note" aria-label="Warnings" {
                h2 { @if warnings.len() == 1 { "Warning" } @else { "Warnings" } }
                ul { @for warning in warnings { li { (warning) } } }
            }
        }
    }
}

fn left_out(figures: &Figures) -> Markup {
    let broken = figures.broken_rows;
    html! {
        @if broken > 0 {
            p.note {
                (crate::number::count(broken))
                @if broken == 1 { " row holds" } @else { " rows hold" }
                " values that are not finite; these values are left out of the figures."
            }
        }
    }
}
