//! Times of the controllers' hardware tasks, as each measures its own with the cycle counter of its
//! core.

use postcard::experimental::max_size::MaxSize;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Most tasks of a controller.
pub const TASKS: usize = 4;

/// Tasks of the drive, in the order of [`TaskTimes::tasks`].
pub const DRIVE_TASKS: [&str; 4] = ["sample_encoder", "command_motor", "render_torque", "link"];

/// Tasks of comms, in the order of [`TaskTimes::tasks`].
pub const COMMS_TASKS: [&str; 3] = ["tick", "usb", "link"];

/// Frequency of a core, Hz: that of its cycles.
pub const CORE_HZ: u32 = 168_000_000;

/// Parts of a cycle in which a mean is sent.
pub const MEAN_PARTS: u32 = 256;

/// Cycles of a task from its first statement to its last, without those of tasks that interrupt it, since
/// the last reset. Zeros where there is no such task.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, MaxSize, Schema)]
pub struct TaskCycles {
    /// Number of runs; wraps.
    pub runs: u32,
    /// Cycles of the worst run.
    pub worst: u32,
    /// Mean cycles of a run, 1/256 of a cycle.
    pub mean_256: u32,
}

/// Times of a controller since its last reset.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, MaxSize, Schema)]
pub struct TaskTimes {
    /// The tasks, the one of the highest priority first.
    pub tasks: [TaskCycles; TASKS],
    /// Earliest sample of the encoder after the beginning of its tick, cycles; 0 of comms.
    pub earliest_sample: u32,
    /// Latest sample of the encoder after the beginning of its tick, cycles; 0 of comms.
    pub latest_sample: u32,
    /// Ticks whose torque was not ready in time; wraps. 0 of comms.
    pub late_ticks: u32,
    /// Most bytes of the stack that were in use.
    pub stack_used: u32,
    /// Bytes of the stack.
    pub stack_bytes: u32,
}

/// Words of [`TaskTimes`].
pub const TIMES_WORDS: usize = 3 * TASKS + 5;

impl TaskTimes {
    /// All fields in their order: encoded one by one they are the message, for an incremental
    /// encoder.
    pub fn words(&self) -> [u32; TIMES_WORDS] {
        let tasks = self.tasks.iter();
        let tasks = tasks.flat_map(|task| [task.runs, task.worst, task.mean_256]);
        let rest = [
            self.earliest_sample,
            self.latest_sample,
            self.late_ticks,
            self.stack_used,
            self.stack_bytes,
        ];
        let mut words = [0; TIMES_WORDS];
        for (place, word) in words.iter_mut().zip(tasks.chain(rest)) {
            *place = word;
        }
        words
    }

    /// Spread of the instant at which the encoder is sampled, cycles.
    pub fn sampling_jitter(&self) -> u32 {
        self.latest_sample.saturating_sub(self.earliest_sample)
    }
}

/// Times of both controllers. None of one that measures none, or has not reported any since its
/// start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, MaxSize, Schema)]
pub struct DeviceTimes {
    /// Times of the drive, as of its last report, one a second.
    pub drive: Option<TaskTimes>,
    /// Times of comms, as of its last report, one a second.
    pub comms: Option<TaskTimes>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::{write, write_words};

    #[test]
    fn the_words_one_by_one_are_the_message() {
        let times = TaskTimes {
            tasks: core::array::from_fn(|n| {
                let n = u32::try_from(n).unwrap();
                TaskCycles {
                    runs: u32::MAX - n,
                    worst: 200 + n,
                    mean_256: 70_000 * n,
                }
            }),
            earliest_sample: 31,
            latest_sample: 45,
            late_ticks: 1 << 20,
            stack_used: 2_048,
            stack_bytes: 65_536,
        };
        let (mut whole, mut parts) = ([0; 128], [0; 128]);
        let whole = write(&times, &mut whole).unwrap();
        assert_eq!(whole, write_words(&times.words(), &mut parts).unwrap());
        assert_eq!(times.sampling_jitter(), 14);
    }
}
