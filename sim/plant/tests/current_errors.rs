//! Errors of the torque by bridge and amplifiers, before and after the drive's corrections: the tables of
//! docs/generated/current-path.md.
//!
//! ```sh
//! CREPITUS_BLESS=1 cargo test -p crepitus-plant --test current_errors
//! ```

use crepitus_model::control::current_path::earlier_half_a;
use crepitus_plant::assembly::{Listed, assemble};
use crepitus_plant::boundary::MotionStep;
use crepitus_plant::chain::Body;
use crepitus_plant::effect::{Context, Given};
use crepitus_plant::effects::motor;
use crepitus_plant::effects::motor::MotorNumbers;
use crepitus_plant::effects::motor::current_path::{CurrentPath, HALF_S, Half};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

const TICK_S: f64 = 2.0 * HALF_S;

/// The board's bridge and amplifiers.
const BOARD: [(&str, f64); 3] = [
    ("bridge_dead_time_us", 0.4),
    ("amplifier_lag_us", 0.5),
    ("amplifier_excursion_a", 0.3),
];

/// The drive's corrections.
const CORRECTED: [(&str, f64); 2] = [("dead_time_us", 0.4), ("lag_us", 0.43)];

/// Build of a motor, and its drive.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Case {
    /// Ideal bridge and amplifiers.
    Ideal,
    /// The board's, by the amplifier of half A, without a correction.
    Before,
    /// The board's, by that of the half that switched earlier, corrected.
    After,
}

fn given(path: Case) -> Given {
    let effect = &motor::EFFECT;
    let mut given = Given::defaults(effect);
    let numbers: Vec<(&str, f64)> = match path {
        Case::Ideal => Vec::new(),
        Case::Before => BOARD.to_vec(),
        Case::After => [&BOARD[..], &CORRECTED].concat(),
    };
    for (key, value) in numbers {
        let at = effect.parameters.iter().position(|spec| spec.key == key);
        given.numbers[at.expect(key)] = value;
    }
    if path == Case::Before {
        given.choices[0] = 1;
    }
    given
}

/// Torque setpoints over time, N·m.
#[derive(Clone, Copy)]
struct Profile {
    name: &'static str,
    torque_nm: fn(f64) -> f64,
}

const PROFILES: [Profile; 5] = [
    Profile {
        name: "0.4 N·m",
        torque_nm: |_| 0.4,
    },
    Profile {
        name: "−0.4 N·m",
        torque_nm: |_| -0.4,
    },
    Profile {
        name: "3 N·m",
        torque_nm: |_| 3.0,
    },
    Profile {
        name: "±0.2 N·m, 50 Hz, square",
        torque_nm: |s| if (50.0 * s).fract() < 0.5 { 0.2 } else { -0.2 },
    },
    Profile {
        name: "1 N·m, 10 Hz, sine",
        torque_nm: |s| (std::f64::consts::TAU * 10.0 * s).sin(),
    },
];

const SPEEDS: [f64; 4] = [0.1, 1.0, 3.0, 5.0];

/// Ticks that are left out, and ticks that are judged: 0.2 s, whole periods of every profile.
const SETTLING: u32 = 400;
const JUDGED: u32 = 4_000;

/// The motor's mean torque in each tick of a shaft that turns steadily, N·m.
fn torques_nm(path: Case, omega_rad_s: f64, profile: &Profile) -> Vec<f64> {
    let start = Body {
        angle_rad: 0.0,
        omega_rad_s,
    };
    let context = Context {
        tick_s: TICK_S,
        single: true,
        start,
        gravity_rad: None,
    };
    let listed = [Listed {
        effect: &motor::EFFECT,
        given: given(path),
    }];
    let mut plant = assemble(&listed, &context, false).expect("a motor");
    let column = plant
        .columns()
        .iter()
        .position(|name| *name == "motor_torque_nm");
    let column = column.expect("its torque");
    let body = |tick: u32| Body {
        angle_rad: omega_rad_s * TICK_S * f64::from(tick),
        omega_rad_s,
    };
    let mut row = Vec::new();
    (0..SETTLING + JUDGED)
        .map(|tick| {
            plant.command((profile.torque_nm)(TICK_S * f64::from(tick)), 0.0);
            plant.advance(&MotionStep {
                length_s: TICK_S,
                from: body(tick),
                to: body(tick + 1),
            });
            row.clear();
            plant.write(&mut row);
            row[column]
        })
        .skip(SETTLING as usize)
        .collect()
}

/// Mean and root mean square of the difference from a motor without bridge and amplifiers, mN·m.
fn errors_mnm(path: Case, omega_rad_s: f64, profile: &Profile) -> [f64; 2] {
    let ideal = torques_nm(Case::Ideal, omega_rad_s, profile);
    let found = torques_nm(path, omega_rad_s, profile);
    let off = found
        .iter()
        .zip(&ideal)
        .map(|(found, ideal)| 1e3 * (found - ideal));
    let count = f64::from(JUDGED);
    let mean = off.clone().sum::<f64>() / count;
    let square = off.map(|off| off * off).sum::<f64>() / count;
    [mean, square.sqrt()]
}

/// By what the loop's current is off in a tick whose current has become steady, mN·m at the joint: by half A, by the
/// earlier half, and without the lag.
fn steady_errors_mnm(duty: f64, current_a: f64) -> [f64; 3] {
    let numbers = MotorNumbers::of(&given(Case::Before));
    let MotorNumbers {
        winding,
        supply_v,
        path,
    } = numbers;
    let mut way = CurrentPath::new(path, winding, supply_v).expect("the board's");
    // The voltage that is lost depends on the current alone, so the back-EMF is what is left.
    let mut emf_v = duty * supply_v - winding.resistance_ohm * current_a;
    let mut lost_v = 0.0;
    let mut sampled_a = [0.0; 2];
    let mut mean_a = current_a;
    for _ in 0..40 {
        let (first_v, middle_a) = way.half(false, duty, current_a, emf_v);
        sampled_a = [Half::A, Half::B].map(|half| way.sampled_a(half));
        let first_a = way.mean_a();
        let (second_v, _) = way.half(true, duty, middle_a, emf_v);
        mean_a = f64::midpoint(first_a, way.mean_a());
        lost_v = duty * supply_v - f64::midpoint(first_v, second_v);
        emf_v = f64::midpoint(first_v, second_v) - winding.resistance_ohm * current_a;
    }
    let [a, b] = sampled_a;
    let earlier_a = earlier_half_a(a, b, duty);
    let full_v = (2.0 * supply_v + 3.2) * path.dead_time_s / TICK_S;
    let lag_s = 0.43e-6 + 0.5 * path.dead_time_s * (lost_v.abs() / full_v).min(1.0);
    let corrected_a = earlier_a - lag_s / winding.inductance_h * (duty * supply_v - lost_v);
    [a, earlier_a, corrected_a].map(|shown_a| 1e3 * winding.constant * (shown_a - mean_a))
}

const HEAD: &str = "\
# The path of the current

What dead time, lag and settling of the current amplifiers do to the torque, and what is left of it after the drive's corrections,
in simulation; not measured on hardware. `CREPITUS_BLESS=1 cargo test -p crepitus-plant --test current_errors` writes this page.

The board: dead time 0.4 µs (0.3 of the timer, 0.1 of the driver), lag 0.5 µs, amplifiers that an edge of their half throws off by
0.3 A (an upper bound) and that settle to 12.5 mA in 9.6 and 9.8 µs. Equations and sources:
`sim/plant/src/effects/motor/current_path.rs` and `model/src/control/current_path.rs`. *Before* is the loop with the amplifier of
half A and without corrections; *after* with that of the half that switched earlier, `motor.dead_time_us` 0.4 and `motor.lag_us` 0.43.
";

fn table() -> String {
    let mut page = HEAD.to_owned();
    page += "
## At every duty

By what the current that the loop takes is off the mean of the tick, as torque, mN·m, once the current is steady. Positive opposes
a growing angle.

| duty | current, A | by half A | by the earlier half | without its lag |
|---|---|---|---|---|
";
    for step in -7..=7 {
        let duty = 0.12 * f64::from(step);
        for current_a in [-0.3, -0.06, 0.06, 0.3] {
            let [a, earlier, corrected] = steady_errors_mnm(duty, current_a);
            let _ = writeln!(
                page,
                "| {duty:.2} | {current_a} | {a:.0} | {earlier:.0} | {corrected:.0} |"
            );
        }
    }
    page += "
## At four speeds

The motor's mean torque in a tick against that of a motor with an ideal bridge and ideal amplifiers, under the same setpoint, mN·m:
mean and RMS over 0.2 s.

| speed, rad/s | setpoint | mean, before | after | RMS, before | after |
|---|---|---|---|---|---|
";
    for omega in SPEEDS {
        for profile in &PROFILES {
            let [before, after] =
                [Case::Before, Case::After].map(|path| errors_mnm(path, omega, profile));
            let _ = writeln!(
                page,
                "| {omega} | {} | {:.0} | {:.0} | {:.0} | {:.0} |",
                profile.name, before[0], after[0], before[1], after[1]
            );
        }
    }
    page.replace(" -0 |", " 0 |")
        .replace("| -0.00 |", "| 0.00 |")
}

#[test]
fn the_tables_of_the_page_are_what_is_computed() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/generated/current-path.md");
    let page = table();
    let is_blessed = std::env::var_os("CREPITUS_BLESS").is_some_and(|value| value != "0");
    if is_blessed {
        fs::write(&path, &page).expect("the page");
    }
    let known = fs::read_to_string(&path).unwrap_or_default();
    assert!(
        page == known,
        "CREPITUS_BLESS=1 cargo test -p crepitus-plant --test current_errors\n{page}"
    );
}

#[test]
fn corrections_leave_a_mean_error_below_what_is_worth_having_at_low_speed_and_little_above_at_high()
{
    for omega in SPEEDS.into_iter().chain(SPEEDS.map(|omega| -omega)) {
        for profile in &PROFILES {
            let case = format!("{omega} rad/s, {}", profile.name);
            let [before, after] =
                [Case::Before, Case::After].map(|path| errors_mnm(path, omega, profile));
            assert!(
                after[0].abs() < 9.0 + 3.0 * omega.abs(),
                "{case}: mean {} mN·m",
                after[0]
            );
            assert!(after[1] < 35.0, "{case}: RMS {} mN·m", after[1]);
            if omega.abs() >= 3.0 {
                assert!(
                    after[1] < 0.6 * before[1],
                    "{case}: {} of {} mN·m",
                    after[1],
                    before[1]
                );
            }
        }
    }
}

#[test]
fn at_every_duty_the_earlier_half_without_its_lag_shows_the_mean_current() {
    let mut worst = [0.0_f64; 3];
    for step in -84..=84 {
        for current_a in [-0.9, -0.3, -0.06, 0.06, 0.3, 0.9] {
            let errors = steady_errors_mnm(0.01 * f64::from(step), current_a);
            worst = std::array::from_fn(|at| worst[at].max(errors[at].abs()));
        }
    }
    println!(
        "worst, mN·m: half A {:.0}, earlier half {:.0}, without its lag {:.0}",
        worst[0], worst[1], worst[2]
    );
    assert!(worst[2] < 27.0 && worst[2] < 0.1 * worst[0], "{worst:?}");
}
