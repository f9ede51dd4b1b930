//! The page around the figures.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use crate::ReportError;
use crate::collector::Figures;
use crate::figure::{Chart, Figure, Key, Sign};
use crate::text::{Section, Text};
use crate::{chart_motion, chart_orbit, chart_spectrum, chart_torque, chart_zoom, palette};

const LAYOUT: &str = include_str!("page.css");

/// The report as one HTML page, complete in itself.
///
/// # Errors
/// [`ReportError::Draw`] if the drawing library refuses a chart.
pub fn html(text: &Text, figures: &Figures) -> Result<String, ReportError> {
    let drawn = draw(figures)?;
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { (text.title) " – Crepitus" }
                style { (PreEscaped(palette::style())) (PreEscaped(LAYOUT)) }
            }
            body {
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
                    @for drawn in &drawn { (figure(drawn)) }
                    (left_out(figures))
                    @if !text.sections.is_empty() {
                        div.tables { @for part in &text.sections { (section(part)) } }
                    }
                }
                @if !text.footer.is_empty() { footer { p { (text.footer) } } }
            }
        }
    };
    Ok(page.into_string())
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
        chart_zoom::figure(figures)?,
        chart_orbit::figure(figures)?,
        chart_spectrum::figure(figures)?,
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

fn figure(figure: &Figure) -> Markup {
    html! {
        section.figure {
            h2 { (figure.title) }
            @if !figure.legend.is_empty() {
                ul.legend { @for entry in &figure.legend { (key(*entry)) } }
            }
            div.charts { @for part in &figure.charts { (chart(part)) } }
            p.caption { (figure.caption) }
        }
    }
}

fn chart(chart: &Chart) -> Markup {
    let class = if chart.half { "half" } else { "full" };
    html! {
        figure class=(class) {
            @if let Some(heading) = &chart.heading { figcaption { (heading) } }
            // A wide chart scrolls in its own box, which then takes the focus.
            @if chart.half {
                div.box { (PreEscaped(&chart.svg)) }
            } @else {
                div.box tabindex="0" role="group" aria-label="Chart" { (PreEscaped(&chart.svg)) }
            }
        }
    }
}

fn key(key: Key) -> Markup {
    html! {
        li {
            @match key.sign {
                Sign::Line(ink) => span class={ "line line-" (ink) } {},
                Sign::Patch(ink) => span class={ "swatch swatch-" (ink) } {},
                Sign::Mark(mark) => span.mark { (mark) },
            }
            (key.text)
        }
    }
}

fn section(section: &Section) -> Markup {
    html! {
        section.table {
            h2 { (section.title) }
            table {
                tbody {
                    @for (name, value) in &section.rows {
                        tr { th scope="row" { (name) } td { (value) } }
                    }
                }
            }
        }
    }
}
