//! Vectors and matrices over the numbers of an impedance.

use crepitus_plant::effects::reaction_mass::impedance::{Impedance, NUMBERS};
use nalgebra::{SMatrix, SVector};

/// Square matrix over the parameters.
pub(crate) type Square = SMatrix<f64, NUMBERS, NUMBERS>;
/// Column vector over the parameters.
pub(crate) type Column = SVector<f64, NUMBERS>;

/// Returns the impedance with a step of its numbers.
pub(crate) fn stepped(impedance: &Impedance, step: &Column) -> Impedance {
    let mut numbers = <[f64; NUMBERS]>::from(*impedance);
    for (number, step) in numbers.iter_mut().zip(step.iter()) {
        *number += step;
    }
    numbers.into()
}
