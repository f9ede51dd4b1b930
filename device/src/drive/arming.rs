//! The arming sequence: tests sensor offset, enable line and motor polarity.
//!
//! ```text
//!            offset       line on      line off     line on       push
//! enable  ______________╱‾‾‾‾‾‾‾‾‾‾╲____________╱‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾
//! bridge  floats                                            + − − + − + + −
//!         measure the   read back   read back   read back   the shaft moves in
//!         offset        on          off         on          the push's direction
//! ```
//!
//! The push is a current of 1.2 A (4 N·m) for 2 ms in each direction, four
//! times: it moves a free shaft by 7 counts forward, twice back, and forward.
//! The speed and acceleration of the hand cancel. A leg that is held does not
//! move, and the polarity stays unproven.

use crepitus_protocol::Fault;

/// Ticks over which the sensor's offset is averaged.
const OFFSET_TICKS: u32 = 64;

/// Largest offset of a current sensor, A.
const LARGEST_OFFSET_A: f32 = 0.1;

/// Ticks within which the read-back follows the output.
const LINE_TICKS: u32 = 9;

/// Ticks of each of the eight parts of the push.
const PUSH_TICKS: u32 = 40;

/// Current of the push, A.
const PUSH_A: f32 = 1.2;

/// Counts that the shaft must move to prove the polarity.
const PROOF_COUNTS: i32 = 12;

/// Output of a tick of arming.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ArmingOutput {
    /// The line off, the bridge floating.
    Off,
    /// The line on, the bridge floating.
    Line,
    /// The line on, this current, A.
    Push(f32),
    /// Arming is complete.
    Armed,
    /// Arming has failed.
    Failed(Fault),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Step {
    Offset,
    FirstOn,
    Off,
    SecondOn,
    Push,
}

/// Arming in progress.
#[derive(Clone, Copy, Debug)]
pub struct Arming {
    step: Step,
    /// Ticks in this step.
    ticks: u32,
    /// Sums of the two sensors' currents.
    offset_sums_a: (f32, f32),
    /// Counts moved in the push's direction, minus those against it.
    moved_counts: i32,
    last_count: Option<i32>,
}

impl Default for Arming {
    fn default() -> Self {
        Self {
            step: Step::Offset,
            ticks: 0,
            offset_sums_a: (0.0, 0.0),
            moved_counts: 0,
            last_count: None,
        }
    }
}

impl Arming {
    /// Runs one tick with the raw currents of sensor and monitor, the line's
    /// read-back and the encoder.
    pub fn tick(
        &mut self,
        raw_a: Option<(f32, f32)>,
        line_is_on: bool,
        count: i32,
    ) -> ArmingOutput {
        self.ticks = self.ticks.saturating_add(1);
        match self.step {
            Step::Offset => self.offset(raw_a, line_is_on),
            Step::FirstOn => self.line(line_is_on, true, Step::Off),
            Step::Off => self.line(line_is_on, false, Step::SecondOn),
            Step::SecondOn => self.line(line_is_on, true, Step::Push),
            Step::Push => self.push(count),
        }
    }

    /// Offsets of the current sensor and of the monitor, once measured, A.
    pub fn offsets_a(&self) -> Option<(f32, f32)> {
        #[expect(clippy::cast_precision_loss, reason = "a small number")]
        let share = 1.0 / OFFSET_TICKS as f32;
        let (sensor_a, monitor_a) = self.offset_sums_a;
        (self.step != Step::Offset).then_some((sensor_a * share, monitor_a * share))
    }

    /// Whether the push has shown that encoder and motor turn the same way.
    pub fn is_proven(&self) -> bool {
        self.moved_counts >= PROOF_COUNTS
    }

    fn go_to(&mut self, step: Step) {
        (self.step, self.ticks) = (step, 0);
    }

    fn offset(&mut self, raw_a: Option<(f32, f32)>, line_is_on: bool) -> ArmingOutput {
        if line_is_on {
            return ArmingOutput::Failed(Fault::EnableStuckOn);
        }
        let Some((sensor_a, monitor_a)) = raw_a else {
            return ArmingOutput::Failed(Fault::CurrentMissing);
        };
        self.offset_sums_a.0 += sensor_a;
        self.offset_sums_a.1 += monitor_a;
        if self.ticks < OFFSET_TICKS {
            return ArmingOutput::Off;
        }
        self.go_to(Step::FirstOn);
        // `<=` so that NaN fails.
        let is_small = |offset_a: f32| offset_a.abs() <= LARGEST_OFFSET_A;
        if self
            .offsets_a()
            .is_some_and(|(sensor_a, monitor_a)| is_small(sensor_a) && is_small(monitor_a))
        {
            ArmingOutput::Line
        } else {
            ArmingOutput::Failed(Fault::CurrentOffset)
        }
    }

    /// Waits for the read-back of the line.
    fn line(&mut self, is_on: bool, should_be_on: bool, next: Step) -> ArmingOutput {
        if is_on == should_be_on {
            self.go_to(next);
            return if next == Step::Off {
                ArmingOutput::Off
            } else {
                ArmingOutput::Line
            };
        }
        if self.ticks >= LINE_TICKS {
            return ArmingOutput::Failed(if should_be_on {
                Fault::EnableStuckOff
            } else {
                Fault::EnableStuckOn
            });
        }
        if should_be_on {
            ArmingOutput::Line
        } else {
            ArmingOutput::Off
        }
    }

    fn push(&mut self, count: i32) -> ArmingOutput {
        let part = self.ticks.saturating_sub(1) / PUSH_TICKS;
        // Motion since the last tick is due to the previous part.
        let moved = self.last_count.map_or(0, |last| count.wrapping_sub(last));
        self.last_count = Some(count);
        // The first and the last pair move the shaft forward, the others back.
        self.moved_counts = if matches!(part, 0 | 1 | 6 | 7) {
            self.moved_counts.saturating_add(moved)
        } else {
            self.moved_counts.saturating_sub(moved)
        };
        match part {
            0 | 3 | 5 | 6 => ArmingOutput::Push(PUSH_A),
            1 | 2 | 4 | 7 => ArmingOutput::Push(-PUSH_A),
            _ if self.moved_counts <= -PROOF_COUNTS => ArmingOutput::Failed(Fault::EncoderPolarity),
            _ => ArmingOutput::Armed,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Arms with a line that follows a tick late, and a shaft that is moved
    /// by `counts` a tick in the sense of the push, on top of a hand's motion.
    fn arm(raw_a: f32, stuck: Option<bool>, counts: i32, hand: i32) -> (ArmingOutput, u32, bool) {
        let mut arming = Arming::default();
        let (mut line, mut count, mut ticks) = (stuck.unwrap_or(false), i32::MAX - 20, 0);
        let mut speed = 0;
        loop {
            let wish = arming.tick(Some((raw_a, raw_a)), stuck.unwrap_or(line), count);
            ticks += 1;
            match wish {
                ArmingOutput::Off => line = false,
                ArmingOutput::Line => line = true,
                ArmingOutput::Push(a) => speed += if a > 0.0 { counts } else { -counts },
                ArmingOutput::Armed | ArmingOutput::Failed(_) => {
                    return (wish, ticks, arming.is_proven());
                }
            }
            count = count.wrapping_add(hand + speed);
            assert!(ticks < 1000);
        }
    }

    #[test]
    fn all_in_order_is_armed_within_twenty_milliseconds() {
        let (wish, ticks, proven) = arm(0.05, None, 1, 0);
        assert_eq!((wish, proven), (ArmingOutput::Armed, true));
        assert!(ticks < 400, "{ticks}");
    }

    #[test]
    fn a_hand_that_moves_the_leg_changes_nothing() {
        for hand in [-3, 3] {
            assert_eq!(arm(0.0, None, 0, hand).0, ArmingOutput::Armed);
            assert!(!arm(0.0, None, 0, hand).2);
            assert!(arm(0.0, None, 1, hand).2);
            assert_eq!(
                arm(0.0, None, -1, hand).0,
                ArmingOutput::Failed(Fault::EncoderPolarity)
            );
        }
    }

    #[test]
    fn a_hand_that_speeds_up_changes_nothing() {
        // Up to 100 rad/s², in counts a tick and tick; right, loose and swapped.
        for per_mille in [-7, -2, 2, 7] {
            for (counts, expected, proven) in [
                (1, ArmingOutput::Armed, true),
                (0, ArmingOutput::Armed, false),
                (-1, ArmingOutput::Failed(Fault::EncoderPolarity), false),
            ] {
                let mut arming = Arming::default();
                let (mut line, mut pushed, mut speed) = (false, 0, 0);
                let (wish, is_proven) = (0_i32..1_000)
                    .find_map(|tick| {
                        let hand = per_mille * tick * tick / 2_000;
                        let wish = arming.tick(Some((0.0, 0.0)), line, hand + pushed);
                        match wish {
                            ArmingOutput::Off => line = false,
                            ArmingOutput::Line => line = true,
                            ArmingOutput::Push(a) => {
                                speed += if a > 0.0 { counts } else { -counts }
                            }
                            _ => return Some((wish, arming.is_proven())),
                        }
                        pushed += speed;
                        None
                    })
                    .unwrap();
                assert_eq!(
                    (wish, is_proven),
                    (expected, proven),
                    "{per_mille} {counts}"
                );
            }
        }
    }

    #[test]
    fn arming_fails_on_a_defect() {
        for (raw_a, stuck, fault) in [
            (0.11, None, Fault::CurrentOffset),
            (-0.11, None, Fault::CurrentOffset),
            (f32::NAN, None, Fault::CurrentOffset),
            (0.0, Some(true), Fault::EnableStuckOn),
            (0.0, Some(false), Fault::EnableStuckOff),
        ] {
            assert_eq!(arm(raw_a, stuck, 1, 0).0, ArmingOutput::Failed(fault));
        }
        assert_eq!(
            Arming::default().tick(None, false, 0),
            ArmingOutput::Failed(Fault::CurrentMissing)
        );
    }

    #[test]
    fn a_line_that_does_not_fall_again_is_stuck() {
        let mut arming = Arming::default();
        let wish = (0..200)
            .map(|n| arming.tick(Some((0.0, 0.0)), n >= 65, 0))
            .find(|wish| matches!(wish, ArmingOutput::Failed(_)));
        assert_eq!(wish, Some(ArmingOutput::Failed(Fault::EnableStuckOn)));
    }
}
