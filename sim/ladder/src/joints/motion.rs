//! Inputs of steps, and what is kept of them.

use crepitus_model::{Event, EventKind, Phase};
use std::ops::Range;

/// Shaft's turns and speeds through steps, for all joints or for each.
#[derive(Clone, Copy, Debug)]
pub struct Motion<'a, F> {
    pub(crate) turns_rad: &'a [F],
    pub(crate) speeds_rad_s: &'a [F],
    pub(crate) is_of_each: bool,
}

impl<'a, F> Motion<'a, F> {
    /// One motion that all joints are on: the turn in each step, rad, and the speed at its end, rad/s.
    pub fn of_all(turns_rad: &'a [F], speeds_rad_s: &'a [F]) -> Self {
        Self {
            turns_rad,
            speeds_rad_s,
            is_of_each: false,
        }
    }

    /// A motion for each joint, one behind the other.
    pub fn of_each(turns_rad: &'a [F], speeds_rad_s: &'a [F]) -> Self {
        Self {
            turns_rad,
            speeds_rad_s,
            is_of_each: true,
        }
    }

    /// Steps of each of `joints`; `None` if the numbers do not come out even.
    pub(crate) fn steps(&self, joints: usize) -> Option<usize> {
        let numbers = self.turns_rad.len();
        if numbers != self.speeds_rad_s.len() {
            return None;
        }
        if !self.is_of_each {
            return Some(numbers);
        }
        if joints == 0 {
            return (numbers == 0).then_some(0);
        }
        numbers.is_multiple_of(joints).then(|| numbers / joints)
    }
}

/// Arrays for the states after each step, the first joint's before the second's; one that is empty is not
/// asked for.
#[derive(Debug, Default)]
pub struct Columns<'a, F> {
    /// Torque, N·m.
    pub torque_nm: &'a mut [F],
    /// 0 in stick, −1 or +1 in slip.
    pub phase: &'a mut [i8],
    /// Angle of the object, rad, with its velocity or not at all.
    pub theta_rad: &'a mut [F],
    /// Velocity of the object, rad/s.
    pub theta_dot_rad_s: &'a mut [F],
}

impl<F> Columns<'_, F> {
    /// Returns whether each array has this length, or is not asked for.
    pub(crate) fn fit(&self, count: usize) -> bool {
        let fits = |length: usize| length == 0 || length == count;
        fits(self.torque_nm.len())
            && fits(self.phase.len())
            && fits(self.theta_rad.len())
            && self.theta_rad.len() == self.theta_dot_rad_s.len()
    }

    /// A range of the states.
    pub(crate) fn part(&mut self, range: Range<usize>) -> Columns<'_, F> {
        Columns {
            torque_nm: self.torque_nm.get_mut(range.clone()).unwrap_or_default(),
            phase: self.phase.get_mut(range.clone()).unwrap_or_default(),
            theta_rad: self.theta_rad.get_mut(range.clone()).unwrap_or_default(),
            theta_dot_rad_s: self.theta_dot_rad_s.get_mut(range).unwrap_or_default(),
        }
    }

    /// The first `count` states, and those after them.
    pub(crate) fn split(self, count: usize) -> (Self, Self) {
        fn part<T>(column: &mut [T], count: usize) -> (&mut [T], &mut [T]) {
            column.split_at_mut(count.min(column.len()))
        }
        let (torque_nm, torques) = part(self.torque_nm, count);
        let (phase, phases) = part(self.phase, count);
        let (theta_rad, thetas) = part(self.theta_rad, count);
        let (theta_dot_rad_s, theta_dots) = part(self.theta_dot_rad_s, count);
        let first = Columns {
            torque_nm,
            phase,
            theta_rad,
            theta_dot_rad_s,
        };
        let rest = Columns {
            torque_nm: torques,
            phase: phases,
            theta_rad: thetas,
            theta_dot_rad_s: theta_dots,
        };
        (first, rest)
    }
}

/// An event, with the number of its step in the arrays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepEvent<F> {
    /// Number of the step, from 0.
    pub step: usize,
    /// The event.
    pub event: Event<F>,
}

/// State of a joint after a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<F> {
    /// Phase.
    pub phase: Phase,
    /// Torque, N·m.
    pub torque_nm: F,
    /// Angle of the object, rad.
    pub theta_rad: F,
    /// Velocity of the object, rad/s.
    pub theta_dot_rad_s: F,
}

/// Events of a joint since it was made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// From stick to slip.
    pub breaks: u64,
    /// From slip to stick.
    pub sticks: u64,
    /// From slip to a slip of the other sense.
    pub reverses: u64,
}

impl Counts {
    #[inline]
    pub(crate) fn count(&mut self, kind: EventKind) {
        match kind {
            EventKind::Break => self.breaks += 1,
            EventKind::Stick => self.sticks += 1,
            EventKind::Reverse => self.reverses += 1,
        }
    }
}
