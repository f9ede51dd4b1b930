//! Inputs as in the device.

use crepitus_ladder::exchange::{Input, Kind};
use crepitus_ladder::{Plan, Subject};
use crepitus_model::control::encoder::EncoderSettings;
use crepitus_model::solver::locate::ExactEvents;
use crepitus_model::{
    Frozen, Parameters, Settings, SettingsError, ShaftStep, StepCoefficients, StickSlip,
};
use crepitus_plant::encoder::Encoder;

/// Torque at the joint for a current of the motor, N·m/A.
const NM_PER_A: f32 = 3.33;

/// Inputs of a subject while the shaft moves.
pub(super) fn usual(plan: &Plan, motion: &[ShaftStep<f32>]) -> Result<Vec<Input>, SettingsError> {
    Ok(match plan.subject {
        Subject::Rung(..) | Subject::Checked(_) | Subject::Renderer | Subject::Law(_) => {
            motion.iter().map(taken).collect()
        }
        Subject::Encoder => counts(motion),
        Subject::Effect(..) => rendered(plan, motion)?
            .iter()
            .zip(motion)
            .map(|((_, jump_nm), step)| input([step.delta_phi_rad, step.omega_end_rad_s, *jump_nm]))
            .collect(),
        Subject::CurrentLoop => {
            let mut measured_a = 0.0;
            let wanted = |(torque_nm, _): &(f32, f32)| {
                let wanted_a = torque_nm / NM_PER_A;
                input([wanted_a, std::mem::replace(&mut measured_a, wanted_a), 0.0])
            };
            rendered(plan, motion)?.iter().map(wanted).collect()
        }
    })
}

/// Inputs with missing samples, one to six at a time, and some refused ones.
/// The next sample has the travel of the missing ones.
pub(super) fn gaps(motion: &[ShaftStep<f32>]) -> Vec<Input> {
    /// Steps from one gap to the next, so that gaps occur in all phases.
    const EVERY: usize = 23;
    let mut travel = 0.0;
    let mut inputs = Vec::new();
    for (n, step) in motion.iter().enumerate() {
        let (gap, place) = (n / EVERY, n % EVERY);
        travel += step.delta_phi_rad;
        inputs.push(if place > gap % 6 {
            taken(&ShaftStep {
                delta_phi_rad: std::mem::take(&mut travel),
                ..*step
            })
        } else if gap.is_multiple_of(5) {
            input([f32::NAN, step.omega_end_rad_s, 0.0])
        } else {
            Input {
                kind: Kind::Lost,
                ..Input::default()
            }
        });
    }
    inputs
}

/// Inputs while the parameters change and change back.
pub(super) fn commits(plan: &Plan, motion: &[ShaftStep<f32>]) -> (Plan, Vec<Input>) {
    /// Longer than a ramp: 2.5 ms at 100 N·m/s.
    const EVERY: usize = 61;
    let [first, _] = plan.parameters;
    let second = Parameters {
        inertia_kg_m2: 1.5 * first.inertia_kg_m2,
        stiffness_nm_per_rad: 0.8 * first.stiffness_nm_per_rad,
        kinetic_torque_nm: 1.5 * first.kinetic_torque_nm,
        static_torque_nm: 1.6 * first.static_torque_nm,
        ..first
    };
    let plan = Plan {
        parameters: [first, second],
        ..*plan
    };
    let commit = |(n, step): (usize, &ShaftStep<f32>)| Input {
        kind: if n.is_multiple_of(EVERY) {
            Kind::Commit
        } else {
            Kind::Taken
        },
        ..taken(step)
    };
    (plan, motion.iter().enumerate().map(commit).collect())
}

/// Each pair of numbers at and beyond the limits.
pub(super) fn extremes() -> Vec<Input> {
    let mut numbers = vec![0.0, 1e-40, 1e-20, 1e-3, 0.05, 0.6, 1.37, 24.0, 1e20, 3e38];
    numbers.push(f32::INFINITY);
    numbers.extend(numbers.clone().iter().map(|number| -number));
    numbers.push(f32::NAN);
    let pairs = numbers
        .iter()
        .flat_map(|a| numbers.iter().map(move |b| input([*a, *b, *b])));
    pairs.collect()
}

pub(super) fn taken(step: &ShaftStep<f32>) -> Input {
    let numbers = [
        step.delta_phi_rad,
        step.omega_start_rad_s,
        step.omega_end_rad_s,
    ];
    Input {
        words: numbers.map(f32::to_bits),
        kind: Kind::Taken,
    }
}

fn input(numbers: [f32; 3]) -> Input {
    Input {
        words: numbers.map(f32::to_bits),
        kind: Kind::Taken,
    }
}

/// Counts of the encoder.
fn counts(motion: &[ShaftStep<f32>]) -> Vec<Input> {
    let encoder = Encoder::new(&EncoderSettings::default());
    let mut phi_rad = 0.0;
    let count = |step: &ShaftStep<f32>| {
        phi_rad += f64::from(step.delta_phi_rad);
        Input {
            words: [encoder.count(phi_rad).cast_unsigned(), 0, 0],
            kind: Kind::Taken,
        }
    };
    motion.iter().map(count).collect()
}

/// Torque and its jumps in each step, N·m, as the device renders them.
fn rendered(plan: &Plan, motion: &[ShaftStep<f32>]) -> Result<Vec<(f32, f32)>, SettingsError> {
    let [parameters, _] = plan.parameters;
    let settings = Settings {
        // `frozen` has no damping.
        parameters: Parameters {
            damping_nms_per_rad: 0.0,
            ..parameters
        },
        restart: plan.restart,
        ..Settings::default()
    };
    let coefficients = StepCoefficients::new(&settings.validate()?, plan.step_s)?;
    let mut joint = Frozen::<f32, ExactEvents>::new(coefficients, plan.omega_rad_s);
    let torque = |step| {
        let mut jump_nm = 0.0;
        joint.step(step, |event| {
            jump_nm += event.torque_after_nm - event.torque_before_nm;
        });
        (joint.torque_nm(), jump_nm)
    };
    Ok(motion.iter().map(torque).collect())
}
