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

use crate::drive::plausibility::TRIP_A;
use crate::drive::prepare::{LARGEST_DUTY, held_rad_s_per_volt};
use crepitus_model::Real;
use crepitus_protocol::telemetry::{BLOCK_TICKS, Block, NO_CURRENT, Sample, SampleFlags};
use crepitus_protocol::{DeviceSettings, Fault, LimitReason, State, TICK_S};

/// Samples with too much current or torque, less those without: the drive takes two.
const BEYOND_SAMPLES: u32 = 4;

/// Blocks that are too fast, less those that are not, and how much faster than the
/// limit: the drive takes one, and its estimate lags.
const FAST_BLOCKS: u32 = 3;
const FAST_SHARE: f64 = 1.15;

/// Largest deviation of the current from that of the torque, A.
const CURRENT_SLACK_A: f32 = 0.25;

/// The most that a sample adds to the [sum](Deviation) of what is beyond that, A, and the
/// samples of as much until the fault: the drive takes a hundred.
const DEVIATION_A: f32 = 0.125;
const DEVIATING_SAMPLES: f64 = 120.0;

/// Resistance of a winding over that which is assumed, with a margin for a speed that is a
/// block's mean: 80 K warmer is 1.31, and the drive takes 1.5.
const WARM: f64 = 2.0;

/// For rounding of a torque, N·m.
const ROUNDING_NM: f32 = 1e-3;

/// Samples without a plausible count until the fault, and how many with one make up for
/// one: the drive takes twenty, and as many.
const LOST_SAMPLES: u32 = 40;
const MAKE_UP_FOR_LOST: u32 = 8;
const LOST: u32 = LOST_SAMPLES * MAKE_UP_FOR_LOST;

/// Bounds that follow from parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// What no model of these symptoms exceeds, N·m.
    model_torque_nm: f32,
    /// Of the motor, N·m.
    torque_nm: f32,
    /// What the motor may get besides the model's torque, N·m.
    added_nm: f32,
    /// How far that fades in a block at least, N·m.
    fade_nm: f32,
    /// Of the joint alone, N·m.
    joint_nm: f32,
    /// Counts of the encoder in a block.
    counts: f32,
    /// Current for a torque, A/(N·m), and its largest setpoint, A.
    amperes_per_nm: f32,
    setpoint_a: f32,
    /// Sum of deviations of the current, A times samples.
    deviation: f32,
    /// Counts in a block at which the back-EMF is the largest voltage, and counts for
    /// the voltage of an ampere.
    emf_counts: f32,
    counts_per_ampere: f32,
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
        added_nm: 0.0,
        fade_nm: 0.0,
        joint_nm: 0.0,
        counts: 0.0,
        amperes_per_nm: 0.0,
        setpoint_a: 0.0,
        deviation: 0.0,
        emf_counts: f32::INFINITY,
        counts_per_ampere: 0.0,
        range: (i32::MAX, i32::MIN),
    };

    /// Of settings.
    pub fn of(settings: &DeviceSettings) -> Self {
        /// For rounding.
        const MARGIN: f64 = 1.001;
        let joint = settings.crepitus.as_ref().map(|joint| &joint.parameters);
        let joint_nm = joint.map_or(0.0, |joint| joint.static_torque_nm);
        let most_nm = settings.effects.torque_bound_nm(joint);
        let added_nm = settings.effects.added_bound_nm();
        let block_s = TICK_S * f64::from(BLOCK_TICKS);
        let counts_per_rad_s = block_s / settings.encoder.rad_per_count();
        let motor = &settings.current_loop;
        let held_rad_s = held_rad_s_per_volt(settings) * motor.supply_v;
        let speed_rad_s = settings.limits.speed_rad_s.at_most(held_rad_s);
        let constant = settings.joint_constant();
        let emf_rad_s = f64::from(LARGEST_DUTY) * motor.supply_v / constant;
        // The deviations of a loop of first order sum up to what its setpoint has moved, times
        // its lag in ticks, 1/(1 − e^(−x)) < 1 + 1/x: here 11 A. One that is slower has more.
        let lag_ticks = 1.0 + 1.0 / (core::f64::consts::TAU * motor.bandwidth_hz * TICK_S);
        let deviation = DEVIATING_SAMPLES * f64::from(DEVIATION_A);
        Self {
            model_torque_nm: single(most_nm * MARGIN),
            torque_nm: single(settings.limits.torque_nm * MARGIN),
            added_nm: single(added_nm * MARGIN),
            fade_nm: single(settings.limits.slew_nm_per_s * block_s),
            joint_nm: single(joint_nm * MARGIN),
            counts: single(FAST_SHARE * speed_rad_s * counts_per_rad_s + 2.0),
            amperes_per_nm: single(1.0 / constant),
            setpoint_a: single(motor.current_limit_a),
            deviation: single(deviation.at_least(2.0 * motor.current_limit_a * lag_ticks)),
            emf_counts: single(emf_rad_s * counts_per_rad_s - 2.0),
            counts_per_ampere: single(WARM * motor.resistance_ohm / constant * counts_per_rad_s),
            range: settings.range_counts(),
        }
    }

    /// Bounds while either may be in force, and what is left of the other besides: symptoms
    /// that leave and others that appear act together. What changes only while disarmed is
    /// that of the other.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        Self {
            model_torque_nm: self.model_torque_nm + other.model_torque_nm,
            torque_nm: self.torque_nm.at_least(other.torque_nm),
            added_nm: self.added_nm + other.added_nm,
            fade_nm: self.fade_nm.at_most(other.fade_nm),
            joint_nm: self.joint_nm.at_least(other.joint_nm),
            counts: self.counts.at_least(other.counts),
            range: (
                self.range.0.min(other.range.0),
                self.range.1.max(other.range.1),
            ),
            ..other
        }
    }

    /// Whether in so many blocks all has faded that is added to the model's torque. The drive
    /// does not report that it fades.
    pub fn has_faded(&self, blocks: u32) -> bool {
        #[expect(clippy::cast_precision_loss, reason = "some thousands")]
        let blocks = blocks as f32;
        blocks * self.fade_nm >= self.added_nm
    }

    /// Whether torque and model of a sample are within the bounds. The torque is what the model
    /// gives and what is added to it, or less. The joint's part may be missing, if its hand has
    /// turned back, or be held; what the drive says of that is worth no more than that part.
    fn allow(&self, sample: &Sample) -> bool {
        let (torque_nm, model_nm) = (sample.torque_nm, sample.model_torque_nm);
        let joint_nm = match sample.flags.limit() {
            LimitReason::None
            | LimitReason::Voltage
            | LimitReason::Current
            | LimitReason::Range => 0.0,
            _ => self.joint_nm,
        };
        let beside_nm = self.added_nm + joint_nm + ROUNDING_NM;
        let (least_nm, most_nm) = (model_nm.at_most(0.0), model_nm.at_least(0.0));
        // A NaN is beyond every bound.
        torque_nm.abs() <= self.torque_nm
            && model_nm.abs() <= self.model_torque_nm
            && (least_nm - beside_nm..=most_nm + beside_nm).contains(&torque_nm)
    }

    /// Whether at this speed, counts in a block, the supply may lack the voltage for a current:
    /// up to the resistance of a [warm](WARM) winding. Slower, a loop at its limit has voltage to
    /// spare, whatever the drive says.
    fn lacks_voltage(&self, counts: f32, setpoint_a: f32) -> bool {
        let needed_a = setpoint_a.abs() + CURRENT_SLACK_A;
        counts >= self.emf_counts - self.counts_per_ampere * needed_a
    }
}

/// Samples with torque of a drive that says it is not armed, less those without: a block may
/// be the last one of it, with as many samples less one.
const ASTRAY_SAMPLES: u32 = 24;

/// Ticks between two counts of which the speed follows: in fewer a single count is too much.
const LEAST_GAP: u64 = 10;
const MOST_GAP: u64 = 200;

/// How far the current has deviated from that of the torque beyond the slack, in either sense,
/// A times samples.
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
    /// In parts of a lost sample that one with a count makes up for.
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
    /// Where the bridge is not driven, there is no current.
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
mod tests {
    use super::*;
    use crepitus_protocol::Values;
    use crepitus_protocol::parameters::find;
    use crepitus_protocol::telemetry::BlockFlags;

    fn bounds() -> Bounds {
        bounds_with(&[])
    }

    fn bounds_with(parameters: &[(&str, f64)]) -> Bounds {
        let mut values = Values::default();
        for (name, value) in parameters {
            values.set(find(name).unwrap().0, *value);
        }
        Bounds::of(&DeviceSettings::of(&values).unwrap())
    }

    /// Blocks of one sample until a fault.
    fn blocks_until(sample: impl Fn(i32) -> Sample, state: State) -> Option<(Fault, usize)> {
        blocks_within(&bounds(), sample, state)
    }

    fn blocks_within(
        bounds: &Bounds,
        sample: impl Fn(i32) -> Sample,
        state: State,
    ) -> Option<(Fault, usize)> {
        let mut checks = SampleChecks::default();
        (0..50).find_map(|n| {
            let block = Block {
                first_tick: u64::try_from(n).unwrap() * 20,
                flags: BlockFlags::new(state, true, 1),
                samples: core::array::from_fn(|k| sample(n * 20 + i32::try_from(k).unwrap())),
                ..Block::default()
            };
            let fault = checks.check(&block, bounds, state == State::Armed)?;
            Some((fault, usize::try_from(n).unwrap() + 1))
        })
    }

    fn armed(sample: impl Fn(i32) -> Sample) -> Option<(Fault, usize)> {
        assert_eq!(blocks_until(&sample, State::Disarmed), None);
        blocks_until(sample, State::Armed)
    }

    /// What the model gives is driven.
    fn energised(torque_nm: f32) -> Sample {
        Sample {
            torque_nm,
            model_torque_nm: torque_nm,
            #[expect(clippy::cast_possible_truncation, reason = "a small number")]
            current_ma: (-torque_nm / (0.0389 * 86.0) * 1e3) as i16,
            flags: SampleFlags(SampleFlags::ENERGISED),
            ..Sample::default()
        }
    }

    /// A wall of 4 N·m beside the joint.
    const WALL: &[(&str, f64)] = &[("range-limit.render", 1.0)];

    #[test]
    fn what_parameters_allow_is_no_fault() {
        for torque_nm in [-4.4, -0.4, 0.0, 4.4] {
            let sample = |n| Sample {
                count: n * 9,
                ..energised(torque_nm)
            };
            assert_eq!(
                blocks_within(&bounds_with(WALL), sample, State::Armed),
                None
            );
        }
    }

    /// The torque is that of the model and what is added to it, or less.
    #[test]
    fn torque_that_the_model_does_not_give_is_a_fault() {
        let beyond = Some((Fault::TorqueBeyondBounds, 1));
        let torque = |model_torque_nm, torque_nm, limit| Sample {
            model_torque_nm,
            flags: energised(0.0).flags.with_limit(limit),
            ..energised(torque_nm)
        };
        let compensated = bounds_with(&[("friction-compensation.render", 1.0)]);
        let wall = bounds_with(WALL);
        for (bounds, sample, expected) in [
            (bounds(), torque(0.1, 0.3, LimitReason::None), beyond),
            (bounds(), torque(0.1, -0.1, LimitReason::None), beyond),
            (bounds(), torque(0.3, 0.1, LimitReason::Range), None),
            (bounds(), torque(0.3, 0.0, LimitReason::TurnedBack), None),
            (bounds(), torque(0.1, 0.3, LimitReason::Holding), None),
            (compensated, torque(0.1, -0.3, LimitReason::None), None),
            (compensated, torque(0.1, -0.45, LimitReason::None), beyond),
            // A joint of 0.4 N·m, whose hand has turned back, beside a wall.
            (wall, torque(1.6, 2.0, LimitReason::TurnedBack), None),
            (wall, torque(1.6, 2.0, LimitReason::None), beyond),
            (wall, torque(1.6, 2.1, LimitReason::TurnedBack), beyond),
            (wall, torque(4.4, 4.4, LimitReason::None), None),
        ] {
            let found = blocks_within(&bounds, |_| sample, State::Armed);
            assert_eq!(found, expected, "{sample:?}");
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
        assert_eq!(armed(|_| energised(-0.41)), beyond);
        let beside = |_| Sample {
            current_ma: 500,
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
        // Also where the drive says that the voltage is at its limit.
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

    /// 8 counts in a tick are 5.7 rad/s, beyond which the supply lacks the voltage for 0.37 A.
    #[test]
    fn a_speed_that_needs_all_voltage_excuses_a_current_and_the_drives_word_does_not() {
        let beside = Some((Fault::CurrentBesideTorque, 6));
        for (counts, expected) in [(0, beside), (4, beside), (7, beside), (8, None)] {
            for limit in [
                LimitReason::None,
                LimitReason::Voltage,
                LimitReason::Current,
            ] {
                let sample = |n: i32| Sample {
                    count: n * counts,
                    current_ma: 300,
                    flags: energised(0.0).flags.with_limit(limit),
                    ..energised(0.4)
                };
                assert_eq!(armed(sample), expected, "{counts}, {limit:?}");
            }
        }
    }

    /// A setpoint beyond the current's limit is cut.
    #[test]
    fn the_current_is_that_of_the_torque_up_to_its_limit() {
        let mut bounds = bounds_with(WALL);
        bounds.setpoint_a = 0.5;
        let with_current = |current_ma| {
            let sample = |_| Sample {
                current_ma,
                ..energised(4.0)
            };
            blocks_within(&bounds, sample, State::Armed)
        };
        assert_eq!(with_current(-500), None);
        // That of 4 N·m.
        let beside = Some((Fault::CurrentBesideTorque, 6));
        assert_eq!(with_current(-1_196), beside);
    }

    #[test]
    fn what_most_samples_show_is_a_fault_and_what_few_show_is_none() {
        let good = energised(0.1);
        let over = Sample {
            current_ma: 2_000,
            flags: SampleFlags::default(),
            ..good
        };
        let beyond = energised(0.5);
        let beside = Sample {
            current_ma: 500,
            ..good
        };
        let outside = Sample {
            count: 70_000,
            ..good
        };
        let few: [fn(i32) -> bool; 3] = [|n| n % 2 == 0, |n| n % 4 == 0, |n| n % 100 < 3];
        // Blocks until three in four are a fault.
        for (bad, fault, blocks) in [
            (over, Fault::CommsOvercurrent, 1),
            (beyond, Fault::TorqueBeyondBounds, 1),
            (beside, Fault::CurrentBesideTorque, 12),
            (outside, Fault::TorqueOutsideRange, 1),
        ] {
            let mixed = |worse: fn(i32) -> bool| {
                blocks_until(|n| if worse(n) { bad } else { good }, State::Armed)
            };
            assert_eq!(mixed(|n| n % 4 != 3), Some((fault, blocks)));
            for few in few {
                assert_eq!(mixed(few), None, "{fault:?}");
            }
        }
        // Two fast blocks of three.
        let mut checks = SampleChecks::default();
        let mut count = 0;
        let found = (0..40_u64).find_map(|n| {
            let step = if n % 3 == 2 { 0 } else { 12 };
            let samples = core::array::from_fn(|_| {
                count += step;
                Sample { count, ..good }
            });
            let block = Block {
                first_tick: n * 20,
                flags: BlockFlags::new(State::Armed, true, 1),
                samples,
                ..Block::default()
            };
            Some((checks.check(&block, &bounds(), true)?, n))
        });
        assert_eq!(found, Some((Fault::CommsOverspeed, 7)));
    }

    /// A stiff joint that rises and breaks in turn: the current lags by 0.4 A, and overtakes.
    #[test]
    fn a_current_that_lags_behind_a_torque_that_breaks_again_and_again_is_no_fault() {
        /// Of what it lacks, in a tick: 1 − e^(−2π·f·h).
        const SHARE: f32 = 0.269_6;
        let bounds = bounds_with(&[
            ("crepitus.kinetic_torque_nm", 2.0),
            ("crepitus.static_torque_nm", 4.0),
        ]);
        let mut current_a = 0.0_f32;
        let samples: std::vec::Vec<Sample> = (0..1_000_i16)
            .map(|n| {
                let torque_nm = 0.4 * f32::from(n % 10);
                let sample = Sample {
                    #[expect(clippy::cast_possible_truncation, reason = "a small number")]
                    current_ma: (current_a * 1e3) as i16,
                    ..energised(torque_nm)
                };
                current_a += SHARE * (-torque_nm * bounds.amperes_per_nm - current_a);
                sample
            })
            .collect();
        let far = samples.iter().filter(|sample| {
            let off_a = f32::from(sample.current_ma) * 1e-3 + sample.torque_nm * 0.299;
            off_a.abs() > CURRENT_SLACK_A
        });
        assert!(far.count() > 500, "most of them are beyond the slack");
        let sample = |n: i32| samples[usize::try_from(n).unwrap()];
        assert_eq!(blocks_within(&bounds, sample, State::Armed), None);
    }

    /// However the drive says that it has no count, speed and place are checked.
    #[test]
    fn counts_that_are_said_to_be_lost_switch_no_check_off() {
        let lost = |every: i32, step: i32| {
            move |n: i32| Sample {
                count: n * step,
                flags: energised(0.0).flags.with(SampleFlags::LOST, n % every == 0),
                ..energised(0.0)
            }
        };
        let outside = |blocks| Some((Fault::TorqueOutsideRange, blocks));
        assert_eq!(armed(lost(1, 0)), outside(2));
        // As the drive, in more than one of nine.
        assert_eq!(armed(lost(4, 0)), outside(13));
        assert_eq!(armed(lost(10, 0)), None);
        assert_eq!(armed(lost(20, 12)), Some((Fault::CommsOverspeed, 4)));
    }

    #[test]
    fn gaps_excuse() {
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
