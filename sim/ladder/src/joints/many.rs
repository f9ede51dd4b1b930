//! Joints of one rung, and the loops that know it.

use crate::joints::lanes::{self, LEAST_LANES};
use crate::joints::motion::{Columns, Counts, State, StepEvent};
use crate::joints::rung::OfRung;
use crepitus_model::joint::SlipLane;
use crepitus_model::solver::{JointVisitor, Solver, with_joint};
use crepitus_model::{
    Phase, Real, Settings, SettingsError, ShaftStep, StepCoefficients, StickSlip, Validated,
};
use std::any::Any;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

/// Steps between two looks whether to go on.
pub(crate) const UNWATCHED_STEPS: usize = 1 << 16;

/// A joint with what its steps need besides.
#[derive(Clone)]
pub(crate) struct Each<J, F> {
    pub(crate) joint: J,
    /// Shaft velocity at the end of the last step, rad/s.
    pub(crate) omega_rad_s: F,
    pub(crate) counts: Counts,
    /// Events since they were taken, if they are recorded.
    pub(crate) events: Option<Vec<StepEvent<F>>>,
}

/// A part of a step: its coefficients, and the shaft meanwhile.
pub type StepPart<F> = (StepCoefficients<F>, ShaftStep<F>);

/// Receiver of the events of a step and the state after it.
pub(crate) type AfterStep<'a, F> = dyn FnMut(&[StepEvent<F>], &State<F>) + 'a;

/// Joints of one rung, without its type.
pub trait Many<F: Lanes>: Send {
    /// A copy with all states.
    fn copied(&self) -> Box<dyn Many<F>>;

    fn as_any(&mut self) -> &mut dyn Any;

    /// Steps each joint through its motion, by this number of threads; ends early if `goes_on` says no,
    /// which the calling thread asks now and then.
    fn steps(&mut self, work: Work<'_, F>, threads: usize, goes_on: &mut dyn FnMut() -> bool);

    /// Steps all joints by one step: a turn and a speed of all, or of each.
    fn step(&mut self, turns_rad: &[F], speeds_rad_s: &[F], is_of_each: bool);

    /// Makes a step of a joint in parts.
    fn step_in_parts(&mut self, n: usize, parts: &[StepPart<F>], after: &mut AfterStep<'_, F>);

    /// Lets the speed of all shafts jump.
    fn jump(&mut self, omega_rad_s: F);

    /// Records events from now on.
    fn record_events(&mut self);

    /// Events of a joint that are recorded and not taken yet.
    fn events(&mut self, n: usize) -> Option<&mut Vec<StepEvent<F>>>;

    /// Puts a joint in stick where the shaft is.
    fn restart(&mut self, n: usize, torque_nm: F, omega_rad_s: F);

    /// Torque of each, N·m.
    fn torques_nm(&self) -> &[F];

    /// Sign of the phase of each.
    fn phases(&self) -> &[i8];

    /// Speed of the shaft of each after its last step, rad/s.
    fn omegas_rad_s(&self) -> &[F];

    /// (θ, θ̇) of a joint, rad and rad/s.
    fn motion(&mut self, n: usize) -> (F, F);

    /// Events of a joint.
    fn counts(&self, n: usize) -> Counts;
}

/// A precision whose rungs are compiled in this crate.
pub trait Lanes: Real {
    /// Adds a joint to those of its rung.
    #[doc(hidden)]
    fn push(
        many: Option<Box<dyn Many<Self>>>,
        settings: &Validated<Settings>,
        solver: Solver,
        step_s: f64,
        omega_rad_s: Self,
    ) -> Result<Box<dyn Many<Self>>, SettingsError>;
}

impl Lanes for f32 {
    fn push(
        many: Option<Box<dyn Many<Self>>>,
        settings: &Validated<Settings>,
        solver: Solver,
        step_s: f64,
        omega_rad_s: Self,
    ) -> Result<Box<dyn Many<Self>>, SettingsError> {
        let push = Push { many, omega_rad_s };
        with_joint(settings, solver, step_s, omega_rad_s, push)
    }
}

impl Lanes for f64 {
    fn push(
        many: Option<Box<dyn Many<Self>>>,
        settings: &Validated<Settings>,
        solver: Solver,
        step_s: f64,
        omega_rad_s: Self,
    ) -> Result<Box<dyn Many<Self>>, SettingsError> {
        let push = Push { many, omega_rad_s };
        with_joint(settings, solver, step_s, omega_rad_s, push)
    }
}

/// Adds a joint to those of its rung.
struct Push<F> {
    many: Option<Box<dyn Many<F>>>,
    omega_rad_s: F,
}

impl<F: Lanes> JointVisitor<F> for Push<F> {
    type Output = Box<dyn Many<F>>;

    fn visit<J: StickSlip<F> + Clone>(self, joint: J) -> Box<dyn Many<F>> {
        let mut many = self.many.unwrap_or_else(|| Box::new(OfRung::<J, F>::new()));
        // One convention and one solver are one type.
        if let Some(joints) = many.as_any().downcast_mut::<OfRung<J, F>>() {
            joints.push(joint, self.omega_rad_s);
        }
        many
    }
}

/// Motion and columns of some joints.
pub struct Work<'a, F> {
    /// Of all joints, or (`is_of_each`) one behind the other.
    pub(crate) turns_rad: &'a [F],
    pub(crate) speeds_rad_s: &'a [F],
    pub(crate) is_of_each: bool,
    /// Steps of each joint.
    pub(crate) steps: usize,
    pub(crate) columns: Columns<'a, F>,
}

impl<F> Work<'_, F> {
    /// The work of the first joints, and that of the others.
    fn split(self, joints: usize) -> (Self, Self) {
        let count = joints * self.steps;
        let (first, rest) = self.columns.split(count);
        let after = if self.is_of_each { count } else { 0 };
        let first = Self {
            columns: first,
            ..self
        };
        let rest = Self {
            turns_rad: &self.turns_rad[after..],
            speeds_rad_s: &self.speeds_rad_s[after..],
            columns: rest,
            ..self
        };
        (first, rest)
    }
}

impl<F: Lanes, J: StickSlip<F>> Each<J, F> {
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a loop around it holds its state")]
    pub(crate) fn step(&mut self, step: usize, turn_rad: F, speed_rad_s: F) {
        let shaft = ShaftStep {
            delta_phi_rad: turn_rad,
            omega_start_rad_s: self.omega_rad_s,
            omega_end_rad_s: speed_rad_s,
        };
        self.step_on(step, &shaft);
    }

    /// Step number `step` of its arrays.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a loop around it holds its state")]
    pub(crate) fn step_on(&mut self, step: usize, shaft: &ShaftStep<F>) {
        let (counts, events) = (&mut self.counts, &mut self.events);
        self.joint.step(shaft, |event| {
            counts.count(event.kind);
            if let Some(events) = events {
                events.push(StepEvent { step, event });
            }
        });
        self.omega_rad_s = shaft.omega_end_rad_s;
    }

    /// Steps a slip on as long as the velocities surely do not meet, with its state in registers; returns the
    /// number of steps.
    fn slip_on(
        &mut self,
        mut slip: SlipLane<F>,
        speeds: &[F],
        (theta, theta_dot): (&mut [F], &mut [F]),
    ) -> usize {
        let coefficients = self.joint.coefficients();
        let (step_s, per_step) = (coefficients.step_s, coefficients.per_step);
        let mut omega_rad_s = self.omega_rad_s;
        let mut made = 0;
        for (n, end) in speeds.iter().enumerate() {
            let (x, v, is_sure) = slip.stepped(omega_rad_s, *end, step_s, per_step);
            if !is_sure {
                break;
            }
            (slip.x, slip.v, omega_rad_s) = (x, v, *end);
            if let Some(theta) = theta.get_mut(n)
                && let Some(theta_dot) = theta_dot.get_mut(n)
            {
                (*theta, *theta_dot) = (x + slip.middle_rad, v);
            }
            made += 1;
        }
        if made > 0 {
            self.omega_rad_s = omega_rad_s;
            self.joint.set_slip(slip.x, slip.v, omega_rad_s);
        }
        made
    }

    /// Steps through a part of its motion, and keeps what is asked for.
    fn through(&mut self, work: &mut Work<'_, F>, range: Range<usize>) {
        let (turns, speeds) = (
            &work.turns_rad[range.clone()],
            &work.speeds_rad_s[range.clone()],
        );
        let (first, steps) = (range.start, turns.len().min(speeds.len()));
        let (turns, speeds) = (&turns[..steps], &speeds[..steps]);
        let Columns {
            torque_nm,
            phase,
            theta_rad,
            theta_dot_rad_s,
        } = work.columns.part(range);
        let mut n = 0;
        while n < steps {
            if let Some(coast) = self.joint.coast() {
                let left = u32::try_from(steps - n).unwrap_or(u32::MAX);
                let count = coast.steps.min(left);
                let range = n..n + count as usize;
                if let Some(torques) = torque_nm.get_mut(range.clone()) {
                    torques.fill(coast.torque_nm);
                }
                if let Some(phases) = phase.get_mut(range.clone()) {
                    phases.fill(Phase::Slip(coast.sense).sign());
                }
                if let Some(theta) = theta_rad.get_mut(range.clone())
                    && let Some(theta_dot) = theta_dot_rad_s.get_mut(range.clone())
                {
                    lanes::motions(&coast, theta, theta_dot);
                }
                n = range.end;
                self.omega_rad_s = speeds[n - 1];
                self.joint.skip(count, self.omega_rad_s);
                continue;
            }
            if let Some(slip) = self.joint.slip_lane() {
                let rest = (
                    theta_rad.get_mut(n..).unwrap_or_default(),
                    theta_dot_rad_s.get_mut(n..).unwrap_or_default(),
                );
                let range = n..n + self.slip_on(slip, &speeds[n..], rest);
                if !range.is_empty() {
                    if let Some(torques) = torque_nm.get_mut(range.clone()) {
                        torques.fill(self.joint.torque_nm());
                    }
                    if let Some(phases) = phase.get_mut(range.clone()) {
                        phases.fill(self.joint.phase().sign());
                    }
                    n = range.end;
                    continue;
                }
            }
            self.step(first + n, turns[n], speeds[n]);
            if let Some(torque) = torque_nm.get_mut(n) {
                *torque = self.joint.torque_nm();
            }
            if let Some(phase) = phase.get_mut(n) {
                *phase = self.joint.phase().sign();
            }
            if let Some(theta) = theta_rad.get_mut(n)
                && let Some(theta_dot) = theta_dot_rad_s.get_mut(n)
            {
                (*theta, *theta_dot) = self.joint.motion();
            }
            n += 1;
        }
    }
}

/// Steps some joints through their work; ends early if `goes_on` says no.
fn steps<F: Lanes, J: StickSlip<F>>(
    joints: &mut [Each<J, F>],
    work: Work<'_, F>,
    goes_on: &mut dyn FnMut() -> bool,
) {
    if J::HAS_LANES && joints.len() >= LEAST_LANES {
        return lanes::steps(joints, work, goes_on);
    }
    let mut rest = work;
    let mut unwatched = 0;
    for joint in joints {
        let (mut work, others) = rest.split(1);
        rest = others;
        let mut begun = 0;
        while begun < work.steps {
            let to = work.steps.min(begun + UNWATCHED_STEPS - unwatched);
            joint.through(&mut work, begun..to);
            unwatched += to - begun;
            begun = to;
            if unwatched >= UNWATCHED_STEPS {
                unwatched = 0;
                if !goes_on() {
                    return;
                }
            }
        }
    }
}

/// [`steps`] by several threads, each with its joints. The calling thread asks whether to go on, for all.
pub(crate) fn in_threads<F: Lanes, J: StickSlip<F>>(
    joints: &mut [Each<J, F>],
    work: Work<'_, F>,
    threads: usize,
    goes_on: &mut dyn FnMut() -> bool,
) {
    if threads < 2 || joints.len() < 2 {
        return steps(joints, work, goes_on);
    }
    let of_each = joints.len().div_ceil(threads);
    let is_stopped = AtomicBool::new(false);
    thread::scope(|scope| {
        let mut chunks = joints.chunks_mut(of_each);
        let Some(own) = chunks.next() else { return };
        let (own_work, mut rest) = work.split(own.len());
        for joints in chunks {
            let (work, others) = rest.split(joints.len());
            rest = others;
            let is_stopped = &is_stopped;
            scope.spawn(move || {
                steps(joints, work, &mut || !is_stopped.load(Ordering::Relaxed));
            });
        }
        steps(own, own_work, &mut || {
            let goes_on = goes_on();
            is_stopped.store(!goes_on, Ordering::Relaxed);
            goes_on
        });
    });
}
