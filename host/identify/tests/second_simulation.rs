//! The estimator on braces that it does not model to the letter.

mod pendulum;

use crepitus_identify::brace::{Measured, Quantity, QuantityResult, TORQUE_DEVIATION, Weight, identify};
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

#[test]
fn draft() {
    let mut random = fastrand::Rng::with_seed(3);
    for stiction in [1.0, 1.3] { for n in 0..6 {
        let factor = |random: &mut fastrand::Rng| 2_f64.powf(2.0 * random.f64() - 1.0);
        let friction_nm = 0.5 * factor(&mut random);
        let moment_nm = friction_nm * (9.0 + 5.0 * random.f64());
        let it = Pendulum {
            friction_nm,
            stiction,
            load_loss: 0.15 + 0.3 * random.f64(),
            viscous_nms: 0.2 * random.f64(),
            rotor_kg_m2: 0.051 * factor(&mut random),
            brace_kg_m2: 0.01 * factor(&mut random),
            gap_rad: 0.0175 * factor(&mut random),
            stiffness_nm: 120.0 * factor(&mut random),
            damping_nms: 1.0 * factor(&mut random),
            moment_nm,
            weight_kg_m2: 0.035 * moment_nm,
            release_rad: 0.8 + 0.3 * random.f64(),
            spring_nm: 0.0,
            brake_nm: 0.0,
        };
        let t = std::time::Instant::now();
        let recordings = [it.recorded(&mut random), Pendulum { spring_nm: 3.0, brake_nm: 0.3, ..it }.recorded(&mut random)];
        let sim = t.elapsed();
        let measured = |value| Measured { value, deviation: 0.005 };
        let weight = Weight { moment_nm: measured(it.moment_nm), inertia_kg_m2: measured(it.weight_kg_m2) };
        let t = std::time::Instant::now();
        match identify(&recordings, &weight, TORQUE_DEVIATION, &mut |_| true) {
            Ok(brace) => {
                print!("{stiction} {n} {sim:?} {:?} rms {:.5} {:?}", t.elapsed(), brace.rms_rad, brace.swung());
                for shown in &brace.shown { let t = truth(&it, shown.quantity); match &shown.result {
                    QuantityResult::Seen(e) => print!(" {}{:.2}%({:.1}σ)", if e.holds(t) {""} else {"!!"}, 100.0*e.share(), 1.96*(e.value-t)/e.half_width),
                    QuantityResult::NotVisible { .. } => print!(" -"),
                }}
                println!();
            }
            Err(e) => println!("{n} {it:?} {e}"),
        }
    }}
}
