//! Samples of the drive, tick by tick, and those that arrive.

use crepitus_client::{Accounting, Begin};
use crepitus_device::drive::exchange::Rendered;
use crepitus_model::render::effects::Phases;
use crepitus_protocol::LimitReason;
use crepitus_protocol::host::Answer;
use crepitus_protocol::telemetry::{BLOCK_SAMPLES, Block, NO_CURRENT, Sample, SampleFlags};
use std::collections::BTreeMap;

/// Flags of a sample that rendering decides.
const RENDERED: u16 = SampleFlags::PHASE
    | SampleFlags::SETTLING
    | SampleFlags::LOST
    | SampleFlags::BREAK
    | SampleFlags::STICK;

/// A tick of the drive.
#[derive(Clone, Copy)]
pub(super) struct Produced {
    pub(super) rendered: Rendered,
    /// The torque of this tick was the motor's setpoint.
    pub(super) is_energised: bool,
    pub(super) has_current: bool,
}

impl Produced {
    fn compare(&self, sample: &Sample, shown_phases: Phases) {
        let Rendered {
            torque_nm,
            model_torque_nm,
            flags,
            phases,
            ..
        } = self.rendered;
        assert_eq!(shown_phases, phases);
        let torque_nm = if self.is_energised { torque_nm } else { 0.0 };
        assert_eq!(sample.model_torque_nm.to_bits(), model_torque_nm.to_bits());
        if sample.flags.limit() == LimitReason::None {
            assert_eq!(sample.torque_nm.to_bits(), torque_nm.to_bits());
        }
        // At an end of the range a share of it; how much is for a test that knows the
        // range.
        let (shown, most) = (sample.torque_nm, torque_nm);
        assert!(
            shown * most >= 0.0 && shown.abs() <= most.abs(),
            "{sample:?}"
        );
        assert_eq!(sample.flags.0 & RENDERED, flags.0 & RENDERED);
        assert_eq!(sample.flags.has(SampleFlags::ENERGISED), self.is_energised);
        assert_eq!(sample.current_ma != NO_CURRENT, self.has_current);
    }
}

/// A subscription as the client accounts for it.
struct Subscription {
    client: Accounting,
    /// Samples lost on the wire to the host: known to the client, and since the
    /// last block that it received.
    lost: u64,
    lost_since: u64,
    start: u8,
}

/// All ticks of all starts of the drive, and the subscriptions.
#[derive(Default)]
pub(super) struct Samples {
    /// Ticks of the drive, by its start and the tick since.
    produced: BTreeMap<u8, Vec<Produced>>,
    subscriptions: BTreeMap<u32, Subscription>,
}

impl Samples {
    /// A tick of the drive in its start with this number.
    pub(super) fn produced(&mut self, start: u8, tick: Produced) {
        self.produced.entry(start).or_default().push(tick);
    }

    /// A reply that arrives and begins a subscription.
    pub(super) fn subscribed(&mut self, session: u32, answer: &Answer) {
        let Answer::Subscribed {
            first_tick,
            dropped,
            start,
        } = *answer
        else {
            return;
        };
        let begin = Begin {
            first_tick,
            dropped,
            start,
        };
        let subscription = Subscription {
            client: Accounting::new(begin),
            lost: 0,
            lost_since: 0,
            start,
        };
        self.subscriptions.insert(session, subscription);
    }

    /// This session has requested another subscription.
    pub(super) fn end(&mut self, session: u32) {
        self.subscriptions.remove(&session);
    }

    /// The connection was lost.
    pub(super) fn cut(&mut self) {
        self.subscriptions.clear();
    }

    /// A block that comms has sent, and whether it arrives.
    pub(super) fn block(&mut self, block: &Block, arrives: bool) {
        let start = block.flags.start();
        let produced = self.produced.get(&start).expect("a start of the drive");
        let first = usize::try_from(block.first_tick).expect("a small number");
        for ((_, sample, phases), tick) in block.ticks().zip(&produced[first..]) {
            tick.compare(sample, phases);
        }
        assert!(produced.len() >= first + BLOCK_SAMPLES, "of the future");
        for subscription in self.subscriptions.values_mut() {
            subscription.block(block, arrives);
        }
    }
}

impl Subscription {
    fn block(&mut self, block: &Block, arrives: bool) {
        if !arrives {
            self.lost_since += BLOCK_SAMPLES as u64;
            return;
        }
        self.client.take(block);
        // What was lost around a restart of the drive cannot be seen.
        let lost_since = std::mem::take(&mut self.lost_since);
        if self.start == block.flags.start() {
            self.lost += lost_since;
        }
        self.start = block.flags.start();
        assert_eq!(self.client.old_blocks(), 0, "received twice");
        assert_eq!(self.client.violations(), 0, "dropped, and received");
        assert_eq!(self.client.lost_on_line(), self.lost, "lost on the wire");
    }
}
