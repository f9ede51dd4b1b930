//! The effects that a scene can call for: one file each here, or in the model,
//! whose [table](crepitus_model::render::effects) has those of the device.

pub mod backlash;
pub mod crepitus;
pub mod cuff;
pub mod drivetrain;
pub mod encoder;
pub mod hand;
pub mod limb;
pub mod limb_stretch;
pub mod motor;
pub mod reaction_mass;
pub mod shell;

use crate::effect::Effect;
use crepitus_model::render::effects::SPECS;

const OWN: &[Effect] = &[
    crepitus::EFFECT,
    encoder::EFFECT,
    motor::EFFECT,
    drivetrain::EFFECT,
    backlash::EFFECT,
    cuff::EFFECT,
    limb::EFFECT,
    limb_stretch::EFFECT,
    shell::EFFECT,
    reaction_mass::EFFECT,
    hand::EFFECT,
];

const COUNT: usize = OWN.len() + SPECS.len();

static ALL: [Effect; COUNT] = {
    let mut all = [OWN[0]; COUNT];
    let mut place = 1;
    while place < COUNT {
        all[place] = if place < OWN.len() {
            OWN[place]
        } else {
            Effect::of_device(&SPECS[place - OWN.len()])
        };
        place += 1;
    }
    all
};

/// All effects: those of the chain in its order, from the motor to the hand,
/// then those of the device in the order in which they act.
pub static EFFECTS: [&Effect; COUNT] = {
    let mut all = [&ALL[0]; COUNT];
    let mut place = 1;
    while place < COUNT {
        all[place] = &ALL[place];
        place += 1;
    }
    all
};

/// The effect of this name.
pub fn find(name: &str) -> Option<&'static Effect> {
    ALL.iter().find(|e| e.name == name)
}
