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
    /// Off, the test passed.
    Tested,
    /// On.
    On,
}

/// The enable line.
#[derive(Clone, Copy, Debug, Default)]
pub struct EnableLine {
    step: Step,
    /// Consecutive milliseconds in which the read-back differs from the output.
    mismatch_ms: u32,
}

impl EnableLine {
    /// Starts the test: on, and off.
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

    /// Switches the line on, if it has passed its test.
    pub fn raise(&mut self) {
        if self.step == Step::Tested {
            self.step = Step::On;
        }
    }

    /// Returns whether the line has passed its test.
    pub fn is_tested(&self) -> bool {
        matches!(self.step, Step::Tested | Step::On)
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
                Step::FirstOn => self.step = Step::OffAgain,
                Step::OffAgain => self.step = Step::Tested,
                Step::Off | Step::Tested | Step::On => {}
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

    /// Outcome of the test of a line that follows a millisecond late, or is stuck.
    fn prove(stuck: Option<bool>) -> (Option<Fault>, bool, u32) {
        let mut line = EnableLine::default();
        let mut is_on = stuck.unwrap_or(false);
        line.prove();
        for ms in 1..20 {
            let fault = line.tick(is_on);
            if fault.is_some() || line.is_tested() {
                return (fault, line.is_tested(), ms);
            }
            is_on = stuck.unwrap_or(line.level());
        }
        panic!("neither tested nor stuck");
    }

    #[test]
    fn it_is_tested_on_and_off_and_then_raised() {
        let (fault, is_tested, ms) = prove(None);
        assert_eq!((fault, is_tested), (None, true));
        assert!(ms <= 6, "{ms}");
        let mut line = EnableLine::default();
        line.raise();
        assert!(!line.level(), "not tested");
    }

    #[test]
    fn a_stuck_one_is_not_tested() {
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
        assert!(line.is_tested() && !line.level());
        line.raise();
        assert!(line.level());
        assert_eq!(line.tick(true), None);
        assert_eq!(line.tick(false), None, "a moment is no fault");
        assert_eq!(
            (0..3).find_map(|_| line.tick(false)),
            Some(Fault::CommsEnableStuckOff)
        );
    }
}
