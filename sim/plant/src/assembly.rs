//! A plant from the effects that a scene lists.
//!
//! Everything is decided here, once: an effect that is not listed has no part. Where the list
//! leaves a shaft that moves as prescribed, [`compose`] makes the plant of types that are
//! known, and the compiler leaves of its step what those parts do.

use crate::actuator::{Actuator, Commanded, Ideal};
use crate::boundary::{Boundary, Prescribed, Released};
use crate::chain::{Chain, Shaft};
use crate::effect::{Context, Effect, Given, Mounted, Part};
use crate::effects::drivetrain::{self, Drivetrain};
use crate::effects::{cuff, limb, reaction_mass, shell};
use crate::mechanics::Driven;
use crate::plant::Plant;
use crate::rigid_shaft::RigidShaft;
use crepitus_model::SettingsError;

/// An effect as a scene lists it.
#[derive(Clone, Debug)]
pub struct Listed {
    /// The effect.
    pub effect: &'static Effect,
    /// Numbers and choices of the effect.
    pub given: Given,
}

/// Assembles `listed`, which stand in the order of
/// [`EFFECTS`](crate::effects::EFFECTS). Nobody holds a leg that is
/// `released`.
///
/// # Errors
/// [`SettingsError`] if a number of the motor is out of its range, or a coil that cannot
/// be.
pub fn assemble(
    listed: &[Listed],
    context: &Context,
    released: bool,
) -> Result<Plant, SettingsError> {
    let actuator = actuator(listed, context)?.unwrap_or_else(ideal);
    Ok(assemble_with(listed, context, released, actuator))
}

/// The actuator of `listed`, if there is one; checks that on the shell, too.
fn actuator(
    listed: &[Listed],
    context: &Context,
) -> Result<Option<Box<dyn Commanded>>, SettingsError> {
    let mut actuator = None;
    for Listed { effect, given } in listed {
        if let Part::Actuator(make) = effect.part {
            actuator = Some(make(given, context)?);
        }
        if effect.name == reaction_mass::EFFECT.name {
            reaction_mass::check(given)?;
        }
    }
    Ok(actuator)
}

/// Runs code with a plant whose types are known.
pub trait PlantVisitor {
    /// Result of `visit`.
    type Output;

    /// The plant that was asked for.
    fn visit<M: Driven>(self, plant: M) -> Self::Output;

    /// The plant that was asked for, where that is a shaft alone.
    fn visit_rigid(self, plant: RigidShaft<Ideal>) -> Self::Output
    where
        Self: Sized,
    {
        self.visit(plant)
    }
}

/// Runs `visitor` with the plant that [`assemble`] makes of `listed`: in boxes only where a body
/// can move otherwise than the motion prescribes. Both make the same steps, to the bit.
///
/// # Errors
/// As [`assemble`].
pub fn compose<V: PlantVisitor>(
    listed: &[Listed],
    context: &Context,
    released: bool,
    visitor: V,
) -> Result<V::Output, SettingsError> {
    let is_of_mechanics = |l: &&Listed| {
        let part = l.effect.part;
        matches!(
            part,
            Part::Link(_) | Part::Shell(_) | Part::Mount(..) | Part::Boundary(_)
        )
    };
    let mut mechanics = listed.iter().filter(is_of_mechanics);
    let (first, more) = (mechanics.next(), mechanics.next());
    let start = context.start;
    Ok(match (first, more) {
        (None, None) if !released => match actuator(listed, context)? {
            None => visitor.visit_rigid(RigidShaft::new(Ideal::default(), start)),
            Some(actuator) => visitor.visit(RigidShaft::new(actuator, start)),
        },
        (Some(only), None) if !released && only.effect.name == drivetrain::EFFECT.name => {
            let chain = Drivetrain::new(&only.given, Shaft);
            let actuator = actuator(listed, context)?.unwrap_or_else(ideal);
            visitor.visit(Plant::new(actuator, chain, Prescribed::new(start), start))
        }
        _ => visitor.visit(assemble(listed, context, released)?),
    })
}

fn ideal() -> Box<dyn Commanded> {
    Box::new(Ideal::default())
}

/// The plant of `listed` with an actuator of its owner's: of the effects, those
/// of the mechanics, without those of the device.
pub fn assemble_with<A: Actuator>(
    listed: &[Listed],
    context: &Context,
    released: bool,
    actuator: A,
) -> Plant<A> {
    let gravity_rad = listed
        .iter()
        .find(|l| l.effect.name == limb::EFFECT.name)
        .map(|l| limb::gravity_rad(&l.given));
    let context = &Context {
        gravity_rad,
        ..*context
    };
    let mounts = |place: Mounted, chain: Box<dyn Chain>| {
        listed.iter().fold(chain, |chain, l| match l.effect.part {
            Part::Mount(of, make) if of(&l.given) == place => make(&l.given, context, chain),
            _ => chain,
        })
    };
    let has = |name: &str| listed.iter().any(|l| l.effect.name == name);
    let mut chain: Box<dyn Chain> = Box::new(Shaft);
    for Listed { effect, given } in listed {
        match effect.part {
            Part::Link(make) => {
                if effect.name == cuff::EFFECT.name {
                    chain = mounts(Mounted::Brace, chain);
                }
                chain = make(given, context, chain);
            }
            Part::Shell(make) => {
                let mount = |shell| mounts(Mounted::Shell, shell);
                chain = make(given, context, chain, &mount);
            }
            Part::Mount(of, make) => {
                // Where nothing else carries it, the right end does.
                let carrier = match of(given) {
                    Mounted::Shell => shell::EFFECT.name,
                    Mounted::Brace => cuff::EFFECT.name,
                };
                if !has(carrier) {
                    chain = make(given, context, chain);
                }
            }
            Part::Joint
            | Part::Sensor
            | Part::Stage(..)
            | Part::Actuator(_)
            | Part::Boundary(_) => {}
        }
    }
    let boundary = boundary(listed, context, released, chain.as_ref());
    Plant::new(actuator, chain, boundary, context.start)
}

/// The boundary of `listed`, for a chain whose right end is at the start of the motion: a hand, or the motion itself;
/// nobody, where the leg is `released`.
pub fn boundary(
    listed: &[Listed],
    context: &Context,
    released: bool,
    chain: &dyn Chain,
) -> Box<dyn Boundary> {
    for Listed { effect, given } in listed {
        if let Part::Boundary(make) = effect.part {
            return make(given, context, chain);
        }
    }
    if released {
        Box::new(Released)
    } else {
        Box::new(Prescribed::new(context.start))
    }
}
