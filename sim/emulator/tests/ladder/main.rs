//! The solver ladder on the target: the host's bits, QEMU's instructions, and
//! cycles within their budgets.

mod bits;
mod budgets;
mod instructions;
mod qemu;

use crepitus_emulator::firmware::{Program, image_for_test};
use crepitus_emulator::ladder::Ladder;
use crepitus_ladder::exchange::{Input, Kind};
use crepitus_model::ShaftStep;

/// A core with the program; none, and a line about it, without the target.
fn ladder() -> Option<Ladder> {
    image_for_test(Program::Ladder).map(|image| Ladder::new(&image))
}

fn taken(step: &ShaftStep<f32>) -> Input {
    let words = [
        step.delta_phi_rad,
        step.omega_start_rad_s,
        step.omega_end_rad_s,
    ];
    Input {
        words: words.map(f32::to_bits),
        kind: Kind::Taken,
    }
}
