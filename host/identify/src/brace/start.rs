//! Initial guess of the fit, from turning points alone.

use crate::brace::numbers::{NUMBERS, place};
use crate::brace::prior::Prior;
use crate::brace::swing::Swing;
use crepitus_plant::swing::STEP_S;
use std::f64::consts::PI;

/// Estimates the angle at which the weight hangs at rest, by recording, rad. Dry friction shifts
/// the centre of a half swing by F/M to one side, then to the other, so (a + 2b + c)/4 of three
/// turning points is free of it.
pub(crate) fn hangs(swings: &[Swing], recordings: usize) -> Vec<f64> {
    (0..recordings)
        .map(|recording| {
            let of = swings.iter().filter(|s| s.recording == recording);
            let mut centres: Vec<f64> = of
                .flat_map(|swing| {
                    let turns = &swing.turns_rad;
                    let threes = turns.windows(3).map(|w| 0.25 * (w[0] + 2.0 * w[1] + w[2]));
                    let pairs = turns.windows(2).map(|w| f64::midpoint(w[0], w[1]));
                    if turns.len() > 2 {
                        threes.collect::<Vec<_>>()
                    } else {
                        pairs.collect()
                    }
                })
                .collect();
            median(&mut centres).unwrap_or(0.0)
        })
        .collect()
}

/// Estimates friction from the loss of each half swing and the rotor's inertia from its duration;
/// the others are those of the prior.
pub(crate) fn numbers(swings: &[Swing], hangs: &[f64], prior: &Prior) -> [f64; NUMBERS] {
    let mut numbers = prior.mean;
    let moment = numbers[place::MOMENT];
    let (mut frictions, mut inertias) = (Vec::new(), Vec::new());
    for swing in swings {
        let hang = hangs[swing.recording];
        let pairs = swing.turns_rad.windows(2).zip(swing.turn_steps.windows(2));
        for (turns, steps) in pairs {
            let (a, b) = ((turns[0] - hang).abs(), (turns[1] - hang).abs());
            let way = a + b;
            let half_s = (steps[1] - steps[0]) as f64 * STEP_S;
            frictions.push(moment * (b.cos() - a.cos()) / way);
            // A large swing is slower by a²/16.
            let slower = 1.0 + (0.5 * way).powi(2) / 16.0;
            inertias.push(moment * (half_s / (PI * slower)).powi(2));
        }
    }
    if let Some(friction) = median(&mut frictions) {
        numbers[place::FRICTION] = friction.max(0.01);
    }
    if let Some(all) = median(&mut inertias) {
        let rotor = all - numbers[place::WEIGHT] - numbers[place::BRACE];
        // Time in the gap is counted in, too: near what a data sheet says.
        let sheet = prior.mean[place::ROTOR];
        numbers[place::ROTOR] = rotor.clamp(0.3 * sheet, 2.0 * sheet);
    }
    numbers
}

fn median(values: &mut [f64]) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}
