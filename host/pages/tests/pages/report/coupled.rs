//! Reports of runs with a plant: leg, hand, motor and energy.

use std::cell::RefCell;

use super::{SINE, page, setup, text};
use crate::fixture::{Motion, Run, plant};
use crate::markup::{assert_drawn, assert_printable, count};
use crepitus_pages::plot::Column as PaperColumn;
use crepitus_pages::report::{Collector, Figures, Paper, pictures};
use crepitus_plant::energy_balance::Account;
use crepitus_scene::run::{EnergyTerm, PlantEnergySummary};

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

fn balance() -> PlantEnergySummary {
    let term = |effect, what, account, joule| EnergyTerm {
        effect,
        what,
        account,
        joule,
    };
    PlantEnergySummary {
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
        ..PlantEnergySummary::default()
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
