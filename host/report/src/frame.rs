//! What the pages of this crate share: the document, its style, figures with
//! their legends, tables of names and values, the last line.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use crate::figure::{Chart, Figure, Key, Sign};
use crate::palette;
use crate::text::Section;

const LAYOUT: &str = include_str!("page.css");

/// A page, complete in itself; `style` is what it needs beyond the layout that
/// all share.
pub(crate) fn document(title: &str, style: &str, body: &Markup) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { (title) " – Crepitus" }
                style { (PreEscaped(palette::style())) (PreEscaped(LAYOUT)) (PreEscaped(style)) }
            }
            body { (body) }
        }
    };
    page.into_string()
}

/// Tables of names and values, side by side where there is room.
pub(crate) fn tables(sections: &[Section]) -> Markup {
    html! {
        @if !sections.is_empty() {
            div.tables { @for part in sections { (section(part)) } }
        }
    }
}

/// The last line of a page, if there is one.
pub(crate) fn footer(footer: &str) -> Markup {
    html! {
        @if !footer.is_empty() { footer { p { (footer) } } }
    }
}

pub(crate) fn figure(figure: &Figure) -> Markup {
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

pub(crate) fn key(key: Key) -> Markup {
    html! {
        li {
            @match key.sign {
                Sign::Line(ink) => span class={ "line line-" (ink) } {},
                Sign::Patch(ink) => span class={ "swatch swatch-" (ink) } {},
                Sign::Mark(mark) => span.mark { (mark) },
                Sign::Curve(hand) => (PreEscaped(hand.sample())),
                Sign::Filled(hand) => (PreEscaped(hand.filled_sample())),
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
