//! Plausibility checks of a fit and of the given weight.

use crate::brace::fit::Fit;
use crate::brace::numbers::{LEAST, MOST, place};
use crate::brace::prior::Prior;
use crate::brace::problem::RESIDUAL_S;
use crate::brace::recording::Weight;
use crate::brace::refusal::Refusal;
use crate::brace::swing::Swing;
use crate::estimate::DEVIATIONS;

/// Largest RMS residual, as a share of the amplitude.
const UNEXPLAINED: f64 = 0.004;

/// Largest deviation of a fitted value from a given one, standard deviations.
const CONTRADICTION: f64 = 3.3;

/// Rejects an impossible weight or torque deviation.
pub(crate) fn given(weight: &Weight, torque_deviation: f64) -> Result<(), Refusal> {
    let checked = [
        ("the weight's moment (N·m)", weight.moment_nm.value),
        (
            "the weight's moment's deviation",
            weight.moment_nm.deviation,
        ),
        ("the weight's inertia (kg·m²)", weight.inertia_kg_m2.value),
        (
            "the weight's inertia's deviation",
            weight.inertia_kg_m2.deviation,
        ),
        ("the torque constant's deviation", torque_deviation),
    ];
    match (checked.into_iter()).find(|(_, value)| !(value.is_finite() && *value > 0.0)) {
        Some((what, value)) => Err(Refusal::Given { what, value }),
        None => Ok(()),
    }
}

/// Returns the largest amplitude of all swings, rad.
pub(crate) fn amplitude_rad(swings: &[Swing], fit: &Fit) -> f64 {
    let of = |swing: &Swing| {
        let hang = fit.hangs_rad.get(swing.recording).copied().unwrap_or(0.0);
        let turns = swing.turns_rad.iter();
        turns.fold(0.0, |most, turn| f64::max(most, (turn - hang).abs()))
    };
    swings.iter().map(of).fold(0.0, f64::max)
}

/// Rejects a motion that the model does not explain.
pub(crate) fn is_explained(swings: &[Swing], fit: &Fit, amplitude: f64) -> Result<(), Refusal> {
    let limit = UNEXPLAINED * amplitude;
    if fit.rms_rad <= limit {
        return Ok(());
    }
    let worst = swings
        .iter()
        .zip(&fit.residuals)
        .flat_map(|(swing, residuals)| {
            let at = |i: usize| swing.begins_s + i as f64 * RESIDUAL_S;
            residuals
                .iter()
                .enumerate()
                .map(move |(i, r)| (at(i), r.abs()))
        });
    let time_s = worst
        .filter(|(_, r)| !r.is_nan())
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .map_or(0.0, |(time_s, _)| time_s);
    Err(Refusal::Misfit {
        rms_deg: fit.rms_rad.to_degrees(),
        swing_deg: amplitude.to_degrees(),
        limit_deg: limit.to_degrees(),
        time_s,
    })
}

/// Rejects parameters at the limits of the model.
pub(crate) fn is_possible(fit: &Fit, prior: &Prior) -> Result<(), Refusal> {
    let checked = [
        (place::FRICTION, "dry friction", "N·m"),
        (place::ROTOR, "rotor inertia", "kg·m²"),
        (place::STIFFNESS, "cuff stiffness", "N·m/rad"),
        (
            place::TORQUE_SCALE,
            "the motor's torque over its current's",
            "1",
        ),
    ];
    for (at, what, unit) in checked {
        let value = fit.numbers[at];
        // What is not visible is as it was before, and never at an end.
        let is_seen = fit.deviation(at) < 0.5 * prior.deviation[at];
        // A gear may have next to no friction, and a weight be fastened without cuffs.
        let can_be_least = at == place::FRICTION;
        let can_be_most = at == place::STIFFNESS;
        let is_at_end =
            (value <= LEAST[at] && !can_be_least) || (value >= MOST[at] && !can_be_most);
        if is_seen && is_at_end {
            return Err(Refusal::Impossible { what, value, unit });
        }
    }
    Ok(())
}

/// Hint for a weight whose mass and inertia contradict each other.
const INERTIA: &str = "; or its inertia is not the one given: only a small weight on a light bar has mass times the lever's square, any \
                       other needs --weight-inertia-kg-m2";

/// Rejects a fit that contradicts the given values.
pub(crate) fn agrees(fit: &Fit, prior: &Prior) -> Result<(), Refusal> {
    let checked = [
        (place::MOMENT, "the weight's moment", "N·m", INERTIA),
        (place::WEIGHT, "the weight's inertia", "kg·m²", INERTIA),
        (
            place::TORQUE_SCALE,
            "the motor's torque over what its current should give",
            "times",
            "; or torque constant, gear ratio or polarity of the motor are not those of the parameters",
        ),
    ];
    for (at, what, unit, also) in checked {
        let (given, deviation) = (prior.mean[at], prior.deviation[at]);
        let found = fit.numbers[at];
        if (found - given).abs() > CONTRADICTION * deviation {
            return Err(Refusal::Contradiction {
                what,
                unit,
                found,
                given,
                error: DEVIATIONS * deviation,
                also,
            });
        }
    }
    Ok(())
}
