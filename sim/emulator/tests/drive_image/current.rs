//! Torque of the image on a bridge and amplifiers as they are.

use crate::host::{Host, image, scene_of};
use crepitus_protocol::State;

/// A leg moved to and fro at up to 4.9 rad/s against 1 N·m of a lead pipe.
const FAST: &str = r#"
version = 1
title = "Fast motion"
duration_s = 60.0
[motion]
kind = "strokes"
from_deg = 10.0
to_deg = 110.0
peak_speed_deg_s = 280.0
pause_s = 0.1
[solver]
kind = "exact-events"
step_s = 5e-5
precision = "f32"
[effects.lead-pipe]
torque_nm = 1.0
[effects.encoder]
[effects.drivetrain]
[effects.motor]
bridge_dead_time_us = 0.4
amplifier_lag_us = 0.5
amplifier_excursion_a = 0.3
"#;

/// The drive's corrections.
const CORRECTED: &str = "dead_time_us = 0.4\nlag_us = 0.43\n";

/// Speed from which on a tick counts, rad/s.
const FAST_RAD_S: f64 = 3.5;

/// Mean by which the motor's torque exceeds the one asked for, N·m, in the sense that it opposes the motion.
fn excess_nm(corrections: &str) -> Option<f64> {
    let image = image()?;
    let mut host = Host::new(&image, &scene_of(&[FAST, corrections].concat()));
    host.arm();
    host.run_until_torque();
    host.run(2_000);
    let (mut sum_nm, mut ticks) = (0.0, 0_u32);
    for _ in 0..16_000 {
        host.blocks.clear();
        host.run(1);
        let leg = host.board.leg();
        let omega_rad_s = leg.shaft().omega_rad_s;
        if omega_rad_s.abs() > FAST_RAD_S {
            // At that speed a lead pipe gives all of its torque.
            sum_nm += leg.motor_nm() * omega_rad_s.signum() - 1.0;
            ticks += 1;
        }
    }
    assert_eq!(host.board.comms().comms().state(), State::Armed);
    assert!(host.board.is_driven());
    assert!(ticks > 1_000, "{ticks}");
    Some(sum_nm / f64::from(ticks))
}

#[test]
fn the_image_takes_the_earlier_half_and_corrects_lag_and_dead_time() {
    let Some(corrected_nm) = excess_nm(CORRECTED) else {
        return;
    };
    let Some(uncorrected_nm) = excess_nm("") else {
        return;
    };
    println!(
        "beyond {FAST_RAD_S} rad/s the torque is off by {:.1} mN·m, without lag and dead time corrected by {:.1}",
        1e3 * corrected_nm,
        1e3 * uncorrected_nm
    );
    // The amplifier of half A would show another 60 to 300 mN·m in one of the two directions.
    assert!(corrected_nm.abs() < 0.025, "{corrected_nm}");
    assert!(
        uncorrected_nm.abs() > 2.0 * corrected_nm.abs() + 0.015,
        "{uncorrected_nm}"
    );
}
