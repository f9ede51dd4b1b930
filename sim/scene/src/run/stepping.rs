//! A run in fixed steps: true motion → sensor → joint.

use super::accounting::StepAccounting;
use super::held_back::{Beyond, TankTotals};
use super::reached::note_speed;
use super::sensor::{Encoded, Ideal, Sensor};
use super::watch::{Ended, Watch};
use super::{Diverged, RunError, Totals, steps};
use crate::any_joint::{AnyJoint, Precise};
use crate::scene::Scene;
use crate::walk::{Part, Walk};
use crepitus_model::joint::StepCoefficients;
use crepitus_model::solver::Solver;
use crepitus_model::{Real, Settings, StickSlip, Validated};

/// Number of steps between two reports of progress.
pub(super) const PROGRESS_STEPS: u64 = 1 << 16;

/// Number of steps between two checks of the state.
pub(super) const CHECK_STEPS: u64 = 1 << 10;

/// The next step after `n` with more to do than a step: a row every so many, a check of the
/// state, progress, or the end. A loop asks for that alone.
pub(super) fn next_stop(n: u64, steps: u64, every: Option<u64>) -> u64 {
    let after = |every: u64| (n / every + 1) * every;
    after(CHECK_STEPS)
        .min(every.map_or(steps, after))
        .min(steps)
}

/// Chooses the types that the scene calls for, and runs.
pub(super) fn simulate<F: Precise>(
    scene: &Scene,
    solver: Solver,
    step_s: f64,
    watch: &mut dyn Watch,
) -> Result<Totals, Ended> {
    match &scene.encoder {
        None => with_sensor::<F, _>(scene, solver, step_s, watch, Ideal),
        Some(encoder) => {
            let sensor = Encoded::new(encoder, step_s, &scene.start())?;
            with_sensor::<F, _>(scene, solver, step_s, watch, sensor)
        }
    }
}

fn with_sensor<F: Precise, S: Sensor<F>>(
    scene: &Scene,
    solver: Solver,
    step_s: f64,
    watch: &mut dyn Watch,
    sensor: S,
) -> Result<Totals, Ended> {
    let Some(crepitus) = &scene.crepitus else {
        return bare(scene, watch, sensor);
    };
    let omega = F::from_f64(scene.start().omega_rad_s);
    let joint = AnyJoint::new(&crepitus.settings, solver, step_s, omega)?;
    step_joint(scene, watch, &crepitus.settings, sensor, joint)
}

/// A scene without a joint: the motion, and perhaps its sensor.
fn bare<F: Real, S: Sensor<F>>(
    scene: &Scene,
    watch: &mut dyn Watch,
    mut sensor: S,
) -> Result<Totals, Ended> {
    let (steps, every) = steps(scene);
    let every = watch.wants_rows().then_some(every);
    let mut walk = Walk::new(&scene.motion, scene.step_s());
    let mut row = Vec::new();
    let mut fastest_rad_s = walk.now().omega_rad_s.abs();
    let mut stop = 0;
    loop {
        let n = walk.steps();
        if n == stop {
            if every.is_some_and(|every| n.is_multiple_of(every)) {
                row.clear();
                row.extend([walk.time_s(), walk.now().angle_rad, walk.now().omega_rad_s]);
                sensor.write(&mut row);
                watch.row(&row)?;
            }
            if n.is_multiple_of(PROGRESS_STEPS) {
                watch.progress(walk.time_s())?;
            }
            if n == steps {
                break;
            }
            stop = next_stop(n, steps, every);
        }
        let (from, to) = walk.step();
        note_speed(&mut fastest_rad_s, to.omega_rad_s);
        std::hint::black_box(sensor.see(&from, &to));
    }
    Ok(Totals {
        steps,
        end_s: walk.time_s(),
        tally: None,
        fastest_rad_s,
        crowded_steps: 0,
        tank: TankTotals::default(),
        beyond: Beyond::new(),
        plant: None,
    })
}

/// A scene with a joint.
fn step_joint<F: Real, S: Sensor<F>>(
    scene: &Scene,
    watch: &mut dyn Watch,
    settings: &Validated<Settings>,
    mut sensor: S,
    mut joint: AnyJoint<F>,
) -> Result<Totals, Ended> {
    let (steps, every) = steps(scene);
    let every = watch.wants_rows().then_some(every);
    let step_s = scene.step_s();
    let mut walk = Walk::new(&scene.motion, step_s).in_parts::<F>();
    let mut accounting = StepAccounting::new::<F>(settings, step_s, walk.now().omega_rad_s);
    let mut beyond = Beyond::new();
    let mut row = Vec::new();
    let mut fastest_rad_s = walk.now().omega_rad_s.abs();
    let mut stop = 0;
    accounting.tally.shown(joint.torque_nm().to_f64());
    loop {
        let n = walk.steps();
        if n == stop {
            let is_row = every.is_some_and(|every| n.is_multiple_of(every));
            // Before its row: a trace holds numbers.
            if (is_row || n.is_multiple_of(CHECK_STEPS) || n == steps)
                && !(joint.theta_rad().is_finite() && joint.theta_dot_rad_s().is_finite())
            {
                return Err(RunError::Diverged(Diverged::Object {
                    solver: scene.solver.name(),
                    by_s: walk.time_s(),
                    radians_per_step: settings.parameters.natural_rad_s() * step_s,
                }));
            }
            if is_row {
                row.clear();
                row.extend([
                    walk.time_s(),
                    walk.now().angle_rad,
                    walk.now().omega_rad_s,
                    f64::from(joint.phase().sign()),
                    joint.theta_rad().to_f64(),
                    joint.theta_dot_rad_s().to_f64(),
                    joint.torque_nm().to_f64(),
                ]);
                sensor.write(&mut row);
                watch.row(&row)?;
            }
            if n.is_multiple_of(PROGRESS_STEPS) {
                watch.progress(walk.time_s())?;
            }
            if n == steps {
                break;
            }
            stop = next_stop(n, steps, every);
        }
        let start_s = walk.time_s();
        let whole = if S::SPLITS {
            walk.step_or_parts()
        } else {
            Some(walk.step())
        };
        let Some((from, to)) = whole else {
            for part in walk.parts() {
                note_speed(&mut fastest_rad_s, part.to.omega_rad_s);
            }
            let parts = (start_s, walk.parts());
            step_in_parts(
                parts,
                settings,
                &mut sensor,
                &mut joint,
                &mut accounting,
                watch,
            )?;
            continue;
        };
        note_speed(&mut fastest_rad_s, to.omega_rad_s);
        let seen = sensor.see(&from, &to);
        let mut result = Ok(());
        joint.step(&seen, |event| {
            let record = accounting.event(start_s, &seen, &event);
            if result.is_ok() {
                result = watch.event(&record);
            }
        });
        result?;
        accounting.end_step(&seen, &joint);
        beyond.note(joint.torque_nm().to_f64(), (walk.time_s(), step_s));
    }
    accounting.finish(walk.time_s(), &joint);
    Ok(Totals {
        steps,
        end_s: walk.time_s(),
        tally: Some(accounting.tally),
        fastest_rad_s,
        crowded_steps: accounting.crowded_steps,
        tank: TankTotals::default(),
        beyond,
        plant: None,
    })
}

/// One step of a joint, in the parts that the motion breaks it into; its coefficients are of a
/// length, so each part has its own.
#[cold]
fn step_in_parts<F: Real, S: Sensor<F>>(
    (start_s, parts): (f64, &[Part]),
    settings: &Validated<Settings>,
    sensor: &mut S,
    joint: &mut AnyJoint<F>,
    accounting: &mut StepAccounting,
    watch: &mut dyn Watch,
) -> Result<(), Ended> {
    let whole = *joint.coefficients();
    let mut time_s = start_s;
    for (left, part) in (0..parts.len()).rev().zip(parts) {
        joint.change_step(StepCoefficients::new(settings, part.length_s)?);
        let seen = sensor.see(&part.from, &part.to);
        let step_s = std::mem::replace(&mut accounting.step_s, part.length_s);
        let mut result = Ok(());
        joint.step(&seen, |event| {
            let record = accounting.event(time_s, &seen, &event);
            if result.is_ok() {
                result = watch.event(&record);
            }
        });
        result?;
        if left > 0 {
            let stick = || (joint.torque_nm(), joint.theta_rad());
            accounting.end_part(&seen, joint.phase(), stick);
        } else {
            accounting.end_step(&seen, joint);
        }
        accounting.step_s = step_s;
        time_s += part.length_s;
    }
    joint.change_step(whole);
    Ok(())
}
