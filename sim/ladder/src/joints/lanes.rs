//! Loops that a compiler makes lanes of, and the runtime choice of their instruction set.
//!
//! No operation is fused or reordered: the bits are those of a processor without these lanes.
//!
//! ```text
//! joints ── gather ──> x, v, … of each in arrays ── a step of all lanes ──┬─ all surely slip on: another
//!    ▲                                                                    └─ one may not ─┐
//!    └── a joint whose velocities may meet steps by itself to its next slip <─────────────┘
//! ```
//!
//! A lane is as far in its motion as it is, not as the others are; one that has ended takes the next joint.

use crate::joints::each::{Each, UNWATCHED_STEPS, Work};
use crate::joints::slips::{LANES, Slips};
use crepitus_model::joint::Coast;
use crepitus_model::{Real, StickSlip};
use std::array::from_fn;

/// Steps whose states are kept in lanes.
const CHUNK: usize = 32;

/// Joints below which each goes by itself.
pub(crate) const LEAST_LANES: usize = 3;

/// Joints that are stepped side by side.
pub(crate) trait InLanes<F> {
    /// Steps all of them by one step; turns and speeds are `stride` apart.
    fn step_in_lanes(&mut self, turns_rad: &[F], speeds_rad_s: &[F], stride: usize);
}

/// As [`Coast::motions`].
pub(crate) fn motions<F: Real>(coast: &Coast<F>, theta_rad: &mut [F], theta_dot_rad_s: &mut [F]) {
    #[cfg(target_arch = "x86_64")]
    if wide::is_there() {
        return wide::motions(coast, theta_rad, theta_dot_rad_s);
    }
    coast.motions(theta_rad, theta_dot_rad_s);
}

/// Steps joints through their motions, several side by side; ends early if `goes_on` says no.
pub(crate) fn steps<F: Real, J: StickSlip<F>>(
    joints: &mut [Each<J, F>],
    work: Work<'_, F>,
    goes_on: &mut dyn FnMut() -> bool,
) {
    #[cfg(target_arch = "x86_64")]
    if wide::is_there() {
        return wide::steps(joints, work, goes_on);
    }
    Block::new(joints, work).steps(goes_on);
}

/// Steps all joints of a rung by one step.
pub(crate) fn step<F: Real>(
    joints: &mut impl InLanes<F>,
    turns_rad: &[F],
    speeds_rad_s: &[F],
    stride: usize,
) {
    #[cfg(target_arch = "x86_64")]
    if wide::is_there() {
        return wide::step(joints, turns_rad, speeds_rad_s, stride);
    }
    joints.step_in_lanes(turns_rad, speeds_rad_s, stride);
}

/// Lanes of 256 bits.
#[cfg(target_arch = "x86_64")]
mod wide {
    #![allow(
        unsafe_code,
        reason = "a call of code for AVX2, behind the test that the processor has it"
    )]

    use super::{Block, Coast, Each, InLanes, Real, StickSlip, Work};

    pub(super) fn is_there() -> bool {
        std::arch::is_x86_feature_detected!("avx2")
    }

    pub(super) fn motions<F: Real>(
        coast: &Coast<F>,
        theta_rad: &mut [F],
        theta_dot_rad_s: &mut [F],
    ) {
        #[target_feature(enable = "avx2")]
        fn wide<F: Real>(coast: &Coast<F>, theta_rad: &mut [F], theta_dot_rad_s: &mut [F]) {
            coast.motions(theta_rad, theta_dot_rad_s);
        }
        assert!(is_there(), "called without AVX2");
        // SAFETY: the processor has AVX2.
        unsafe { wide(coast, theta_rad, theta_dot_rad_s) }
    }

    pub(super) fn steps<F: Real, J: StickSlip<F>>(
        joints: &mut [Each<J, F>],
        work: Work<'_, F>,
        goes_on: &mut dyn FnMut() -> bool,
    ) {
        #[target_feature(enable = "avx2")]
        fn wide<F: Real, J: StickSlip<F>>(
            joints: &mut [Each<J, F>],
            work: Work<'_, F>,
            goes_on: &mut dyn FnMut() -> bool,
        ) {
            Block::new(joints, work).steps(goes_on);
        }
        assert!(is_there(), "called without AVX2");
        // SAFETY: the processor has AVX2.
        unsafe { wide(joints, work, goes_on) }
    }

    pub(super) fn step<F: Real>(
        joints: &mut impl InLanes<F>,
        turns_rad: &[F],
        speeds_rad_s: &[F],
        stride: usize,
    ) {
        #[target_feature(enable = "avx2")]
        fn wide<F: Real>(
            joints: &mut impl InLanes<F>,
            turns_rad: &[F],
            speeds_rad_s: &[F],
            stride: usize,
        ) {
            joints.step_in_lanes(turns_rad, speeds_rad_s, stride);
        }
        assert!(is_there(), "called without AVX2");
        // SAFETY: the processor has AVX2.
        unsafe { wide(joints, turns_rad, speeds_rad_s, stride) }
    }
}

/// Joint that a lane steps, and how far it is.
#[derive(Clone, Copy)]
struct Place {
    joint: usize,
    /// Steps that it has made.
    made: usize,
    /// Those of them whose torque and phase are written.
    written: usize,
}

/// Joints that take turns in the lanes.
struct Block<'a, 'w, J, F> {
    joints: &'a mut [Each<J, F>],
    work: Work<'w, F>,
    slips: Slips<F>,
    places: [Option<Place>; LANES],
    /// The next joint that has no lane yet.
    next: usize,
    /// Step and its reciprocal, s and 1/s.
    step: (F, F),
    /// Steps since it was asked whether to go on.
    unwatched: usize,
}

impl<'a, 'w, F: Real, J: StickSlip<F>> Block<'a, 'w, J, F> {
    fn new(joints: &'a mut [Each<J, F>], work: Work<'w, F>) -> Self {
        let coefficients = joints.first().map(|each| *each.joint.coefficients());
        Self {
            joints,
            work,
            slips: Slips::new(),
            places: [None; LANES],
            next: 0,
            step: coefficients.map_or((F::ZERO, F::ZERO), |of| (of.step_s, of.per_step)),
            unwatched: 0,
        }
    }

    /// Steps all joints through their motions; ends early if `goes_on` says no.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "the target features of its caller")]
    fn steps(mut self, goes_on: &mut dyn FnMut() -> bool) {
        for i in 0..LANES {
            self.take_next(i);
        }
        let mut stays = true;
        while stays && self.places.iter().any(Option::is_some) {
            let (count, is_sure) = self.together();
            for (i, is_sure) in is_sure.into_iter().enumerate() {
                let Some(place) = &mut self.places[i] else {
                    continue;
                };
                place.made += count;
                if (!is_sure || place.made >= self.work.steps) && !self.alone(i) {
                    self.take_next(i);
                }
            }
            self.unwatched += count * LANES;
            if self.unwatched >= UNWATCHED_STEPS {
                self.unwatched = 0;
                stays = goes_on();
            }
        }
        for i in 0..LANES {
            if let Some(place) = self.places[i] {
                self.scatter(i, place);
            }
        }
    }

    /// Steps all lanes until one of them may not slip on, or is at its end; returns the number of steps, and
    /// which lanes may make another one.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "the target features of its caller")]
    fn together(&mut self) -> (usize, [bool; LANES]) {
        let steps = self.work.steps;
        let left = self.places.iter().flatten().map(|place| steps - place.made);
        let count = left.min().unwrap_or(0);
        let (mut starts, mut rows) = ([0; LANES], [0; LANES]);
        for (i, place) in self.places.iter().enumerate() {
            if let Some(place) = place {
                rows[i] = place.joint * steps + place.made;
                starts[i] = if self.work.is_of_each {
                    rows[i]
                } else {
                    place.made
                };
            }
        }
        let speeds = starts.map(|start| &self.work.speeds_rad_s[start..start + count]);
        let has_motion = !self.work.columns.theta_rad.is_empty();
        let mut made = 0;
        while made < count {
            // States of a few steps, which are put into the columns of the joints together.
            let mut states = [([F::ZERO; LANES], [F::ZERO; LANES]); CHUNK];
            let mut unsure = None;
            let mut few = 0;
            for state in states.iter_mut().take(count - made) {
                let ends: [F; LANES] = from_fn(|i| speeds[i][made + few]);
                let (x, v, is_sure) = self.slips.stepped(&ends, self.step);
                if is_sure != [true; LANES] {
                    unsure = Some(is_sure);
                    break;
                }
                (self.slips.x, self.slips.v, self.slips.omega) = (x, v, ends);
                *state = (x, v);
                few += 1;
            }
            if has_motion {
                for (i, place) in self.places.iter().enumerate() {
                    if place.is_some() {
                        let row = rows[i] + made;
                        let part = self.work.columns.part(row..row + few);
                        let middle_rad = self.slips.middle_rad[i];
                        for ((x, v), (theta, theta_dot)) in states
                            .iter()
                            .zip(part.theta_rad.iter_mut().zip(part.theta_dot_rad_s))
                        {
                            *theta = x[i] + middle_rad;
                            *theta_dot = v[i];
                        }
                    }
                }
            }
            made += few;
            if let Some(is_sure) = unsure {
                return (made, is_sure);
            }
        }
        (count, [true; LANES])
    }

    /// Lets the joint of a lane step by itself to its next slip; returns whether it has not come to its end, and
    /// keeps its lane.
    #[inline(never)]
    fn alone(&mut self, i: usize) -> bool {
        let Some(mut place) = self.places[i] else {
            return false;
        };
        self.scatter(i, place);
        let steps = self.work.steps;
        while place.made < steps {
            let row = place.joint * steps + place.made;
            let at = if self.work.is_of_each {
                row
            } else {
                place.made
            };
            let each = &mut self.joints[place.joint];
            each.step(
                place.made,
                self.work.turns_rad[at],
                self.work.speeds_rad_s[at],
            );
            let part = self.work.columns.part(row..row + 1);
            part.torque_nm.fill(each.joint.torque_nm());
            part.phase.fill(each.joint.phase().sign());
            if !part.theta_rad.is_empty() {
                let (theta, theta_dot) = each.joint.motion();
                part.theta_rad.fill(theta);
                part.theta_dot_rad_s.fill(theta_dot);
            }
            place.made += 1;
            place.written = place.made;
            self.unwatched += 1;
            let slip = each.joint.slip_lane();
            // A long stick waits with a slip of zeros, which is not sure of anything.
            if place.made < steps && (slip.is_some() || self.unwatched >= UNWATCHED_STEPS) {
                let omega_rad_s = each.omega_rad_s;
                self.slips.set(i, &slip.unwrap_or_default(), omega_rad_s);
                self.places[i] = Some(place);
                return true;
            }
        }
        false
    }

    /// Gives a lane the next joint that has a step to make with others, if there is one.
    fn take_next(&mut self, i: usize) {
        while self.next < self.joints.len() && self.work.steps > 0 {
            let each = &self.joints[self.next];
            let (slip, omega_rad_s) = (each.joint.slip_lane(), each.omega_rad_s);
            self.places[i] = Some(Place {
                joint: self.next,
                made: 0,
                written: 0,
            });
            self.next += 1;
            let has_slip = slip.is_some();
            self.slips.set(i, &slip.unwrap_or_default(), omega_rad_s);
            if has_slip || self.alone(i) {
                return;
            }
        }
        self.places[i] = None;
        self.slips.rest(i);
    }

    /// Brings a joint to where its lane is, and writes what the slip has shown since it is there.
    fn scatter(&mut self, i: usize, place: Place) {
        let each = &mut self.joints[place.joint];
        if place.made == place.written {
            return;
        }
        each.omega_rad_s = self.slips.omega[i];
        each.joint
            .set_slip(self.slips.x[i], self.slips.v[i], each.omega_rad_s);
        let first = place.joint * self.work.steps;
        let range = first + place.written..first + place.made;
        let part = self.work.columns.part(range);
        part.torque_nm.fill(each.joint.torque_nm());
        part.phase.fill(each.joint.phase().sign());
    }
}
