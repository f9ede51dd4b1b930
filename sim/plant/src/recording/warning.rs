//! Oddities of a recording: for a person to judge, the motion is made all the same.

use super::{AngleUnit, JOINT_DEG, JOINT_DEG_S, Place};
use std::fmt;

/// Warnings about a usable recording.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the text of each is in Display below")]
pub enum Warning {
    DeclaredRows {
        place: Place,
        declared: u64,
        found: u64,
    },
    DeclaredColumns {
        place: Place,
        declared: u64,
        found: u64,
    },
    /// The longest of `count` gaps, in the times of the file.
    Gap {
        place: Place,
        from_s: f64,
        to_s: f64,
        median_interval_s: f64,
        count: usize,
    },
    UnitInName {
        place: Place,
        unit: AngleUnit,
    },
    SmallAngles {
        place: Place,
        largest_deg: f64,
    },
    /// `file` is what the file says and where, `taken` the unit that counts.
    UnitAgainstFile {
        place: Place,
        file: String,
        taken: String,
    },
    NoAngleName {
        place: Place,
    },
    DoubledRows {
        place: Place,
        count: usize,
    },
    /// The first of `count` marks of missing samples.
    Mark {
        place: Place,
        number: f64,
        count: usize,
    },
    /// The first of `count` samples at zero between others that are not.
    Dropout {
        place: Place,
        count: usize,
    },
    /// The farthest of `count` samples, as the angle of the joint.
    Range {
        place: Place,
        deg: f64,
        count: usize,
        advice: &'static str,
    },
    /// The first of `count` steps by a whole turn.
    Wrap {
        place: Place,
        step_deg: f64,
        count: usize,
    },
    /// The fastest of `count` steps.
    Speed {
        place: Place,
        deg_s: f64,
        count: usize,
    },
}

impl fmt::Display for Warning {
    #[expect(clippy::too_many_lines, reason = "a sentence for each warning")]
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::DeclaredRows {
                place,
                declared,
                found,
            } => write!(
                f,
                "{place}: the header declares {declared} rows, the file has {found}; \
                 it may have been cut"
            ),
            Self::DeclaredColumns {
                place,
                declared,
                found,
            } => write!(
                f,
                "{place}: the header declares {declared} columns, the line of names has {found}"
            ),
            Self::Gap {
                place,
                from_s,
                to_s,
                median_interval_s,
                count,
            } => write!(
                f,
                "{place}: no samples between {from_s:.3} s and {to_s:.3} s, where \
                 {} s is usual ({count} such {}); the motion there is a guess",
                significant(*median_interval_s),
                if *count == 1 {
                    "gap"
                } else {
                    "gaps, this is the longest"
                }
            ),
            Self::UnitInName { place, unit } => {
                write!(
                    f,
                    "{place}: the name does not look like the chosen unit, \"{unit}\""
                )
            }
            Self::UnitAgainstFile { place, file, taken } => {
                write!(f, "{place}: {file}; taken as {taken}")
            }
            Self::NoAngleName { place } => write!(
                f,
                "{place}: the name is not that of an angle; check the column"
            ),
            Self::DoubledRows { place, count } => write!(
                f,
                "{place}: the row repeats the one before it, time and value; left out ({count} \
                 such {})",
                if *count == 1 { "row" } else { "rows" }
            ),
            Self::Mark {
                place,
                number,
                count,
            } => write!(
                f,
                "{place}: {number} looks like a mark of a missing sample ({count} in all), and is \
                 taken for an angle; leave such cells empty and write max_gap_s"
            ),
            Self::Dropout { place, count } => write!(
                f,
                "{place}: the angle drops to exactly 0 between samples far from it ({count} in \
                 all); if samples were lost there, leave the cells empty and write max_gap_s"
            ),
            Self::Range {
                place,
                deg,
                count,
                advice,
            } => write!(
                f,
                "{place}: the joint would be at {deg:.1} deg, where {} to {} deg is usual ({count} \
                 samples beyond, this is the farthest){advice}",
                JOINT_DEG.start(),
                JOINT_DEG.end()
            ),
            Self::Wrap {
                place,
                step_deg,
                count,
            } => write!(
                f,
                "{place}: the angle steps by {step_deg:.1} deg ({count} such in all): it wraps; \
                 unwrap the column"
            ),
            Self::Speed {
                place,
                deg_s,
                count,
            } => write!(
                f,
                "{place}: the angle changes by {deg_s:.0} deg/s, where up to {JOINT_DEG_S} is \
                 usual ({count} such steps, this is the fastest); check the sample"
            ),
            Self::SmallAngles { place, largest_deg } => write!(
                f,
                "{place}: no angle is beyond ±{largest_deg:.3} deg; \
                 if the file is in radians, write unit = \"rad\""
            ),
        }
    }
}

/// A time with three digits after the point, or three that are not zero.
fn significant(value: f64) -> String {
    let mut digits = 3;
    while digits < 12 && value.abs() * 10_f64.powi(digits) < 99.5 {
        digits += 1;
    }
    format!("{value:.*}", usize::try_from(digits).unwrap_or(3))
}
