//! Reasons to reject a chirp.

use crepitus_model::SettingsError;

/// Reason why a chirp gives no parameters; the text says what to do.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Refusal {
    /// The voltage does not reach all of the band.
    #[error(
        "too little excitation at {hz:.0} Hz: the voltage has less than {share:.0} % there of what it has elsewhere; \
         play a chirp over the whole band, or name the band that was played with --from-hz and --to-hz"
    )]
    LittleExcitation {
        /// Frequency that lacks excitation, Hz.
        hz: f64,
        /// The limit, %.
        share: f64,
    },
    /// No voltage.
    #[error("no voltage: {volts:.4} V rms; expected the chirp in the column volts")]
    NoVoltage {
        /// Root mean square of the voltage, V.
        volts: f64,
    },
    /// Too few samples to tell noise from misfit.
    #[error(
        "{rows_per_s:.0} rows per second are too few: of this chirp the band up to {to_hz:.0} Hz is fitted, and the \
         noise is taken from above it; sample faster, at {needed_per_s:.0} rows per second or more, or end the \
         chirp lower with --to-hz"
    )]
    FewRows {
        /// Sampling rate, Hz.
        rows_per_s: f64,
        /// End of the band, Hz.
        to_hz: f64,
        /// Least sampling rate for it, Hz.
        needed_per_s: f64,
    },
    /// The recording does not begin and end at rest.
    #[error(
        "the recording {place} while the chirp plays ({volts:.3} V rms): record from before its start \
         until 0.5 s after its end"
    )]
    NotAtRest {
        /// "begins" or "ends".
        place: &'static str,
        /// Voltage there, V.
        volts: f64,
    },
    /// No current, or next to none.
    #[error(
        "the coil is open, or its current is not measured: {amperes:.4} A rms at {volts:.3} V rms, more than \
         {limit_ohm:.0} Ω; check the coil's wires and the current sensor"
    )]
    CoilOpen {
        /// Root mean square of the current, A.
        amperes: f64,
        /// Root mean square of the voltage, V.
        volts: f64,
        /// The limit, Ω.
        limit_ohm: f64,
    },
    /// Voltage and current have opposite signs.
    #[error(
        "the resistance would be {resistance_ohm:.2} Ω: the sign of the current, or of the voltage, is reversed"
    )]
    Reversed {
        /// R, Ω.
        resistance_ohm: f64,
    },
    /// No resonance in the band.
    #[error(
        "no resonance between {from_hz:.0} and {to_hz:.0} Hz: the current shows resistance and inductance only; \
         the mass is stuck, its resonance lies outside the band, the amplitude is too low to see it, or mains hum hides it"
    )]
    NoResonance {
        /// Start of the band, Hz.
        from_hz: f64,
        /// End of the band, Hz.
        to_hz: f64,
    },
    /// The resonance is too near an end of the band.
    #[error(
        "the resonance at {resonance_hz:.1} Hz lies at the edge of the band of {from_hz:.0} to {to_hz:.0} Hz: \
         play a chirp that begins below {below_hz:.0} Hz and ends above {above_hz:.0} Hz"
    )]
    AtEdge {
        /// The resonance, Hz.
        resonance_hz: f64,
        /// Start of the band, Hz.
        from_hz: f64,
        /// End of the band, Hz.
        to_hz: f64,
        /// Greatest start that would do, Hz.
        below_hz: f64,
        /// Least end that would do, Hz.
        above_hz: f64,
    },
    /// The current is cut at a level.
    #[error(
        "the current is clipped at {amperes:.3} A ({share:.0} % of the time that it is high): lower the amplitude, \
         or widen the range of the current sensor"
    )]
    Clipped {
        /// The level, A.
        amperes: f64,
        /// Share of the samples above 70 % of it, %.
        share: f64,
    },
    /// The current is too small for the steps in which it is recorded.
    #[error(
        "the current is too weak: it reaches {milliamperes:.1} mA, and is recorded in steps of {step_ma:.1} mA; \
         raise the amplitude"
    )]
    Weak {
        /// Largest current, mA.
        milliamperes: f64,
        /// Least difference of two samples, mA.
        step_ma: f64,
    },
    /// A second resonance.
    #[error(
        "a second resonance near {hz:.0} Hz, with {height:.1} % of the first one's hump ({deviations:.0} times its \
         noise): the ring moves, as in a hand or on a leg; clamp it in a vice, and keep the cable from swinging"
    )]
    SecondResonance {
        /// Frequency of the second resonance, Hz.
        hz: f64,
        /// Height of its hump over that of the first, %.
        height: f64,
        /// The height over its standard deviation.
        deviations: f64,
    },
    /// Far above the resonance a coil is more than R and L.
    #[error(
        "above the resonance the coil is no resistance with an inductance: near {hz:.0} Hz the current differs by \
         {share:.1} %; eddy currents or the amplifier's bandwidth do this: take a lower --to-hz"
    )]
    NotAnInductance {
        /// Frequency of the greatest difference, Hz.
        hz: f64,
        /// The difference, %.
        share: f64,
    },
    /// A frequency that the chirp does not explain.
    #[error(
        "the current has a steady {hz:.1} Hz that the voltage does not have, {share:.0} % of what is neither explained \
         nor noise: mains hum, or another device's; twist the wires, and keep them away from mains and its adapters"
    )]
    Hum {
        /// Frequency of the hum, Hz.
        hz: f64,
        /// Share of the hum in the unexplained power, %.
        share: f64,
    },
    /// Current that no linear system has.
    #[error(
        "the current is not that of a linear actuator: {share:.1} % of it is neither explained nor noise; the mass \
         probably hits its stops{swing}, or rubs, or the amplifier has a dead time: \
         lower the amplitude, then look at the flexure"
    )]
    Nonlinear {
        /// Unexplained share, %.
        share: f64,
        /// Swing of a linear actuator, for people.
        swing: String,
    },
    /// A number that cannot be below zero is.
    #[error(
        "{what} would be {value:.4}, below zero: check that volts and amperes were taken at the same time and \
         with the right scale"
    )]
    Negative {
        /// Name of the number, with its unit.
        what: &'static str,
        /// Value of the number.
        value: f64,
    },
    /// The noise leaves a parameter too uncertain.
    #[error(
        "{what} is known to ±{share:.1} % only, expected ±{limit:.0} % or better: play a longer chirp or a higher \
         amplitude; the noise of the current is {noise_ma:.1} mA"
    )]
    Uncertain {
        /// Name of the parameter.
        what: &'static str,
        /// Half width of its interval, %.
        share: f64,
        /// The limit, %.
        limit: f64,
        /// Noise of a sample, mA.
        noise_ma: f64,
    },
    /// The resistance differs between the two chirps.
    #[error(
        "the coil has {first_ohm:.3} Ω without and {second_ohm:.3} Ω with the added mass: let it cool down between \
         the two chirps"
    )]
    Warm {
        /// R of the first, Ω.
        first_ohm: f64,
        /// R of the second, Ω.
        second_ohm: f64,
    },
    /// The added mass changes resonance and coupling differently.
    #[error(
        "the added mass lowers the resonance as {by_resonance:.3} times the mass would, and the back-EMF as \
         {by_coupling:.3} times: it is not rigidly on the moving mass, or the ring moved in its clamp"
    )]
    AddedMassLoose {
        /// (m + Δ)/m from the resonance.
        by_resonance: f64,
        /// (m + Δ)/m from the coupling.
        by_coupling: f64,
    },
    /// The recording with the added mass has the higher resonance.
    #[error(
        "the second recording has the higher resonance, {with_hz:.2} Hz after {without_hz:.2} Hz, but an added mass lowers \
         it: are the two files swapped?"
    )]
    Swapped {
        /// Resonance of the first, Hz.
        without_hz: f64,
        /// Resonance of the second, Hz.
        with_hz: f64,
    },
    /// The added mass does next to nothing.
    #[error(
        "the added mass changes the resonance from {without_hz:.2} to {with_hz:.2} Hz only: use a third of the moving \
         mass or more"
    )]
    AddedMassSmall {
        /// Resonance without it, Hz.
        without_hz: f64,
        /// Resonance with it, Hz.
        with_hz: f64,
    },
    /// The mass that was weighed is not the one that moves.
    #[error(
        "the added mass says that {found_g:.1} g move, but {weighed_g:.1} g were given: the ring moves, as in a hand; or \
         weigh again, and count a third of the flexure and what of the cable moves"
    )]
    WrongMass {
        /// Mass found from the two chirps, g.
        found_g: f64,
        /// Mass as given, g.
        weighed_g: f64,
    },
    /// Outside what the device takes.
    #[error("{0}")]
    Settings(SettingsError),
}
