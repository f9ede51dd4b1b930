//! A plant from the effects that a scene lists.
//!
//! Everything is decided here, once: an effect that is not listed has no part.

use crate::actuator::{Actuator, Commanded, Ideal};
use crate::boundary::{Boundary, Prescribed, Released};
use crate::chain::{Chain, Shaft};
use crate::effect::{Context, Effect, Given, Part};
use crate::plant::Plant;
use crepitus_model::SettingsError;

/// An effect as a scene lists it.
#[derive(Clone, Debug)]
pub struct Listed {
    /// Which one.
    pub effect: &'static Effect,
    /// Its numbers and choices.
    pub given: Given,
}

/// Assembles `listed`, which stand in the order of
/// [`EFFECTS`](crate::effects::EFFECTS). Nobody holds a leg that is
/// `released`.
///
/// # Errors
/// [`SettingsError`] if a number of the motor is out of its range.
pub fn assemble(
    listed: &[Listed],
    context: &Context,
    released: bool,
) -> Result<Plant, SettingsError> {
    let mut actuator: Box<dyn Commanded> = Box::new(Ideal::default());
    for Listed { effect, given } in listed {
        if let Part::Actuator(make) = effect.part {
            actuator = make(given, context)?;
        }
    }
    Ok(assemble_with(listed, context, released, actuator))
}

/// The plant of `listed` with an actuator of its owner's: of the effects, those
/// of the mechanics, without those of the device.
pub fn assemble_with<A: Actuator>(
    listed: &[Listed],
    context: &Context,
    released: bool,
    actuator: A,
) -> Plant<A> {
    let mut chain: Box<dyn Chain> = Box::new(Shaft);
    let mut boundary: Box<dyn Boundary> = if released {
        Box::new(Released)
    } else {
        Box::new(Prescribed::new(context.start))
    };
    for Listed { effect, given } in listed {
        match effect.part {
            Part::Link(make) => chain = make(given, context, chain),
            Part::Boundary(make) => boundary = make(given, context, chain.as_ref()),
            Part::Joint | Part::Sensor | Part::Stage(..) | Part::Actuator(_) => {}
        }
    }
    Plant::new(actuator, chain, boundary, context.start)
}
