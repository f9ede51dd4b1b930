//! Reasons to reject an examination.

/// Reason why a recording gives no model; the text says what to do.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Refusal {
    /// Next to no samples.
    #[error("{samples} samples are too few: record several strokes, 10 s or more at 50 Hz or more")]
    Short {
        /// Number of samples.
        samples: usize,
    },
    /// Times go back, or a number is not finite.
    #[error(
        "times must increase and all numbers be finite: check the columns of time, angle and torque"
    )]
    NotInOrder,
    /// Samples are missing.
    #[error("{longest_s:.2} s without a sample: record again, or cut the file there")]
    Gap {
        /// Longest interval, s.
        longest_s: f64,
    },
    /// Too few samples a second.
    #[error(
        "{hz:.1} samples a second are too few: record at 50 Hz or more; is the unit of the times right (--time-unit)?"
    )]
    Slow {
        /// Samples a second.
        hz: f64,
    },
    /// Longer than an examination.
    #[error(
        "the recording lasts {lasts_s:.0} s, at most {most_s:.0} s are fitted: cut out the strokes; is the unit of the \
         times right (--time-unit)?"
    )]
    Long {
        /// Duration, s.
        lasts_s: f64,
        /// Limit, s.
        most_s: f64,
    },
    /// Too few strokes.
    #[error(
        "{strokes} strokes were found ({flexions} of flexion), {least} are needed, there and back at two speeds or more: \
         a stroke is a motion of 10 degrees or more in one direction; are the angle's column and unit right, and \
         that of the time?"
    )]
    FewStrokes {
        /// Number of strokes.
        strokes: usize,
        /// Number of those in flexion.
        flexions: usize,
        /// Number that is needed.
        least: usize,
    },
    /// Too little range.
    #[error(
        "the angle covers {range_deg:.0} degrees only, {least_deg:.0} are needed to tell limb and symptom apart; \
         is its unit right (--unit deg or rad)?"
    )]
    Narrow {
        /// Range of the angle, deg.
        range_deg: f64,
        /// Range that is needed, deg.
        least_deg: f64,
    },
    /// The torque has nothing to do with the motion.
    #[error(
        "the torque is noise: limb and symptom explain {share:.0} % of it, and {residual_nm:.2} N·m rms are left; \
         check the torque's column and its unit, and that the sensor was on, or that a released leg was free"
    )]
    Noise {
        /// Explained share of the torque's variance, %.
        share: f64,
        /// RMS residual, N·m.
        residual_nm: f64,
    },
    /// Two symptoms explain it alike.
    #[error(
        "{first} and {second} explain this examination alike (errors in strokes that were left out: {first_nm:.3} and \
         {second_nm:.3} N·m rms): record more strokes, at 30, 90 and 180 deg/s or more, with a second's hold after each"
    )]
    Alike {
        /// The better one.
        first: &'static str,
        /// The other one.
        second: &'static str,
        /// Error of the first in left-out strokes, N·m rms.
        first_nm: f64,
        /// Error of the second.
        second_nm: f64,
    },
    /// The caller has ended it.
    #[error("interrupted")]
    Interrupted,
}
