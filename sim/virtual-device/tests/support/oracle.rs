//! Invariants of every tick, whatever the wires do.
//!
//! The oracle believes only what it sees at the ends: heartbeats and renewals that were
//! counted, the bridge, the values in force at the drive, and the samples that
//! arrive. Neither controller may have restarted meanwhile.

use crepitus_protocol::counters::{CommsCounter, DriveCounter};
use crepitus_protocol::parameters::id;
use crepitus_protocol::telemetry::{Block, SampleFlags};
use crepitus_protocol::{DeviceSettings, HEARTBEAT_TICKS, LEASE_TICKS, Revision, State, Values};
use crepitus_virtual_device::Board;
use std::collections::BTreeMap;

/// Watches a board.
#[derive(Debug)]
pub(crate) struct Oracle {
    /// Every set that was proposed and is whole and allowed.
    proposed: Vec<Values>,
    /// Values that took effect at the drive, by their revision.
    pub(crate) in_force: BTreeMap<u32, Values>,
    revision: Revision,
    heartbeats: u32,
    comms_start: Option<u64>,
    renewals: u32,
    was_arming: bool,
    renewed: Option<u64>,
    pub(crate) driven_ticks: u64,
    /// The longest torque without a heartbeat, and without a renewal.
    pub(crate) longest: [u64; 2],
}

impl Oracle {
    /// Returns an oracle before the first tick of a board with these values kept.
    pub(crate) fn new(board: &Board, kept: Values) -> Self {
        Self {
            proposed: vec![Values::default(), kept],
            in_force: BTreeMap::from([(0, Values::default())]),
            revision: Revision::NONE,
            heartbeats: board.drive().counters().get(DriveCounter::Heartbeats),
            comms_start: None,
            renewals: board.comms().counters().get(CommsCounter::Renewals),
            was_arming: false,
            renewed: None,
            driven_ticks: 0,
            longest: [0; 2],
        }
    }

    /// These values may take effect from now on.
    pub(crate) fn propose(&mut self, values: &Values) {
        assert!(DeviceSettings::of(values).is_ok(), "not to be proposed");
        self.proposed.push(*values);
    }

    /// The last ones were refused, so they may not.
    pub(crate) fn withdraw(&mut self) {
        let refused = self.proposed.pop().expect("a proposal");
        let has_come = self.in_force.values().any(|set| same(set, &refused));
        assert!(!has_come, "refused, and in force");
    }

    /// The device says that they are in force.
    pub(crate) fn committed(&self, revision: Revision, values: &Values) {
        let in_force = self.in_force.get(&revision.0);
        assert!(
            in_force.is_some_and(|set| same(set, values)),
            "revision {revision} is not what was committed"
        );
    }

    /// Checks the board after a tick.
    pub(crate) fn look(&mut self, board: &Board) {
        let now = board.now();
        let heartbeats = board.drive().counters().get(DriveCounter::Heartbeats);
        if heartbeats != self.heartbeats {
            (self.heartbeats, self.comms_start) = (heartbeats, Some(now));
        }
        let renewals = board.comms().counters().get(CommsCounter::Renewals);
        let is_arming = board.comms().state() == State::Arming;
        if renewals != self.renewals || is_arming && !self.was_arming {
            (self.renewals, self.renewed) = (renewals, Some(now));
        }
        self.was_arming = is_arming;
        if board.is_driven() {
            self.driven_ticks += 1;
            let limits = [HEARTBEAT_TICKS, LEASE_TICKS];
            for (i, last) in [self.comms_start, self.renewed].into_iter().enumerate() {
                let silence = now - last.expect("torque before the first word");
                assert!(
                    silence < limits[i],
                    "torque {silence} ticks after the last {}",
                    ["heartbeat", "renewal"][i]
                );
                self.longest[i] = self.longest[i].max(silence);
            }
        }
        self.look_at_values(board);
    }

    fn look_at_values(&mut self, board: &Board) {
        let revision = board.drive().revision();
        if revision != self.revision {
            assert!(
                revision.0.wrapping_sub(self.revision.0).cast_signed() > 0,
                "revision {revision} came into force after {}",
                self.revision
            );
            self.revision = revision;
        }
        // None: the next ones are prepared already.
        let Some(values) = board.drive().values() else {
            return;
        };
        let known = self.in_force.entry(revision.0).or_insert_with(|| {
            assert!(
                self.proposed.iter().any(|set| same(set, values)),
                "revision {revision} was never proposed: {values:?}"
            );
            *values
        });
        assert!(same(known, values), "revision {revision} has changed");
    }

    /// A block has arrived at the host.
    pub(crate) fn block(&self, block: &Block) {
        let revision = block.revision.0;
        let (at, values) = self
            .in_force
            .range(..=revision)
            .next_back()
            .expect("a revision that was in force");
        assert_eq!(*at, revision, "a block of a revision that never was");
        let before = self
            .in_force
            .range(..revision)
            .next_back()
            .map_or(values, |(_, values)| values);
        let now_nm = largest(values);
        let settling_nm = now_nm.max(largest(before));
        for sample in &block.samples {
            let most_nm = if sample.flags.has(SampleFlags::SETTLING) {
                settling_nm
            } else {
                now_nm
            };
            assert!(
                f64::from(sample.model_torque_nm.abs()) <= most_nm * (1.0 + 1e-5) + 1e-6,
                "{} N·m of at most {most_nm} N·m, revision {revision}",
                sample.model_torque_nm
            );
        }
    }
}

/// Ts, or nothing.
fn largest(values: &Values) -> f64 {
    match values.get(id::CREPITUS) {
        Some(0.0) => 0.0,
        _ => values.get(id::STATIC_TORQUE).unwrap_or(0.0),
    }
}

fn same(a: &Values, b: &Values) -> bool {
    a.0.iter()
        .zip(&b.0)
        .all(|(a, b)| a.to_bits() == b.to_bits())
}
