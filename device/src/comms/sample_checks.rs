//! Checks of the drive's samples by comms.
//!
//! The drive checks the same sooner, and more. These are for a drive that does
//! not react and still sends, because its program or its memory is wrong. So the
//! debounce of each is longer than the drive's.

use crate::drive::plausibility::TRIP_A;
use crate::drive::prepare::held_rad_s_per_volt;
use crepitus_model::Real;
use crepitus_protocol::telemetry::{BLOCK_TICKS, Block, NO_CURRENT, Sample, SampleFlags};
use crepitus_protocol::{DeviceSettings, Fault, LimitReason, State, TICK_S};

/// Consecutive samples with too much current or torque: the drive takes two.
const BEYOND_SAMPLES: u32 = 4;

/// Consecutive samples whose current is not that of their torque: the drive takes
/// a hundred.
const BESIDE_SAMPLES: u32 = 120;

/// Consecutive blocks that are too fast, and how much faster than the limit: the
/// drive takes one, and its estimate lags.
const FAST_BLOCKS: u32 = 3;
const FAST_SHARE: f64 = 1.15;

/// Largest deviation of the current from that of the torque, A.
const CURRENT_SLACK_A: f32 = 0.25;

/// Bounds that follow from parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// What no model of these symptoms exceeds, N·m.
    model_torque_nm: f32,
    /// Of the motor, N·m.
    torque_nm: f32,
    /// Counts of the encoder in a block.
    counts: f32,
    /// Current for a torque, A/(N·m).
    amperes_per_nm: f32,
    /// Ends of the range of motion, counts from the angle's zero.
    range: (i32, i32),
}

#[expect(clippy::cast_possible_truncation, reason = "rounded to f32, once")]
fn single(value: f64) -> f32 {
    value as f32
}

impl Bounds {
    /// Nothing is allowed.
    pub const NONE: Self = Self {
        model_torque_nm: 0.0,
        torque_nm: 0.0,
        counts: 0.0,
        amperes_per_nm: 0.0,
        range: (i32::MAX, i32::MIN),
    };

    /// Of settings.
    pub fn of(settings: &DeviceSettings) -> Self {
        /// For rounding.
        const MARGIN: f64 = 1.001;
        let joint = settings.crepitus.as_ref().map(|joint| &joint.parameters);
        let most_nm = settings.effects.torque_bound_nm(joint);
        let rad_per_count = settings.encoder.rad_per_count();
        let held_rad_s = held_rad_s_per_volt(settings) * settings.current_loop.supply_v;
        let speed_rad_s = settings.limits.speed_rad_s.at_most(held_rad_s);
        let rad = FAST_SHARE * speed_rad_s * TICK_S * f64::from(BLOCK_TICKS);
        Self {
            model_torque_nm: single(most_nm * MARGIN),
            torque_nm: single(settings.limits.torque_nm * MARGIN),
            counts: single(rad / rad_per_count + 2.0),
            amperes_per_nm: single(1.0 / settings.joint_constant()),
            range: settings.range_counts(),
        }
    }

    /// The wider of two bounds. The motor's constant changes only while disarmed.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        Self {
            model_torque_nm: self.model_torque_nm.at_least(other.model_torque_nm),
            torque_nm: self.torque_nm.at_least(other.torque_nm),
            counts: self.counts.at_least(other.counts),
            amperes_per_nm: other.amperes_per_nm,
            range: (
                self.range.0.min(other.range.0),
                self.range.1.max(other.range.1),
            ),
        }
    }
}

/// Consecutive samples with torque of a drive that says it is not armed: a block may be
/// the last one of it, with as many samples less one.
const ASTRAY_SAMPLES: u32 = 24;

/// Blocks between two counts of which the speed follows.
const MOST_GAP: u64 = 10;

/// The checks and their debounce counters.
#[derive(Clone, Copy, Debug, Default)]
pub struct SampleChecks {
    overcurrent: u32,
    beyond: u32,
    beside: u32,
    outside: u32,
    astray: u32,
    fast_blocks: u32,
    /// The block before was of a drive that said it was armed.
    was_live: bool,
    /// End of the last block whose counts are sound, and its last count.
    last: Option<(u64, i32)>,
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
        // The state and the zero are those at a block's end: in the last one with torque they may
        // be what the drive has just found.
        let is_last = core::mem::replace(&mut self.was_live, is_live) && !is_live;
        let range = (block.flags.is_zeroed()).then_some(bounds.range);
        // A leg that coasts fast drives a current through a bridge that floats.
        let is_slow = speed.is_none_or(|counts| counts <= 0.5 * bounds.counts);
        let floats = block.flags.state() == State::Armed && is_slow;
        let fault = (block.samples.iter()).find_map(|sample| {
            let fault = self.sample(sample, bounds, is_last, floats);
            let fault = fault.or_else(|| is_live.then(|| self.place(sample, range))?);
            fault.or_else(|| self.state(sample, is_live))
        });
        // A leg that coasts may be fast.
        fault.or_else(|| self.speed(speed.filter(|_| is_live), bounds))
    }

    /// `floats`: where the bridge is not driven, there is no current.
    fn sample(
        &mut self,
        sample: &Sample,
        bounds: &Bounds,
        is_last: bool,
        floats: bool,
    ) -> Option<Fault> {
        let current_a =
            (sample.current_ma != NO_CURRENT).then(|| f32::from(sample.current_ma) * 1e-3);
        let is_over = current_a.is_some_and(|a| a.abs() > TRIP_A);
        // A sensor that is stuck goes on when the drive has let go.
        if held(&mut self.overcurrent, is_over && !is_last) >= BEYOND_SAMPLES {
            return Some(Fault::CommsOvercurrent);
        }
        // A NaN is beyond every bound.
        let within = |value: f32, most: f32| value.abs() <= most;
        let is_energised = sample.flags.has(SampleFlags::ENERGISED);
        let is_beyond = is_energised
            && !(within(sample.torque_nm, bounds.torque_nm)
                && within(sample.model_torque_nm, bounds.model_torque_nm));
        if held(&mut self.beyond, is_beyond) >= BEYOND_SAMPLES {
            return Some(Fault::TorqueBeyondBounds);
        }
        let is_limited = matches!(
            sample.flags.limit(),
            LimitReason::Voltage | LimitReason::Current
        );
        // A drive without a current lets the bridge float: one that does not is beside it, too.
        let is_that_of_torque = current_a.is_some_and(|a| {
            let off_a = a + sample.torque_nm * bounds.amperes_per_nm;
            within(off_a, CURRENT_SLACK_A)
        });
        let flows = || current_a.is_some_and(|a| !within(a, CURRENT_SLACK_A));
        let is_beside = if is_energised {
            !is_that_of_torque
        } else {
            floats && flows()
        };
        // A limited sample neither counts nor makes up for others.
        if !is_limited && held(&mut self.beside, is_beside) >= BESIDE_SAMPLES {
            return Some(Fault::CurrentBesideTorque);
        }
        None
    }

    fn place(&mut self, sample: &Sample, range: Option<(i32, i32)>) -> Option<Fault> {
        let is_inside = range.is_some_and(|(least, most)| (least..=most).contains(&sample.count));
        let has_torque = sample.flags.has(SampleFlags::ENERGISED) && sample.torque_nm != 0.0;
        let is_outside = has_torque && !is_inside;
        (held(&mut self.outside, is_outside) >= BEYOND_SAMPLES).then_some(Fault::TorqueOutsideRange)
    }

    fn state(&mut self, sample: &Sample, is_live: bool) -> Option<Fault> {
        let is_astray = !is_live && sample.flags.has(SampleFlags::ENERGISED);
        (held(&mut self.astray, is_astray) >= ASTRAY_SAMPLES).then_some(Fault::TorqueBeyondBounds)
    }

    /// Counts for a block since the last sound one. `None` if this one is not sound, which is
    /// the drive's to judge, or the last one long ago.
    fn counts(&mut self, block: &Block) -> Option<f32> {
        let is_sound = (block.samples.iter()).all(|sample| !sample.flags.has(SampleFlags::LOST));
        if !is_sound {
            return None;
        }
        let end = block.end_tick();
        let count = block.samples.last().map_or(0, |sample| sample.count);
        let (last_end, last_count) = self.last.replace((end, count))?;
        let ticks = end.checked_sub(last_end)?;
        if !(1..=MOST_GAP * u64::from(BLOCK_TICKS)).contains(&ticks) {
            return None;
        }
        #[expect(clippy::cast_precision_loss, reason = "some hundreds")]
        let (counts, ticks) = (
            count.wrapping_sub(last_count).unsigned_abs() as f32,
            ticks as f32,
        );
        #[expect(clippy::cast_precision_loss, reason = "20")]
        let block_ticks = BLOCK_TICKS as f32;
        Some(counts * block_ticks / ticks)
    }

    fn speed(&mut self, counts: Option<f32>, bounds: &Bounds) -> Option<Fault> {
        // Of a block without them nothing is known.
        let is_fast = counts? > bounds.counts;
        (held(&mut self.fast_blocks, is_fast) >= FAST_BLOCKS).then_some(Fault::CommsOverspeed)
    }
}

/// Counts for how many times in a row a condition holds.
fn held(count: &mut u32, condition: bool) -> u32 {
    *count = if condition {
        count.saturating_add(1)
    } else {
        0
    };
    *count
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_protocol::Values;
    use crepitus_protocol::telemetry::BlockFlags;

    fn bounds() -> Bounds {
        Bounds::of(&DeviceSettings::of(&Values::default()).unwrap())
    }

    /// Blocks of one sample until a fault.
    fn blocks_until(sample: impl Fn(i32) -> Sample, state: State) -> Option<(Fault, usize)> {
        let mut checks = SampleChecks::default();
        (0..50).find_map(|n| {
            let block = Block {
                first_tick: u64::try_from(n).unwrap() * 20,
                flags: BlockFlags::new(state, true, 1),
                samples: core::array::from_fn(|k| sample(n * 20 + i32::try_from(k).unwrap())),
                ..Block::default()
            };
            let fault = checks.check(&block, &bounds(), state == State::Armed)?;
            Some((fault, usize::try_from(n).unwrap() + 1))
        })
    }

    fn armed(sample: impl Fn(i32) -> Sample) -> Option<(Fault, usize)> {
        assert_eq!(blocks_until(&sample, State::Disarmed), None);
        blocks_until(sample, State::Armed)
    }

    fn energised(torque_nm: f32) -> Sample {
        Sample {
            torque_nm,
            #[expect(clippy::cast_possible_truncation, reason = "a small number")]
            current_ma: (-torque_nm / (0.0389 * 86.0) * 1e3) as i16,
            flags: SampleFlags(SampleFlags::ENERGISED),
            ..Sample::default()
        }
    }

    #[test]
    fn what_parameters_allow_is_no_fault() {
        for torque_nm in [-4.5, -0.4, 0.0, 4.5] {
            let model_torque_nm = 0.4_f32.copysign(torque_nm);
            let sample = |n| Sample {
                count: n * 9,
                model_torque_nm,
                ..energised(torque_nm)
            };
            assert_eq!(armed(sample), None);
        }
    }

    #[test]
    fn too_much_of_anything_is_a_fault() {
        let over = |_| Sample {
            current_ma: -1_960,
            ..Sample::default()
        };
        assert_eq!(armed(over), Some((Fault::CommsOvercurrent, 1)));
        let beyond = Some((Fault::TorqueBeyondBounds, 1));
        assert_eq!(armed(|_| energised(4.51)), beyond);
        assert_eq!(armed(|_| energised(f32::NAN)), beyond);
        let model = |_| Sample {
            model_torque_nm: -0.41,
            ..energised(0.1)
        };
        assert_eq!(armed(model), beyond);
        let beside = |_| Sample {
            current_ma: 300,
            ..energised(0.0)
        };
        assert_eq!(armed(beside), Some((Fault::CurrentBesideTorque, 6)));
        // Also of a drive that says that it drives nothing, but for a leg that coasts fast.
        let floating = |counts: i32| {
            move |n: i32| Sample {
                count: n * counts,
                flags: SampleFlags::default(),
                ..beside(n)
            }
        };
        assert_eq!(armed(floating(0)), Some((Fault::CurrentBesideTorque, 6)));
        assert_eq!(armed(floating(3)), Some((Fault::CurrentBesideTorque, 6)));
        assert_eq!(armed(floating(7)), None);
        assert_eq!(blocks_until(floating(0), State::Arming), None);
        // 5.73 rad/s are 8.0 counts a tick, with 15 % and the bound's two counts 9.4.
        let fast = |n: i32| Sample {
            count: n * 10,
            ..energised(0.0)
        };
        assert_eq!(armed(fast), Some((Fault::CommsOverspeed, 4)));
        // Also where the voltage is at its limit, which excuses the current.
        let limited = |n| Sample {
            flags: fast(n).flags.with_limit(LimitReason::Voltage),
            ..fast(n)
        };
        assert_eq!(armed(limited), Some((Fault::CommsOverspeed, 4)));
    }

    #[test]
    fn torque_outside_the_range_or_without_a_zero_is_a_fault() {
        // 61,155 counts are 125°, −2,446 are −5°.
        let outside = Some((Fault::TorqueOutsideRange, 1));
        for (count, torque_nm, expected) in [
            (61_155, 0.1, None),
            (61_156, 0.1, outside),
            (61_156, 0.0, None),
            (-2_446, -0.1, None),
            (-2_447, -0.1, outside),
            (i32::MIN, 0.1, outside),
        ] {
            let sample = |_| Sample {
                count,
                ..energised(torque_nm)
            };
            assert_eq!(armed(sample), expected, "{count}");
        }
        let block = Block {
            flags: BlockFlags::new(State::Armed, false, 1),
            samples: [energised(0.1); 20],
            ..Block::default()
        };
        let fault = SampleChecks::default().check(&block, &bounds(), true);
        assert_eq!(fault, Some(Fault::TorqueOutsideRange));
    }

    #[test]
    fn what_the_drive_stops_by_itself_is_no_fault_of_comms() {
        // Three samples, and then it has reacted.
        let over = |n: i32| Sample {
            current_ma: if n % 20 < 3 { 2_400 } else { 0 },
            ..Sample::default()
        };
        assert_eq!(armed(over), None);
        let fast = |n: i32| Sample {
            count: n.min(60) * 10,
            ..energised(0.0)
        };
        assert_eq!(armed(fast), None);
    }

    #[test]
    fn limited_samples_and_gaps_excuse() {
        let limited = |_| Sample {
            current_ma: 300,
            flags: energised(0.0).flags.with_limit(LimitReason::Voltage),
            ..energised(0.0)
        };
        assert_eq!(armed(limited), None);
        let mut checks = SampleChecks::default();
        for n in 0..50 {
            let block = Block {
                first_tick: u64::try_from(n).unwrap() * 240,
                flags: BlockFlags::new(State::Armed, true, 1),
                samples: [Sample {
                    count: n * 100_000,
                    ..Sample::default()
                }; 20],
                ..Block::default()
            };
            assert_eq!(checks.check(&block, &bounds(), true), None);
        }
    }

    /// The checks do not depend on the state that the drive reports.
    #[test]
    fn a_drive_that_says_it_is_not_armed_is_checked_while_the_line_is_on() {
        let check = |sample: Sample, line_is_on: bool| {
            let mut checks = SampleChecks::default();
            (0..10).find_map(|n| {
                let block = Block {
                    first_tick: n * 20,
                    flags: BlockFlags::new(State::Disarmed, true, 1),
                    samples: [sample; 20],
                    ..Block::default()
                };
                let fault = checks.check(&block, &bounds(), line_is_on)?;
                Some((fault, n + 1))
            })
        };
        let over = Sample {
            current_ma: 2_000,
            ..Sample::default()
        };
        for (sample, found) in [
            (over, (Fault::CommsOvercurrent, 1)),
            (energised(5.0), (Fault::TorqueBeyondBounds, 1)),
            (energised(0.3), (Fault::TorqueBeyondBounds, 2)),
        ] {
            assert_eq!(check(sample, true), Some(found));
            assert_eq!(check(sample, false), None);
        }
        assert_eq!(check(Sample::default(), true), None);
    }

    /// The last block of an honest drive, wherever in it torque ends, and whatever it has found:
    /// that the zero is lost, or a current that stays.
    #[test]
    fn what_a_drive_has_just_found_is_no_second_fault() {
        for (last, zeroed) in (0..20).flat_map(|last| [(last, true), (last, false)]) {
            let mut checks = SampleChecks::default();
            for n in 0..6 {
                let is_last = n == 3;
                let state = if n < 3 { State::Armed } else { State::Faulted };
                let after = Sample {
                    current_ma: if is_last { 2_500 } else { 0 },
                    ..Sample::default()
                };
                let block = Block {
                    first_tick: n * 20,
                    flags: BlockFlags::new(state, zeroed || n < 3, 1),
                    samples: core::array::from_fn(|k| {
                        if n < 3 || is_last && k < last {
                            energised(0.3)
                        } else {
                            after
                        }
                    }),
                    ..Block::default()
                };
                assert_eq!(checks.check(&block, &bounds(), true), None, "{last} {n}");
            }
        }
    }

    #[test]
    fn torque_without_a_current_is_beside_it() {
        let without = |n: i32| Sample {
            current_ma: if n % 4 == 0 { NO_CURRENT } else { 1_200 },
            ..energised(0.2)
        };
        assert_eq!(armed(without), Some((Fault::CurrentBesideTorque, 6)));
    }

    /// Every second block lost, and every second one with a lost count.
    #[test]
    fn a_runaway_is_seen_through_gaps() {
        for (step, lost_every) in [(2, 0), (1, 2), (3, 0)] {
            let mut checks = SampleChecks::default();
            let found = (0..40).step_by(step).position(|n: i32| {
                let is_lost = lost_every > 0 && n % lost_every == 1;
                let block = Block {
                    first_tick: u64::try_from(n).unwrap() * 20,
                    flags: BlockFlags::new(State::Armed, true, 1),
                    samples: core::array::from_fn(|k| Sample {
                        count: (n * 20 + i32::try_from(k).unwrap()) * 12,
                        flags: energised(0.0)
                            .flags
                            .with(SampleFlags::LOST, is_lost && k == 7),
                        ..energised(0.0)
                    }),
                    ..Block::default()
                };
                checks.check(&block, &bounds(), true) == Some(Fault::CommsOverspeed)
            });
            assert!(
                found.is_some_and(|n| n <= 7),
                "{step} {lost_every} {found:?}"
            );
        }
    }
}
