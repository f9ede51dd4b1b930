//! Whole reports, from rows to a page: what is on it, and that nothing on it
//! depends on anything outside.
//!
//! The pages are left in the target's `tmp` directory to be looked at.

mod coupled;
mod recorded;

use std::cell::RefCell;

use crate::fixture::{KINETIC, Motion, Run, STATIC};
use crate::markup::{assert_page, count, on_a_desk};
use crepitus_model::render::effects::EffectSettings;
use crepitus_pages::report::{Collector, Figures, Section, Setup, Text, TorqueLevels, html};
use crepitus_scene::trace::Column;

const SINE: Motion = Motion::Sine {
    amplitude: 0.5,
    frequency: 0.4,
    phase: -1.5,
};

/// A run of this motion, with as many rows as it announces.
fn collect(motion: Motion, rows: u32, step: f64, encoder: bool) -> Figures {
    let columns = Run::columns(true, encoder);
    let collector = RefCell::new(Collector::new(&setup(&columns, rows, step)));
    let run = Run::new(motion, f64::from(rows - 1) * step, step);
    let run = if encoder { run.with_encoder() } else { run };
    run.play(
        |row| collector.borrow_mut().row(row),
        |event| collector.borrow_mut().event(event),
    );
    collector.into_inner().finish()
}

fn setup(columns: &[Column], rows: u32, step: f64) -> Setup<'_> {
    Setup {
        columns,
        rows_expected: u64::from(rows),
        row_step_s: step,
        levels: Some(TorqueLevels::elastic(KINETIC, STATIC)),
        effects: EffectSettings::default(),
    }
}

fn text(title: &str) -> Text {
    let row = |name: &str, value: &str| (name.to_owned(), value.to_owned());
    Text {
        title: title.to_owned(),
        description: Some(
            "The joint of a patient with coarse crepitus, moved slowly.\n\
             Parameters are those of the paper."
                .to_owned(),
        ),
        warnings: vec![
            "The step of 1 ms is longer than a stick phase (0.95 ms at 1 rad/s): torque peaks \
             between rows are seen only at events."
                .to_owned(),
        ],
        sections: vec![
            Section {
                title: "Run".to_owned(),
                rows: vec![
                    row("Scene", "coarse-sine"),
                    row("Duration", "10 s"),
                    row("Solver", "exact-events, 50 µs, f64"),
                    row("Real-time factor", "812"),
                ],
            },
            Section {
                title: "Torque".to_owned(),
                rows: vec![
                    row("Smallest", "−0.4 N·m"),
                    row("Mean", "0.012 N·m"),
                    row("Largest", "0.4 N·m"),
                    row("RMS", "0.213 N·m"),
                ],
            },
            Section {
                title: "Effects".to_owned(),
                rows: vec![
                    row("crepitus", "2 states, 31 ns a step"),
                    row("encoder", "1 state, 9 ns a step"),
                ],
            },
        ],
        footer: "crepitus 0.1.0, report of a closed-form run".to_owned(),
    }
}

/// Draws, checks what every page must keep to, and leaves the page to be
/// looked at.
fn page(name: &str, text: &Text, figures: &Figures) -> String {
    let page = html(text, figures);
    assert_page(name, &page, 500_000, &["NaN", "inf,"]);
    on_a_desk(&page)
}

#[test]
fn a_long_sine_with_an_encoder() {
    let motion = Motion::Sine {
        amplitude: 0.785,
        frequency: 0.25,
        phase: -1.5,
    };
    let figures = collect(motion, 200_001, 5e-5, true);
    let page = page("sine", &text("Coarse crepitus, slow flexion"), &figures);
    // Motion, torque, two zooms, two orbits and the whole run, spectrum.
    assert_eq!(count(&page, "<svg "), 8);
    assert_eq!(count(&page, "role=\"img\""), 8);
    assert!(page.contains("speed by the encoder"));
    assert!(page.contains("The fastest part"));
    assert!(page.contains("−Tk = −0.2"));
    assert!(page.contains("Warning"));
}

#[test]
fn a_steady_run() {
    let motion = Motion::Constant { speed: 1.0 };
    let figures = collect(motion, 200_001, 5e-5, false);
    let page = page("steady", &text("Constant speed of 1 rad/s"), &figures);
    assert_eq!(count(&page, "<svg "), 6);
    assert!(!page.contains("speed by the encoder"));
    assert!(!page.contains("slip −"));
    assert!(page.contains("the strongest line is at"));
}

#[test]
fn a_short_run_shows_every_cycle() {
    let motion = Motion::Constant { speed: 1.0 };
    let figures = collect(motion, 16_001, 5e-5, false);
    let page = page("short", &text("Less than a second"), &figures);
    assert!(!page.contains("too many cycles"));
    assert!(page.contains("Tk = 0.2"));
}

#[test]
fn coarse_rows_still_show_the_cycles() {
    let motion = Motion::Constant { speed: 1.0 };
    let figures = collect(motion, 501, 4e-3, false);
    let page = page("coarse", &text("A trace of few rows"), &figures);
    assert!(page.contains("too few for a spectrum"));
    assert!(page.contains("The onset"));
}

#[test]
fn slow_motion_sticks_for_long() {
    let motion = Motion::Sine {
        amplitude: 0.01,
        frequency: 0.1,
        phase: -1.5,
    };
    let figures = collect(motion, 10_001, 1e-3, false);
    page("slow", &text("Slow motion"), &figures);
}

#[test]
fn presliding_has_no_events() {
    let motion = Motion::Sine {
        amplitude: 8e-4,
        frequency: 0.5,
        phase: 0.0,
    };
    let figures = collect(motion, 4001, 1e-3, false);
    let page = page("presliding", &text("Presliding"), &figures);
    assert!(page.contains("never broke loose"));
}

#[test]
fn a_healthy_joint_is_motion_only() {
    let columns = Run::columns(false, false);
    let mut collector = Collector::new(&Setup {
        columns: &columns,
        rows_expected: 1000,
        row_step_s: 1e-3,
        levels: None,
        effects: EffectSettings::default(),
    });
    for i in 0..1000_u32 {
        let t = f64::from(i) * 1e-3;
        collector.row(&[t, t.sin(), t.cos()]);
    }
    let page = page("healthy", &text("Healthy"), &collector.finish());
    assert_eq!(count(&page, "<svg "), 1);
    for absent in ["Torque (N·m)", "A zoom", "Spectrum", "Imaginary"] {
        assert!(!page.contains(absent), "{absent}");
    }
}

#[test]
fn no_rows_and_one_row() {
    let columns = Run::columns(true, true);
    let setup = Setup {
        columns: &columns,
        rows_expected: 0,
        row_step_s: 5e-5,
        levels: Some(TorqueLevels::elastic(KINETIC, STATIC)),
        effects: EffectSettings::default(),
    };
    let empty = page("empty", &Text::default(), &Collector::new(&setup).finish());
    assert!(empty.contains("too few rows to draw"));
    let mut collector = Collector::new(&setup);
    collector.row(&[0.0, 0.1, 1.0, 0.0, 0.0, 1.0, 0.0, 0.1, 1.0]);
    let one = page("one-row", &Text::default(), &collector.finish());
    assert_eq!(count(&one, "<svg "), 0);
}

#[test]
fn broken_values_are_left_out_and_counted() {
    let columns = Run::columns(true, false);
    let collector = RefCell::new(Collector::new(&Setup {
        columns: &columns,
        rows_expected: 2000,
        row_step_s: 1e-3,
        levels: Some(TorqueLevels::elastic(f64::NAN, STATIC)),
        effects: EffectSettings::default(),
    }));
    let mut broken = 0;
    Run::new(Motion::Constant { speed: 1.0 }, 2.0, 1e-3).play(
        |row| {
            let mut row = row.to_vec();
            broken += 1;
            match broken % 50 {
                7 => row[6] = f64::NAN,
                19 => row[1] = f64::INFINITY,
                23 => row[0] = f64::NAN,
                31 => row.fill(f64::NEG_INFINITY),
                _ => {}
            }
            collector.borrow_mut().row(&row);
        },
        |event| {
            let mut event = *event;
            event.torque_after_nm = f64::NAN;
            collector.borrow_mut().event(&event);
        },
    );
    let page = page("broken", &text("Broken"), &collector.into_inner().finish());
    // Four of every fifty of 2,001 rows.
    assert!(page.contains(">160 rows hold values that are not finite"));
}

#[test]
fn a_column_that_may_lack_a_value_breaks_no_row() {
    let columns = Run::columns(true, false);
    for (lacks, told) in [(f64::NAN, false), (f64::INFINITY, true)] {
        let mut collector = Collector::new(&Setup {
            columns: &columns,
            rows_expected: 100,
            row_step_s: 1e-3,
            levels: None,
            effects: EffectSettings::default(),
        });
        collector.may_lack_from(columns.len() - 1);
        for n in 0..100 {
            let mut row = vec![0.0; columns.len()];
            row[0] = f64::from(n) * 1e-3;
            row[columns.len() - 1] = lacks;
            collector.row(&row);
        }
        let page = crepitus_pages::report::html(&text("Lacks"), &collector.finish());
        assert_eq!(page.contains("not finite"), told, "{lacks}");
    }
}

#[test]
fn words_are_escaped() {
    let evil = "<script>alert('&')</script>";
    let columns = Run::columns(false, false);
    let figures = Collector::new(&Setup {
        columns: &columns,
        rows_expected: 0,
        row_step_s: 1.0,
        levels: None,
        effects: EffectSettings::default(),
    })
    .finish();
    let text = Text {
        title: evil.to_owned(),
        description: Some(evil.to_owned()),
        warnings: vec![evil.to_owned()],
        sections: vec![Section {
            title: evil.to_owned(),
            rows: vec![(evil.to_owned(), evil.to_owned())],
        }],
        footer: evil.to_owned(),
    };
    let page = page("escaped", &text, &figures);
    assert_eq!(count(&page, "&lt;script&gt;"), 8);
}
