//! Blocks of a device, and recordings of them.

use crepitus_model::render::effects::{Phases, SPECS};
use crepitus_protocol::management::Identity;
use crepitus_protocol::parameters::id;
use crepitus_protocol::telemetry::{
    Block, BlockFlags, CoilCurrent, EffectPhases, NO_CURRENT, Sample, SampleFlags,
};
use crepitus_protocol::{LimitReason, Revision, State, Values};
use crepitus_recording::{Begin, Damage, Metadata, ReadError, Recorder, Recording, Row, Samples};
use std::path::Path;

/// Reasons of the format's first recordings, one of which is kept: those that come later are not drawn.
const FIRST_REASONS: [LimitReason; 9] = {
    let [a, b, c, d, e, f, g, h, i, ..] = LimitReason::ALL;
    [a, b, c, d, e, f, g, h, i]
};

/// Samples that differ from each other, with every flag and phase that there is.
pub(crate) fn block(first_tick: u64, revision: u32, dropped: u32, start: u16) -> Block {
    let mut block = plain(first_tick, revision, dropped, start);
    let mut random = fastrand::Rng::with_seed(!first_tick ^ u64::from(start) << 40);
    for sample in &mut block.samples {
        for bit in [
            SampleFlags::SETTLING,
            SampleFlags::LOST,
            SampleFlags::STICK,
            SampleFlags::CHIRP,
        ] {
            sample.flags = sample.flags.with(bit, random.u8(..8) == 0);
        }
    }
    block.phases = core::array::from_fn(|_| phases(&mut random));
    block
}

/// Mostly all effects are at rest, else up to two are not.
fn phases(random: &mut fastrand::Rng) -> EffectPhases {
    let mut all = Phases::default();
    if random.u8(..4) == 0 {
        for spec in random.choose_multiple(SPECS, 2) {
            if let Some(phases) = spec.phases
                && let Some(name) = random.choice(phases.names)
            {
                all = all.with_named(spec.name, name).unwrap();
            }
        }
    }
    all.into()
}

/// Samples with fewer flags than in [`block`] and all effects at rest, as in the golden file.
pub(crate) fn plain(first_tick: u64, revision: u32, dropped: u32, start: u16) -> Block {
    let mut random = fastrand::Rng::with_seed(first_tick ^ u64::from(start) << 40);
    let angle = |tick: u64| (900.0 * (tick as f64 * 2e-4).sin()) as i32;
    Block {
        sequence: (first_tick / 20) as u16,
        first_tick,
        revision: Revision(revision),
        dropped,
        flags: BlockFlags::new(State::Armed, true, start),
        samples: core::array::from_fn(|n| Sample {
            count: angle(first_tick + n as u64),
            model_torque_nm: random.f32() - 0.5,
            torque_nm: random.f32(),
            current_ma: if random.u8(..) < 200 {
                random.i16(-9_000..9_000)
            } else {
                NO_CURRENT
            },
            flags: SampleFlags::default()
                .with_phase(random.i8(-1..2))
                .with_limit(random.choice(FIRST_REASONS).unwrap_or_default())
                .with(SampleFlags::BREAK, random.bool())
                .with(SampleFlags::LATE, random.bool()),
        }),
        coil_currents: std::array::from_fn(|n| {
            match i16::try_from((first_tick / 20 + n as u64) % 400) {
                Ok(ma) if ma > 0 => CoilCurrent(10 * ma - 2_000),
                _ => CoilCurrent::NONE,
            }
        }),
        ..Block::default()
    }
}

/// Messages of a device, and subscriptions of its host.
#[derive(Clone, Debug)]
pub(crate) enum Sent {
    Subscribed(Begin),
    Parameters(Revision, Box<Values>),
    Block(Box<Block>),
}

/// Returns so many blocks without a loss, but for: 2 blocks that the device drops, one
/// that is lost on the way, a lost connection, a restart of the drive, and
/// parameters that change now and then.
pub(crate) fn sent(blocks: u64) -> Vec<Sent> {
    sent_of(blocks, block)
}

/// Returns the messages of [`sent`], with blocks that are made like this.
pub(crate) fn sent_of(blocks: u64, block: fn(u64, u32, u32, u16) -> Block) -> Vec<Sent> {
    let mut sent = vec![Sent::Subscribed(Begin {
        first_tick: 1_000,
        dropped: 60,
        start: 1,
    })];
    let (mut tick, mut dropped, mut start, mut revision) = (1_000, 60, 1, 0);
    let mut values = Values::default();
    for n in 0..blocks {
        if n % 97 == 0 {
            revision += 1;
            values.set(id::STATIC_TORQUE, 0.4 + 0.001 * f64::from(revision));
            sent.push(Sent::Parameters(Revision(revision), Box::new(values)));
        }
        if n == blocks / 5 {
            (tick, dropped) = (tick + 40, dropped + 40);
        } else if n == 2 * blocks / 5 {
            tick += 20;
        } else if n == 3 * blocks / 5 {
            tick += 4_000;
            dropped += 4_000;
            sent.push(Sent::Subscribed(Begin {
                first_tick: tick,
                dropped,
                start: 1,
            }));
        } else if n == 4 * blocks / 5 {
            (tick, dropped, start) = (20, 20, 2);
        }
        sent.push(Sent::Block(Box::new(block(tick, revision, dropped, start))));
        tick += 20;
    }
    sent
}

pub(crate) fn metadata(title: &str) -> Metadata {
    Metadata::new(title, &Identity::default(), None)
}

/// Hands to a recorder what was sent; it is flushed every few blocks.
pub(crate) fn record<D: crepitus_recording::Disk>(
    recorder: &mut Recorder<D>,
    sent: &[Sent],
) -> Result<(), crepitus_recording::RecordError> {
    for (n, sent) in sent.iter().enumerate() {
        match sent {
            Sent::Subscribed(begin) => recorder.subscribed(*begin)?,
            Sent::Parameters(revision, values) => recorder.announce(*revision, values),
            Sent::Block(block) => recorder.block(block)?,
        }
        if n % 20 == 0 {
            recorder.flush()?;
        }
    }
    Ok(())
}

/// The rows that must be in the file.
pub(crate) fn rows_of(sent: &[Sent]) -> Vec<Row> {
    let mut samples = Samples::default();
    let mut rows = Vec::new();
    for sent in sent {
        match sent {
            Sent::Subscribed(_) => {}
            Sent::Parameters(_, values) => samples.set(values),
            Sent::Block(block) => rows.extend(samples.rows(block)),
        }
    }
    // Whether the bridge was driven follows from the limit in other formats.
    for row in &mut rows {
        let is_armed = row.flags.limit() != LimitReason::NotArmed;
        row.flags = row.flags.with(SampleFlags::ENERGISED, is_armed);
    }
    rows
}

pub(crate) fn recorded(path: &Path, title: &str, sent: &[Sent]) {
    let mut recorder = Recorder::create(path, &metadata(title)).unwrap();
    record(&mut recorder, sent).unwrap();
    recorder.finish().unwrap();
}

pub(crate) fn open(path: &Path) -> Result<Recording, ReadError> {
    Recording::open(path, Damage::Refuse)
}

pub(crate) fn salvaged(path: &Path) -> Recording {
    Recording::open(path, Damage::Salvage).unwrap()
}

pub(crate) fn rows(recording: &Recording) -> Vec<Row> {
    let mut rows: Vec<_> = recording.rows().unwrap().map(Result::unwrap).collect();
    for row in &mut rows {
        let is_armed = row.flags.limit() != LimitReason::NotArmed;
        row.flags = row.flags.with(SampleFlags::ENERGISED, is_armed);
    }
    rows
}

/// The accounting add up, and are those of the rows.
pub(crate) fn check_accounting(recording: &Recording) {
    let totals = recording.accounting().totals;
    assert_eq!(totals.produced, totals.received + totals.dropped);
    assert!(totals.by_device + totals.not_connected + totals.damaged <= totals.dropped);
    assert_eq!(totals.received, rows(recording).len() as u64);
}

/// Every row of `some` is in `all`, in the same order.
pub(crate) fn is_part(some: &[Row], all: &[Row]) -> bool {
    let same = |a: &Row, b: &Row| {
        let key = |row: &Row| {
            (
                row.tick,
                row.count,
                row.model_torque_nm.to_bits(),
                row.torque_nm.to_bits(),
                row.current_a.map(f32::to_bits),
                row.coil_a.map(f32::to_bits),
                row.flags,
                row.phases,
            )
        };
        key(a) == key(b)
    };
    let mut all = all.iter();
    some.iter().all(|row| all.any(|other| same(row, other)))
}

/// Cuts, overwrites, doubles and moves parts of a file.
pub(crate) fn mangled(whole: &[u8], random: &mut fastrand::Rng) -> Vec<u8> {
    let mut bytes = whole.to_vec();
    for _ in 0..random.usize(1..6) {
        let from = random.usize(..bytes.len());
        let to = (from + 1 + random.usize(..30_000)).min(bytes.len());
        let part = bytes[from..to].to_vec();
        match random.u8(..5) {
            // By a byte at least.
            0 => bytes.truncate((to - 1).max(1_000)),
            1 if bytes.len() > 60_000 => drop(bytes.drain(from..to)),
            1 | 2 => bytes[from..to].fill_with(|| random.u8(..)),
            3 => bytes.extend(part),
            _ => drop(bytes.splice(from..from, part)),
        }
    }
    bytes
}
