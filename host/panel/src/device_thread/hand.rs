//! The hand that moves the leg of a simulated device, beside the protocol.
//!
//! Pages count angles from the device's zero, the leg from its own: the difference is seen while the
//! leg rests, as samples are a few milliseconds old.

use super::DeviceThread;
use crate::control::Page;
use crate::hand::{HandRequest, reachable_deg};
use crepitus_client::Transport;
use crepitus_client::connection::HandInput;
use crepitus_recording::Row;
use std::time::{Duration, Instant};

/// Time for which the hand of a page that has gone, or has no control any more, holds the leg still.
const HOLDS_STILL: Duration = Duration::from_secs(2);

/// A slower leg rests, rad/s.
const REST_RAD_S: f32 = 0.05;

/// Largest difference that the age of samples makes, rad: beyond it another zero was set.
const ANOTHER_ZERO_RAD: f64 = 0.1;

/// The hand.
pub(super) struct Hand {
    input: HandInput,
    /// Angle and speed in the newest sample.
    newest: Option<(f64, f32)>,
    /// Angle of the leg where that of the device is zero, rad.
    zero_rad: Option<f64>,
    /// The page whose hand has the leg.
    page: Option<Page>,
    /// Time since which that page is gone.
    gone_since: Option<Instant>,
}

impl Hand {
    pub(super) fn new(input: HandInput) -> Self {
        Self {
            input,
            newest: None,
            zero_rad: None,
            page: None,
            gone_since: None,
        }
    }

    /// Takes the newest sample.
    pub(super) fn see(&mut self, row: &Row) {
        self.newest = Some((row.angle_rad, row.omega_rad_s));
    }

    /// Returns whether it has the leg.
    pub(super) fn has_leg(&self) -> bool {
        self.input.hand_rad().is_some()
    }

    /// Tells the examiner of the simulated leg whether the knee is hidden.
    pub(super) fn set_blind(&self, is_blind: bool) {
        self.input.set_blind(is_blind);
    }

    /// Angle of the hand from the device's zero, rad; `None` while it does not have the leg.
    pub(super) fn angle_rad(&self) -> Option<f64> {
        Some(self.input.hand_rad()? - self.zero_rad?)
    }

    /// Determines where the device's zero is.
    fn align(&mut self) {
        let Some((angle_rad, omega_rad_s)) = self.newest else {
            return;
        };
        let zero_rad = self.input.shaft_rad() - angle_rad;
        let is_another = |known: f64| (zero_rad - known).abs() > ANOTHER_ZERO_RAD;
        if omega_rad_s.abs() < REST_RAD_S || self.zero_rad.is_none_or(is_another) {
            self.zero_rad = Some(zero_rad);
        }
    }

    fn execute(&mut self, request: &HandRequest) {
        self.gone_since = None;
        if !request.holds {
            self.page = None;
            self.input.release();
        } else if let Some(zero_rad) = self.zero_rad {
            self.page = Some(request.page);
            let angle_rad = reachable_deg(request.angle_deg).to_radians();
            self.input.aim(zero_rad + angle_rad);
        }
    }

    /// Holds the leg still once its page is gone, and lets go of it after a while.
    fn supervise(&mut self, is_gone: bool, now: Instant) {
        if !is_gone {
            self.gone_since = None;
            return;
        }
        match self.gone_since {
            None => {
                self.gone_since = Some(now);
                if let Some(hand_rad) = self.input.hand_rad() {
                    self.input.aim(hand_rad);
                }
            }
            Some(since) if now.saturating_duration_since(since) >= HOLDS_STILL => {
                (self.page, self.gone_since) = (None, None);
                self.input.release();
            }
            Some(_) => {}
        }
    }
}

impl<T: Transport> DeviceThread<'_, T> {
    /// Moves the hand as the page in control asks.
    pub(super) fn move_hand(&mut self) {
        let (Some(hand), control) = (&mut self.hand, &self.shared.control) else {
            return;
        };
        hand.align();
        let now = Instant::now();
        let request = self.shared.hand_requests.take(now);
        if let Some(request) = request.filter(|request| control.is_held_by(request.page)) {
            hand.execute(&request);
        }
        let is_gone = hand.page.is_some_and(|page| !control.is_held_by(page));
        hand.supervise(is_gone, now);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn aligned() -> Hand {
        let mut hand = Hand::new(HandInput::default());
        hand.see(&Row {
            angle_rad: -0.25,
            ..Row::default()
        });
        hand.align();
        hand
    }

    fn request(angle_deg: f64, holds: bool) -> HandRequest {
        HandRequest {
            page: 7,
            angle_deg,
            holds,
        }
    }

    #[test]
    fn the_zero_is_that_of_a_leg_at_rest() {
        let mut hand = aligned();
        let mut zero_rad = |angle_rad, omega_rad_s| {
            hand.see(&Row {
                angle_rad,
                omega_rad_s,
                ..Row::default()
            });
            hand.align();
            hand.zero_rad
        };
        // In motion the sample is old.
        assert_eq!(zero_rad(-0.26, 2.0), Some(0.25));
        assert_eq!(zero_rad(-0.26, 0.01), Some(0.26));
        assert_eq!(zero_rad(-0.27, -2.0), Some(0.26));
        // Another zero is one in motion, too.
        assert_eq!(zero_rad(-0.5, 2.0), Some(0.5));
    }

    #[test]
    fn nothing_is_moved_before_the_first_sample() {
        let mut hand = Hand::new(HandInput::default());
        hand.execute(&request(30.0, true));
        assert_eq!((hand.page, hand.angle_rad()), (None, None));
    }

    #[test]
    fn the_hand_of_a_page_that_is_gone_holds_still_and_lets_go() {
        let mut hand = aligned();
        let begun = Instant::now();
        let at = |ms| begun + Duration::from_millis(ms);
        hand.execute(&request(30.0, true));
        hand.supervise(false, at(0));
        hand.supervise(true, at(10));
        hand.supervise(true, at(2_000));
        assert_eq!(hand.page, Some(7));
        // It comes back in time.
        hand.supervise(false, at(2_005));
        hand.supervise(true, at(2_020));
        hand.supervise(true, at(4_010));
        assert_eq!(hand.page, Some(7));
        hand.supervise(true, at(4_021));
        assert_eq!(hand.page, None);
    }
}
