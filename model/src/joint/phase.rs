//! The phases of the imaginary object and the events between them.

use crate::real::Real;

/// The direction of a slip: the sign of the shaft's velocity relative to the
/// imaginary object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sense {
    /// The shaft overtakes the object towards growing angle; T = +Tk.
    Positive,
    /// The shaft overtakes the object towards falling angle; T = −Tk.
    Negative,
}

impl Sense {
    /// The sense of a number, `None` for zero (and for NaN).
    pub fn of<F: Real>(x: F) -> Option<Self> {
        if x > F::ZERO {
            Some(Self::Positive)
        } else if x < F::ZERO {
            Some(Self::Negative)
        } else {
            None
        }
    }

    /// `x` for a positive sense, `−x` for a negative one: the product s·x,
    /// exact for every `x`.
    #[inline]
    pub fn of_signed<F: Real>(self, x: F) -> F {
        match self {
            Self::Positive => x,
            Self::Negative => -x,
        }
    }

    /// The other sense.
    #[inline]
    pub fn opposite(self) -> Self {
        match self {
            Self::Positive => Self::Negative,
            Self::Negative => Self::Positive,
        }
    }
}

/// Phase of the imaginary object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// The object moves with the shaft.
    Stick,
    /// The object slides against the shaft.
    Slip(Sense),
}

impl Phase {
    /// −1, 0 (stick) or +1, as traces and recordings write it.
    pub fn sign(self) -> i8 {
        match self {
            Self::Slip(Sense::Negative) => -1,
            Self::Stick => 0,
            Self::Slip(Sense::Positive) => 1,
        }
    }

    /// The name in files: `slip-`, `stick`, `slip+`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Slip(Sense::Negative) => "slip-",
            Self::Stick => "stick",
            Self::Slip(Sense::Positive) => "slip+",
        }
    }

    /// The phase with this [`sign`](Self::sign); zero and everything else is
    /// stick.
    pub fn from_sign(sign: i8) -> Self {
        match sign {
            -1 => Self::Slip(Sense::Negative),
            1 => Self::Slip(Sense::Positive),
            _ => Self::Stick,
        }
    }
}

/// Events of the imaginary object.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum EventKind {
    /// Stick ends: the torque reached the static limit, or the shaft jumped.
    Break,
    /// Slip ends in stick.
    Stick,
    /// Slip ends in slip of the other sense: at the velocity match the static
    /// limit could not hold the object, or the shaft jumped past it.
    Reverse,
}

impl EventKind {
    /// The name in files: `break`, `stick`, `reverse`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Break => "break",
            Self::Stick => "stick",
            Self::Reverse => "reverse",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_signs_are_those_of_the_files() {
        let phases = [
            (Phase::Slip(Sense::Negative), -1, "slip-"),
            (Phase::Stick, 0, "stick"),
            (Phase::Slip(Sense::Positive), 1, "slip+"),
        ];
        for (phase, sign, name) in phases {
            assert_eq!((phase.sign(), phase.name()), (sign, name));
            assert_eq!(Phase::from_sign(sign), phase);
        }
        assert_eq!(Phase::from_sign(7), Phase::Stick);
        let kinds = [EventKind::Break, EventKind::Stick, EventKind::Reverse];
        assert_eq!(kinds.map(EventKind::name), ["break", "stick", "reverse"]);
        assert_eq!(Sense::of(2.0), Some(Sense::Positive));
        assert_eq!(Sense::of(-2.0_f32), Some(Sense::Negative));
        assert_eq!((Sense::of(0.0), Sense::of(f64::NAN)), (None, None));
        assert_eq!(Sense::Positive.opposite(), Sense::Negative);
        assert_eq!(Sense::Negative.opposite().of_signed(3.0), 3.0);
    }
}
