//! The page: the document, its style, figures with their legends, tables of
//! names and values, warnings, the last line. It needs nothing else: no network,
//! no scripts, no fonts; it follows light and dark, prints, and reads on a
//! phone, where wide charts and tables scroll in boxes of their own.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use crate::plot::figure::{Chart, Figure, Key, Sign};
use crate::plot::palette::{self, Ink};
use crate::plot::paper::{Column, Paper};

const LAYOUT: &str = include_str!("page.css");

/// One table of names and values.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Section {
    /// The heading of the table.
    pub title: String,
    /// Name of a fact, and its value with its unit.
    pub rows: Vec<(String, String)>,
}

/// A page in English, complete in itself; `style` is what it needs beyond the layout that
/// all share, `inks` what its charts have beside the palette's.
pub fn document(title: &str, style: &str, inks: &[Ink], body: &Markup) -> String {
    document_in("en", title, style, inks, body)
}

/// A page as [`document`], in the language of this tag, such as `de`.
pub fn document_in(
    language: &str,
    title: &str,
    style: &str,
    inks: &[Ink],
    body: &Markup,
) -> String {
    let page = html! {
        (DOCTYPE)
        html lang=(language) {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { (title) " – Crepitus" }
                style { (PreEscaped(palette::style(inks))) (PreEscaped(LAYOUT)) (PreEscaped(style)) }
            }
            body { (body) }
        }
    };
    page.into_string()
}

/// Width up to which a chart fits a phone, CSS pixels.
const PHONE: f64 = 520.0;

/// Rows from which on a table of names and values is folded: nobody reads so many before the figures.
const FOLDED: usize = 16;

/// Tables of names and values, side by side where there is room; long ones are folded.
pub fn tables(sections: &[Section]) -> Markup {
    html! {
        @if !sections.is_empty() {
            div.tables { @for part in sections { (section(part)) } }
        }
    }
}

/// The last line of a page, if there is one.
pub fn footer(footer: &str) -> Markup {
    html! {
        @if !footer.is_empty() { footer { p { (footer) } } }
    }
}

/// Box of warnings for the reader; nothing if
/// there is nothing.
pub fn warnings(title: &str, warnings: &[String]) -> Markup {
    html! {
        @if !warnings.is_empty() {
            aside.warnings role="note" aria-label="Warnings" {
                h2 { (title) }
                ul { @for warning in warnings { li { (warning) } } }
            }
        }
    }
}

/// Notes below all else; nothing if there are none.
pub fn notes(notes: &[String]) -> Markup {
    html! {
        @if !notes.is_empty() {
            section.notes {
                h2 { "Notes" }
                @for note in notes { p { (note) } }
            }
        }
    }
}

/// A scrolling box for wide content; focusable for the keyboard. A phone, which shows no bar, says that it scrolls.
pub fn scrolling(label: &str, content: &Markup) -> Markup {
    html! {
        (fitting(label, content))
        p.sideways { "Wider than a phone: swipe it sideways." }
    }
}

/// A box for content that fits.
fn fitting(label: &str, content: &Markup) -> Markup {
    html! { div.box tabindex="0" role="group" aria-label=(label) { (content) } }
}

/// Figures as they are drawn for a medium. Those that have another layout for a phone are there twice, and the page shows
/// the one that fits.
pub fn figures(draw: impl Fn(Paper) -> Vec<Figure>) -> Markup {
    let narrow = draw(Paper::Print(Column::One));
    html! {
        @for (wide, narrow) in draw(Paper::Screen).iter().zip(&narrow) { (laid_out(wide, Some(narrow))) }
    }
}

/// A figure.
pub fn figure(figure: &Figure) -> Markup {
    laid_out(figure, None)
}

fn laid_out(figure: &Figure, narrow: Option<&Figure>) -> Markup {
    let narrow = narrow.filter(|narrow| is_for_a_phone(narrow) && !is_for_a_phone(figure));
    html! {
        section.figure {
            h2 { (figure.title) }
            @if !figure.legend.is_empty() {
                ul.legend { @for entry in &figure.legend { (key(*entry)) } }
            }
            div.charts.wide[narrow.is_some()] { @for part in &figure.charts { (chart(part)) } }
            @if let Some(narrow) = narrow {
                div.charts.narrow { @for part in &narrow.charts { (chart(part)) } }
            }
            p.caption { (figure.caption) }
        }
    }
}

/// Returns whether all charts fit a phone once they are scaled to its width, with letters that can be read.
fn is_for_a_phone(figure: &Figure) -> bool {
    figure.charts.iter().all(|chart| chart.svg.width <= PHONE)
}

fn chart(chart: &Chart) -> Markup {
    let class = if chart.half { "half" } else { "full" };
    let svg = html! { (chart.svg) };
    let shown = if chart.svg.width <= PHONE {
        fitting("Chart", &svg)
    } else {
        scrolling("Chart", &svg)
    };
    html! {
        figure class=(class) {
            @if let Some(heading) = &chart.heading { figcaption { (heading) } }
            (shown)
        }
    }
}

fn key(key: Key) -> Markup {
    html! {
        li {
            @match key.sign {
                Sign::Line(ink) => span.line style={ "border-color:var(--" (ink.name) ")" } {},
                Sign::Dashed(ink) => span.line style={ "border-style:dashed;border-color:var(--" (ink.name) ")" } {},
                Sign::Patch(ink) => span.swatch style={ "background:var(--" (ink.name) ")" } {},
                Sign::Mark(mark) => span.mark { (mark) },
                Sign::Curve(style) => (style.inline(false)),
                Sign::Filled(style) => (style.inline(true)),
            }
            (key.text)
        }
    }
}

fn section(section: &Section) -> Markup {
    let table = html! {
        table {
            tbody {
                @for (name, value) in &section.rows {
                    tr { th scope="row" { (name) } td { (value) } }
                }
            }
        }
    };
    html! {
        @if section.rows.len() < FOLDED {
            section.table { h2 { (section.title) } (table) }
        } @else {
            details.table { summary { (section.title) " (" (section.rows.len()) ")" } (table) }
        }
    }
}
