//! Hands, as the travel of a shaft tick by tick.

use crate::rig::{Rig, TICK_S};
use crepitus_model::{Parameters, Phase};
use fastrand::Rng;
use std::f64::consts::TAU;

/// The fastest that they move, rad/s.
const FASTEST_RAD_S: f64 = 3.0;

/// The fastest that one moves whose speed jumps, rad/s: back-EMF jumps with it,
/// and the supply has to follow.
const FASTEST_JUMPING_RAD_S: f64 = 1.5;

/// Behaviour of a hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Hand {
    /// Sines from 2 Hz to 400 Hz.
    Sine,
    /// Constant speed to and fro: its direction jumps.
    Triangle,
    /// A filtered random speed.
    Walk,
    /// A speed that changes its sign at random moments, and a little always.
    Telegraph,
    /// Minimum-jerk moves between random points.
    Moves,
}

impl Hand {
    pub(crate) const ALL: [Self; 5] = [
        Self::Sine,
        Self::Triangle,
        Self::Walk,
        Self::Telegraph,
        Self::Moves,
    ];

    /// A random one of its kind: travel of each tick, rad.
    pub(crate) fn travels(self, rng: &mut Rng, parameters: &Parameters, ticks: u32) -> Vec<f64> {
        let stroke_rad = parameters.static_torque_nm / parameters.stiffness_nm_per_rad;
        let amplitude_rad = stroke_rad * logarithmic(rng, 0.2, 30.0);
        let angles = |at: &dyn Fn(f64) -> f64| {
            (0..ticks)
                .map(|n| at(f64::from(n + 1) * TICK_S) - at(f64::from(n) * TICK_S))
                .collect()
        };
        match self {
            Self::Sine => {
                let most_hz = FASTEST_RAD_S / (TAU * amplitude_rad);
                let hertz = logarithmic(rng, 2.0, 400.0).min(most_hz);
                angles(&|t| -amplitude_rad * (TAU * hertz * t).cos())
            }
            Self::Triangle => {
                let most_hz = FASTEST_JUMPING_RAD_S / (4.0 * amplitude_rad);
                let hertz = logarithmic(rng, 2.0, 400.0).min(most_hz);
                angles(&|t| {
                    let u = (t * hertz).fract();
                    amplitude_rad * if u < 0.5 { 4.0 * u } else { 4.0 - 4.0 * u }
                })
            }
            Self::Walk => {
                let (push, kept) = (
                    logarithmic(rng, 0.01, 0.3),
                    1.0 - logarithmic(rng, 1e-4, 0.1),
                );
                let mut speed = 0.0;
                (0..ticks)
                    .map(|_| {
                        speed = kept * speed + push * (rng.f64() - 0.5);
                        speed.clamp(-FASTEST_RAD_S, FASTEST_RAD_S) * TICK_S
                    })
                    .collect()
            }
            Self::Telegraph => {
                let mut speed = logarithmic(rng, 0.05, FASTEST_JUMPING_RAD_S);
                let turns = logarithmic(rng, 1e-3, 0.3);
                (0..ticks)
                    .map(|_| {
                        if rng.f64() < turns {
                            speed = -speed;
                        }
                        speed * (0.5 + rng.f64()) * TICK_S
                    })
                    .collect()
            }
            Self::Moves => moves(rng, stroke_rad, ticks),
        }
    }
}

fn logarithmic(rng: &mut Rng, low: f64, high: f64) -> f64 {
    low * (high / low).powf(rng.f64())
}

fn moves(rng: &mut Rng, stroke_rad: f64, ticks: u32) -> Vec<f64> {
    let mut travels = Vec::new();
    let mut from_rad = 0.0;
    while travels.len() < ticks as usize {
        let to_rad = stroke_rad * (8.0 * rng.f64() - 4.0);
        // The speed of a stroke peaks at 15/8 of the mean.
        let least = 1.875 * (to_rad - from_rad).abs() / (FASTEST_RAD_S * TICK_S);
        let length = f64::from(rng.u32(20..2000)).max(least.ceil());
        let part = |u: f64| u * u * u * (10.0 + u * (6.0 * u - 15.0));
        let mut done = 0.0;
        while done < length {
            let parts = part((done + 1.0) / length) - part(done / length);
            travels.push((to_rad - from_rad) * parts);
            done += 1.0;
        }
        from_rad = to_rad;
    }
    travels
}

/// Turns back in every slip: forward until it begins, back by a little, still
/// until it ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TurnsBack {
    pub(crate) forward_rad_s: f64,
    pub(crate) back_rad_s: f64,
    pub(crate) back_ticks: u32,
}

impl TurnsBack {
    /// Back by four counts and a tick, at up to 0.15 rad/s.
    pub(crate) fn slowly(rng: &mut Rng, count_rad: f64) -> Self {
        let back_rad_s = logarithmic(rng, 0.02, 0.15);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a few hundred"
        )]
        let back_ticks = (4.0 * count_rad / (back_rad_s * TICK_S)) as u32 + 1;
        Self {
            forward_rad_s: logarithmic(rng, 0.05, FASTEST_RAD_S),
            back_rad_s,
            back_ticks,
        }
    }

    /// Back with a jump of the speed, for some ticks.
    pub(crate) fn at_once(rng: &mut Rng) -> Self {
        Self {
            forward_rad_s: logarithmic(rng, 0.05, FASTEST_RAD_S),
            back_rad_s: logarithmic(rng, 0.1, FASTEST_RAD_S),
            back_ticks: rng.u32(1..12),
        }
    }

    pub(crate) fn shake(self, rig: &mut Rig, ticks: u32) {
        let mut back = 0;
        for _ in 0..ticks {
            let speed = if rig.phase() == Phase::Stick {
                back = 0;
                self.forward_rad_s
            } else if back < self.back_ticks {
                back += 1;
                -self.back_rad_s
            } else {
                0.0
            };
            rig.turn(speed * TICK_S, false);
        }
    }
}

/// Samples that are lost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Losses {
    /// Each by itself, with this probability.
    Single(f64),
    /// Bursts of so many, one to thirty in a second.
    Bursts(u32, u32),
    /// Bursts of so many, where the hand retreats: the worst moments.
    Retreats(u32, u32),
}

/// Decides sample by sample.
#[derive(Clone, Debug)]
pub(crate) struct Loser {
    losses: Losses,
    rng: Rng,
    share: f64,
    left: u32,
    rests: u32,
}

impl Loser {
    pub(crate) fn new(losses: Losses, mut rng: Rng) -> Self {
        Self {
            losses,
            share: logarithmic(&mut rng, 5e-5, 0.04),
            rng,
            left: 0,
            rests: 0,
        }
    }

    pub(crate) fn loses(&mut self, rig: &Rig, travel_rad: f64) -> bool {
        let (low, high, begins) = match self.losses {
            Losses::Single(share) => return self.rng.f64() < share,
            Losses::Bursts(low, high) => (low, high, self.rng.f64() < self.share),
            Losses::Retreats(low, high) => (low, high, rig.torque_nm() * travel_rad < 0.0),
        };
        if self.left == 0 && self.rests == 0 && begins {
            self.left = self.rng.u32(low..=high);
            self.rests = self.left + self.rng.u32(1..20);
        }
        let is_lost = self.left > 0;
        self.left = self.left.saturating_sub(1);
        self.rests = self.rests.saturating_sub(1);
        is_lost
    }
}
