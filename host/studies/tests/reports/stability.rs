//! The report of the stability study, from a matrix to a page: what every kind
//! of verdict looks like, and that nothing on it depends on anything outside.
//!
//! The pages are left in the target's `tmp` directory to be looked at.

use crate::evil_text;
use crate::markup::{
    assert_balanced, assert_drawn, assert_page, assert_printable, count, keep, on_a_desk,
};
use crate::matrix;
use crepitus_model::Convention;
use crepitus_scene::scene::Precision;
use crepitus_studies::stability::report::{html, pictures};
use crepitus_studies::stability::story as told;
use crepitus_studies::stability::{Failure, Matrix, Verdict};
use crepitus_studies::{Column, Paper, Section, StudyText};

fn text(title: &str) -> StudyText {
    StudyText {
        title: title.to_owned(),
        intro: "Every case on every rung under every convention, in single and double precision."
            .to_owned(),
        tables: vec![Section {
            title: "The study".to_owned(),
            rows: vec![("cases".to_owned(), "33".to_owned())],
        }],
        footer: "crepitus 0.1.0, made-up verdicts".to_owned(),
        ..StudyText::default()
    }
}

fn page(name: &str, matrix: &Matrix, stories: Option<&told::Stories>, text: &StudyText) -> String {
    let page = html(matrix, stories, text);
    assert_page(&format!("stability-{name}"), &page, 3_000_000, &[]);
    on_a_desk(&page)
}

#[test]
fn a_whole_matrix_with_its_stories() {
    let matrix = matrix::whole();
    let stories = told::all().expect("computed");
    let page = page(
        "whole",
        &matrix,
        Some(&stories),
        &text("Which hard cases hold"),
    );
    // Conventions, then rungs; f32 above f64.
    assert_eq!(count(&page, "class=\"convention\""), 3);
    assert_eq!(count(&page, "class=\"rung"), 5 + 11 + 12);
    let cells: usize = matrix.rows.iter().map(|row| row.cells.len()).sum();
    let drawn = page.matches("<td class=\"h").count()
        + page.matches("<td class=\"degrades").count()
        + page.matches("<td class=\"fails").count();
    assert_eq!(drawn, cells);
    assert_eq!(count(&page, "<details class=\"case\""), matrix.rows.len());
    assert_eq!(count(&page, "<details class=\"case\" open"), 0);
    for row in &matrix.rows {
        assert!(page.contains(&format!("id=\"{}\"", row.case.id)));
        for words in row.case.inputs().iter().chain(&row.case.criteria()) {
            let words = words
                .replace('&', "&amp;")
                .replace('<', "&lt;")
                .replace('>', "&gt;")
                .replace('"', "&quot;");
            assert!(page.contains(&words), "{words}");
        }
    }
    assert_eq!(count(&page, "role=\"img\""), 5);
    assert!(!page.contains("What must hold and does not"));
}

#[test]
fn every_verdict_has_a_colour_a_sign_and_words() {
    let matrix = matrix::kinds();
    let page = page("kinds", &matrix, None, &text("Every kind"));
    for (sign, words) in [
        (">2e-13<", "holds (2.1e-13 ≤ 1.0e-12 s)"),
        (">✓<", "holds"),
        (">↓0.03<sup>⚑</sup>", "degrades, flagged (0.031 &gt; 0.010)"),
        (">↓2e-3<", "degrades (2.0e-3 &gt; 1.0e-3 N·m)"),
        (">✗∞<", "fails: overflow at t = 0.012 s"),
        (">✗Ts<", "fails: torque above its limit at t = 1.050 s"),
        (">✗1<sup>⚑</sup>", "fails, flagged: 1 events instead of 637"),
        (">✗<", "fails: the torque drifts"),
    ] {
        assert!(page.contains(sign), "{sign}");
        assert!(page.contains(words), "{words}");
    }
    // One case: its list is open.
    assert_eq!(count(&page, "<details class=\"case\" open"), 1);
    // The cell that fails and must not is outlined and spelled out.
    assert_eq!(count(&page, "must broken\""), 1);
    assert!(page.contains("What must hold and does not"));
    let list = page
        .split("What must hold and does not")
        .nth(1)
        .expect("a list");
    let list = list.split("</ul>").next().expect("its end");
    assert!(
        list.contains("H02 mirror") && list.contains("overflow"),
        "{list}"
    );
    assert_eq!(count(list, "<li>"), 1);
}

#[test]
fn a_part_of_the_matrix_has_only_its_columns() {
    let mut part = matrix::whole();
    part.rows.truncate(2);
    for row in &mut part.rows {
        row.cells.retain(|cell| {
            cell.subject.precision == Precision::F64
                && cell.subject.convention == Convention::Physical
        });
    }
    let page = page("part", &part, None, &text("A part"));
    assert_eq!(count(&page, "class=\"convention\""), 1);
    assert_eq!(count(&page, "class=\"rung"), 12);
    assert!(!page.contains(">f32<"));
    let picture = pictures(&part, None, Paper::Screen).remove(0);
    assert!(picture.svg.contains("case, f64"));

    let empty = html(&Matrix::default(), None, &StudyText::default());
    assert!(empty.contains("There are no cases."));
    assert_balanced(&empty);
    assert_balanced(&pictures(&Matrix::default(), None, Paper::Screen)[0].svg);
}

#[test]
fn words_are_escaped() {
    let evil = "<script>alert('&\"')</script>";
    let mut matrix = matrix::kinds();
    let row = &mut matrix.rows[0];
    row.case.title = evil;
    row.case.hard = evil;
    row.case.source = evil;
    row.case.name = evil;
    for cell in &mut row.cells {
        evil.clone_into(&mut cell.detail);
    }
    row.cells[0].verdict = Verdict::Fails {
        what: Failure::Broken(evil),
        at_s: None,
        flagged: false,
    };
    let page = page("escaped", &matrix, None, &evil_text());
    assert!(count(&page, "&lt;script&gt;") > 20);
    let printed = pictures(&matrix, None, Paper::Print(Column::One)).remove(0);
    assert_printable(&printed);
    assert_eq!(printed.print_mm(), Column::Two.mm());
    let svg = &pictures(&matrix, None, Paper::Screen)[0].svg;
    assert!(!svg.contains("<script"));
    assert_drawn(svg);
}

#[test]
fn pictures_are_documents() {
    let matrix = matrix::whole();
    let stories = told::all().expect("computed");
    let pictures = pictures(&matrix, Some(&stories), Paper::Screen);
    let names: Vec<&str> = pictures.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(names[..3], ["matrix", "three-solvers", "implicit-euler"]);
    for picture in &pictures {
        keep(&format!("stability-{}.svg", picture.name), &picture.svg);
        assert_drawn(&picture.svg);
        assert!(picture.svg.contains("xmlns=\"http://www.w3.org/2000/svg\""));
        assert!(
            picture.svg.len() < 500_000,
            "{}: {}",
            picture.name,
            picture.svg.len()
        );
    }
    // The rungs of `frozen` and `physical`, and two of `paper`.
    assert_eq!(count(&pictures[0].svg, "rotate(-90)"), 4 + 2 + 10);
    assert!(pictures[0].svg.contains("case, f32"));
}

#[test]
fn every_story_has_its_own_name_and_says_what_one_sees() {
    let figures = told::figures(&told::all().expect("computed"), Paper::Screen);
    let names: Vec<_> = figures.iter().map(|figure| figure.name).collect();
    assert_eq!(
        names,
        [
            "three-solvers",
            "implicit-euler",
            "restick-rules",
            "parameter-change",
            "turn-back-guard"
        ]
    );
    for (figure, words) in figures.iter().zip([
        ["4 breaks", "explicit Euler", "breaks once and slides on"],
        ["breaks once", "shaft, Ω", "λ²/4π at 8.0 µs"],
        ["124 times", "−Ts", "Cycles so far: 124 and 3"],
        [
            "no energy from nowhere",
            "kr 10 → 400",
            "replaced as they are",
        ],
        ["as a share of the 0.2 mJ", "bound", "torque 2 ticks late"],
    ]) {
        assert!(figure.caption.len() > 100);
        let svg = &crepitus_pages::plot::pictures([figure])[0].svg;
        for words in words {
            let is_there = svg.contains(words)
                || figure.caption.contains(words)
                || figure.title.contains(words);
            assert!(is_there, "{}: {words}; {}", figure.name, figure.caption);
        }
    }
}
