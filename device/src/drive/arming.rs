//! The arming sequence: tests sensor offset, enable lines, gates and motor polarity.
//!
//! ```text
//!         offset   line on             line off                    line on    push
//! drive  ________╱‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾╲__________________________╱‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾
//! comms  ________________________________________╱‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾
//! bridge floats             + −                     + −                  + − − + − + + −
//!        measure  read back no current  read back,  no current  read     the shaft moves in
//!        it       on        may flow    await comms may flow    back on  the push's direction
//! ```
//!
//! Two pushes must *not* move current: each with one of the two lines off and the other
//! on, as read back in every tick of it. They are 0.6 V beside the back-EMF, 1 ms each
//! way, which through a gate that does not follow its line gives 0.5 A. Comms switches its
//! line on when the drive awaits it.
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

/// Voltage of the pushes that must not move current, V, beside the back-EMF.
const PROOF_V: f32 = 0.6;

/// Ticks of each of the two parts of such a push.
const PROOF_TICKS: u32 = 20;

/// Largest current of such a push, A, and the consecutive ticks beyond it.
const LEAK_A: f32 = 0.15;
const LEAK_TICKS: u32 = 2;

/// Ticks for which the enable line of comms is awaited: the link may lose the word.
const AWAIT_TICKS: u32 = 2_000;

/// Counts that the shaft must move to prove the polarity.
const PROOF_COUNTS: i32 = 12;

/// Output of a tick of arming.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ArmingOutput {
    /// The line off, the bridge floating.
    Off,
    /// The line on, the bridge floating.
    Line,
    /// A voltage that must not move current, V, beside the back-EMF; the line on or
    /// off.
    Proof(f32, bool),
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
    ProveComms,
    Off,
    AwaitComms,
    ProveDrive,
    SecondOn,
    Push,
}

/// Inputs of arming in a tick.
#[derive(Clone, Copy, Debug)]
pub struct ArmingInputs {
    /// Raw currents of sensor and monitor, A.
    pub raw_a: Option<(f32, f32)>,
    /// The drive's enable line, as read back.
    pub line_is_on: bool,
    /// Level of the enable line of comms, read at its gate: true if on.
    pub comms_line_is_on: bool,
    /// The encoder's count.
    pub count: i32,
}

/// Arming in progress.
#[derive(Clone, Copy, Debug)]
pub struct Arming {
    step: Step,
    /// Ticks in this step.
    ticks: u32,
    /// Sums of the two sensors' currents.
    offset_sums_a: (f32, f32),
    /// Consecutive ticks with a current that must not be.
    leak_ticks: u32,
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
            leak_ticks: 0,
            moved_counts: 0,
            last_count: None,
        }
    }
}

impl Arming {
    /// Runs one tick.
    pub fn tick(&mut self, seen: &ArmingInputs) -> ArmingOutput {
        self.ticks = self.ticks.saturating_add(1);
        match self.step {
            Step::Offset => self.offset(seen.raw_a, seen.line_is_on),
            Step::FirstOn => self.line(seen.line_is_on, true, Step::ProveComms),
            Step::ProveComms if seen.comms_line_is_on => {
                ArmingOutput::Failed(Fault::CommsGateStuck)
            }
            // With both lines off the push would show nothing.
            Step::ProveComms if !seen.line_is_on => ArmingOutput::Failed(Fault::EnableStuckOff),
            Step::ProveComms => self.prove(seen.raw_a, true, Fault::CommsGateStuck, Step::Off),
            Step::Off => self.line(seen.line_is_on, false, Step::AwaitComms),
            Step::AwaitComms => self.await_comms(seen.comms_line_is_on),
            // Without the line of comms the push would show nothing.
            Step::ProveDrive if !seen.comms_line_is_on => ArmingOutput::Failed(Fault::CommsLineOff),
            Step::ProveDrive if seen.line_is_on => ArmingOutput::Failed(Fault::EnableStuckOn),
            Step::ProveDrive => {
                self.prove(seen.raw_a, false, Fault::DriveGateStuck, Step::SecondOn)
            }
            Step::SecondOn => self.line(seen.line_is_on, true, Step::Push),
            Step::Push => self.push(seen.count),
        }
    }

    /// Returns whether it waits for the enable line of comms, or has it.
    pub fn awaits_comms(&self) -> bool {
        matches!(
            self.step,
            Step::AwaitComms | Step::ProveDrive | Step::SecondOn | Step::Push
        )
    }

    fn await_comms(&mut self, is_on: bool) -> ArmingOutput {
        if is_on {
            self.go_to(Step::ProveDrive);
        } else if self.ticks >= AWAIT_TICKS {
            return ArmingOutput::Failed(Fault::CommsLineOff);
        }
        ArmingOutput::Off
    }

    /// Pushes with one of the lines off: no current may flow.
    fn prove(
        &mut self,
        raw_a: Option<(f32, f32)>,
        line: bool,
        fault: Fault,
        next: Step,
    ) -> ArmingOutput {
        let Some((sensor_a, monitor_a)) = raw_a else {
            return ArmingOutput::Failed(Fault::CurrentMissing);
        };
        let (sensor_off_a, monitor_off_a) = self.offsets_a().unwrap_or_default();
        // `<=` so that NaN fails.
        let is_none = |raw_a: f32, off_a: f32| (raw_a - off_a).abs() <= LEAK_A;
        self.leak_ticks = if is_none(sensor_a, sensor_off_a) && is_none(monitor_a, monitor_off_a) {
            0
        } else {
            self.leak_ticks.saturating_add(1)
        };
        if self.leak_ticks >= LEAK_TICKS {
            return ArmingOutput::Failed(fault);
        }
        match self.ticks.saturating_sub(1) / PROOF_TICKS {
            0 => ArmingOutput::Proof(PROOF_V, line),
            1 => ArmingOutput::Proof(-PROOF_V, line),
            _ => {
                self.go_to(next);
                if line {
                    ArmingOutput::Line
                } else {
                    ArmingOutput::Off
                }
            }
        }
    }

    /// Offsets of the current sensor and of the monitor, A, once they were measured and
    /// found small.
    pub fn offsets_a(&self) -> Option<(f32, f32)> {
        (self.step != Step::Offset).then(|| self.mean_offsets_a())
    }

    fn mean_offsets_a(&self) -> (f32, f32) {
        #[expect(clippy::cast_precision_loss, reason = "a small number")]
        let share = 1.0 / OFFSET_TICKS as f32;
        let (sensor_a, monitor_a) = self.offset_sums_a;
        (sensor_a * share, monitor_a * share)
    }

    /// Returns whether the push has shown that encoder and motor turn the same way.
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
        // `<=` so that NaN fails.
        let is_small = |offset_a: f32| offset_a.abs() <= LARGEST_OFFSET_A;
        let (sensor_a, monitor_a) = self.mean_offsets_a();
        if !(is_small(sensor_a) && is_small(monitor_a)) {
            return ArmingOutput::Failed(Fault::CurrentOffset);
        }
        self.go_to(Step::FirstOn);
        ArmingOutput::Line
    }

    /// Waits for the read-back of the line.
    fn line(&mut self, is_on: bool, should_be_on: bool, next: Step) -> ArmingOutput {
        if is_on == should_be_on {
            self.go_to(next);
            return if should_be_on {
                ArmingOutput::Line
            } else {
                ArmingOutput::Off
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
mod tests;
