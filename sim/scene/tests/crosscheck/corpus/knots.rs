//! Velocity knots: jumps, dwells at exactly 0, very short pieces.

use super::joint::Scale;
use super::uniform;
use crepitus_plant::Motion;
use crepitus_plant::motion::VelocityKnot;
use fastrand::Rng;

pub(super) fn draw(rng: &mut Rng, scale: Scale) -> (Motion, f64) {
    let Scale {
        speed_rad_s,
        duration_s,
    } = scale;
    let mut times = vec![0.0];
    for _ in 0..rng.u32(1..14) {
        let t = duration_s * rng.f64();
        times.push(t);
        if rng.u32(0..6) == 0 {
            times.push(t + duration_s * 10.0_f64.powf(uniform(rng, -9.0, -3.0)));
        }
    }
    times.sort_by(f64::total_cmp);
    // The last knot at the very end, before it, or beyond it.
    match rng.u32(0..10) {
        0..4 => {
            times.retain(|&t| t < duration_s);
            times.push(duration_s);
        }
        4..7 => times.push(2.0 * duration_s),
        _ => {}
    }
    times.dedup_by(|b, a| *b - *a <= 1e-12 * duration_s);
    let mut left = 0.0;
    let mut knots = Vec::with_capacity(times.len());
    let velocity = |rng: &mut Rng, before: f64| match rng.u32(0..10) {
        0 | 1 => 0.0,
        2 => before,
        _ => uniform(rng, -1.5, 1.5) * speed_rad_s,
    };
    for time_s in times {
        let right = if time_s == 0.0 || rng.u32(0..3) == 0 {
            velocity(rng, left)
        } else {
            left
        };
        knots.push(VelocityKnot {
            time_s,
            omega_left_rad_s: if time_s == 0.0 { right } else { left },
            omega_right_rad_s: right,
        });
        left = velocity(rng, right);
    }
    (Motion::velocity_knots(&knots), duration_s)
}
