//! The report of the study, from points to a page: what its diagrams show and
//! leave out, and that nothing on it depends on anything outside.
//!
//! The pages are left in the target's `tmp` directory to be looked at.
// Small whole numbers.
#![allow(clippy::cast_precision_loss)]

use crate::evil_text;
use crate::markup::{assert_drawn, assert_page, assert_printable, count, keep};
use crate::study;
use crepitus_studies::accuracy::actuator::ActuatorPoint;
use crepitus_studies::accuracy::report::{html, pictures};
use crepitus_studies::accuracy::symptoms::SymptomPoint;
use crepitus_studies::accuracy::target::{LABEL, OnTarget, Row};
use crepitus_studies::accuracy::{Point, Study};
use crepitus_studies::{Column, Paper, Section, StudyText};

fn text(title: &str) -> StudyText {
    let row = |name: &str, value: &str| (name.to_owned(), value.to_owned());
    StudyText {
        title: title.to_owned(),
        intro: "Every rung of the solver ladder, in single and double precision, over steps from \
                1 ms to 2 µs, against an event-driven reference."
            .to_owned(),
        notes: vec![
            "Semi-implicit Euler is erratic at this speed: errors of neighbouring events cancel \
             by luck."
                .to_owned(),
            "Times are medians of interleaved repeats.".to_owned(),
        ],
        tables: vec![Section {
            title: "The study".to_owned(),
            rows: vec![
                row("Simulated time of a point", "10 s"),
                row("Repeats", "7, interleaved"),
                row("Spread of the repeats", "median 2.1 %, worst 6 %"),
            ],
        }],
        footer: "crepitus 0.1.0, made-up points".to_owned(),
    }
}

fn page(name: &str, points: &[Point], text: &StudyText) -> String {
    whole_page(name, &of_points(points), text)
}

fn of_points(points: &[Point]) -> Study {
    Study {
        points: points.to_vec(),
        ..Study::default()
    }
}

fn whole_page(name: &str, study: &Study, text: &StudyText) -> String {
    let page = html(study, text);
    let wrong = ["NaN", "inf,", "inf "];
    assert_page(&format!("accuracy-{name}"), &page, 3_000_000, &wrong);
    page
}

#[test]
fn symptoms_have_a_table_at_the_tick_and_one_by_step() {
    let point = |symptom, form, step_s, events_true, unmatched| SymptomPoint {
        symptom,
        form,
        precision: "f32",
        step_s,
        events: events_true + unmatched,
        events_true,
        unmatched,
        max_event_error_s: if events_true > 0 { 1.5e-8 } else { f64::NAN },
        rms_event_error_s: f64::NAN,
        max_tick_torque_error_nm: 2.5e-6,
        rms_tick_torque_error_nm: 3e-7,
        ns_per_step: 12.5,
        time_ratio: 6.25,
        time_spread: 0.01,
    };
    let points = [
        point("lead-pipe", None, 1e-4, 0, 0),
        point("lead-pipe", None, 5e-5, 0, 0),
        point("cogwheel", Some("space"), 5e-5, 40, 0),
        point("texture", None, 5e-5, 40, 3),
    ];
    let study = Study {
        symptoms: points.to_vec(),
        ..Study::default()
    };
    let page = whole_page("symptoms", &study, &text("With symptoms"));
    assert_eq!(count(&page, "The other symptoms"), 1);
    assert!(page.contains("cogwheel (space)") && page.contains("3 unmatched"));
    assert!(page.contains("100 µs") && page.contains("50 µs"));
    // Only lead-pipe was studied at both steps.
    assert_eq!(count(&page, "lead-pipe</th>"), 2);
    assert!(page.contains("1.5·10⁻⁸") && page.contains("worst event error"));
    let without = page_of_nothing();
    assert!(!without.contains("The other symptoms"));
}

fn page_of_nothing() -> String {
    whole_page("nothing", &Study::default(), &text("Without"))
}

#[test]
fn the_actuator_has_a_table() {
    let study = Study {
        actuator: vec![ActuatorPoint {
            precision: "f32",
            step_s: 5e-5,
            error: 0.0123,
            rounding: 2.5e-7,
            time_ratio: 1.25,
        }],
        ..Study::default()
    };
    let page = whole_page("actuator", &study, &text("With the actuator"));
    assert!(page.contains("<th scope=\"row\">50 µs</th>") && page.contains("2.5·10⁻⁷"));
    assert!(!page_of_nothing().contains("vibration actuator"));
}

#[test]
fn a_whole_study() {
    let page = page("study", &study::all(), &text("What accuracy costs in time"));
    // Seven pairs, four measures, two precisions.
    assert_eq!(count(&page, "role=\"img\""), 7 * 4 * 2);
    // The frozen and the physical 0.988 are open, the others folded.
    assert_eq!(count(&page, "<details"), 5);
    let frozen = page.find("constant-0.988, frozen").expect("first");
    let physical = page.find("constant-0.988, physical").expect("second");
    let others = page.find("<details").expect("others");
    assert!(frozen < physical && physical < others);
    assert!(page.contains("0.1 ms imperceptible"));
    assert!(page.contains("5 mN·m worth having"));
    assert!(page.contains("At the device's tick, 50 µs"));
    assert!(page.contains("Held torque: the RMS error against the cost"));
    assert!(page.contains("nearer than 4.7·10⁻³ N·m"));
    // Steps that can be read in print.
    for step in [">1 ms</text>", ">50 µs</text>", ">2 µs</text>"] {
        assert!(page.contains(step), "{step}");
    }
}

#[test]
fn what_the_target_says_has_its_diagram_and_its_table() {
    let mut points = study::all();
    let (mut marked, mut cycles) = (0, 100.0);
    for point in &mut points {
        let is_there = point.scene == "constant-0.988" && point.convention == "frozen";
        if is_there && point.precision == "f32" && point.step_s == 5e-5 {
            cycles += 10.0;
            point.cycles_per_step = cycles;
            point.worst_cycles = 5.0 * cycles;
            point.instructions_per_step = 0.5 * cycles;
            marked += usize::from(point.unmatched == 0);
        }
    }
    let row = Row {
        subject: "bone-shaping",
        form: None,
        convention: None,
        is_rung: false,
        frequency_error_rel: f64::NAN,
        mean_cycles: 171.4,
        worst_cycles: 192,
        worst_on: "extremes".to_owned(),
        mean_instructions: 125.0,
        worst_instructions: 141,
        mean_share: 0.0204,
        worst_share: 0.0229,
        steps: 100,
    };
    let target = OnTarget {
        label: LABEL,
        tick_cycles: 8_400.0,
        steps: 100,
        rows: vec![row],
    };
    let study = Study {
        target: Some(target),
        ..of_points(&points)
    };
    let page = whole_page("target", &study, &text("On the target"));
    assert!(marked >= 2);
    assert_eq!(count(&page, "% of a tick)</title>"), marked);
    assert_eq!(count(&page, "role=\"img\""), 7 * 4 * 2 + 1);
    assert!(page.contains("not measured on hardware"));
    assert!(page.contains("bone-shaping") && page.contains("extremes"));
    let pictures = pictures(&points, Paper::Screen);
    let names = pictures.iter().filter(|p| p.name.starts_with("target-"));
    let names: Vec<_> = names.map(|p| p.name.as_str()).collect();
    assert_eq!(names, ["target-constant-0-988-frozen-f32"]);
}

#[test]
fn titles_tell_rung_step_error_and_cost() {
    let page = page(
        "one-pair",
        &study::pair("constant-0.988", "physical"),
        &text("One pair"),
    );
    let title = page
        .split("<title>")
        .find(|title| title.starts_with("exact-break, f64, step 50 µs: error "))
        .expect("a title");
    let title = title.split('<').next().expect("its text");
    assert!(title.contains("·10⁻⁸ s, cost 7"), "{title}");
    // The quartiles of the repeats.
    assert!(title.contains(" (5") && title.contains("–1"), "{title}");
    assert!(title.ends_with("µs per simulated second"), "{title}");
    assert_eq!(count(&page, "<details"), 0);
}

#[test]
fn wrong_points_are_in_the_list_and_in_no_curve() {
    let points: Vec<Point> = study::pair("constant-0.988", "physical")
        .into_iter()
        .filter(|point| point.solver == "euler" && point.precision == "f64")
        .collect();
    let wrong = points.iter().filter(|point| point.unmatched > 0).count();
    assert_eq!(wrong, 5);
    let page = page("euler", &points, &text("Euler alone"));
    // Four curves of the four points that are left.
    let curves: Vec<&str> = page
        .split("<path")
        .skip(1)
        .filter_map(|rest| rest.split_once('>'))
        .map(|(tag, _)| tag)
        .filter(|tag| tag.contains("stroke-width=\"1.75\"") && tag.contains("#d55e00"))
        .collect();
    let long: Vec<usize> = curves
        .iter()
        .filter_map(|tag| tag.split(" d=\"").nth(1)?.split('"').next())
        // Two numbers a point.
        .map(|path| path.split([' ', 'l']).count() / 2)
        .filter(|number| *number > 2)
        .collect();
    assert_eq!(long, [4, 4, 4, 4]);
    // Nor has one a sign.
    assert!(!page.contains("step 1 ms: error"));
    assert_eq!(count(&page, "step 20 µs: error"), 4);
    assert!(page.contains("wrong events"));
    let first = points.first().expect("a point");
    assert!(page.contains(&format!("1 ms: {} of 637", first.events)));
    assert!(page.contains(&format!("50 µs: {} of 637", points[4].events)));
}

#[test]
fn errors_that_are_no_number_are_listed() {
    let mut points = study::pair("sine", "physical");
    points.retain(|point| point.solver == "exact");
    for point in &mut points {
        point.frequency_error_rel = f64::NAN;
        point.max_event_error_s = 0.0;
    }
    let page = page("no-number", &points, &text("No cycle"));
    assert!(page.contains("no frequency error"));
    assert!(page.contains("Not drawn: no point has this error."));
    assert!(page.contains("the error is 0, or below"));
    assert_eq!(count(&page, "role=\"img\""), 6);
}

#[test]
fn every_rung_has_its_own_curve() {
    let page = page(
        "hands",
        &study::pair("constant-0.988", "physical"),
        &text("Hands"),
    );
    let legend = page.split("<ul class=\"legend\">").nth(1).expect("legend");
    let legend = legend.split("</ul>").next().expect("its end");
    let mut samples: Vec<&str> = legend
        .split("<svg")
        .skip(1)
        .filter_map(|entry| entry.split("</svg>").next())
        .collect();
    assert_eq!(count(legend, "bar: quartiles of the timings"), 1);
    // Ten rungs and the filled sign.
    assert_eq!(samples.len(), 11);
    samples.sort_unstable();
    samples.dedup();
    assert_eq!(samples.len(), 11);
}

#[test]
fn no_points_and_odd_points() {
    let empty = page("empty", &[], &StudyText::default());
    assert!(empty.contains("There are no points to draw."));
    assert_eq!(count(&empty, "<svg"), 0);
    let mut one = study::pair("constant-0.988", "frozen");
    one.truncate(1);
    let single = page("one-point", &one, &text("One point"));
    assert_eq!(count(&single, "role=\"img\""), 4);
    for value in [f64::NAN, f64::INFINITY, 0.0, -1.0] {
        one[0].us_per_simulated_s = value;
        one[0].ns_per_step = value;
        let page = page("odd", &one, &text("Odd"));
        assert_eq!(count(&page, "role=\"img\""), 0);
        assert!(page.contains("or no cost"));
    }
    one[0] = study::pair("constant-0.988", "frozen").remove(0);
    for value in [0.0, f64::MIN_POSITIVE, 1e-18, f64::MAX] {
        one[0].max_event_error_s = value;
        one[0].rms_held_torque_error_nm = value;
        one[0].rms_tick_torque_error_nm = value;
        one[0].frequency_error_rel = value;
        let page = page("extreme", &one, &text("Extreme"));
        assert_eq!(count(&page, "role=\"img\""), 4);
    }
    let mut many = Vec::new();
    for (i, name) in [
        "a", "b", "c", "d", "e", "f", "g", "h", "i", "j", "k", "l", "m", "n", "o", "p", "q", "r",
        "s", "t", "u", "v", "w", "x", "y", "z",
    ]
    .into_iter()
    .enumerate()
    {
        let mut point = study::pair("many", "frozen").remove(9 + 4);
        point.solver = name;
        point.us_per_simulated_s *= 1.0 + i as f64;
        many.push(point);
    }
    page("many", &many, &text("Many rungs"));
}

/// Left ends and widths of the error bars of the first rung, CSS pixels.
fn bars(svg: &str) -> Vec<(f64, f64)> {
    let paths = svg.split("<path d=\"").skip(1);
    let of_rung = |path: &&str| {
        let tag = path.split('>').next().unwrap_or_default();
        // A leader to a name is one line.
        tag.matches('M').count() > 3
            && tag.contains("#d55e00")
            && tag.contains("stroke-width=\"1\"")
    };
    let lines = paths
        .filter(of_rung)
        .flat_map(|path| path.split('"').next().unwrap_or_default().split('M'));
    let bar = |line: &str| {
        let (start, way) = line.split_once('l')?;
        let left = start.split_once(' ')?.0.parse().ok()?;
        let (width, height) = way.split_once(' ')?;
        // The others are the caps.
        (height == "0").then_some((left, width.parse().ok()?))
    };
    lines.filter_map(bar).collect()
}

#[test]
fn error_bars_span_the_quartiles_of_the_cost() {
    let mut points = study::pair("constant-0.988", "physical");
    points.retain(|point| point.solver == "exact" && point.precision == "f32");
    for point in &mut points {
        point.ns_per_step = 4.0;
        point.ns_per_step_q1 = 3.2;
        point.ns_per_step_q3 = 6.0;
        point.us_per_simulated_s = 4e-3 / point.step_s;
    }
    let pictures = pictures(&points, Paper::Screen);
    assert_eq!(pictures.len(), 4);
    for picture in pictures {
        let bars = bars(&picture.svg);
        assert_eq!(bars.len(), study::STEPS.len(), "{}", picture.name);
        // Steps of 1 and of 0.1 ms.
        let decade = bars[3].0 - bars[0].0;
        let width = (6.0_f64 / 3.2).log10() * decade;
        for (_, found) in bars {
            assert!(
                decade > 50.0 && (found - width).abs() < 0.3,
                "{found} {width}"
            );
        }
    }
}

#[test]
fn curves_behind_the_encoder_stand_beside_the_others_with_bars_of_the_quartiles() {
    let mut points = study::pair("constant-0.988", "frozen");
    let alone = pictures(&points, Paper::Screen).len();
    let mut behind = points.clone();
    behind.retain(|point| point.precision == "f32");
    for point in &mut behind {
        point.input = "encoder";
        point.max_event_error_s = 2e-5;
        // Its own cost: the same axis has room for it.
        for time in [
            &mut point.ns_per_step,
            &mut point.ns_per_step_q1,
            &mut point.ns_per_step_q3,
            &mut point.us_per_simulated_s,
        ] {
            *time *= 4.0;
        }
    }
    points.extend(behind);
    let page = page("encoder", &points, &text("Behind the encoder"));
    assert_eq!(count(&page, "role=\"img\""), 4 * 3);
    assert_eq!(count(&page, "<figcaption>f32, encoder</figcaption>"), 4);
    assert_eq!(count(&page, "Encoder: the rung has counts"), 4);
    assert!(page.contains("exact, f32, encoder, step 50 µs: error 2.0·10⁻⁵ s"));
    let shown = pictures(&points, Paper::Screen);
    assert_eq!((alone, shown.len()), (8, 12));
    let of = |name: &str| shown.iter().find(|p| p.name == name).expect("a picture");
    of("event-time-constant-0-988-frozen-f32-encoder");
}

#[test]
fn words_are_escaped() {
    let text = evil_text();
    let mut points = study::pair("<script>alert('&')</script>", "frozen");
    for point in &mut points {
        point.solver = "<script>&\"";
    }
    let page = page("escaped", &points, &text);
    assert!(count(&page, "&lt;script&gt;") > 8);
}

#[test]
fn pictures_are_documents_with_their_legend() {
    for column in Column::ALL {
        for picture in pictures(&study::all(), Paper::Print(column)) {
            assert_printable(&picture);
            assert_eq!(picture.print_mm(), column.mm(), "{}", picture.name);
        }
    }
    let pictures = pictures(&study::all(), Paper::Screen);
    assert_eq!(pictures.len(), 56);
    let mut names: Vec<&str> = pictures.iter().map(|p| p.name.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), 56);
    let picture = pictures
        .iter()
        .find(|p| p.name == "event-time-constant-0-988-physical-f64")
        .expect("a name");
    keep("accuracy.svg", &picture.svg);
    assert_drawn(&picture.svg);
    assert!(picture.svg.contains("xmlns=\"http://www.w3.org/2000/svg\""));
    assert!(picture.svg.contains("device's tick"));
}
