//! The weight that a person has weighed.

use crate::cli::{above_zero, tolerance};
use crate::failure::Failure;
use clap::Args;
use crepitus_identify::brace::Weight;
use crepitus_identify::{DEVIATIONS, Estimate};
use crepitus_plant::effects::limb::STANDARD_GRAVITY;

/// The weight.
#[derive(Debug, Args)]
pub(super) struct WeightArguments {
    /// Mass of what hangs in the brace, kg, with the bar that holds it.
    #[arg(long, value_name = "KG", requires = "lever_m")]
    weight_kg: Option<f64>,

    /// Distance of its centre of mass from the axis, m.
    #[arg(long, value_name = "M", requires = "weight_kg")]
    lever_m: Option<f64>,

    /// Inertia about the axis, kg·m², for the step friction [default: mass times the lever's square].
    #[arg(long, value_name = "KG_M2", requires = "weight_kg")]
    weight_inertia_kg_m2: Option<f64>,

    /// 95 % interval of mass times lever, ± %.
    #[arg(long, value_name = "PERCENT", default_value_t = 1.0)]
    weight_tolerance: f64,
}

/// A known weight.
#[derive(Clone, Copy, Debug)]
pub(super) struct Known {
    kg: f64,
    lever_m: f64,
    inertia_kg_m2: Option<f64>,
    share: f64,
}

impl Known {
    /// A mass at a lever, with the share by which their product may be off.
    #[cfg(test)]
    pub(super) const fn new(kg: f64, lever_m: f64, share: f64) -> Self {
        Self {
            kg,
            lever_m,
            inertia_kg_m2: None,
            share,
        }
    }

    /// Torque about the axis when it is horizontal, N·m.
    pub(super) fn moment_nm(&self) -> Estimate {
        let value = self.kg * STANDARD_GRAVITY * self.lever_m;
        Estimate {
            value,
            half_width: value * self.share,
        }
    }

    /// The weight as the identification of the brace takes it.
    pub(super) fn swinging(&self) -> Weight {
        let deviation = self.share / DEVIATIONS;
        Weight::new(self.kg, self.lever_m, self.inertia_kg_m2, deviation)
    }
}

impl WeightArguments {
    /// Returns whether there is one.
    pub(super) fn is_given(&self) -> bool {
        self.weight_kg.is_some()
    }

    /// The weight, if there is one.
    pub(super) fn weight(&self) -> Result<Option<Known>, Failure> {
        let positive =
            |option, value: Option<f64>| value.map(|value| above_zero(option, value)).transpose();
        let kg = positive("--weight-kg", self.weight_kg)?;
        let lever_m = positive("--lever-m", self.lever_m)?;
        let inertia_kg_m2 = positive("--weight-inertia-kg-m2", self.weight_inertia_kg_m2)?;
        let share = tolerance("--weight-tolerance", self.weight_tolerance)?;
        Ok(kg.zip(lever_m).map(|(kg, lever_m)| Known {
            kg,
            lever_m,
            inertia_kg_m2,
            share,
        }))
    }
}
