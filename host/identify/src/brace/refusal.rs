//! Reasons to reject recordings of a swinging weight.

/// Reason why recordings give no values; the text says what to do.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Refusal {
    /// Next to no samples.
    #[error(
        "the recording is too short: {duration_s:.1} s; record from before the release until the weight hangs still"
    )]
    Short {
        /// Length of the recording, s.
        duration_s: f64,
    },
    /// Samples are missing.
    #[error(
        "{share:.1} % of the samples are missing or rejected, up to {longest_ms:.0} ms in a row (at most {limit:.0} % \
         and {limit_ms:.0} ms): record again; `crepitus doctor` finds a bad cable or encoder"
    )]
    Missing {
        /// Missing or rejected share of all samples, %.
        share: f64,
        /// The longest gap, ms.
        longest_ms: f64,
        /// The limit, %.
        limit: f64,
        /// The limit in a row, ms.
        limit_ms: f64,
    },
    /// Ticks go back.
    #[error(
        "tick {tick} comes after a later one: the drive has restarted in this recording; record again"
    )]
    NotInOrder {
        /// The tick.
        tick: u64,
    },
    /// The encoder jumps.
    #[error(
        "the encoder jumps by {degrees:.1}° at {time_s:.3} s: a belt or coupling slips, or edges are lost; nothing \
         after that is where it was: repair it and record again"
    )]
    Jump {
        /// Time, s from the recording's start.
        time_s: f64,
        /// Size of the jump, °.
        degrees: f64,
    },
    /// The encoder stops counting in mid-motion.
    #[error(
        "the encoder stands still from {time_s:.2} s on in the middle of a motion of {speed_deg_s:.0} °/s: its signal \
         is lost or its counter saturates; check the encoder's cable"
    )]
    Frozen {
        /// Time, s from the recording's start.
        time_s: f64,
        /// The speed before, °/s.
        speed_deg_s: f64,
    },
    /// No motion.
    #[error(
        "nothing turns: the angle stays within {degrees:.2}° (expected {expected:.0}° or more); lift the weight by 50° \
         or more and let go"
    )]
    NoMotion {
        /// Range of the angle, °.
        degrees: f64,
        /// Expected at least, °.
        expected: f64,
    },
    /// Turns in one direction only.
    #[error(
        "the motion never reverses and comes to rest within {duration_s:.1} s of recording: a weight that is lifted and \
         let go swings there and back; use a longer lever or more weight if the gear's friction stops it at once"
    )]
    NoReversal {
        /// Length of the recording, s.
        duration_s: f64,
    },
    /// The recording ends in mid-swing.
    #[error(
        "the recording ends while the weight still moves: record until it has hung still for a second"
    )]
    NotToRest,
    /// Motion, but no free swing.
    #[error(
        "no free swing: expected a release at {amplitude:.0}° or more from rest, then two turning points or more \
         before the weight hangs still; let go without pushing, and do not touch it"
    )]
    NoSwing {
        /// Amplitude that a swing needs, °.
        amplitude: f64,
    },
    /// Impossible value given for the weight.
    #[error("{what} = {value}: expected a number above zero")]
    Given {
        /// Name of the value.
        what: &'static str,
        /// The value that was given.
        value: f64,
    },
    /// The fit does not explain the motion.
    #[error(
        "the motion is not that of a weight on friction, gap and cuffs: the best fit is off by {rms_deg:.2}° rms in swings \
         of {swing_deg:.0}° (at most {limit_deg:.2}°), most at {time_s:.1} s; a leg in the brace, a hand that touches \
         it, a swinging bench or cable does this"
    )]
    Misfit {
        /// Root mean square of what is left, °.
        rms_deg: f64,
        /// The first amplitude, °.
        swing_deg: f64,
        /// The limit, °.
        limit_deg: f64,
        /// Time at which that is greatest, s from the recording's start.
        time_s: f64,
    },
    /// The swing contradicts what was given.
    #[error(
        "the swing contradicts what was given: {what} would have to be {found:.3} {unit} instead of {given:.3} ± {error:.3}; \
         weigh again, and measure from the axis to the centre of mass{also}"
    )]
    Contradiction {
        /// Name of what was given.
        what: &'static str,
        /// Unit of the values.
        unit: &'static str,
        /// Value that the swing gives.
        found: f64,
        /// Value that was given.
        given: f64,
        /// 95 % interval of the given value.
        error: f64,
        /// Another possible cause, for people.
        also: &'static str,
    },
    /// A number at the end of what can be.
    #[error(
        "{what} would be {value:.4} {unit}, which no brace has: check mass, lever and inertia of the weight"
    )]
    Impossible {
        /// Name of the quantity.
        what: &'static str,
        /// Value of the quantity.
        value: f64,
        /// Unit of the value.
        unit: &'static str,
    },
    /// The caller has ended it.
    #[error("interrupted")]
    Interrupted,
    /// The equations have no solution.
    #[error(
        "the fit has no solution: the recording does not tell its numbers apart; record again, with torque"
    )]
    Singular,
}
