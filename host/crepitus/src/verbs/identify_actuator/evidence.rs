//! Evidence of the moving mass: a balance, or a mass that was added.

use crate::failure::Failure;
use clap::Args;
use crepitus_identify::actuator::{MassEvidence, Series, Weighed};

/// Masses as they were weighed.
#[derive(Debug, Args)]
pub(super) struct Masses {
    /// Moving mass as weighed, g: with a third of the flexure.
    #[arg(
        long,
        value_name = "G",
        required_unless_present = "added_mass_g",
        allow_negative_numbers = true
    )]
    moving_mass_g: Option<f64>,

    /// Mass that was fastened to it for the second chirp, g.
    #[arg(long, value_name = "G", allow_negative_numbers = true)]
    added_mass_g: Option<f64>,

    /// Uncertainty of the masses, ±%.
    #[arg(
        long,
        value_name = "%",
        default_value_t = 1.0,
        allow_negative_numbers = true
    )]
    mass_tolerance: f64,
}

/// The same, checked.
#[derive(Clone, Copy, Debug)]
pub(super) struct WeighedMasses {
    /// Moving mass, if it was weighed: then it is no result.
    pub(super) moving: Option<Weighed>,
    /// Mass that is added for a second chirp.
    pub(super) added: Option<Weighed>,
}

impl Masses {
    /// Checks the ranges.
    pub(super) fn weighed(&self) -> Result<WeighedMasses, Failure> {
        if !(0.0..=20.0).contains(&self.mass_tolerance) {
            return Err(Failure::Input(format!(
                "--mass-tolerance: expected 0 to 20 %, got {}",
                self.mass_tolerance
            )));
        }
        let weighed = |name: &str, mass_g: Option<f64>| match mass_g {
            None => Ok(None),
            Some(mass_g) if mass_g > 0.0 && mass_g <= 1000.0 => Ok(Some(Weighed {
                mass_kg: 1e-3 * mass_g,
                share: 1e-2 * self.mass_tolerance,
            })),
            Some(mass_g) => Err(Failure::Input(format!(
                "--{name}: expected a mass above 0 g, up to 1000 g, got {mass_g}"
            ))),
        };
        Ok(WeighedMasses {
            moving: weighed("moving-mass-g", self.moving_mass_g)?,
            added: weighed("added-mass-g", self.added_mass_g)?,
        })
    }
}

impl WeighedMasses {
    /// The evidence, with the second recording where there is one.
    pub(super) fn evidence<'s>(
        &self,
        with_added: Option<&'s Series>,
    ) -> Result<MassEvidence<'s>, Failure> {
        match (self.moving, self.added.zip(with_added)) {
            (Some(moving), None) => Ok(MassEvidence::Weighed(moving)),
            (None, Some((added, series))) => Ok(MassEvidence::Added(series, added)),
            (Some(moving), Some((added, series))) => {
                Ok(MassEvidence::Both(moving, series, added))
            }
            (None, None) => Err(Failure::Input(
                "the mass is not known: expected --moving-mass-g, or --added-mass-g with a second chirp".to_owned(),
            )),
        }
    }
}
