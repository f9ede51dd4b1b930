//! A run in fixed steps: true motion → sensor → joint.

use super::held_back::{Beyond, TankTotals};
use super::lead::Lead;
use super::reached::note_speed;
use super::sensor::{Encoded, Ideal, Sensor};
use super::tally::{Gap, ObjectState, StickEnd, Tally};
use super::watch::{Ended, Watch};
use super::{Diverged, RunError, Totals, steps};
use crate::any_joint::{AnyJoint, Precise};
use crate::scene::Scene;
use crate::trace::EventRecord;
use crate::walk::{Part, Walk};
use crepitus_model::joint::StepCoefficients;
use crepitus_model::solver::Solver;
use crepitus_model::{
    EVENTS_PER_STEP, Event, Phase, Real, Settings, ShaftStep, StickSlip, Validated,
};

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
            accounting.end_part(&seen, joint);
        } else {
            accounting.end_step(&seen, joint);
        }
        accounting.step_s = step_s;
        time_s += part.length_s;
    }
    joint.change_step(whole);
    Ok(())
}

/// Keeps the tally of a stepping run: where in the step it is, and what the
/// joint has seen of the shaft.
pub(super) struct StepAccounting {
    pub(super) tally: Tally,
    /// Length of the step, or of the part of one that is being accounted for, s.
    pub(super) step_s: f64,
    /// Angle of the shaft as the joint has seen it, at the start of the step.
    pub(super) phi_rad: f64,
    /// The last point of the step that is booked, as a fraction of it.
    booked: f64,
    stick: StickEnd,
    /// Events of the present step.
    in_step: usize,
    /// Steps with as many events as a step may have: more may have followed.
    pub(super) crowded_steps: u64,
    /// While the device refuses samples.
    gap: Option<Gap>,
    /// Gaps after which the joint began again.
    restarts: u32,
}

impl StepAccounting {
    /// Accounting of a joint in precision `F`.
    pub(super) fn new<F: Real>(
        settings: &Validated<Settings>,
        step_s: f64,
        omega_rad_s: f64,
    ) -> Self {
        let lead = Lead::new(settings, step_s, F::IS_SINGLE);
        let touches = StepCoefficients::<F>::new(settings, step_s).is_ok_and(|c| c.touches());
        Self {
            tally: Tally::new(**settings, omega_rad_s, lead, touches),
            step_s,
            phi_rad: 0.0,
            booked: 0.0,
            stick: StickEnd {
                theta_rad: 0.0,
                omega_rad_s,
                omega_dot: 0.0,
            },
            in_step: 0,
            crowded_steps: 0,
            gap: None,
            restarts: 0,
        }
    }

    /// Accounts for the events of a step in the order of time.
    pub(super) fn event<F: Real>(
        &mut self,
        start_s: f64,
        seen: &ShaftStep<F>,
        event: &Event<F>,
    ) -> EventRecord {
        let event = event.to_f64();
        let time_s = start_s + event.fraction * self.step_s;
        if event.from == Phase::Stick {
            self.book_stick(seen, event.fraction, event.theta_rad);
        }
        let travel = travel(seen, event.fraction, self.step_s);
        self.tally.event(time_s, self.phi_rad + travel, &event);
        self.in_step += 1;
        self.booked = event.fraction;
        self.stick = self.stick_end(seen, event.fraction, event.theta_rad);
        EventRecord::new(time_s, &event)
    }

    /// Accounts for the rest of a step.
    #[inline(always)]
    #[expect(
        clippy::inline_always,
        reason = "a call of the loop, whose arguments and results would pass through memory"
    )]
    pub(super) fn end_step<F: Real, J: StickSlip<F>>(&mut self, seen: &ShaftStep<F>, joint: &J) {
        match joint.phase() {
            Phase::Stick => self.end_stick(seen, joint),
            Phase::Slip(_) => {
                if self.tally.lead.is_due() {
                    let (omega, v) = (seen.omega_end_rad_s, joint.theta_dot_rad_s());
                    let sign = f64::from(joint.phase().sign());
                    self.tally.lead.look(sign, omega.to_f64(), v.to_f64());
                }
            }
        }
        self.close(seen);
    }

    /// Accounts for the rest of a part of a step that is not its last: looks at a slip are a
    /// number of steps apart.
    #[cold]
    pub(super) fn end_part<F: Real, J: StickSlip<F>>(&mut self, seen: &ShaftStep<F>, joint: &J) {
        if joint.phase() == Phase::Stick {
            self.end_stick(seen, joint);
        }
        self.close(seen);
    }

    #[inline]
    fn end_stick<F: Real, J: StickSlip<F>>(&mut self, seen: &ShaftStep<F>, joint: &J) {
        self.tally.shown(joint.torque_nm().to_f64());
        self.book_stick(seen, 1.0, joint.theta_rad().to_f64());
    }

    #[inline]
    fn close<F: Real>(&mut self, seen: &ShaftStep<F>) {
        if self.in_step > 0 {
            self.crowded_steps += u64::from(self.in_step >= EVENTS_PER_STEP);
            self.in_step = 0;
            self.booked = 0.0;
        }
        self.phi_rad += seen.delta_phi_rad.to_f64();
    }

    /// Accounts for a step whose sample the device refused: its joint never learns of this travel
    /// and stands still; what it showed last is held or released.
    #[cold]
    pub(super) fn hold<F: Real, J: StickSlip<F>>(
        &mut self,
        seen: &ShaftStep<F>,
        start_s: f64,
        joint: &J,
        held_nm: f64,
    ) {
        let delta_phi = seen.delta_phi_rad.to_f64();
        let (step_s, phi_rad) = (self.step_s, self.phi_rad);
        let begin = || Gap::new(object_state(start_s, phi_rad, joint));
        let gap = self.gap.get_or_insert_with(begin);
        gap.hold(held_nm, step_s, delta_phi);
        self.tally.shown(held_nm);
    }

    /// Accounts for a step whose sample a device took; `restarts` counts the gaps so far after
    /// which its joint began again.
    #[inline]
    pub(super) fn end_tick<F: Real, J: StickSlip<F>>(
        &mut self,
        seen: &ShaftStep<F>,
        start_s: f64,
        joint: &J,
        restarts: u32,
    ) {
        if restarts == self.restarts {
            self.end_step(seen, joint);
            if self.gap.is_some() {
                self.close_gap();
            }
            return;
        }
        self.restart(seen, start_s, joint, restarts);
    }

    /// Ends a gap after which the joint went on.
    #[cold]
    fn close_gap(&mut self) {
        if let Some(gap) = self.gap.take() {
            self.tally.caught_up(&gap);
        }
    }

    /// Accounts for a step in which the joint began again.
    #[cold]
    fn restart<F: Real, J: StickSlip<F>>(
        &mut self,
        seen: &ShaftStep<F>,
        start_s: f64,
        joint: &J,
        restarts: u32,
    ) {
        let gap = self.gap.take();
        self.restarts = restarts;
        self.phi_rad += seen.delta_phi_rad.to_f64();
        let now = object_state(start_s + self.step_s, self.phi_rad, joint);
        self.stick = self.stick_end(seen, 1.0, now.theta_rad);
        self.tally.constant(joint.torque_nm().to_f64(), self.step_s);
        if let Some(gap) = gap {
            self.tally.restart(&gap, now);
        }
    }

    /// Completes the totals at the end of the run.
    pub(super) fn finish<F: Real, J: StickSlip<F>>(&mut self, time_s: f64, joint: &J) {
        let end = object_state(time_s, self.phi_rad, joint);
        if let Some(gap) = self.gap.take() {
            self.tally.restart(&gap, end);
        }
        self.tally
            .finish(end.time_s, end.phi_rad, end.theta_rad, end.theta_dot_rad_s);
    }

    /// Accounts for the stick from the last booked point to `fraction`.
    #[inline]
    fn book_stick<F: Real>(&mut self, seen: &ShaftStep<F>, fraction: f64, theta_rad: f64) {
        let end = self.stick_end(seen, fraction, theta_rad);
        let delta_phi =
            travel(seen, fraction, self.step_s) - travel(seen, self.booked, self.step_s);
        // A step begins after a jump of the velocity.
        let omega_rad_s = if self.booked > 0.0 {
            self.stick.omega_rad_s
        } else {
            seen.omega_start_rad_s.to_f64()
        };
        let start = StickEnd {
            omega_rad_s,
            omega_dot: end.omega_dot,
            ..self.stick
        };
        self.tally.stick(
            (fraction - self.booked) * self.step_s,
            delta_phi,
            start,
            end,
        );
        self.stick = end;
    }

    /// The stick at `fraction` of the step.
    #[inline]
    fn stick_end<F: Real>(&self, seen: &ShaftStep<F>, fraction: f64, theta_rad: f64) -> StickEnd {
        let (a, b) = (
            seen.omega_start_rad_s.to_f64(),
            seen.omega_end_rad_s.to_f64(),
        );
        StickEnd {
            theta_rad,
            omega_rad_s: a + fraction * (b - a),
            omega_dot: (b - a) / self.step_s,
        }
    }
}

fn object_state<F: Real, J: StickSlip<F>>(time_s: f64, phi_rad: f64, joint: &J) -> ObjectState {
    ObjectState {
        phase: joint.phase(),
        time_s,
        phi_rad,
        theta_rad: joint.theta_rad().to_f64(),
        theta_dot_rad_s: joint.theta_dot_rad_s().to_f64(),
    }
}

/// Shaft angle travelled after `fraction` of a step, rad.
#[inline]
fn travel<F: Real>(seen: &ShaftStep<F>, fraction: f64, step_s: f64) -> f64 {
    ShaftStep {
        delta_phi_rad: seen.delta_phi_rad.to_f64(),
        omega_start_rad_s: seen.omega_start_rad_s.to_f64(),
        omega_end_rad_s: seen.omega_end_rad_s.to_f64(),
    }
    .travel(fraction, step_s)
}
