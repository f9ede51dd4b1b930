//! Why a controller has started: what the reset hardware says, and what was
//! kept.
//!
//! | flags | kept | cause |
//! |---|---|---|
//! | brown-out without power-on | | brown-out |
//! | power-on | valid: RAM has lived through it | brown-out |
//! | power-on | no | power |
//! | any other | panic, fault, unhandled | panic |
//! | a watchdog | | watchdog |
//! | software, pin | | asked |
//!
//! Every reset also sets the pin's flag, so that one says least.

use crate::kept::{Kept, Reason};
use crepitus_protocol::management::ResetCause;

/// The flags of RCC_CSR.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Flags {
    /// Power was switched on, or was gone.
    pub power_on: bool,
    /// The supply fell below the level that the option bytes say.
    pub brown_out: bool,
    /// The independent watchdog, or the window watchdog.
    pub watchdog: bool,
}

/// The cause.
pub fn reset_cause(flags: Flags, kept: Option<&Kept>) -> ResetCause {
    let reason = kept.map_or(Reason::None, |kept| kept.reason);
    match (flags, reason) {
        (Flags { power_on: true, .. }, _) if kept.is_none() => ResetCause::Power,
        (
            Flags {
                power_on,
                brown_out,
                ..
            },
            _,
        ) if power_on || brown_out => ResetCause::BrownOut,
        // A fault handler that could not finish ends in the watchdog.
        (_, Reason::Panic | Reason::Fault | Reason::Unhandled) => ResetCause::Panic,
        (Flags { watchdog: true, .. }, _) => ResetCause::Watchdog,
        _ => ResetCause::Asked,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_of_the_table() {
        let kept = |reason| Kept {
            reason,
            ..Kept::default()
        };
        let no = Flags::default();
        let power = Flags {
            power_on: true,
            brown_out: true,
            ..no
        };
        let fell = Flags {
            brown_out: true,
            ..no
        };
        let watchdog = Flags {
            watchdog: true,
            ..no
        };
        let (none, asked, panic) = (
            Some(kept(Reason::None)),
            Some(kept(Reason::Asked)),
            Some(kept(Reason::Fault)),
        );
        for (flags, kept, cause) in [
            (power, None, ResetCause::Power),
            (power, none, ResetCause::BrownOut),
            (fell, none, ResetCause::BrownOut),
            (fell, None, ResetCause::BrownOut),
            (watchdog, none, ResetCause::Watchdog),
            (watchdog, panic, ResetCause::Panic),
            (no, panic, ResetCause::Panic),
            (no, asked, ResetCause::Asked),
            (no, none, ResetCause::Asked),
            (no, None, ResetCause::Asked),
        ] {
            assert_eq!(reset_cause(flags, kept.as_ref()), cause);
        }
    }
}
