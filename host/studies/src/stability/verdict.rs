//! Verdict of a case.

use std::fmt;

/// A measured number and its limit: it holds if it is not above. A criterion that is met or not, without a number,
/// has [none](Margin::NONE).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Margin {
    /// The measured value.
    pub measured: f64,
    /// The largest allowed value.
    pub limit: f64,
    /// Unit of both; empty for counts and ratios.
    pub unit: &'static str,
}

/// Verdict of a subject in a case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// Every criterion is met; the margin is the narrowest.
    Holds(Margin),
    /// The motion is right in kind, a number is not; `flagged` if the run says
    /// so by itself ("step longer than a stick phase").
    Degrades {
        /// The worst number.
        margin: Margin,
        /// Whether the run itself gives the warning.
        flagged: bool,
    },
    /// The motion is not the joint's: NaN, another sequence of events, a torque
    /// above its limit.
    Fails {
        /// The failure.
        what: Failure,
        /// Time since the start of the trial, s; `None` where the failure has no time.
        at_s: Option<f64>,
        /// Whether the run itself gives the warning.
        flagged: bool,
    },
}

/// The ways to fail.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Failure {
    /// A state or a torque is infinite or NaN.
    Overflow,
    /// |T| > Ts, or a `frozen` object beyond Ts/kr.
    AboveTheLimit,
    /// Other events than the true ones, or in another order.
    OtherEvents {
        /// Their number.
        found: u64,
        /// The expected number.
        expected: u64,
    },
    /// A criterion without a number.
    Broken(&'static str),
}

impl Verdict {
    /// A criterion without a number that is met.
    pub(super) const MET: Self = Self::Holds(Margin::NONE);

    /// Compares a number with its limit; NaN is above every limit.
    pub(super) fn of(measured: f64, limit: f64, unit: &'static str) -> Self {
        let margin = Margin {
            measured,
            limit,
            unit,
        };
        if measured <= limit {
            Self::Holds(margin)
        } else {
            Self::Degrades {
                margin,
                flagged: false,
            }
        }
    }

    /// A criterion without a number that is not met.
    pub(super) fn broken(what: &'static str) -> Self {
        Self::fails(Failure::Broken(what), None)
    }

    /// The motion is not the joint's.
    pub(super) fn fails(what: Failure, at_s: Option<f64>) -> Self {
        Self::Fails {
            what,
            at_s,
            flagged: false,
        }
    }

    /// Sets whether the run itself gives a warning.
    pub(super) fn flag(mut self, by_itself: bool) -> Self {
        if let Self::Degrades { flagged, .. } | Self::Fails { flagged, .. } = &mut self {
            *flagged = by_itself;
        }
        self
    }

    /// Returns whether every criterion is met.
    pub fn holds(&self) -> bool {
        matches!(self, Self::Holds(_))
    }

    /// The name in files: `holds`, `degrades`, `fails`.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Holds(_) => "holds",
            Self::Degrades { .. } => "degrades",
            Self::Fails { .. } => "fails",
        }
    }

    /// Returns whether the run itself gives a warning.
    pub fn is_flagged(&self) -> bool {
        match self {
            Self::Holds(_) => false,
            Self::Degrades { flagged, .. } | Self::Fails { flagged, .. } => *flagged,
        }
    }
}

impl Margin {
    /// Of a criterion without a number, which is met.
    pub const NONE: Self = Self {
        measured: 0.0,
        limit: 0.0,
        unit: "",
    };

    /// Returns whether there is a number that could come near its limit.
    pub fn is_number(&self) -> bool {
        *self != Self::NONE
    }

    /// The used share of the limit: at most 1 if it holds. 0 of 0 is 0; NaN
    /// exceeds every limit.
    pub fn share(&self) -> f64 {
        if self.measured == 0.0 {
            0.0
        } else if self.measured.is_nan() {
            f64::INFINITY
        } else {
            self.measured / self.limit
        }
    }
}

impl fmt::Display for Margin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sign = if self.measured <= self.limit {
            "≤"
        } else {
            ">"
        };
        write!(f, "{} {sign} {}", Short(self.measured), Short(self.limit))?;
        if self.unit.is_empty() {
            Ok(())
        } else {
            write!(f, " {}", self.unit)
        }
    }
}

/// A number as a table shows it: two digits, whole numbers as they are.
struct Short(f64);

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let x = self.0;
        if x == x.trunc() && x.abs() < 1e6 {
            write!(f, "{x}")
        } else if (1e-2..1e4).contains(&x.abs()) {
            write!(f, "{x:.3}")
        } else {
            write!(f, "{x:.1e}")
        }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let flag = |flagged: &bool| if *flagged { ", flagged" } else { "" };
        match self {
            Self::Holds(margin) if margin.is_number() => write!(f, "holds ({margin})"),
            Self::Holds(_) => f.write_str("holds"),
            Self::Degrades { margin, flagged } => {
                write!(f, "degrades{} ({margin})", flag(flagged))
            }
            Self::Fails {
                what,
                at_s,
                flagged,
            } => {
                write!(f, "fails{}: {what}", flag(flagged))?;
                at_s.map_or(Ok(()), |t| write!(f, " at t = {} s", Short(t)))
            }
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Overflow => f.write_str("overflow"),
            Self::AboveTheLimit => f.write_str("torque above its limit"),
            Self::OtherEvents { found, expected } => {
                write!(f, "{found} events instead of {expected}")
            }
            Self::Broken(what) => f.write_str(what),
        }
    }
}
