//! The effects that a scene can call for, one file each.

use crate::effect::Effect;

/// Declares the effects' files and the table of them.
macro_rules! effects {
    ($($file:ident),* $(,)?) => {
        $(pub mod $file;)*

        /// All effects. Those of the chain stand in its order, from the motor
        /// to the hand.
        pub const EFFECTS: &[&Effect] = &[$(&$file::EFFECT),*];
    };
}

effects! {
    crepitus,
    encoder,
    motor,
    drivetrain,
    friction_compensation,
    backlash,
    cuff,
    limb,
    hand,
    bone_shaping,
}

/// The effect of this name.
pub fn find(name: &str) -> Option<&'static Effect> {
    EFFECTS.iter().copied().find(|e| e.name == name)
}
