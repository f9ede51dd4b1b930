//! The page: the document, its style, figures with their legends, tables of
//! names and values, warnings, the last line. It needs nothing else: no network,
//! no scripts, no fonts; it follows light and dark, prints, and reads on a
//! phone, where wide charts and tables scroll in boxes of their own.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use crate::figure::{Chart, Figure, Key, Sign};
use crate::palette::{self, Ink};

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

/// Tables of names and values, side by side where there is room.
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

/// A scrolling box for wide content; focusable for the keyboard.
pub fn scrolling(label: &str, content: &Markup) -> Markup {
    html! { div.box tabindex="0" role="group" aria-label=(label) { (content) } }
}

/// A figure.
pub fn figure(figure: &Figure) -> Markup {
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
            (scrolling("Chart", &html! { (chart.svg) }))
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
