//! Place of a coupled run, and its sums so far.

use super::command::Command;
use super::held_back::Beyond;
use super::tally::TorqueTally;
use crepitus_plant::chain::Body;

/// A coupled run before its next tick.
#[derive(Clone)]
pub(super) struct Reached {
    /// Ticks so far.
    pub(super) n: u64,
    pub(super) time_s: f64,
    /// Length of a tick, s.
    pub(super) tick_s: f64,
    pub(super) shaft: Body,
    /// Command for the next tick.
    pub(super) command: Command,
    /// Torque at the hand in the last tick, without impacts, N·m.
    pub(super) felt_nm: f64,
    /// Impulse of impacts in the last tick, N·m·s.
    pub(super) struck_nms: f64,
    pub(super) felt: TorqueTally,
    pub(super) most_struck_nms: f64,
    /// Work of the model's torque, held over each tick, J.
    pub(super) held_j: f64,
    /// Work of what guards and limits of a device take away, J.
    pub(super) limited_j: f64,
    pub(super) beyond: Beyond,
    pub(super) fastest_rad_s: f64,
}

impl Reached {
    /// Accounts for the velocity of the shaft as the next tick begins, rad/s.
    #[inline]
    pub(super) fn note_speed(&mut self, omega_rad_s: f64) {
        note_speed(&mut self.fastest_rad_s, omega_rad_s);
    }

    /// Accounts for a tick of the mechanics: impulse that the hand felt, without impacts, and the
    /// way of the shaft with the torque that was held.
    #[inline]
    pub(super) fn note_motion(&mut self, felt_nms: f64, turned_rad: f64) {
        self.felt_nm = felt_nms / self.tick_s;
        self.felt.add(self.felt_nm);
        self.held_j += self.command.joint_nm * turned_rad;
    }

    /// Ends a tick.
    #[inline]
    pub(super) fn end_tick(&mut self, time_s: f64) {
        self.time_s = time_s;
        self.beyond
            .note(self.command.asked_nm, (time_s, self.tick_s));
    }
}

/// Accounts for a velocity of the shaft, rad/s, in the fastest so far.
#[inline]
pub(super) fn note_speed(fastest_rad_s: &mut f64, omega_rad_s: f64) {
    let speed_rad_s = omega_rad_s.abs();
    if speed_rad_s > *fastest_rad_s {
        *fastest_rad_s = speed_rad_s;
    }
}
