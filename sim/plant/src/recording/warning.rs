//! Oddities of a recording: for a person to judge, the motion is made all the same.

use super::{AngleUnit, Place};
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
}

impl fmt::Display for Warning {
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
                 {median_interval_s:.3} s is usual ({count} such {}); the motion there is a guess",
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
            Self::SmallAngles { place, largest_deg } => write!(
                f,
                "{place}: no angle is beyond ±{largest_deg:.3} deg; \
                 if the file is in radians, write unit = \"rad\""
            ),
        }
    }
}
