//! The page of the matrix.

use super::{details, heat_map, look, scale};
use crate::StudyText;
use crate::stability::Matrix;
use crate::stability::story::{Stories, figures};
use crepitus_pages::plot::page;
use maud::{Markup, html};

const LAYOUT: &str = include_str!("page.css");

/// The report as one HTML page, complete in itself.
pub fn html(matrix: &Matrix, stories: Option<&Stories>, text: &StudyText) -> String {
    let told = |paper| stories.map_or_else(Vec::new, |told| figures(told, paper));
    let body = html! {
        header {
            p.kicker { "Crepitus · which hard cases hold" }
            h1 { (text.title) }
            @if !text.intro.is_empty() { p.description { (text.intro) } }
        }
        (broken(matrix))
        main {
            (page::figures(|paper| told(paper).into_iter().take(1).collect()))
            @if matrix.rows.is_empty() { p { "There are no cases." } }
            @else { (how_to_read()) (heat_map::table(matrix)) }
            (page::figures(|paper| told(paper).into_iter().skip(1).collect()))
            (details::cases(matrix))
            (page::tables(&text.tables))
        }
        (page::footer(&text.footer))
    };
    page::document(
        &text.title,
        &(scale::rules() + LAYOUT),
        &scale::inks(),
        &body,
    )
}

/// The cells that must hold and do not, spelled out.
fn broken(matrix: &Matrix) -> Markup {
    let broken: Vec<String> = matrix
        .broken()
        .map(|(case, cell)| format!("{} {}, {}", case.id, case.name, look::words(cell)))
        .collect();
    page::warnings("What must hold and does not", &broken)
}

fn how_to_read() -> Markup {
    html! {
        section.reading {
            h2 { "How to read it" }
            p {
                "A line is a hard case, a column a rung of the solver ladder under one of the three \
                 conventions, once in f32, the precision of the device, and once in f64. A faint cell \
                 holds with room to spare; the stronger the blue, the nearer it comes to its limit. \
                 An amber cell with an arrow is right in kind but misses a number. A red cell with a \
                 cross simulated something else than the joint. A corner marks the cells that must \
                 hold: what ships and what is offered as exact. The others show what a cheaper \
                 method does there, and they may fail."
            }
        }
    }
}
