//! Reset cause, from the reset hardware's flags and the record in RAM.
//!
//! | flags | record | cause |
//! |---|---|---|
//! | brown-out without power-on | | brown-out |
//! | power-on | valid: RAM has kept its contents | brown-out |
//! | power-on | invalid | power |
//! | any other | panic, fault, unhandled | panic |
//! | a watchdog | | watchdog |
//! | software, pin | | asked |
//!
//! Every reset also sets the pin's flag, so that one is ignored.

use crate::reset_record::{Reason, ResetRecord};
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

/// Returns the reset cause.
pub fn reset_cause(flags: Flags, record: Option<&ResetRecord>) -> ResetCause {
    let reason = record.map_or(Reason::None, |record| record.reason);
    match (flags, reason) {
        (Flags { power_on: true, .. }, _) if record.is_none() => ResetCause::Power,
        (
            Flags {
                power_on,
                brown_out,
                ..
            },
            _,
        ) if power_on || brown_out => ResetCause::BrownOut,
        // A fault handler that did not finish ends in a watchdog reset.
        (_, Reason::Panic | Reason::Fault | Reason::Unhandled) => ResetCause::Panic,
        (Flags { watchdog: true, .. }, _) => ResetCause::Watchdog,
        _ => ResetCause::Requested,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_of_the_table() {
        let record = |reason| ResetRecord {
            reason,
            ..ResetRecord::default()
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
            Some(record(Reason::None)),
            Some(record(Reason::Asked)),
            Some(record(Reason::Fault)),
        );
        for (flags, record, cause) in [
            (power, None, ResetCause::Power),
            (power, none, ResetCause::BrownOut),
            (fell, none, ResetCause::BrownOut),
            (fell, None, ResetCause::BrownOut),
            (watchdog, none, ResetCause::Watchdog),
            (watchdog, panic, ResetCause::Panic),
            (no, panic, ResetCause::Panic),
            (no, asked, ResetCause::Requested),
            (no, none, ResetCause::Requested),
            (no, None, ResetCause::Requested),
        ] {
            assert_eq!(reset_cause(flags, record.as_ref()), cause);
        }
    }
}
