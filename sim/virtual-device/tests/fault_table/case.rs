//! A cause of a fault, and its repair.

use crate::support::Host;
use crepitus_protocol::State;
use crepitus_protocol::counters::{CommsCounter, DriveCounter};
use crepitus_protocol::telemetry::Block;
use crepitus_virtual_device::leg::CurrentPath;
use std::ops::Range;

/// Lag of the estimated speed behind a hand's, ticks, with a margin.
pub(crate) const ESTIMATE_TICKS: u64 = 150;

/// A torque whose current is worth measuring: 1.1 N·m.
const HEAVY: &[(&str, f64)] = &[
    ("crepitus.inertia_kg_m2", 0.03),
    ("crepitus.static_torque_nm", 1.1),
    ("crepitus.kinetic_torque_nm", 1.0),
];

/// A current loop that takes 30 ms.
pub(crate) const SLOW_LOOP: &[(&str, f64)] = &[("motor.bandwidth_hz", 5.0)];

/// Moment at which the cause comes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Moment {
    /// Moment under torque.
    Armed,
    /// Moment before arming, which finds the cause.
    Arming,
    /// Moment while the bridge floats.
    Disarmed,
}

/// A cause.
pub(crate) struct Case {
    /// Description of what happens.
    pub(crate) name: &'static str,
    /// Parameters that are set, and their values.
    pub(crate) values: &'static [(&'static str, f64)],
    /// Moment of the cause.
    pub(crate) moment: Moment,
    /// Armed: what is waited for.
    pub(crate) settled: fn(&Host) -> bool,
    /// Further ticks to wait; each number of them is one trial.
    pub(crate) phases: Range<u64>,
    /// Falsification of the drive's blocks, from the first tick on.
    pub(crate) falsify: Option<fn(&mut Block)>,
    /// The cause, before each tick; ticks since the first.
    pub(crate) cause: fn(&mut Host, u64),
    /// Whether it has come to what the table calls the cause.
    pub(crate) onset: fn(&Host) -> bool,
    /// Ticks that it takes to be seen, beside what the table says.
    pub(crate) lag: u64,
    /// The repair.
    pub(crate) repair: fn(&mut Host),
}

/// Returns a case under torque, on a leg that is being flexed.
pub(crate) fn case(name: &'static str, cause: fn(&mut Host, u64), repair: fn(&mut Host)) -> Case {
    Case {
        name,
        values: &[],
        moment: Moment::Armed,
        settled: moves,
        phases: 0..20,
        falsify: None,
        cause,
        onset: |_| true,
        lag: 0,
        repair,
    }
}

impl Case {
    pub(crate) fn when(self, moment: Moment) -> Self {
        Self {
            moment,
            // Nothing moves: one is like the other.
            phases: 0..3,
            ..self
        }
    }

    /// Returns the case with its cause at this moment, which is the worst, or a little later.
    pub(crate) fn settled(self, settled: fn(&Host) -> bool) -> Self {
        Self {
            settled,
            phases: 0..3,
            ..self
        }
    }

    pub(crate) fn onset(self, onset: fn(&Host) -> bool) -> Self {
        Self { onset, ..self }
    }

    pub(crate) fn lag(self, lag: u64) -> Self {
        Self { lag, ..self }
    }

    /// Returns the case with much torque, and its cause while the motor pulls.
    pub(crate) fn heavy(self) -> Self {
        Self {
            values: HEAVY,
            settled: pulls,
            ..self
        }
    }
}

/// The leg is being flexed at more than 0.9 rad/s.
fn moves(host: &Host) -> bool {
    host.device.board().leg().shaft().omega_rad_s > 0.9
}

/// The motor's current is large.
fn pulls(host: &Host) -> bool {
    host.device.board().leg().winding_current_a().abs() > 0.28
}

/// A heartbeat has just been heard, and the leg is being flexed.
pub(crate) fn heartbeat(host: &Host) -> bool {
    changes(host, host.drive_count(DriveCounter::Heartbeats)) && moves(host)
}

/// The lease has just been renewed, and the leg is being flexed.
pub(crate) fn renewal(host: &Host) -> bool {
    changes(host, host.comms_count(CommsCounter::Renewals)) && moves(host)
}

/// Returns whether this is another number than a tick before.
fn changes(host: &Host, now: u32) -> bool {
    host.watched.replace(now) != now
}

/// The two sensors of the current differ by more than they may.
pub(crate) fn disagrees(host: &Host) -> bool {
    let leg = host.device.board().leg();
    (leg.current_a(CurrentPath::Sensor) - leg.current_a(CurrentPath::Monitor)).abs() > 0.2
}

/// The drive has let go.
pub(crate) fn is_disarmed(host: &Host) -> bool {
    host.device.board().drive().state() != State::Armed
}
