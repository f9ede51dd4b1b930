//! The estimator on braces that it does not model to the letter: a second simulation that shares
//! no code with the first and none with the estimator.

mod compared;
mod pendulum;

use compared::{Compared, PAGE, compared};
use crepitus_identify::brace::{Measured, Quantity, TORQUE_DEVIATION, Weight, identify};
use pendulum::Pendulum;

fn truth(it: &Pendulum, quantity: Quantity) -> f64 {
    match quantity {
        Quantity::Friction => it.friction_nm,
        Quantity::LoadLoss => it.load_loss,
        Quantity::Viscous => it.viscous_nms,
        Quantity::RotorInertia => it.rotor_kg_m2,
        Quantity::BraceInertia => it.brace_kg_m2,
        Quantity::Backlash => it.gap_rad.to_degrees(),
        Quantity::CuffStiffness => it.stiffness_nm,
        Quantity::CuffDamping => it.damping_nms,
        Quantity::TorqueConstant => 3.3 / 86.0,
    }
}

fn drawn(random: &mut fastrand::Rng, stiction: f64) -> Pendulum {
    let mut factor = |nominal: f64| nominal * 2_f64.powf(2.0 * random.f64() - 1.0);
    let friction_nm = factor(0.5);
    let rotor_kg_m2 = factor(0.051);
    let brace_kg_m2 = factor(0.01);
    let gap_rad = factor(0.0175);
    let stiffness_nm = factor(120.0);
    let damping_nms = factor(1.0);
    let moment_nm = friction_nm * (9.0 + 5.0 * random.f64());
    Pendulum {
        friction_nm,
        stiction,
        load_loss: 0.15 + 0.3 * random.f64(),
        viscous_nms: 0.2 * random.f64(),
        rotor_kg_m2,
        brace_kg_m2,
        gap_rad,
        stiffness_nm,
        damping_nms,
        moment_nm,
        weight_kg_m2: 0.035 * moment_nm,
        release_rad: 0.8 + 0.3 * random.f64(),
        spring_nm: 0.0,
        brake_nm: 0.0,
    }
}

/// Values of four braces, compared; the row `name` of the page's table has what is outside.
fn simulated(seed: u64, stiction: f64, name: &str) -> (usize, usize) {
    // Two of the page's four, but in the long mode.
    let is_long = std::env::var_os("CREPITUS_LONG").is_some();
    let braces = if is_long { 4 } else { 2 };
    let mut random = fastrand::Rng::with_seed(seed);
    let mut all: Vec<Compared> = Vec::new();
    for number in 0..braces {
        let it = drawn(&mut random, stiction);
        let armed = Pendulum {
            spring_nm: 3.0,
            brake_nm: 0.3,
            ..it
        };
        let recordings = [it.recorded(&mut random), armed.recorded(&mut random)];
        let measured = |value| Measured {
            value,
            deviation: 0.005,
        };
        let weight = Weight {
            moment_nm: measured(it.moment_nm),
            inertia_kg_m2: measured(it.weight_kg_m2),
        };
        let found = identify(&recordings, &weight, TORQUE_DEVIATION, &mut |_| true);
        let brace = found.unwrap_or_else(|refusal| panic!("{it:?}: {refusal}"));
        let title = format!("{name}, brace {number}");
        all.extend(compared(&title, &brace, |quantity| truth(&it, quantity)));
    }
    let outside: Vec<String> = (all.iter().filter(|value| !value.holds()))
        .map(|value| format!("{}, {:+.0} %", value.quantity.name(), value.error_percent()))
        .collect();
    let (visible, wrong) = (all.len(), outside.len());
    let row = match outside.as_slice() {
        [] => format!("| {visible} of {visible} | none |"),
        list => format!("| {} of {visible} | {} |", visible - wrong, list.join("; ")),
    };
    let head = ["| inside, of those visible | outside |", "|---|---|"].map(str::to_owned);
    if is_long {
        PAGE.hold(name, &[&head[..], &[row]].concat());
    }
    (visible - wrong, wrong)
}

#[test]
fn soft_teeth_and_a_noisy_current_are_within_the_intervals() {
    let (inside, outside) = simulated(101, 1.0, "soft teeth");
    assert!(inside >= 15 && outside <= 1, "{inside} {outside}");
}

#[test]
fn a_friction_that_is_greater_at_rest_is_within_the_intervals() {
    let (inside, outside) = simulated(102, 1.3, "soft teeth and stiction");
    assert!(inside >= 14 && outside <= 1, "{inside} {outside}");
}
