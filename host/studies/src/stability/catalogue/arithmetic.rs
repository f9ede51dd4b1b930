//! Arithmetic that gives the same numbers on every processor.

use super::motions::{ACCELERATION_JUMPS, DWELL, SLOW, STOP, THROUGH_ZERO, VELOCITY_JUMPS, WANDER};
use super::tools::{CASE, ENCODER, at_tick, constant, encoder, is_frozen, knee, knots, sine};
use crate::stability::case::{Case, located};
use crate::stability::criteria::{events, torque_bits};
use crate::stability::input::{Input, Readings, Shaft};
use crepitus_scene::scene::Precision;
use std::f64::consts::FRAC_PI_4;

/// Parameters J, kr, c, Tk, Ts with an input: the reference cases.
fn reference_cases() -> Vec<([f64; 5], Input)> {
    let paper = [0.01, 400.0, 0.0, 0.2, 0.4];
    let damped = |c| [0.01, 400.0, c, 0.2, 0.4];
    let near_critical = |c| [0.0625, 400.0, c, 0.2, 0.4];
    vec![
        (paper, knots(ACCELERATION_JUMPS, 0.7)),
        (paper, constant(0.05, 1.5)),
        (paper, constant(0.5, 1.0)),
        (paper, constant(3.0, 1.0)),
        ([0.01, 400.0, 0.0, 0.3, 0.3], constant(1.0, 1.0)),
        (damped(0.08), constant(1.0, 10.0)),
        (paper, at_tick(knee(2.0), 1.0)),
        (paper, at_tick(sine(FRAC_PI_4, 2.0), 1.0)),
        (paper, knots(STOP, 2.0)),
        ([1e-8, 400.0, 0.0, 0.2, 0.4], constant(1.0, 0.05)),
        ([1e-9, 400.0, 0.0, 0.2, 0.4], constant(1.0, 0.05)),
        ([1e-5, 4e4, 0.0, 0.2, 0.4], constant(1.0, 0.006)),
        ([0.01, 10.0, 0.0, 0.2, 0.4], constant(1.0, 10.0)),
        (paper, constant(-1.0, 1.0)),
        (damped(6.0), at_tick(sine(0.004, 2.0), 2.0)),
        (near_critical(9.999_999_999), knots(SLOW, 0.7)),
        (near_critical(10.0), knots(SLOW, 0.7)),
        (near_critical(10.000_000_001), knots(SLOW, 0.7)),
        (damped(0.8), at_tick(sine(0.02, 1.0), 3.0)),
        (paper, at_tick(sine(0.0009, 1.0), 3.0)),
        (paper, knots(VELOCITY_JUMPS, 1.0)),
        (paper, at_tick(sine(0.003, 1.0), 3.0)),
        (paper, at_tick(knee(0.25), 4.0)),
        (paper, at_tick(knee(0.5), 4.0)),
        (paper, knots(THROUGH_ZERO, 0.6)),
        (paper, knots(WANDER, 1.05)),
        (paper, knots(DWELL, 1.1)),
        ([0.01, 400.0, 0.0, 0.0, 0.4], constant(1.0, 2.0)),
    ]
}

/// Reference cases that need more than 24 bits.
fn double_only() -> [([f64; 5], Input); 5] {
    let damped = |c| [0.01, 400.0, c, 0.2, 0.4];
    [
        ([0.01, 400.0, 0.0, 0.3, 0.300_03], constant(1.0, 1.0)),
        (damped(0.003_167_616_664_188_220_3), constant(1.0, 1.0)),
        (damped(0.003_167_622_999_427_884), constant(1.0, 1.0)),
        (damped(0.231_316_233_234_191_84), constant(0.1, 1.0)),
        (damped(0.231_316_695_867_120_95), constant(0.1, 1.0)),
    ]
}

/// The cases of this theme.
pub(super) const CASES: &[Case] = &[
    Case {
        id: "H35",
        name: "precisions",
        title: "f32 finds the events that 50 digits find",
        hard: "All reference cases at the device's tick, under every convention: with 24 bits each event must be \
               the same event, in the same order. Two of them are for f64 only: damping at \
               1 ± 1e-6 of critical (H11 has 1 ± 1e-3), and Ts = 1.0001 Tk, whose sticks of 150 ns are the noise \
               of its matches.",
        source: "tests/reference-cases, computed with 50 digits",
        trials: |subject| {
            let mut cases = reference_cases();
            if subject.precision == Precision::F64 {
                cases.extend(double_only());
            }
            // The closed form of `frozen` has no damping.
            cases.retain(|(values, _)| !is_frozen(subject) || values[2] == 0.0);
            cases
                .into_iter()
                .map(|(values, input)| input.meets([events(2e-5)]).with(values))
                .collect()
        },
        ..CASE
    },
    Case {
        id: "H36",
        name: "golden-bits",
        title: "The bits that every target must reproduce",
        hard: "A fused multiply-add, another sine or a reordered sum changes the last bit, and then firmware, \
               software in the loop and host are no longer one program. These hashes of every torque of six runs \
               are the numbers that the firmware must reproduce. It does: the same runs on an emulated STM32F405 \
               (`cargo test -p crepitus-emulator --test ladder golden`) give these hashes, and QEMU executes \
               the same instructions.",
        source: "the hashes are of this model's own torques",
        // One set of bits: that of the firmware.
        of: |s| is_frozen(s) && s.precision == Precision::F32 && located(s),
        trials: |_| {
            let turned = |omega, jitter| {
                let readings = Readings { jitter, ..ENCODER };
                encoder(Shaft::Constant(omega), 1.0, readings)
            };
            [
                (constant(0.5, 1.0), 0x4dde_20ef_eb40_198e),
                (knots(VELOCITY_JUMPS, 1.0), 0xd6cc_ebf6_c6cf_ab94),
                (knots(WANDER, 1.05), 0xaa03_203b_772f_71ce),
                (knots(STOP, 2.0), 0x6301_096b_fa19_691a),
                (turned(1.0, 0.0), 0x04be_8558_9cc4_e3e7),
                (turned(-0.1, 0.1), 0x7751_dc13_3863_2086),
            ]
            .map(|(input, hash)| input.meets([torque_bits(hash)]))
            .into()
        },
        ..CASE
    },
];
