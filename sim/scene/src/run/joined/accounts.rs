//! Joints side by side with the accounts of each.

use super::path::{BLOCK_STEPS, Block, SplitStep};
use crate::run::Totals;
use crate::run::accounting::StepAccounting;
use crate::run::held_back::{Beyond, TankTotals};
use crate::run::sensor::{Ideal, Sensor};
use crate::run::tally::ObjectState;
use crepitus_ladder::joints::{Columns, JointError, Joints, Lanes, Motion, StepEvent};
use crepitus_model::solver::Solver;
use crepitus_model::{
    Phase, Sense, Settings, SettingsError, ShaftStep, StepCoefficients, Validated,
};
use std::ops::Range;

/// Totals of the shaft, which all joints have in common.
pub(super) struct ShaftTotals {
    pub(super) steps: u64,
    pub(super) end_s: f64,
    pub(super) fastest_rad_s: f64,
}

/// Joints on one motion.
pub(super) struct Runs<F> {
    joints: Joints<F>,
    settings: Vec<Validated<Settings>>,
    /// Of each joint; `None` once it has to be run by itself.
    accounts: Vec<Option<Accounts>>,
    states: States<F>,
}

/// Accounts of a joint.
struct Accounts {
    steps: StepAccounting,
    beyond: Beyond,
    /// Whether its torque can be beyond the largest of a device.
    can_be_beyond: bool,
}

/// States of all joints after each step of a block, the first joint's before the second's.
struct States<F> {
    torque_nm: Vec<F>,
    phase: Vec<i8>,
    theta_rad: Vec<F>,
    theta_dot_rad_s: Vec<F>,
}

/// States of one joint.
struct StatesOf<'a, F> {
    torque_nm: &'a [F],
    phase: &'a [i8],
    theta_rad: &'a [F],
    theta_dot_rad_s: &'a [F],
}

impl<F: Lanes> States<F> {
    fn of(joints: usize) -> Self {
        let room = joints * usize::try_from(BLOCK_STEPS).unwrap_or(0);
        Self {
            torque_nm: vec![F::ZERO; room],
            phase: vec![0; room],
            theta_rad: vec![F::ZERO; room],
            theta_dot_rad_s: vec![F::ZERO; room],
        }
    }

    fn columns(&mut self, count: usize) -> Columns<'_, F> {
        Columns {
            torque_nm: &mut self.torque_nm[..count],
            phase: &mut self.phase[..count],
            theta_rad: &mut self.theta_rad[..count],
            theta_dot_rad_s: &mut self.theta_dot_rad_s[..count],
        }
    }

    /// The states of joint `n` after so many steps.
    fn of_joint(&self, n: usize, steps: usize) -> StatesOf<'_, F> {
        let range = n * steps..(n + 1) * steps;
        StatesOf {
            torque_nm: &self.torque_nm[range.clone()],
            phase: &self.phase[range.clone()],
            theta_rad: &self.theta_rad[range.clone()],
            theta_dot_rad_s: &self.theta_dot_rad_s[range],
        }
    }
}

impl<F: Lanes> Runs<F> {
    /// Joints with these settings, in stick at θ = 0 on a shaft with this speed.
    ///
    /// # Errors
    /// As of [`Joints::new`].
    pub(super) fn new(
        settings: Vec<Validated<Settings>>,
        (solver, step_s): (Solver, f64),
        omega_rad_s: f64,
    ) -> Result<Self, JointError> {
        let omega = F::from_f64(omega_rad_s);
        let each = settings.iter().map(|settings| (*settings, omega));
        let mut joints = Joints::new(each, solver, step_s)?;
        joints.record_events();
        let torques = settings.iter().zip(joints.torques_nm());
        let accounts = torques
            .map(|(settings, torque_nm)| {
                let mut accounts = Accounts::new::<F>(settings, step_s, omega_rad_s);
                accounts.steps.tally.shown(torque_nm.to_f64());
                Some(accounts)
            })
            .collect();
        Ok(Self {
            states: States::of(joints.len()),
            joints,
            settings,
            accounts,
        })
    }

    /// Steps all joints through a block.
    pub(super) fn step_through(&mut self, block: &Block<F>) {
        if let Some(omega_rad_s) = block.jumps_to {
            self.joints.jump(omega_rad_s);
        }
        let steps = block.steps.len();
        let motion = Motion::of_all(&block.turns_rad, &block.speeds_rad_s);
        let columns = self.states.columns(steps * self.joints.len());
        let stepped = self.joints.steps(motion, columns, 1, || true);
        for (n, accounts) in self.accounts.iter_mut().enumerate() {
            let events = self.joints.take_events(n);
            if stepped.is_err() {
                *accounts = None;
            }
            if let Some(accounts) = accounts {
                accounts.note(block, &self.states.of_joint(n, steps), events);
            }
        }
    }

    /// Makes a step of all joints in the parts that the motion breaks it into.
    pub(super) fn step_in_parts(&mut self, step: &SplitStep<'_>) {
        for (n, (settings, account)) in self.settings.iter().zip(&mut self.accounts).enumerate() {
            let parts: Result<Vec<_>, SettingsError> = (step.parts.iter())
                .map(|part| {
                    let coefficients = StepCoefficients::new(settings, part.length_s)?;
                    Ok((coefficients, Ideal.see(&part.from, &part.to)))
                })
                .collect();
            let (Ok(parts), Some(accounts)) = (parts, account.as_mut()) else {
                *account = None;
                continue;
            };
            accounts.note_parts(&mut self.joints, n, step, &parts);
        }
    }

    /// Leaves joints whose state is no number to a run by itself, which says so.
    pub(super) fn leave_diverged(&mut self) {
        let motions = self.accounts.iter_mut().zip(self.joints.motions());
        for (accounts, (theta_rad, theta_dot_rad_s)) in motions {
            if !(theta_rad.is_finite() && theta_dot_rad_s.is_finite()) {
                *accounts = None;
            }
        }
    }

    /// Completes the totals of each joint.
    pub(super) fn finish(mut self, shaft: &ShaftTotals) -> Vec<Option<Totals>> {
        let phases = self.joints.phases().to_vec();
        let states = phases.into_iter().zip(self.joints.motions());
        (self.accounts.into_iter().zip(states))
            .map(|(accounts, (phase, (theta_rad, theta_dot_rad_s)))| {
                let Accounts {
                    mut steps, beyond, ..
                } = accounts?;
                steps.finish_in(ObjectState {
                    phase: phase_of(phase),
                    time_s: shaft.end_s,
                    phi_rad: steps.phi_rad,
                    theta_rad: theta_rad.to_f64(),
                    theta_dot_rad_s: theta_dot_rad_s.to_f64(),
                });
                Some(Totals {
                    steps: shaft.steps,
                    end_s: shaft.end_s,
                    tally: Some(steps.tally),
                    fastest_rad_s: shaft.fastest_rad_s,
                    crowded_steps: steps.crowded_steps,
                    tank: TankTotals::default(),
                    beyond,
                    plant: None,
                })
            })
            .collect()
    }
}

impl Accounts {
    fn new<F: Lanes>(settings: &Validated<Settings>, step_s: f64, omega_rad_s: f64) -> Self {
        let beyond = Beyond::new();
        let largest_nm = F::from_f64(settings.parameters.static_torque_nm);
        Self {
            steps: StepAccounting::new::<F>(settings, step_s, omega_rad_s),
            can_be_beyond: largest_nm.to_f64() > beyond.limit_nm,
            beyond,
        }
    }

    /// Accounts for a block of steps.
    fn note<F: Lanes>(
        &mut self,
        block: &Block<F>,
        states: &StatesOf<'_, F>,
        events: impl Iterator<Item = StepEvent<F>>,
    ) {
        let mut events = events.peekable();
        let mut n = 0;
        while n < block.steps.len() {
            let next = (events.peek()).map_or(block.steps.len(), |event| event.step);
            if next > n {
                n = self.note_quiet(block, states, n..next);
                continue;
            }
            let step = &block.steps[n];
            while let Some(event) = events.next_if(|event| event.step == n) {
                self.steps.event(step.start_s, &step.seen, &event.event);
            }
            self.steps.end_in(
                &step.seen,
                phase_of(states.phase[n]),
                || (states.torque_nm[n], states.theta_rad[n]),
                || states.theta_dot_rad_s[n],
            );
            n += 1;
        }
        if self.can_be_beyond {
            for (step, torque_nm) in block.steps.iter().zip(states.torque_nm) {
                (self.beyond).note(torque_nm.to_f64(), (step.end_s, self.steps.step_s));
            }
        }
    }

    /// Accounts for steps without an event as long as they are in one phase; returns the number of the step after
    /// them.
    fn note_quiet<F: Lanes>(
        &mut self,
        block: &Block<F>,
        states: &StatesOf<'_, F>,
        range: Range<usize>,
    ) -> usize {
        let phases = &states.phase[range.clone()];
        let (start, phase) = (range.start, phases[0]);
        let changed = phases.iter().position(|other| *other != phase);
        let range = start..changed.map_or(range.end, |count| start + count);
        let end = range.end;
        if phase == 0 {
            let steps = block.steps[range.clone()].iter();
            let torques = states.torque_nm[range.clone()].iter();
            for ((step, torque_nm), theta_rad) in steps.zip(torques).zip(&states.theta_rad[range]) {
                let (torque_nm, theta_rad) = (torque_nm.to_f64(), theta_rad.to_f64());
                (self.steps).whole_stick(&step.stretch, torque_nm, theta_rad);
            }
        } else {
            self.steps.tally.lead.look_along(
                f64::from(phase),
                &block.omega_rad_s[range.clone()],
                &states.theta_dot_rad_s[range],
            );
        }
        self.steps.phi_rad = block.steps[end - 1].phi_rad;
        end
    }

    /// Accounts for a step of joint `n` in parts, which it makes.
    fn note_parts<F: Lanes>(
        &mut self,
        joints: &mut Joints<F>,
        n: usize,
        step: &SplitStep<'_>,
        parts: &[(StepCoefficients<F>, ShaftStep<F>)],
    ) {
        let accounting = &mut self.steps;
        let whole_s = accounting.step_s;
        let mut time_s = step.start_s;
        let mut left = parts.len();
        let mut lengths = step.parts.iter().map(|part| part.length_s).zip(parts);
        joints.step_in_parts(n, parts, |events, state| {
            let Some((length_s, (_, seen))) = lengths.next() else {
                return;
            };
            accounting.step_s = length_s;
            for event in events {
                accounting.event(time_s, seen, &event.event);
            }
            left -= 1;
            let stick = || (state.torque_nm, state.theta_rad);
            if left > 0 {
                accounting.end_part(seen, state.phase, stick);
            } else {
                accounting.end_in(seen, state.phase, stick, || state.theta_dot_rad_s);
            }
            time_s += length_s;
        });
        accounting.step_s = whole_s;
    }
}

/// The phase with this sign.
fn phase_of(sign: i8) -> Phase {
    match Sense::of(f64::from(sign)) {
        Some(sense) => Phase::Slip(sense),
        None => Phase::Stick,
    }
}
