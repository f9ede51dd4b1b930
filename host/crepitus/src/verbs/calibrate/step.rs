//! The steps, and what a person does in each.

use clap::ValueEnum;

crepitus_model::named! {
    /// A step of the calibration.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
    pub(super) enum Step {
        /// The angle's zero, with the joint straight.
        Zero => "zero",
        /// The range of motion, by hand.
        Range => "range",
        /// Motor and encoder turn the same way.
        Polarity => "polarity",
        /// Friction, by a weight that swings.
        Friction => "friction",
        /// The motor's torque constant, by a weight that hangs.
        TorqueConstant => "torque-constant",
    }
}

impl Step {
    /// Returns whether a known weight hangs in the brace.
    pub(super) fn needs_weight(self) -> bool {
        matches!(self, Self::Friction | Self::TorqueConstant)
    }

    /// Returns whether the angle has to have its zero: without one the device is not armed.
    pub(super) fn needs_zero(self) -> bool {
        matches!(self, Self::Range | Self::Polarity | Self::TorqueConstant)
    }

    /// Returns whether the person says when the motion has ended.
    pub(super) fn ends_by_hand(self) -> bool {
        matches!(self, Self::Range | Self::Friction)
    }

    /// Instruction to the person.
    pub(super) fn instruction(self) -> &'static str {
        match self {
            Self::Zero => {
                "Straighten the joint (full extension), and hold it still for a second. Torque stays off."
            }
            Self::Range => {
                "Move the joint by hand from straight to its flexion stop and back to its extension stop, twice, slowly. Torque stays off."
            }
            Self::Polarity => {
                "Bend the joint to somewhere in the middle, nothing hanging on it, and let go of it. The motor pushes it to and fro \
                 for 16 ms, by less than a degree. Keep the stop in your hand."
            }
            Self::Friction => {
                "Strap the weight into the lower half of the brace, the axis level. After Enter: lift it by 50 to 65 degrees, hold it still \
                 for half a second, let go without pushing, and do not touch it until it has hung still for a second. Torque stays off."
            }
            Self::TorqueConstant => {
                "Fasten the weight to the lower half of the brace, the axis level, and let it hang still. The motor lifts it slowly \
                 towards horizontal and lets it down again, for about half a minute. Stand clear of it, do not touch it, and keep the stop in \
                 your hand."
            }
        }
    }
}
