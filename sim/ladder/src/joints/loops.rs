//! Loops over the steps of joints, on one thread or several.

use crate::joints::each::{Each, UNWATCHED_STEPS, Work};
use crate::joints::lanes::{self, LEAST_LANES};
use crate::joints::motion::Columns;
use crepitus_model::joint::SlipLane;
use crepitus_model::{Phase, Real, StickSlip};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

impl<F: Real, J: StickSlip<F>> Each<J, F> {
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
fn steps<F: Real, J: StickSlip<F>>(
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
pub(crate) fn in_threads<F: Real, J: StickSlip<F>>(
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
