//! Lead-in from a straight leg to the start of a scene's motion.
//!
//! ```text
//!    φ                                ╱ the scene's motion
//!   from ┤                      ·─────
//!        │                 ╱‾‾‾‾
//!    0°  ┼───────────╱‾‾‾‾
//!          at rest  ╎ one minimum-jerk stroke, as slow as a slow stretch
//!                   ╎ the motor has been driven for a tenth of a second
//! ```
//!
//! A device counts its angle from where its zero is set: with the leg held straight. So the leg
//! of a simulated device waits there until the device is armed. Arming pushes the motor for
//! 16 ms, which is no reason to begin. A motion that begins with a velocity gets a run-up of a
//! tenth of a second, in which it grows evenly.
//!
//! The way back from a hand that has moved the leg is such a stroke, too. If the leg moves there, it is first
//! slowed down to rest.

use super::TICK_S;
use super::movement::{stop, stroke, whole_ticks};
use crepitus_plant::Motion;
use crepitus_plant::chain::Body;
use crepitus_plant::motion::STOP_S;
use crepitus_plant::piece::{Curve, Piece};
use crepitus_scene::Scene;

/// Largest speed of the stroke, rad/s: 30 deg/s, V1 of the Tardieu scale, at which a muscle is
/// stretched to find nothing.
const SPEED_RAD_S: f64 = std::f64::consts::FRAC_PI_6;

/// Ticks for which the motor is driven before: 0.1 s.
const DRIVEN_TICKS: u32 = 2_000;

/// The way to a scene's motion.
pub(super) struct LeadIn {
    way: Motion,
    way_ticks: u32,
    then: Motion,
    stage: Stage,
}

/// Stage of the lead-in.
#[derive(Clone, Copy)]
enum Stage {
    /// The leg rests; the motor has been driven for so many ticks without a break.
    Waits { driven_ticks: u32 },
    /// The leg is on its way, for so many ticks more.
    Leads { ticks: u32 },
    /// The leg is there.
    Over,
}

impl LeadIn {
    /// Returns the lead-in of a scene whose leg begins straight. `None` where nothing leads: the motion
    /// begins at 0°, or nobody holds the leg.
    pub(super) fn of(scene: &Scene) -> Option<Self> {
        let start = scene.start();
        if !scene.begins_straight || !scene.is_held() || start.angle_rad == 0.0 {
            return None;
        }
        let (way, way_ticks) = way(Body::default(), start);
        Some(Self {
            way,
            way_ticks,
            then: scene.endless_motion(),
            stage: Stage::Waits { driven_ticks: 0 },
        })
    }

    /// Returns the way to a scene's motion of a leg that is elsewhere, which begins at once, and its motion.
    pub(super) fn back(from: Body, scene: &Scene) -> (Self, Motion) {
        let (way, way_ticks) = way(from, scene.start());
        let lead_in = Self {
            way: way.clone(),
            way_ticks,
            then: scene.endless_motion(),
            stage: Stage::Leads { ticks: way_ticks },
        };
        (lead_in, way)
    }

    /// Returns whether the leg is there.
    pub(super) fn is_over(&self) -> bool {
        matches!(self.stage, Stage::Over)
    }

    /// A tick is over, in which the motor was driven or not. Returns the motion that begins
    /// with the next one, if another does.
    pub(super) fn tick(&mut self, is_driven: bool) -> Option<Motion> {
        match &mut self.stage {
            Stage::Waits { driven_ticks } => {
                *driven_ticks = if is_driven { *driven_ticks + 1 } else { 0 };
                if *driven_ticks < DRIVEN_TICKS {
                    return None;
                }
                self.stage = Stage::Leads {
                    ticks: self.way_ticks,
                };
                Some(self.way.clone())
            }
            Stage::Leads { ticks } => {
                *ticks -= 1;
                if *ticks > 0 {
                    return None;
                }
                self.stage = Stage::Over;
                Some(self.then.clone())
            }
            Stage::Over => None,
        }
    }
}

/// The motion from one angle and velocity to another, and its length in ticks.
fn way(from: Body, to: Body) -> (Motion, u32) {
    let (mut pieces, mut ticks) = (Vec::new(), 0);
    let mut add = |piece: Piece, length: u32| {
        let start_s = f64::from(ticks) * TICK_S;
        ticks += length;
        let end_s = f64::from(ticks) * TICK_S;
        pieces.push(Piece {
            start_s,
            end_s,
            ..piece
        });
    };
    let mut rest_rad = from.angle_rad;
    if from.omega_rad_s != 0.0 {
        let (slows, length, rests_at_rad) = stop(from);
        add(slows, length);
        rest_rad = rests_at_rad;
    }
    let run_up_s = if to.omega_rad_s == 0.0 { 0.0 } else { STOP_S };
    let before_rad = to.angle_rad - 0.5 * to.omega_rad_s * run_up_s;
    let (leads, length) = stroke(rest_rad, before_rad, SPEED_RAD_S);
    add(leads, length);
    let curve = |polynomial| Piece {
        start_s: 0.0,
        end_s: f64::INFINITY,
        jump: false,
        curve: Curve::Polynomial(polynomial),
    };
    if run_up_s > 0.0 {
        let half_slope = 0.5 * to.omega_rad_s / run_up_s;
        let runs = curve([before_rad, 0.0, half_slope, 0.0, 0.0, 0.0]);
        add(runs, whole_ticks(run_up_s));
    }
    pieces.push(Piece {
        start_s: f64::from(ticks) * TICK_S,
        ..curve([to.angle_rad, to.omega_rad_s, 0.0, 0.0, 0.0, 0.0])
    });
    (Motion::Sequence(pieces), ticks)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A leg at this angle in degrees, with this velocity in rad/s.
    fn body((deg, omega_rad_s): (f64, f64)) -> Body {
        Body {
            angle_rad: deg.to_radians(),
            omega_rad_s,
        }
    }

    /// Angle and velocity at every tick.
    fn states(motion: &Motion, ticks: u32) -> Vec<(f64, f64)> {
        (0..=ticks)
            .map(|n| {
                let state = motion.at(f64::from(n) * TICK_S);
                (state.phi_rad, state.omega_rad_s)
            })
            .collect()
    }

    #[test]
    fn a_way_is_slow_and_ends_as_the_motion_begins() {
        for (from, to) in [
            ((0.0, 0.0), (60.0, 0.0)),
            ((0.0, 0.0), (-4.0, 0.0)),
            ((0.0, 0.0), (1e-9, 0.0)),
            ((0.0, 0.0), (50.0, 0.1)),
            ((0.0, 0.0), (5.0, -3.0)),
            ((70.0, 0.0), (20.0, 0.0)),
            ((70.0, 4.0), (20.0, 0.0)),
            ((30.0, -1e-6), (30.0, 0.5)),
        ] {
            let (deg, from, to) = (to.0, body(from), body(to));
            let (motion, ticks) = way(from, to);
            let states = states(&motion, ticks);
            assert_eq!(states[0], (from.angle_rad, from.omega_rad_s));
            let (end_rad, end_rad_s) = states[states.len() - 1];
            assert!((end_rad - to.angle_rad).abs() < 1e-12, "{deg}: {end_rad}");
            assert!((end_rad_s - to.omega_rad_s).abs() < 1e-12, "{deg}");
            let fastest = states.iter().fold(0.0_f64, |most, s| most.max(s.1.abs()));
            let ends = from.omega_rad_s.abs().max(to.omega_rad_s.abs());
            assert!(fastest <= SPEED_RAD_S.max(ends) + 1e-9, "{fastest}");
            // Angle and velocity go on over the ends of pieces.
            for pair in states.windows(2) {
                let mean = 0.5 * (pair[0].1 + pair[1].1);
                let off_rad = pair[1].0 - pair[0].0 - mean * TICK_S;
                assert!(off_rad.abs() < 1e-8, "{deg}: {pair:?}");
            }
        }
        // 60° at 30 deg/s at most: 15/8 of the mean.
        assert_eq!(way(Body::default(), body((60.0, 0.0))).1, 75_000);
    }

    #[test]
    fn a_motor_that_is_pushed_is_no_reason_to_begin() {
        let (way, way_ticks) = way(Body::default(), body((57.0, 0.0)));
        let mut lead_in = LeadIn {
            way,
            way_ticks,
            then: Motion::rest(1.0),
            stage: Stage::Waits { driven_ticks: 0 },
        };
        for n in 0..3 * DRIVEN_TICKS {
            // Driven for all but one of as many ticks as it takes.
            assert_eq!(lead_in.tick(n % DRIVEN_TICKS != 7), None);
        }
        let begun = (0..=DRIVEN_TICKS).find_map(|_| lead_in.tick(true));
        assert_eq!(begun, Some(lead_in.way.clone()));
        for _ in 1..way_ticks {
            assert_eq!(lead_in.tick(false), None);
        }
        assert_eq!(lead_in.tick(true), Some(Motion::rest(1.0)));
        assert_eq!(lead_in.tick(true), None);
    }
}
