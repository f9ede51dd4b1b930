//! Whole reports, from rows to a page: what is on it, and that nothing on it
//! depends on anything outside.
//!
//! The pages are left in the target's `tmp` directory to be looked at.

use std::cell::RefCell;
use std::path::Path;

use crate::fixture::{KINETIC, Motion, Run, STATIC, plant};
use crate::markup::{
    assert_balanced, assert_drawn, assert_fits_a_phone, assert_labels_inside, assert_printable,
    charts, count, on_a_desk,
};
use crepitus_model::render::effects::EffectSettings;
use crepitus_pages::plot::Column as PaperColumn;
use crepitus_pages::report::{
    Account, Balance, Collector, EnergyTerm, Figures, Mark, Paper, Section, Setup, Text,
    TorqueLevels, html, pictures,
};
use crepitus_scene::trace::Column;

/// A run of this motion, with as many rows as it announces.
fn collect(motion: Motion, rows: u32, step: f64, encoder: bool) -> Figures {
    let columns = Run::columns(true, encoder);
    let collector = RefCell::new(Collector::new(&Setup {
        columns: &columns,
        rows_expected: u64::from(rows),
        row_step_s: step,
        levels: Some(TorqueLevels::elastic(KINETIC, STATIC)),
        effects: EffectSettings::default(),
    }));
    let run = Run::new(motion, f64::from(rows - 1) * step, step);
    let run = if encoder { run.with_encoder() } else { run };
    run.play(
        |row| collector.borrow_mut().row(row),
        |event| collector.borrow_mut().event(event),
    );
    collector.into_inner().finish()
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
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}.html"));
    std::fs::write(path, &page).expect("written");
    assert!(page.len() < 500_000, "{name}: {} bytes", page.len());
    for forbidden in ["http", "url(", "<script", "@import", "NaN", "inf,"] {
        assert!(!page.contains(forbidden), "{name} contains {forbidden}");
    }
    assert_balanced(&page);
    assert_fits_a_phone(&page);
    for chart in charts(&page) {
        assert!(assert_labels_inside(&chart) > 3);
    }
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

const SINE: Motion = Motion::Sine {
    amplitude: 0.5,
    frequency: 0.4,
    phase: -1.5,
};

/// A run with a plant that has these columns.
fn coupled(motion: Motion, rows: u32, step: f64, encoder: bool, names: &[&'static str]) -> Figures {
    let columns = plant::columns(Run::columns(true, encoder), names);
    let collector = RefCell::new(Collector::new(&setup(&columns, rows, step)));
    let run = Run::new(motion, f64::from(rows - 1) * step, step);
    let run = if encoder { run.with_encoder() } else { run };
    run.play(
        |row| {
            collector.borrow_mut().row(&plant::row(row, row[6], names));
        },
        |event| collector.borrow_mut().event(event),
    );
    let mut figures = collector.into_inner().finish();
    figures.set_balance(balance());
    figures
}

/// A run with a plant and a healthy joint.
fn healthy(rows: u32, step: f64, names: &[&'static str]) -> Figures {
    let columns = plant::columns(Run::columns(false, false), names);
    let mut collector = Collector::new(&setup(&columns, rows, step));
    for i in 0..rows {
        let t = f64::from(i) * step;
        let joint = [t, 1.0 - 0.6 * (3.0 * t).cos(), 1.8 * (3.0 * t).sin()];
        collector.row(&plant::row(&joint, 0.0, names));
    }
    let mut figures = collector.finish();
    figures.set_balance(balance());
    figures
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

fn balance() -> Balance {
    let term = |effect: &str, what: &str, account, joule| EnergyTerm {
        effect: effect.to_owned(),
        what: what.to_owned(),
        account,
        joule,
    };
    Balance {
        terms: vec![
            term("hand", "work", Account::Given, 1.2),
            term("hand", "arm", Account::Stored, 1e-5),
            term("motor", "supply", Account::Given, 0.4),
            term("drivetrain", "friction", Account::Lost, 1.3),
            term("drivetrain", "rotor", Account::Stored, 2e-5),
            term("limb", "weight", Account::Stored, -0.1),
            term("limb", "damping", Account::Lost, 0.399_97),
        ],
        residual_j: 1e-14,
        residual_relative: 3e-15,
    }
}

#[test]
fn a_coupled_run_with_all_effects() {
    let figures = coupled(SINE, 100_001, 5e-5, true, &plant::ALL);
    let page = page("coupled", &text("All effects"), &figures);
    // Motion, torque, hand, two zooms, three orbits, spectrum, nine columns,
    // energy.
    assert_eq!(count(&page, "<svg "), 19);
    for present in [
        "What the hand feels",
        "Torque of the model",
        "intended by the hand",
        "hand torque, fast part",
        "torque of the motor",
        "model, RMS in the band",
        "Backlash: rotor ahead of the joint",
        "hand: work",
        "2 smaller terms",
        "given = stored + lost",
        "of the hand torque is at",
    ] {
        assert!(page.contains(present), "{present}");
    }
    for column in PaperColumn::ALL {
        for picture in pictures(&figures, Paper::Print(column)) {
            assert_printable(&picture);
            let is_bars = picture.name == "energy";
            assert!(
                is_bars || picture.print_mm() <= column.mm(),
                "{}",
                picture.name
            );
        }
    }
    let pictures = pictures(&figures, Paper::Screen);
    for picture in &pictures {
        assert_drawn(&picture.svg);
    }
    let names: Vec<String> = pictures.into_iter().map(|p| p.name).collect();
    for name in ["hand", "energy", "effects-9", "spectrum"] {
        assert!(names.iter().any(|n| n == name), "{name} of {names:?}");
    }
}

#[test]
fn a_short_coupled_run_draws_lines_and_phases() {
    let names = [
        "motor_current_a",
        "motor_voltage_v",
        "motor_torque_nm",
        "hand_torque_nm",
    ];
    let figures = coupled(Motion::Constant { speed: 1.0 }, 12_001, 5e-5, false, &names);
    let page = page("coupled-short", &text("A motor alone"), &figures);
    assert!(!page.contains("too many cycles"));
    assert!(!page.contains(">range<"));
    assert!(!page.contains("how far each is ahead"));
    assert!(page.contains("the motor’s own"));
}

#[test]
fn a_released_healthy_leg_is_motion_weight_and_energy() {
    let figures = healthy(5001, 1e-3, &["limb_torque_nm"]);
    let page = page("released", &text("Pendulum test"), &figures);
    assert_eq!(count(&page, "<svg "), 3);
    for absent in [
        "What the hand feels",
        "A zoom",
        "Spectrum",
        "the motor’s own",
    ] {
        assert!(!page.contains(absent), "{absent}");
    }
}

#[test]
fn a_hand_moves_a_healthy_leg() {
    let names = ["limb_torque_nm", "intended_angle_rad", "hand_torque_nm"];
    let figures = healthy(5001, 1e-3, &names);
    let page = page("healthy-hand", &text("Healthy, with a hand"), &figures);
    // Motion, hand, spectrum, weight, energy.
    assert_eq!(count(&page, "<svg "), 5);
    assert!(page.contains("Spectrum of the hand torque"));
    assert!(page.contains("Fast part (N·m)"));
    assert!(!page.contains("broke loose"));
}

#[test]
fn few_and_coarse_rows_of_a_coupled_run() {
    for (rows, step) in [(2, 1e-2), (3, 5e-5), (40, 0.03), (40, 1e-3), (402, 1e-3)] {
        let figures = coupled(
            Motion::Constant { speed: 1.0 },
            rows,
            step,
            true,
            &plant::ALL,
        );
        let page = page("coupled-few", &text("Few rows"), &figures);
        assert!(page.contains("What the hand feels"));
        // Too far apart, or too short.
        assert_eq!(page.contains("Fast part"), rows == 402, "{rows} {step}");
        assert!(page.contains("too few for a spectrum"));
    }
    for rows in [0, 1] {
        let figures = healthy(rows, 1e-3, &plant::ALL);
        let page = page("coupled-none", &text("No rows"), &figures);
        assert_eq!(count(&page, "<svg "), 0);
    }
}

#[test]
fn what_never_moves_has_no_chart_and_peaks_do_not_hide_the_rest() {
    let names = ["shaping_nm", "gear_friction_nm", "hand_torque_nm"];
    let columns = plant::columns(Run::columns(false, false), &names);
    let mut collector = Collector::new(&setup(&columns, 10_000, 1e-3));
    for i in 0..10_000_u32 {
        let t = f64::from(i) * 1e-3;
        let hit = if i % 1000 == 500 { 700.0 } else { 0.0 };
        let mut row = plant::row(&[t, t.sin(), t.cos()], 0.0, &names);
        row[5] += hit;
        collector.row(&row);
    }
    let page = page("peaks", &text("Peaks"), &collector.finish());
    // Motion, hand, spectrum, gear: no energy either.
    assert_eq!(count(&page, "<svg "), 4);
    assert!(page.contains("Zero all the time: Bone shaping"));
    assert!(page.contains("Peaks of up to 69"));
}

/// A recording of so many seconds: torque, motor, two changes of parameters,
/// and the push that arms it.
fn recorded(rows: u32, pushed_s: f64) -> Figures {
    let names = ["motor_torque_nm"];
    let columns = plant::columns(Run::columns(true, false), &names);
    let collector = RefCell::new(Collector::new(&setup(&columns, rows, 5e-5)));
    for (at, name) in [
        (0.1, "revision 3: kinetic_torque_nm = 0.25"),
        (0.4, "revision 4: 2 parameters"),
    ] {
        collector.borrow_mut().mark(Mark {
            at,
            name: name.to_owned(),
        });
    }
    collector
        .borrow_mut()
        .arming_push(pushed_s, pushed_s + 0.016);
    let last_s = f64::from(rows - 1) * 5e-5;
    Run::new(Motion::Constant { speed: 1.0 }, last_s, 5e-5).play(
        |row| collector.borrow_mut().row(&plant::row(row, row[6], &names)),
        |event| collector.borrow_mut().event(event),
    );
    collector.into_inner().finish()
}

#[test]
fn every_chart_over_time_says_when_parameters_changed() {
    for rows in [12_001, 200_001] {
        let page = page("recorded", &text("A recording"), &recorded(rows, 0.0));
        let over_time = charts(&page).filter(|chart| chart.contains(">Time (s)<"));
        let mut charts = 0;
        for chart in
            over_time.filter(|chart| chart.contains("whole run") || chart.contains("Motor torque"))
        {
            charts += 1;
            // Named once, above the panels; a line in each panel, and from the first up to the name.
            let panels = count(&chart, "rotate(-90");
            let marks = 2 + usize::from(chart.contains("Motor torque"));
            let in_panels = 2 * panels + marks - 2;
            assert_eq!(
                count(&chart, "stroke-dasharray=\"2 3\""),
                in_panels + marks,
                "{chart:.200}"
            );
            assert_eq!(
                count(&chart, ">revision 3: kinetic_torque_nm = 0.25</text>"),
                1
            );
        }
        // Motion, torque, motor.
        assert_eq!(charts, 3, "{rows}");
    }
    let page = page(
        "not-recorded",
        &text("No change"),
        &collect(SINE, 12_001, 5e-5, false),
    );
    assert_eq!(count(&page, "stroke-dasharray=\"2 3\""), 0);
}

#[test]
fn the_push_that_arms_is_shaded_and_named_on_the_motors_torque() {
    let page = page("armed", &text("A recording"), &recorded(12_001, 0.0));
    let named: Vec<String> = charts(&page)
        .filter(|chart| chart.contains(">arming: polarity test</text>"))
        .collect();
    // The motor's own chart, and the zoom in which it begins.
    assert_eq!(named.len(), 2);
    assert!(named.iter().all(|chart| chart.contains("fill=\"#c8d5e0\"")));
    assert!(page.contains("no torque that was rendered, and in no table"));
    // A zoom on another stretch of time does not show it.
    let later = on_a_desk(&html(&text("A recording"), &recorded(200_001, 5.0)));
    assert_eq!(count(&later, ">arming: polarity test</text>"), 1);
}
