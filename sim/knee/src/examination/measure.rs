//! The table of measures.

crepitus_model::named! {
    /// A measure of an examination; its place in [`Measure::ALL`] is its place in every list.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    pub enum Measure {
        /// From the least angle to the greatest.
        Range => "range",
        /// The greatest angle.
        Flexion => "flexion",
        /// Degrees that are missing to straight.
        Deficit => "deficit",
        /// The highest speed.
        PeakSpeed => "peak-speed",
        /// R1.
        Catch => "catch",
        /// R2.
        SlowEnd => "slow-end",
        /// R2 − R1.
        Dynamic => "dynamic",
        /// Beats of clonus.
        Beats => "beats",
        /// Beats a second.
        BeatRate => "beat-rate",
        /// Steadiness of the last stroke.
        Unsteadiness => "unsteadiness",
        /// Smoothness of the last stroke.
        Smoothness => "smoothness",
    }
}

/// Number of measures.
pub const COUNT: usize = Measure::ALL.len();

/// Description of a measure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MeasureSpec {
    /// Name with its unit, in files and in Python.
    pub key: &'static str,
    /// Name for people.
    pub label: &'static str,
    /// Unit for people; empty for a number.
    pub unit: &'static str,
    /// Decimal places that are worth showing.
    pub digits: u8,
    /// Whether it tells something of the torque, which a blind trial hides.
    pub is_of_torque: bool,
    /// Meaning.
    pub meaning: &'static str,
}

const fn spec(
    key: &'static str,
    label: &'static str,
    unit: &'static str,
    digits: u8,
    is_of_torque: bool,
    meaning: &'static str,
) -> MeasureSpec {
    MeasureSpec {
        key,
        label,
        unit,
        digits,
        is_of_torque,
        meaning,
    }
}

/// The table, in the order of [`Measure::ALL`].
static SPECS: [MeasureSpec; COUNT] = [
    spec(
        "range_deg",
        "range of motion",
        "°",
        0,
        false,
        "from the least angle that was reached to the greatest",
    ),
    spec(
        "flexion_deg",
        "flexion",
        "°",
        0,
        false,
        "the greatest angle that was reached",
    ),
    spec(
        "deficit_deg",
        "extension deficit",
        "°",
        0,
        true,
        "angle at which the last slow stroke into extension met its end; 0 if it came within 5° of straight without",
    ),
    spec(
        "peak_speed_deg_s",
        "peak speed",
        "°/s",
        0,
        false,
        "the highest speed, over 20 ms",
    ),
    spec(
        "catch_deg",
        "catch angle (R1)",
        "°",
        0,
        true,
        "angle at which the resistance to the fastest stretch rose all at once",
    ),
    spec(
        "slow_end_deg",
        "end of the slow stretch (R2)",
        "°",
        0,
        true,
        "furthest angle of a slow stroke in the sense of the catch, or in flexion: where it met its end, or turned",
    ),
    spec(
        "dynamic_deg",
        "R2 − R1",
        "°",
        0,
        true,
        "the dynamic part of a spastic muscle's shortening",
    ),
    spec(
        "beats",
        "beats",
        "",
        0,
        true,
        "beats of torque in a row, with the leg held",
    ),
    spec(
        "beat_rate_hz",
        "beats a second",
        "Hz",
        1,
        true,
        "their rate",
    ),
    spec(
        "unsteadiness_percent",
        "unsteadiness",
        "%",
        0,
        false,
        "coefficient of variation of the speed in the middle half of the last stroke; 5 of a practised hand",
    ),
    spec(
        "smoothness",
        "smoothness",
        "",
        1,
        false,
        "−ln of the dimensionless jerk of the last stroke; −2.9 of the smoothest",
    ),
];

impl Measure {
    /// Description of the measure.
    pub fn spec(self) -> &'static MeasureSpec {
        let [first, ..] = &SPECS;
        // The table has a line for each.
        SPECS.get(self as usize).unwrap_or(first)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_in_the_order_of_the_measures() {
        for (place, measure) in Measure::ALL.into_iter().enumerate() {
            assert_eq!(measure as usize, place);
            let stem = measure.name().replace('-', "_");
            assert!(measure.spec().key.starts_with(&stem), "{measure:?}");
            assert_eq!(Measure::ALL[place], measure);
        }
    }
}
