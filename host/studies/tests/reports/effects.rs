//! The report of the study of effects, from rows to a page: every kind of
//! row, odd numbers, and that nothing on it depends on anything outside.
//!
//! The pages are left in the target's `tmp` directory to be looked at.

use crate::evil_text;
use crate::markup::{assert_drawn, assert_page, assert_printable, count, on_a_desk};
use crepitus_scene::run::AddedTime;
use crepitus_studies::effects::answer::{Dropped, Subset};
use crepitus_studies::effects::influence::{Difference, Torque};
use crepitus_studies::effects::report::{html, pictures};
use crepitus_studies::effects::row::{Added, Outcome, Ran};
use crepitus_studies::effects::variant::Change;
use crepitus_studies::effects::{Answer, EffectsStudy, HandTorque, Row, VariantTorque};
use crepitus_studies::{Column, Paper, Section, StudyText};

fn ran(rms_nm: f64, ns: f64) -> Outcome {
    Outcome::Ran(Ran {
        torque: Torque {
            rms_nm: 1.0 + rms_nm,
            peak_nm: 2.0,
            bands_nm: [0.01 + rms_nm, 0.002, 3e-4 * rms_nm],
        },
        events: 100,
        added: Some(Added {
            rms_nm,
            peak_nm: 2.0 * rms_nm,
            events: -7,
            states: 2,
            time: AddedTime {
                ns_per_step: (ns > 1.0).then_some(ns),
                ns_resolution: if ns.is_finite() { 1.0 } else { f64::NAN },
            },
            instructions: 10.0 * ns,
        }),
    })
}

fn row(change: Change, effect: &'static str, rms_nm: f64, ns: f64) -> Row {
    Row {
        change,
        effect,
        along: Vec::new(),
        states: 3,
        ns_per_step: 100.0 + ns,
        time_spread: 0.02,
        instructions_per_step: 10.0 * ns,
        outcome: ran(rms_nm, ns),
    }
}

fn study() -> EffectsStudy {
    let mut whole = row(Change::Scene, "", 0.0, 0.0);
    whole.outcome = match ran(0.0, 0.0) {
        Outcome::Ran(ran) => Outcome::Ran(Ran { added: None, ..ran }),
        failed @ Outcome::Failed { .. } => failed,
    };
    let mut gear = row(Change::Without, "drivetrain", 0.5, 30.0);
    gear.along = vec!["friction-compensation", "backlash"];
    EffectsStudy {
        scene: "knee.toml".to_owned(),
        title: "A knee".to_owned(),
        effects: vec![
            "crepitus",
            "drivetrain",
            "friction-compensation",
            "backlash",
        ],
        tick_s: 5e-5,
        ticks: 20_000,
        warnings: Vec::new(),
        rows: vec![
            whole,
            row(Change::Without, "crepitus", 0.2, 10.0),
            gear,
            row(Change::Without, "friction-compensation", 0.003, -0.4),
            row(Change::Without, "backlash", 0.0, 12.0),
            row(Change::With, "encoder", 0.02, 9.0),
            Row {
                outcome: Outcome::Failed {
                    failure: "solver \"rk4\" is refused".to_owned(),
                },
                ..row(Change::With, "motor", 0.0, 0.0)
            },
        ],
        timings: 25,
        loop_instructions: 76.0,
        answer: None,
        build_up: Vec::new(),
        build_up_torques: Vec::new(),
        wall_s: 1.5,
        hand_torque: Some(HandTorque {
            from_s: 0.0,
            to_s: 1.0,
            less_trend: false,
            scene_nm: vec![(0.0, 0.0), (1.0, 0.3)],
            variants: vec![VariantTorque {
                name: "without crepitus".to_owned(),
                change: Change::Without,
                torque_nm: vec![(0.0, 0.1), (1.0, 0.1)],
            }],
        }),
    }
}

fn difference(rms_nm: f64) -> Difference {
    Difference {
        rms_nm,
        peak_nm: 3.0 * rms_nm,
        events_relative: 0.01,
    }
}

fn answer() -> Answer {
    let subset = |effects: &[&'static str]| Subset {
        effects: effects.to_vec(),
        difference: difference(0.003),
        states: 3,
        ns_per_step: 60.0,
    };
    let dropped = |effect, along: &[&'static str], difference, failure: Option<&str>| Dropped {
        effect,
        along: along.to_vec(),
        difference,
        failure: failure.map(str::to_owned),
    };
    Answer {
        tolerance: "torque=5e-3,events=0.1".parse().expect("a tolerance"),
        chosen: subset(&["crepitus", "drivetrain"]),
        kept: vec![
            dropped("crepitus", &[], Some(difference(0.2)), None),
            dropped("drivetrain", &["backlash"], None, Some("it diverged")),
        ],
        dropped: vec![
            dropped("friction-compensation", &[], Some(difference(0.003)), None),
            dropped("backlash", &[], Some(difference(0.0)), None),
        ],
        others: vec![subset(&["crepitus", "backlash"])],
        scene_ns_per_step: 100.0,
        scene_states: 5,
        tried: 12,
        sets: 40,
    }
}

fn text() -> StudyText {
    StudyText {
        title: "What each effect does and costs: a knee".to_owned(),
        intro: "Each effect is left out in turn.".to_owned(),
        notes: vec!["Influences do not add up.".to_owned()],
        tables: vec![Section {
            title: "What was studied".to_owned(),
            rows: vec![("ticks".to_owned(), "20000".to_owned())],
        }],
        footer: "crepitus 0.1.0, made-up rows".to_owned(),
    }
}

fn page(name: &str, study: &EffectsStudy, text: &StudyText) -> String {
    let page = html(study, text);
    let wrong = ["NaN", "inf "];
    assert_page(&format!("effects-{name}"), &page, 3_000_000, &wrong);
    on_a_desk(&page)
}

#[test]
fn every_kind_of_row_is_shown() {
    let page = page("all", &study(), &text());
    assert_eq!(count(&page, "role=\"img\""), 3);
    for part in [
        "without drivetrain (and friction-compensation, backlash)",
        "solver &quot;rk4&quot; is refused",
        "drivetrain +2</text>",
        "5 mN·m worth having",
        "<title>without crepitus: 0.2 N·m RMS, 10 ns a step</title>",
        "50–250 Hz",
        "−7",
        "<title>without friction-compensation: 0.003 N·m RMS, a cost below what can be measured (1 ns a step)</title>",
        "&lt; 1</td>",
        "an absent effect, added",
    ] {
        assert!(page.contains(part), "{part}");
    }
    assert!(!page.contains("The smallest set"));
    assert!(!page.contains("Before you believe"));
}

#[test]
fn the_smallest_set_says_what_was_dropped_and_why() {
    let mut study = study();
    study.answer = Some(answer());
    study.warnings.push("a step < a stick".to_owned());
    let page = page("answer", &study, &text());
    for part in [
        "<strong>crepitus, drivetrain</strong>",
        "60 of 100 ns a step",
        "3 mN·m RMS, at most 9 mN·m, number of events off by 1.0 %",
        "Tried 12 of the 40 sets",
        "dearer or further off: crepitus, backlash",
        "drivetrain (and backlash)",
        "it diverged",
        "a step &lt; a stick",
    ] {
        assert!(page.contains(part), "{part}");
    }
    study.answer = Some(Answer {
        chosen: Subset {
            effects: Vec::new(),
            ..answer().chosen
        },
        ..answer()
    });
    assert!(self::page("none-kept", &study, &text()).contains("No effect at all"));
}

#[test]
fn odd_numbers_are_drawn_or_left_out() {
    let mut odd = study();
    odd.hand_torque = None;
    odd.rows.truncate(2);
    for (rms_nm, ns) in [
        (0.0, 0.0),
        (1e-300, 1e-300),
        (1e300, 1e300),
        (f64::NAN, 1.0),
        (1.0, f64::INFINITY),
        (1.0, -1e9),
    ] {
        odd.rows[1].outcome = ran(rms_nm, ns);
        page("odd", &odd, &text());
    }
    for ns in [f64::NAN, f64::INFINITY, 0.0] {
        odd.rows[0].ns_per_step = ns;
        odd.rows[1].outcome = ran(0.1, 5.0);
        page("odd", &odd, &text());
    }
    odd.rows.clear();
    let empty = page("empty", &odd, &StudyText::default());
    assert_eq!(count(&empty, "role=\"img\""), 0);
}

#[test]
fn without_a_spectrum_there_are_no_bands() {
    let mut study = study();
    for row in &mut study.rows {
        if let Outcome::Ran(ran) = &mut row.outcome {
            ran.torque.bands_nm = [f64::NAN; 3];
        }
    }
    let page = page("no-bands", &study, &text());
    assert_eq!(count(&page, "role=\"img\""), 2);
}

#[test]
fn words_are_escaped() {
    let text = evil_text();
    let mut study = study();
    study.warnings.push(text.title.clone());
    study.rows[6].outcome = Outcome::Failed {
        failure: text.title.clone(),
    };
    let page = page("escaped", &study, &text);
    assert!(count(&page, "&lt;script&gt;") >= 8);
}

#[test]
fn pictures_are_documents() {
    for column in Column::ALL {
        for picture in pictures(&study(), Paper::Print(column)) {
            assert_printable(&picture);
            assert!(picture.print_mm() <= Column::Two.mm(), "{}", picture.name);
        }
    }
    let pictures = pictures(&study(), Paper::Screen);
    let names: Vec<&str> = pictures.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(names, ["bands", "influence-and-cost", "hand-torque"]);
    for picture in &pictures {
        assert_drawn(&picture.svg);
        assert!(picture.svg.contains("xmlns=\"http://www.w3.org/2000/svg\""));
    }
}
