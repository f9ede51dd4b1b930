//! Pictures for a paper: their size, letters, lines, and that they bring their letters along.

#![cfg(feature = "pdf")]

use crepitus_pages::plot::paper::{SMALLEST_PT, THINNEST_PT};
use crepitus_pages::plot::{
    Axis, Column, CurveStyle, Drawing, Figure, Key, Panel, Paper, Picture, Point, Sign, Stroke,
    Svg, pictures, stack,
};
use crepitus_pages::plot::{Chart, palette};

const PT_PER_MM: f64 = 72.0 / 25.4;

/// A chart with all that charts have: numbers, titles, names, labels, leaders, signs, levels.
fn chart(paper: Paper) -> Svg {
    let line: Vec<Point> = (0..200)
        .map(|i| f64::from(i) * 0.05)
        .map(|x| Point::new(x, x.sin()))
        .collect();
    let panel = Panel::new(
        200.0,
        Axis::linear(0.0, 10.0, 8),
        ("Torque (N·m)", Axis::linear(-1.0, 1.0, 5)),
        |plot| {
            plot.grid();
            plot.across(0.5);
            plot.line(&line, palette::OBJECT, 1.5);
            let style = CurveStyle::of(1);
            plot.over.marker((200.0, 100.0), style, true, "");
            plot.over.leader((200.0, 100.0), (230.0, 120.0), style.ink);
            plot.over.label(
                (230.0, 120.0),
                crepitus_pages::plot::Anchor::Start,
                style.ink,
                "label ωθ",
            );
        },
    );
    stack(
        paper.width(960.0),
        "x",
        vec![
            panel
                .x_title(Some("Time (s)"))
                .names(vec![(0.5, "Ts".into())]),
        ],
    )
}

fn picture(paper: Paper) -> Picture {
    let figure = Figure {
        name: "test",
        title: "Test",
        legend: vec![
            Key::new(Sign::Line(palette::OBJECT), "torque of the model"),
            Key::new(Sign::Curve(CurveStyle::of(1)), "another"),
        ],
        charts: vec![Chart::full(chart(paper))],
        caption: String::new(),
    };
    pictures([&figure]).remove(0).in_print()
}

/// The numbers of an attribute.
fn numbers(svg: &str, attribute: &str) -> Vec<f64> {
    let key = format!(" {attribute}=\"");
    svg.split(&key)
        .skip(1)
        .filter_map(|rest| rest.split_once('"')?.0.trim_end_matches("mm").parse().ok())
        .collect()
}

#[test]
fn widths_are_those_of_a_column_with_letters_of_7_pt_and_lines_of_half_a_point() {
    for column in Column::ALL {
        let picture = picture(Paper::Print(column));
        let svg = &picture.svg;
        let head = format!("width=\"{}mm\"", column.mm());
        assert!(svg.contains(&head), "{}", &svg[..300]);
        let view = svg.split_once("viewBox=\"0 0 ").unwrap().1;
        let across: f64 = view.split_once(' ').unwrap().0.parse().unwrap();
        let pt_per_px = column.mm() * PT_PER_MM / across;
        let letters = numbers(svg, "font-size");
        assert!(letters.len() > 1);
        for size in letters {
            assert!(size * pt_per_px >= SMALLEST_PT, "{} pt", size * pt_per_px);
            assert!(size * pt_per_px < 10.0, "{} pt", size * pt_per_px);
        }
        let lines = numbers(svg, "stroke-width");
        assert!(lines.len() > 5);
        for width in lines {
            assert!(width * pt_per_px >= THINNEST_PT, "{} pt", width * pt_per_px);
        }
    }
}

#[test]
fn svg_has_outlines_and_no_text_and_looks_the_same_without_fonts() {
    let picture = picture(Paper::Print(Column::One));
    assert!(picture.svg.contains("<text"));
    let outlined = picture.outlined().unwrap();
    assert!(!outlined.contains("<text") && !outlined.contains("font-family"));
    assert!(
        outlined.contains("width=\"88.9mm\""),
        "{}",
        &outlined[..200]
    );
    // Drawn by a program that knows no font, as with them.
    let draw = |svg: &str, with_fonts: bool| {
        let mut options = resvg::usvg::Options::default();
        if with_fonts {
            let fonts = options.fontdb_mut();
            fonts.load_system_fonts();
            // The one of the outlines.
            let is_there = |name: &&str| {
                fonts
                    .faces()
                    .any(|face| face.families.iter().any(|family| family.0 == *name))
            };
            let known = ["Noto Sans", "DejaVu Sans", "Arial", "Helvetica"];
            let name = known.into_iter().find(is_there).expect("a font");
            fonts.set_sans_serif_family(name);
        }
        let tree = resvg::usvg::Tree::from_str(svg, &options).unwrap();
        let mut image = resvg::tiny_skia::Pixmap::new(336, 190).unwrap();
        resvg::render(
            &tree,
            resvg::tiny_skia::Transform::default(),
            &mut image.as_mut(),
        );
        image
    };
    let image = draw(&outlined, false);
    let ink = |image: &resvg::tiny_skia::Pixmap| {
        let dark = |p: &&resvg::tiny_skia::PremultipliedColorU8| p.red() < 128;
        image.pixels().iter().filter(dark).count()
    };
    let bare = draw(&picture.svg, false);
    let (without_letters, with_letters) = (ink(&bare), ink(&image));
    assert!(
        with_letters > without_letters + 100,
        "{with_letters}, {without_letters}"
    );
    let difference = |one: &resvg::tiny_skia::Pixmap, other: &resvg::tiny_skia::Pixmap| {
        let channels = one.data().iter().zip(other.data());
        channels
            .map(|(one, other)| u64::from(one.abs_diff(*other)))
            .sum::<u64>()
    };
    let with_fonts = draw(&picture.svg, true);
    let (apart, letters) = (
        difference(&image, &with_fonts),
        difference(&bare, &with_fonts),
    );
    // Rounded coordinates move an edge by thousandths of a pixel.
    assert!(10 * apart < letters, "{apart} of {letters}");
}

#[test]
fn pdf_is_of_that_size_and_embeds_its_fonts() {
    for column in Column::ALL {
        let pdf = picture(Paper::Print(column)).pdf().unwrap();
        let text = String::from_utf8_lossy(&pdf);
        let media = text.split_once("/MediaBox [0 0 ").expect("a page").1;
        let across: f64 = media.split_once(' ').unwrap().0.parse().unwrap();
        assert!(
            (across - column.mm() * PT_PER_MM).abs() < 0.01,
            "{across} pt"
        );
        let fonts = text.matches("/Type /FontDescriptor").count();
        let embedded = text.matches("/FontFile").count();
        assert!(fonts > 0 && embedded == fonts, "{embedded} of {fonts}");
    }
}

#[test]
fn a_picture_of_fixed_layout_is_as_wide_as_its_letters_need() {
    let fixed = |across: f64| {
        let mut drawing = Drawing::default();
        drawing.label(
            (10.0, 10.0),
            crepitus_pages::plot::Anchor::Start,
            palette::TEXT,
            "cell",
        );
        drawing.line(
            &[(0.0, 0.0), (across, 9.0)],
            Stroke::new(palette::TEXT, 1.0),
        );
        Picture::new("x".into(), &drawing.svg((across, 100.0), "x"), &[], &[]).print_mm()
    };
    assert_eq!(fixed(400.0), 88.9);
    assert_eq!(fixed(900.0), 182.0);
    assert!(fixed(1200.0) > 220.0);
}
