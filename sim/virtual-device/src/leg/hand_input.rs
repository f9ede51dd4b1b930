//! Input of a hand that moves the leg, beside the protocol.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};

/// Input of a hand, which the leg looks at once a tick, and what the leg reports; also whether the knee is a secret that
/// its examiner must not tell. All clones are one input, for any thread: each value stands for itself, so none waits for
/// another.
#[derive(Clone, Debug)]
pub struct HandInput(Arc<State>);

/// Angles, rad, as their bits, where NaN is none, and the secret.
#[derive(Debug)]
struct State {
    target: AtomicU64,
    hand: AtomicU64,
    shaft: AtomicU64,
    is_blind: AtomicBool,
}

impl Default for HandInput {
    fn default() -> Self {
        let none = || AtomicU64::new(f64::NAN.to_bits());
        Self(Arc::new(State {
            target: none(),
            hand: none(),
            shaft: AtomicU64::new(0),
            is_blind: AtomicBool::new(false),
        }))
    }
}

impl HandInput {
    /// Sets the angle to which the hand moves the leg, rad, and takes the leg if nobody has it. One that is no number
    /// is ignored.
    pub fn aim(&self, angle_rad: f64) {
        if angle_rad.is_finite() {
            store(&self.0.target, angle_rad);
        }
    }

    /// Lets go of the leg: the scene's motion goes on.
    pub fn release(&self) {
        store(&self.0.target, f64::NAN);
    }

    /// Angle of the hand, rad, on its way to where it moves; `None` while it does not have the leg.
    pub fn hand_rad(&self) -> Option<f64> {
        load(&self.0.hand)
    }

    /// Angle of the shaft that the encoder counts, rad.
    pub fn shaft_rad(&self) -> f64 {
        load(&self.0.shaft).unwrap_or_default()
    }

    /// Sets whether a trial is blind: then the examiner, if there is one, moves every knee alike.
    pub fn set_blind(&self, is_blind: bool) {
        self.0.is_blind.store(is_blind, Relaxed);
    }

    /// Returns whether a trial is blind.
    pub fn is_blind(&self) -> bool {
        self.0.is_blind.load(Relaxed)
    }

    /// Angle to which the hand moves, rad; `None` where it does not hold the leg.
    pub(super) fn target_rad(&self) -> Option<f64> {
        load(&self.0.target)
    }

    /// Reports a tick of the leg.
    pub(super) fn report(&self, hand_rad: Option<f64>, shaft_rad: f64) {
        store(&self.0.hand, hand_rad.unwrap_or(f64::NAN));
        store(&self.0.shaft, shaft_rad);
    }
}

fn load(place: &AtomicU64) -> Option<f64> {
    let number = f64::from_bits(place.load(Relaxed));
    (!number.is_nan()).then_some(number)
}

fn store(place: &AtomicU64, number: f64) {
    place.store(number.to_bits(), Relaxed);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clones_are_one_input() {
        let input = HandInput::default();
        let leg = input.clone();
        assert_eq!((leg.target_rad(), input.hand_rad()), (None, None));
        input.aim(0.5);
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            input.aim(bad);
            assert_eq!(leg.target_rad(), Some(0.5));
        }
        leg.report(Some(0.25), 0.75);
        assert_eq!((input.hand_rad(), input.shaft_rad()), (Some(0.25), 0.75));
        input.release();
        assert_eq!(leg.target_rad(), None);
        leg.report(None, 0.75);
        assert_eq!(input.hand_rad(), None);
        for is_blind in [true, false] {
            input.set_blind(is_blind);
            assert_eq!(leg.is_blind(), is_blind);
        }
    }
}
