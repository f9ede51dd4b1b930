//! The weight that a person has weighed.

use crate::failure::Failure;
use clap::Args;
use crepitus_identify::Estimate;
use crepitus_identify::brace::{GRAVITY, Weight};

/// The weight.
#[derive(Debug, Args)]
pub(super) struct WeightArguments {
    /// Mass of what hangs in the brace, kg, with the bar that holds it.
    #[arg(long, value_name = "KG", requires = "lever_m")]
    weight_kg: Option<f64>,

    /// Distance of its centre of mass from the axis, m.
    #[arg(long, value_name = "M", requires = "weight_kg")]
    lever_m: Option<f64>,

    /// Its inertia about the axis, kg·m², for the step friction [default: mass times the lever's square].
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
        let value = self.kg * GRAVITY * self.lever_m;
        Estimate {
            value,
            half_width: value * self.share,
        }
    }

    /// As the identification of the brace takes it.
    pub(super) fn swinging(&self) -> Weight {
        Weight::new(self.kg, self.lever_m, self.inertia_kg_m2, self.share / 1.96)
    }
}

impl WeightArguments {
    /// Whether there is one.
    pub(super) fn is_given(&self) -> bool {
        self.weight_kg.is_some()
    }

    /// The weight, if there is one.
    pub(super) fn weight(&self) -> Result<Option<Known>, Failure> {
        let given = [
            ("--weight-kg", self.weight_kg),
            ("--lever-m", self.lever_m),
            ("--weight-inertia-kg-m2", self.weight_inertia_kg_m2),
        ];
        for (option, value) in given {
            if let Some(value) = value.filter(|value| !(value.is_finite() && *value > 0.0)) {
                return Err(Failure::Input(format!(
                    "{option}: expected a number above 0, got {value}"
                )));
            }
        }
        let percent = self.weight_tolerance;
        if !(percent > 0.0 && percent <= 50.0) {
            return Err(Failure::Input(format!(
                "--weight-tolerance: expected a number above 0, up to 50 %, got {percent}"
            )));
        }
        let (Some(kg), Some(lever_m)) = (self.weight_kg, self.lever_m) else {
            return Ok(None);
        };
        Ok(Some(Known {
            kg,
            lever_m,
            inertia_kg_m2: self.weight_inertia_kg_m2,
            share: percent / 100.0,
        }))
    }
}
