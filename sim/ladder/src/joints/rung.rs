//! Joints of one rung, step by step together.

use crate::joints::each::{AfterStep, Each, StepPart, Work};
use crate::joints::lanes::{self, InLanes};
use crate::joints::loops::in_threads;
use crate::joints::many::{Lanes, Many};
use crate::joints::motion::{Counts, State, StepEvent};
use crate::joints::slips::{LANES, Slips};
use crepitus_model::joint::SlipLane;
use crepitus_model::solver::{JointVisitor, Solver, with_joint};
use crepitus_model::{Settings, SettingsError, StickSlip, Validated};
use std::any::Any;
use std::array::from_fn;

/// Joints of a rung.
#[derive(Clone)]
pub(crate) struct OfRung<J, F> {
    pub(crate) joints: Vec<Each<J, F>>,
    /// Of each joint after its last step.
    torque_nm: Vec<F>,
    phase: Vec<i8>,
    omega_rad_s: Vec<F>,
    /// Next steps that leave torque and phase as they are, and those of them that a joint has not made yet.
    constant_steps: Vec<u32>,
    skipped_steps: Vec<u32>,
    /// Slips that are stepped side by side, and the joints which are behind their lanes.
    slips: Vec<Slips<F>>,
    is_in_lane: Vec<bool>,
    /// Step and its reciprocal, s and 1/s.
    step: (F, F),
}

impl<F: Lanes, J: StickSlip<F>> OfRung<J, F> {
    pub(crate) fn new() -> Self {
        Self {
            joints: Vec::new(),
            torque_nm: Vec::new(),
            phase: Vec::new(),
            omega_rad_s: Vec::new(),
            constant_steps: Vec::new(),
            skipped_steps: Vec::new(),
            slips: Vec::new(),
            is_in_lane: Vec::new(),
            step: (F::ZERO, F::ZERO),
        }
    }

    pub(crate) fn push(&mut self, joint: J, omega_rad_s: F) {
        let coefficients = joint.coefficients();
        self.step = (coefficients.step_s, coefficients.per_step);
        if J::HAS_LANES && self.joints.len().is_multiple_of(LANES) {
            let mut slips = Slips::new();
            (0..LANES).for_each(|i| slips.rest(i));
            self.slips.push(slips);
        }
        self.is_in_lane.push(false);
        self.joints.push(Each {
            joint,
            omega_rad_s,
            counts: Counts::default(),
            events: None,
        });
        self.torque_nm.push(F::ZERO);
        self.phase.push(0);
        self.omega_rad_s.push(F::ZERO);
        self.constant_steps.push(0);
        self.skipped_steps.push(0);
        self.look_at(self.joints.len() - 1);
    }

    /// Makes the steps of a joint that have only been counted.
    #[inline]
    fn catch_up(&mut self, n: usize) {
        let steps = std::mem::take(&mut self.skipped_steps[n]);
        if steps > 0 {
            let each = &mut self.joints[n];
            each.omega_rad_s = self.omega_rad_s[n];
            each.joint.skip(steps, each.omega_rad_s);
        }
        if self.is_in_lane[n] {
            let (slips, i) = (&self.slips[n / LANES], n % LANES);
            let each = &mut self.joints[n];
            each.omega_rad_s = slips.omega[i];
            each.joint.set_slip(slips.x[i], slips.v[i], slips.omega[i]);
        }
    }

    #[inline]
    fn look_at(&mut self, n: usize) {
        let each = &self.joints[n];
        self.torque_nm[n] = each.joint.torque_nm();
        self.phase[n] = each.joint.phase().sign();
        self.omega_rad_s[n] = each.omega_rad_s;
        self.constant_steps[n] = each.joint.coast().map_or(0, |coast| coast.steps);
        if J::HAS_LANES {
            let slip = each.joint.slip_lane();
            self.is_in_lane[n] = slip.is_some();
            let slips = &mut self.slips[n / LANES];
            slips.set(n % LANES, &slip.unwrap_or_default(), each.omega_rad_s);
        }
    }

    /// A step of a joint by itself.
    fn step_alone(&mut self, n: usize, turn_rad: F, speed_rad_s: F) {
        self.catch_up(n);
        self.joints[n].step(0, turn_rad, speed_rad_s);
        self.look_at(n);
    }
}

impl<F: Lanes, J: StickSlip<F> + Clone> Many<F> for OfRung<J, F> {
    fn copied(&self) -> Box<dyn Many<F>> {
        Box::new(self.clone())
    }

    fn as_any(&mut self) -> &mut dyn Any {
        self
    }

    fn steps(&mut self, work: Work<'_, F>, threads: usize, goes_on: &mut dyn FnMut() -> bool) {
        for n in 0..self.joints.len() {
            self.catch_up(n);
        }
        in_threads(&mut self.joints, work, threads, goes_on);
        for n in 0..self.joints.len() {
            self.look_at(n);
        }
    }

    fn step(&mut self, turns_rad: &[F], speeds_rad_s: &[F], is_of_each: bool) {
        let stride = usize::from(is_of_each);
        if J::HAS_LANES {
            return lanes::step(self, turns_rad, speeds_rad_s, stride);
        }
        for n in 0..self.joints.len() {
            let speed_rad_s = speeds_rad_s[n * stride];
            if self.constant_steps[n] > 0 {
                self.constant_steps[n] -= 1;
                self.skipped_steps[n] += 1;
                self.omega_rad_s[n] = speed_rad_s;
            } else {
                self.step_alone(n, turns_rad[n * stride], speed_rad_s);
            }
        }
    }

    fn step_in_parts(&mut self, n: usize, parts: &[StepPart<F>], after: &mut AfterStep<'_, F>) {
        self.catch_up(n);
        let each = &mut self.joints[n];
        let whole = *each.joint.coefficients();
        let recorded = each.events.replace(Vec::new());
        for (coefficients, shaft) in parts {
            each.joint.change_step(*coefficients);
            each.step_on(0, shaft);
            let (theta_rad, theta_dot_rad_s) = each.joint.motion();
            let state = State {
                phase: each.joint.phase(),
                torque_nm: each.joint.torque_nm(),
                theta_rad,
                theta_dot_rad_s,
            };
            let events = each.events.get_or_insert_default();
            after(events, &state);
            events.clear();
        }
        each.joint.change_step(whole);
        each.events = recorded;
        self.look_at(n);
    }

    fn jump(&mut self, omega_rad_s: F) {
        for n in 0..self.joints.len() {
            self.catch_up(n);
            self.joints[n].omega_rad_s = omega_rad_s;
            self.look_at(n);
            // Its next step tells the joint of the jump, which its lane would hide.
            if J::HAS_LANES {
                self.is_in_lane[n] = false;
                self.slips[n / LANES].set(n % LANES, &SlipLane::default(), omega_rad_s);
            }
        }
    }

    fn record_events(&mut self) {
        for each in &mut self.joints {
            each.events.get_or_insert_default();
        }
    }

    fn events(&mut self, n: usize) -> Option<&mut Vec<StepEvent<F>>> {
        self.joints[n].events.as_mut()
    }

    fn restart(&mut self, n: usize, torque_nm: F, omega_rad_s: F) {
        self.skipped_steps[n] = 0;
        let each = &mut self.joints[n];
        each.joint.restart(torque_nm, omega_rad_s);
        each.omega_rad_s = omega_rad_s;
        self.look_at(n);
    }

    fn torques_nm(&self) -> &[F] {
        &self.torque_nm
    }

    fn phases(&self) -> &[i8] {
        &self.phase
    }

    fn omegas_rad_s(&self) -> &[F] {
        &self.omega_rad_s
    }

    fn motion(&mut self, n: usize) -> (F, F) {
        self.catch_up(n);
        self.joints[n].joint.motion()
    }

    fn counts(&self, n: usize) -> Counts {
        self.joints[n].counts
    }
}

impl<F: Lanes, J: StickSlip<F>> InLanes<F> for OfRung<J, F> {
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "the target features of its caller")]
    fn step_in_lanes(&mut self, turns_rad: &[F], speeds_rad_s: &[F], stride: usize) {
        let count = self.joints.len();
        for block in 0..self.slips.len() {
            let first = block * LANES;
            let ends = if stride == 0 {
                [speeds_rad_s[0]; LANES]
            } else {
                from_fn(|i| speeds_rad_s[(first + i).min(count - 1)])
            };
            let slips = &mut self.slips[block];
            let (x, v, is_sure) = slips.stepped(&ends, self.step);
            if is_sure == [true; LANES] {
                (slips.x, slips.v, slips.omega) = (x, v, ends);
                for (omega, end) in self.omega_rad_s[first..].iter_mut().zip(ends) {
                    *omega = end;
                }
                continue;
            }
            for i in 0..LANES.min(count - first) {
                let n = first + i;
                if is_sure[i] {
                    let slips = &mut self.slips[block];
                    (slips.x[i], slips.v[i], slips.omega[i]) = (x[i], v[i], ends[i]);
                    self.omega_rad_s[n] = ends[i];
                } else {
                    self.step_alone(n, turns_rad[n * stride], ends[i]);
                }
            }
        }
    }
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
