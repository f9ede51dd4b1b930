//! The page of the study.

use super::{figures, scale};
use crate::StudyText;
use crate::laws::law_tables::costs_table;
use crate::laws::ranking::{Answer, orders};
use crate::laws::words::fits::{self, fits};
use crate::laws::words::numbers::percent;
use crate::laws::words::{RULE, rows_table, scores_table};
use crate::laws::{LawStudy, TASKS};
use crepitus_pages::plot::page::{self, scrolling};
use maud::{Markup, html};

const LAYOUT: &str = include_str!("page.css");

/// See [`super::html`].
pub(super) fn html(study: &LawStudy, answers: &[Answer], text: &StudyText) -> String {
    let body = html! {
        header {
            p.kicker { "Crepitus · what accuracy costs for every friction law" }
            h1 { (text.title) }
            @if !text.intro.is_empty() { p.description { (text.intro) } }
        }
        main {
            @if study.rows.is_empty() { p { "There are no numbers to draw." } }
            (page::figures(|paper| figures(study, answers, paper)))
            @if !study.rows.is_empty() { (scores(study, answers)) }
            (rule())
            (demands(study))
            (fitted(study))
            (costs(study))
            (best(study))
            (numbers(study))
            (page::tables(&text.tables))
            (page::notes(&text.notes))
        }
        (page::footer(&text.footer))
    };
    page::document(&text.title, LAYOUT, &scale::inks(), &body)
}

fn scores(study: &LawStudy, answers: &[Answer]) -> Markup {
    let laws = scores_table::in_order(study, answers);
    let table = scores_table::table(study, answers, &laws);
    html! {
        section.table {
            h2 { "The laws by use" }
            (scrolling("Mean errors by use", &table.to_html()))
            p.caption { "Mean relative error at 20 kHz in f32, in percent; 100: the law fails in all. Cost of a step in steady grating." }
            dl {
                @for (law, title) in &study.laws { dt { (law) } dd { (title) } }
            }
        }
    }
}

fn rule() -> Markup {
    html! { section.table { h2 { "How a law is chosen" } p { (RULE) } } }
}

/// Table of what every task demands, and how it is known.
fn demands(study: &LawStudy) -> Markup {
    let studied = |name: &str| study.rows.iter().any(|row| row.task == name);
    html! {
        section.table {
            h2 { "The tasks" }
            @for task in TASKS.iter().filter(|task| studied(task.name())) {
                h3 { (task.name()) ": " (task.title()) }
                dl {
                    @for quantity in task.quantities() {
                        dt { (quantity.name) }
                        dd {
                            (quantity.title) @if quantity.unit != "1" { ", " (quantity.unit) }
                            ". Demanded: " (quantity.demands) "."
                        }
                    }
                }
            }
        }
    }
}

fn fitted(study: &LawStudy) -> Markup {
    let fits = fits(study);
    html! {
        section.table {
            h2 { "The fits" }
            (scrolling("Parameters of the contacts", &fits::table(&fits).to_html()))
            p.caption { (fits::RULE) }
        }
    }
}

fn costs(study: &LawStudy) -> Markup {
    html! {
        @if !study.costs.is_empty() {
            section.table {
                h2 { "What a step costs" }
                (scrolling("Costs of a step", &costs_table(&study.costs).to_html()))
                p.caption { "Time on this computer, with the distance of the quartiles as a share; cycles and instructions on the controller, if it was run." }
            }
        }
    }
}

/// The order of the laws in each quantity.
fn best(study: &LawStudy) -> Markup {
    html! {
        @if !study.rows.is_empty() {
            section.table {
                h2 { "The order in each number" }
                dl {
                    @for order in orders(study) {
                        dt { (order.quantity) }
                        dd {
                            @for (place, (law, error)) in order.laws.iter().take(5).enumerate() {
                                @if place > 0 { ", " }
                                (law) " "
                                @match error { Some(error) => { (percent(*error)) " %" } None => { "✗" } }
                            }
                        }
                    }
                }
                p.caption { "The first five, by the worst relative error of the joints." }
            }
        }
    }
}

fn numbers(study: &LawStudy) -> Markup {
    html! {
        section.numbers {
            @if !study.rows.is_empty() { h2 { "Every number" } }
            @for (_, quantity, rows) in rows_table::by_quantity(study) {
                details {
                    summary { (quantity.name) ": " (quantity.title) }
                    (scrolling(quantity.name, &rows_table::table(&rows).to_html()))
                }
            }
        }
    }
}
