//! Checks of the drive's samples by comms.
//!
//! The drive checks the same sooner, and more. These are for a drive that does
//! not react and still sends, because its program or its memory is wrong. So the
//! debounce of each is longer than the drive's, and none is switched off by what
//! the drive says of itself: a limit that it reports, or a count that it reports
//! as lost.
//!
//! A condition counts up with each sample that meets it and down with each that
//! does not: what most samples meet is found, also if single ones between do not.

mod bounds;

pub use bounds::Bounds;

use crate::board::TRIP_A;
use crepitus_model::Real;
use crepitus_protocol::telemetry::{BLOCK_TICKS, Block, NO_CURRENT, Sample, SampleFlags};
use crepitus_protocol::{Fault, State};

/// Samples with too much current or torque, less those without: the drive takes two.
const BEYOND_SAMPLES: u32 = 4;

/// Blocks that are too fast, less those that are not: the drive takes one.
const FAST_BLOCKS: u32 = 3;

/// Largest deviation of the current from that of the torque, A.
const CURRENT_SLACK_A: f32 = 0.25;

/// The most that a sample adds to the [sum](Deviation) of what is beyond that, A, and the
/// samples of as much until the fault: the drive takes a hundred.
const DEVIATION_A: f32 = 0.125;
const DEVIATING_SAMPLES: f64 = 120.0;

/// Samples without a plausible count until the fault, and how many with one make up for
/// one: the drive takes twenty, and as many.
const LOST_SAMPLES: u32 = 40;
const MAKE_UP_FOR_LOST: u32 = 8;
const LOST: u32 = LOST_SAMPLES * MAKE_UP_FOR_LOST;

/// Samples with torque of a drive that says it is not armed, less those without: a block may
/// be the last one of it, with as many samples less one.
const ASTRAY_SAMPLES: u32 = 24;

/// Ticks between two counts of which the speed follows: in fewer a single count is too much.
const LEAST_GAP: u64 = 10;
const MOST_GAP: u64 = 200;

/// Sum over samples of the current's deviation from the setpoint, less [`CURRENT_SLACK_A`],
/// above and below it, A times samples.
///
/// Torque that rises and breaks in turn has a current that lags behind it for most of the time:
/// its deviations have both senses, and sum up to nothing. So what deviates the other way makes
/// up for as much. What deviates by an eighth of an ampere beyond the slack or more counts
/// alike, so that this takes longer than the drive does; and so does what is within it.
#[derive(Clone, Copy, Debug, Default)]
struct Deviation {
    above: f32,
    below: f32,
}

impl Deviation {
    /// Adds a sample, `None` for one that lacks its current; true once there is too much.
    fn reaches(&mut self, off_a: Option<f32>, most: f32) -> bool {
        let beyond = |off_a: f32| {
            let beyond_a = off_a - CURRENT_SLACK_A;
            if off_a < -CURRENT_SLACK_A {
                beyond_a
            } else {
                beyond_a.within(DEVIATION_A)
            }
        };
        let (above, below) = off_a.map_or((DEVIATION_A, DEVIATION_A), |off_a| {
            (beyond(off_a), beyond(-off_a))
        });
        self.above = (self.above + above).at_least(0.0).at_most(most);
        self.below = (self.below + below).at_least(0.0).at_most(most);
        self.above >= most || self.below >= most
    }
}

/// The checks and their debounce counters.
#[derive(Clone, Copy, Debug, Default)]
pub struct SampleChecks {
    overcurrent: u32,
    beyond: u32,
    deviation: Deviation,
    outside: u32,
    astray: u32,
    /// Debounce count of lost samples, in the parts of one that a sample with a count makes up for.
    lost: u32,
    fast_blocks: u32,
    /// The block before was of a drive that said it was armed.
    was_live: bool,
    /// Tick of the last count that was not lost, and the count.
    last: Option<(u64, i32)>,
}

/// A block, as its samples need it.
#[derive(Clone, Copy, Debug)]
struct Context {
    /// The last one of a drive that was armed.
    is_last: bool,
    /// The bridge floats wherever it is not driven: no current is expected.
    floats: bool,
    /// Counts in a block, if known.
    speed: Option<f32>,
}

impl SampleChecks {
    /// Checks a block that is newer than the one before. While the enable line of comms is
    /// off no torque is possible, and nothing is checked of a drive that says so.
    pub fn check(&mut self, block: &Block, bounds: &Bounds, line_is_on: bool) -> Option<Fault> {
        let speed = self.counts(block);
        let is_live = matches!(block.flags.state(), State::Arming | State::Armed);
        if !is_live && !line_is_on {
            *self = Self {
                last: self.last,
                was_live: is_live,
                ..Self::default()
            };
            return None;
        }
        // A leg that coasts fast drives a current through a bridge that floats.
        let is_slow = speed.is_none_or(|counts| counts <= 0.5 * bounds.counts);
        let context = Context {
            // The state and the zero are those at a block's end: in the last one with torque they
            // may be what the drive has just found.
            is_last: core::mem::replace(&mut self.was_live, is_live) && !is_live,
            floats: block.flags.state() == State::Armed && is_slow,
            speed,
        };
        let range = (block.flags.is_zeroed()).then_some(bounds.range);
        let fault = (block.samples.iter()).find_map(|sample| {
            let fault = self.sample(sample, bounds, &context);
            let fault = fault.or_else(|| is_live.then(|| self.place(sample, range))?);
            fault.or_else(|| self.state(sample, is_live))
        });
        // A leg that coasts may be fast.
        fault.or_else(|| self.speed(speed.filter(|_| is_live), bounds))
    }

    fn sample(&mut self, sample: &Sample, bounds: &Bounds, context: &Context) -> Option<Fault> {
        let current_a =
            (sample.current_ma != NO_CURRENT).then(|| f32::from(sample.current_ma) * 1e-3);
        let is_over = current_a.is_some_and(|a| a.abs() > TRIP_A);
        // A sensor that is stuck goes on when the drive has let go.
        if !context.is_last && prevails(&mut self.overcurrent, is_over, BEYOND_SAMPLES) {
            return Some(Fault::CommsOvercurrent);
        }
        let is_energised = sample.flags.has(SampleFlags::ENERGISED);
        let is_beyond = is_energised && !bounds.allow(sample);
        if prevails(&mut self.beyond, is_beyond, BEYOND_SAMPLES) {
            return Some(Fault::TorqueBeyondBounds);
        }
        let setpoint_a = (-sample.torque_nm * bounds.amperes_per_nm).within(bounds.setpoint_a);
        let lacks_voltage =
            (context.speed).is_some_and(|counts| bounds.lacks_voltage(counts, setpoint_a));
        // What says nothing neither counts nor makes up for others. A drive without a current lets
        // the bridge float: one that does not deviates, too.
        let is_judged = if is_energised {
            !lacks_voltage
        } else {
            context.floats && current_a.is_some()
        };
        let off_a = current_a.map(|a| if is_energised { a - setpoint_a } else { a });
        let off_a = off_a.filter(|off_a| off_a.is_finite());
        let deviates = is_judged && self.deviation.reaches(off_a, bounds.deviation);
        deviates.then_some(Fault::CurrentBesideTorque)
    }

    /// Torque needs a place within the range, and a count that says so.
    fn place(&mut self, sample: &Sample, range: Option<(i32, i32)>) -> Option<Fault> {
        let is_inside = range.is_some_and(|(least, most)| (least..=most).contains(&sample.count));
        let is_energised = sample.flags.has(SampleFlags::ENERGISED);
        let is_outside = is_energised && sample.torque_nm != 0.0 && !is_inside;
        if is_energised {
            self.lost = if sample.flags.has(SampleFlags::LOST) {
                self.lost.saturating_add(MAKE_UP_FOR_LOST).min(LOST)
            } else {
                self.lost.saturating_sub(1)
            };
        }
        let is_lost = self.lost >= LOST;
        let is_outside = prevails(&mut self.outside, is_outside, BEYOND_SAMPLES);
        (is_outside || is_lost).then_some(Fault::TorqueOutsideRange)
    }

    fn state(&mut self, sample: &Sample, is_live: bool) -> Option<Fault> {
        let is_astray = !is_live && sample.flags.has(SampleFlags::ENERGISED);
        let has_torque = prevails(&mut self.astray, is_astray, ASTRAY_SAMPLES);
        has_torque.then_some(Fault::TorqueBeyondBounds)
    }

    /// Counts for a block between the last count that is not lost and that of the blocks
    /// before. `None` if this one has none, or the other is long ago.
    fn counts(&mut self, block: &Block) -> Option<f32> {
        let (tick, sample, _) = (block.ticks())
            .filter(|(_, sample, _)| !sample.flags.has(SampleFlags::LOST))
            .last()?;
        let (last_tick, last_count) = *self.last.get_or_insert((tick, sample.count));
        let ticks = tick.saturating_sub(last_tick);
        if ticks < LEAST_GAP {
            return None;
        }
        self.last = Some((tick, sample.count));
        if ticks > MOST_GAP {
            return None;
        }
        #[expect(clippy::cast_precision_loss, reason = "some hundreds")]
        let (counts, ticks) = (
            sample.count.wrapping_sub(last_count).unsigned_abs() as f32,
            ticks as f32,
        );
        #[expect(clippy::cast_precision_loss, reason = "20")]
        let block_ticks = BLOCK_TICKS as f32;
        Some(counts * block_ticks / ticks)
    }

    fn speed(&mut self, counts: Option<f32>, bounds: &Bounds) -> Option<Fault> {
        // Of a block without them nothing is known.
        let is_fast = counts? > bounds.counts;
        prevails(&mut self.fast_blocks, is_fast, FAST_BLOCKS).then_some(Fault::CommsOverspeed)
    }
}

/// Counts a condition up where it holds and down where it does not; true once it has held so
/// many times more.
fn prevails(count: &mut u32, condition: bool, most: u32) -> bool {
    *count = if condition {
        count.saturating_add(1).min(most)
    } else {
        count.saturating_sub(1)
    };
    *count >= most
}

#[cfg(test)]
mod tests;
