//! The enable line of comms: tested at every arming, read back at all times.

use crepitus_protocol::Fault;

/// Milliseconds within which the read-back follows the output.
const SETTLE_MS: u32 = 2;

/// State of the test.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Step {
    /// Off.
    #[default]
    Off,
    /// On for the first time: waits for the read-back to rise.
    FirstOn,
    /// Off again: waits for the read-back to fall.
    OffAgain,
    /// On, the test passed.
    On,
}

/// The enable line.
#[derive(Clone, Copy, Debug, Default)]
pub struct EnableLine {
    step: Step,
    /// The read-back was on in [`Step::On`].
    proven: bool,
    /// Consecutive milliseconds in which the read-back differs from the output.
    mismatch_ms: u32,
}

impl EnableLine {
    /// Starts the test: on, off, on.
    pub fn prove(&mut self) {
        if self.step == Step::Off {
            *self = Self {
                step: Step::FirstOn,
                ..Self::default()
            };
        }
    }

    /// Switches the line off.
    pub fn off(&mut self) {
        if self.step != Step::Off {
            *self = Self::default();
        }
    }

    /// Whether the line passed its test and is on.
    pub fn is_proven(&self) -> bool {
        self.proven
    }

    /// The output level: true for on.
    pub fn level(&self) -> bool {
        matches!(self.step, Step::FirstOn | Step::On)
    }

    /// Runs once a millisecond with the read-back; returns a stuck-line fault.
    pub fn tick(&mut self, is_on: bool) -> Option<Fault> {
        if is_on == self.level() {
            self.mismatch_ms = 0;
            match self.step {
                Step::Off => {}
                Step::FirstOn => self.step = Step::OffAgain,
                Step::OffAgain => self.step = Step::On,
                Step::On => self.proven = true,
            }
            return None;
        }
        self.mismatch_ms = self.mismatch_ms.saturating_add(1);
        if self.mismatch_ms <= SETTLE_MS {
            return None;
        }
        Some(if is_on {
            Fault::CommsEnableStuckOn
        } else {
            Fault::CommsEnableStuckOff
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What comes of a line that follows a millisecond late, or is stuck.
    fn prove(stuck: Option<bool>) -> (Option<Fault>, bool, u32) {
        let mut line = EnableLine::default();
        let mut is_on = stuck.unwrap_or(false);
        line.prove();
        for ms in 1..20 {
            let fault = line.tick(is_on);
            if fault.is_some() || line.is_proven() {
                return (fault, line.is_proven(), ms);
            }
            is_on = stuck.unwrap_or(line.level());
        }
        panic!("neither proven nor stuck");
    }

    #[test]
    fn it_is_proven_on_off_and_on() {
        let (fault, proven, ms) = prove(None);
        assert_eq!((fault, proven), (None, true));
        assert!(ms <= 8, "{ms}");
    }

    #[test]
    fn a_stuck_one_is_not_proven() {
        assert_eq!(prove(Some(false)).0, Some(Fault::CommsEnableStuckOff));
        assert_eq!(prove(Some(true)).0, Some(Fault::CommsEnableStuckOn));
    }

    #[test]
    fn it_is_watched_at_rest_and_while_on() {
        let mut line = EnableLine::default();
        assert_eq!(
            (0..3).find_map(|_| line.tick(true)),
            Some(Fault::CommsEnableStuckOn)
        );
        let mut line = EnableLine::default();
        line.prove();
        for _ in 0..6 {
            assert_eq!(line.tick(line.level()), None);
        }
        assert!(line.is_proven());
        assert_eq!(line.tick(false), None, "a moment is no fault");
        assert_eq!(
            (0..3).find_map(|_| line.tick(false)),
            Some(Fault::CommsEnableStuckOff)
        );
    }
}
