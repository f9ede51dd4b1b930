//! Turn-back guard: no push from a slip after the hand has reversed.
//!
//! A frozen slip outputs s·Tk until its time is over, whatever the hand does. If
//! the hand turns back meanwhile, that torque no longer resists it but pushes
//! it along, and would return energy that nobody has put in. So where the
//! shaft has retreated inside a slip by more than two encoder counts, the
//! torque shown is zero until the slip ends; the joint's own events stay what
//! they are. (One count alone is noise: a resting hand must not switch the
//! torque.)
//!
//! With it crepitus returns to the hand at most
//!
//! ```text
//! E ≤ Ts²/2kr + (½ + d)·kr·h·∫Ω² dt
//! ```
//!
//! over any time, with d the ticks between sample and torque and h the tick:
//! what the spring holds, and what a sampled spring gives away.
//!
//! # Where it holds
//!
//! Until the guard is sure, a hand that turns back is pushed: by three counts,
//! and while the torque lags by about another. What that returns has to be less
//! than what the slip has taken out of the spring, which begins it with Ts and
//! ends it with the restart torque Tr:
//!
//! ```text
//! 4·Δ·Tk ≤ (Ts² − Tr²)/2kr         with Tr = 2Tk − Ts:   2·Δ ≤ (Ts − Tk)/kr
//! ```
//!
//! The stick after such a slip begins with Tr where the hand felt nothing, and
//! the lag keeps that from it for a while: at a speed of Ω the hand is spared
//! Tr·Ω·d·h, and the term of the sampled spring pays for (Ts − Tr)·Ω·d·h of
//! it. Worst is a stick just as long as the lag, Ω·d·h = (Ts − Tr)/kr, and what
//! is left of the slip's energy then has to be enough:
//!
//! ```text
//! 4·Δ·Tk ≤ (Ts² − Tr²)/2kr − (2Tr − Ts)·(Ts − Tr)/kr = 3·(Ts − Tr)²/2kr
//! ```
//!
//! This is the stricter one where Tr is above Ts/2. [`most_rad_per_count`] is
//! the largest count Δ that keeps both; the presets keep it by a factor of 2.6
//! and more.

use crate::joint::{Phase, Restart, Settings};
use crate::real::Real;

/// The counts that a hand may go back in a slip before its torque is gone: two
/// are allowed, the third is detected, and in the time of a fourth the torque
/// goes.
const UNGUARDED_COUNTS: f64 = 4.0;

/// The largest angle of one count with which the guard keeps its bound, rad:
/// (Ts − Tr)·min(Ts + Tr, 3·(Ts − Tr))/(8·kr·Tk). Infinite where slip shows no
/// torque.
pub fn most_rad_per_count(settings: &Settings) -> f64 {
    let p = &settings.parameters;
    let restart_nm = match settings.restart {
        Restart::Elastic => p.restart_torque_nm(),
        Restart::FromKinetic => p.kinetic_torque_nm,
    };
    if p.kinetic_torque_nm == 0.0 {
        return f64::INFINITY;
    }
    let (static_nm, kinetic_nm) = (p.static_torque_nm, p.kinetic_torque_nm);
    // As a product: the difference of two squares would lose digits.
    let drop_nm = static_nm - restart_nm;
    let left_nm = (static_nm + restart_nm).min(3.0 * drop_nm);
    drop_nm * left_nm / (2.0 * UNGUARDED_COUNTS * p.stiffness_nm_per_rad * kinetic_nm)
}

/// Detects reversals of the shaft inside slips.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TurnBack<F> {
    allowance_rad: F,
    slip_number: u32,
    /// Distance of the shaft behind the foremost point of this slip, rad.
    behind_rad: F,
    turned: bool,
}

impl<F: Real> TurnBack<F> {
    /// Detector for an encoder with this angle of one count at the joint.
    pub fn new(rad_per_count: F) -> Self {
        Self {
            allowance_rad: F::TWO * rad_per_count,
            slip_number: 0,
            behind_rad: F::ZERO,
            turned: false,
        }
    }

    /// Takes in a step of the shaft that has left the joint in `phase`, the
    /// `slip_number`-th slip or after it.
    #[inline]
    pub fn moved(&mut self, delta_phi_rad: F, phase: Phase, slip_number: u32) {
        let Phase::Slip(sense) = phase else {
            self.turned = false;
            return;
        };
        if slip_number != self.slip_number {
            self.slip_number = slip_number;
            self.behind_rad = F::ZERO;
            self.turned = false;
        }
        let behind = self.behind_rad - sense.of_signed(delta_phi_rad);
        self.behind_rad = F::ZERO.at_least(behind);
        if self.behind_rad > self.allowance_rad {
            self.turned = true;
        }
    }

    /// Returns whether the hand has turned back: the torque to show is zero.
    #[inline]
    pub fn is_turned(&self) -> bool {
        self.turned
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::encoder::EncoderSettings;
    use crate::{Parameters, Sense};

    const COUNT: f64 = 1e-5;

    /// Returns whether the torque is off after each of the moves, in counts, in one slip.
    fn turned_after(sense: Sense, moves: &[f64]) -> std::vec::Vec<bool> {
        let mut guard = TurnBack::new(COUNT);
        moves
            .iter()
            .map(|counts| {
                guard.moved(sense.of_signed(counts * COUNT), Phase::Slip(sense), 1);
                guard.is_turned()
            })
            .collect()
    }

    #[test]
    fn more_than_two_counts_back_switch_the_torque_off_for_the_rest_of_the_slip() {
        for sense in [Sense::Positive, Sense::Negative] {
            assert_eq!(turned_after(sense, &[5.0, -1.0, -1.0]), [false; 3]);
            assert_eq!(
                turned_after(sense, &[5.0, -1.0, -1.5, 4.0, 9.0]),
                [false, false, true, true, true]
            );
            // There and back again is no retreat: it counts from the foremost point.
            assert_eq!(
                turned_after(sense, &[3.0, -1.5, 1.0, -1.0, -0.4, -0.2]),
                [false, false, false, false, false, true]
            );
            assert_eq!(turned_after(sense, &[-2.1]), [true]);
        }
    }

    #[test]
    fn a_stick_or_another_slip_resets_the_guard() {
        let mut guard = TurnBack::new(COUNT);
        let slip = Phase::Slip(Sense::Positive);
        guard.moved(-3.0 * COUNT, slip, 1);
        assert!(guard.is_turned());
        guard.moved(-3.0 * COUNT, Phase::Stick, 1);
        assert!(!guard.is_turned());
        guard.moved(-COUNT, slip, 2);
        assert!(!guard.is_turned());
        guard.moved(-3.0 * COUNT, slip, 2);
        assert!(guard.is_turned());
        guard.moved(-COUNT, slip, 3);
        assert!(!guard.is_turned());
    }

    fn most(kinetic_nm: f64, restart: Restart) -> f64 {
        most_rad_per_count(&Settings {
            parameters: Parameters {
                kinetic_torque_nm: kinetic_nm,
                ..Parameters::default()
            },
            restart,
            ..Settings::default()
        })
    }

    #[test]
    fn two_counts_are_to_be_below_the_drop_over_the_stiffness() {
        for kinetic in [0.01, 0.1, 0.2, 0.3] {
            let two_counts = (0.4 - kinetic) / 400.0;
            let elastic = most(kinetic, Restart::Elastic);
            assert!((2.0 * elastic - two_counts).abs() < 1e-12 * two_counts);
            // A stick from Tk loses less to a slip, by (Ts + Tk)/4Tk.
            let from_kinetic = most(kinetic, Restart::FromKinetic);
            let less = elastic * (0.4 + kinetic) / (4.0 * kinetic);
            assert!(from_kinetic - less < 1e-12 * less);
            assert!(kinetic > 0.2 || (from_kinetic - less).abs() < 1e-12 * less);
        }
        assert_eq!(most(0.4, Restart::Elastic), 0.0);
        assert_eq!(most(0.0, Restart::Elastic), f64::INFINITY);
    }

    #[test]
    fn near_the_static_torque_the_lag_asks_for_more() {
        // 4·Δ·Tk = 3·(Ts − Tr)²/2kr; Tr = 0.32, and Tr = Tk = 0.36.
        let elastic = 3.0 * 0.08_f64.powi(2) / (2.0 * 400.0 * 4.0 * 0.36);
        let from_kinetic = 3.0 * 0.04_f64.powi(2) / (2.0 * 400.0 * 4.0 * 0.36);
        for (restart, expected) in [
            (Restart::Elastic, elastic),
            (Restart::FromKinetic, from_kinetic),
        ] {
            let found = most(0.36, restart);
            assert!((found / expected - 1.0).abs() < 1e-9, "{restart:?} {found}");
        }
    }

    #[test]
    fn the_papers_joint_is_far_from_the_limit() {
        let count_rad = EncoderSettings::default().rad_per_count();
        let margin = most_rad_per_count(&Settings::default()) / count_rad;
        assert!(margin > 2.5, "{margin}");
    }
}
