//! Frames from the drive, held to what the bench has seen of it.

use super::Bench;
use crepitus_device::drive::batch::QUEUE_BLOCKS;
use crepitus_protocol::counters::DriveCounter;
use crepitus_protocol::crash::PART_WORDS;
use crepitus_protocol::link::FromDrive;
use crepitus_protocol::management::Answer;
use crepitus_protocol::telemetry::{BLOCK_SAMPLES, Block, SampleFlags};
use crepitus_protocol::{Lane, Revision, State};

/// The largest torque that limits can be set to, N·m.
const MOST_NM: f32 = 4.5;

/// More runs than a status takes to be made, with the answers that go before it.
const STATUS_RUNS: usize = 60;

impl Bench {
    /// Lets the link's task run so often, and takes the frames it makes.
    pub(super) fn read(&mut self, runs: usize) {
        for _ in 0..runs {
            let drive = &self.drive;
            let now = (drive.next_tick(), drive.state(), drive.revision());
            // A status takes a few runs to be made.
            self.states.truncate(STATUS_RUNS);
            self.states.push_front(now);
            if let Some(frame) = self.drive.link_to_send(true) {
                self.received(&frame);
            }
        }
        let counters = self.drive.counters();
        let produced = u64::from(counters.get(DriveCounter::Produced));
        let dropped = u64::from(counters.get(DriveCounter::Dropped));
        let samples = BLOCK_SAMPLES as u64;
        let queue = QUEUE_BLOCKS as u64;
        assert_eq!(produced, self.ticks / samples * samples);
        let waiting = produced - dropped - self.received;
        assert!(waiting <= queue * samples, "{waiting} samples wait");
    }

    fn received(&mut self, frame: &[u8]) {
        let mut found = 0;
        for byte in frame {
            let Some(body) = self.host.push(*byte) else {
                continue;
            };
            let body = body.expect("a frame in order");
            found += 1;
            match body.lane() {
                Some(Lane::FromDrive) => match body.message().expect("a message") {
                    FromDrive::Status(status) => {
                        let told = (status.tick, status.state, status.revision);
                        // Of what another start of comms has sent, or one that it has not heard of, the drive
                        // tells nothing.
                        let is_other = self.has_restarted || status.comms_start.is_none();
                        let is_so = |(tick, state, revision): &(u64, State, Revision)| {
                            let is_told = status.revision == Revision::NONE && is_other;
                            (*tick, *state) == (told.0, told.1) && (*revision == told.2 || is_told)
                        };
                        assert!(self.states.iter().any(is_so), "{told:?} was never so");
                    }
                    FromDrive::Times(times) => panic!("nobody measures {times:?}"),
                    FromDrive::CrashPart(part) => {
                        let expected = self.crash.chunks(PART_WORDS).nth(part.number.into());
                        let words = part.words.as_ref().map(<[u32; PART_WORDS]>::as_slice);
                        assert_eq!(words.is_some(), expected.is_some(), "{part:?}");
                        let pairs = words.into_iter().zip(expected);
                        assert!(
                            pairs
                                .into_iter()
                                .all(|(words, expected)| words.starts_with(expected))
                        );
                    }
                },
                Some(Lane::ManagementAnswer) => {
                    assert!(Answer::of(body.payload).is_some());
                }
                Some(Lane::Telemetry) => {
                    let block = body.message().expect("a block");
                    self.received += BLOCK_SAMPLES as u64;
                    self.energised(&block);
                    let end = self.received + u64::from(block_dropped(&block));
                    assert_eq!(block.end_tick() - self.first_tick, end, "sample accounting");
                    let blocks = (block.first_tick - self.first_tick) / BLOCK_SAMPLES as u64;
                    let [low, high, ..] = blocks.to_le_bytes();
                    let expected = self.sequence.wrapping_add(u16::from_le_bytes([low, high]));
                    assert_eq!(block.sequence, expected);
                }
                other => panic!("{other:?} from the drive"),
            }
        }
        assert_eq!(found, 1, "frames in a frame");
    }

    /// The samples say in which ticks there was torque.
    fn energised(&self, block: &Block) {
        let first = usize::try_from(block.first_tick - self.first_tick).expect("a few");
        let ticks = self.energised.get(first..).unwrap_or_default();
        for (sample, is_energised) in block.samples.iter().zip(ticks) {
            let says = sample.flags.has(SampleFlags::ENERGISED);
            assert_eq!(says, *is_energised, "{sample:?}");
        }
    }
}

/// Number of dropped samples that a block reports; its torque is held to its law on the way.
fn block_dropped(block: &Block) -> u32 {
    for sample in &block.samples {
        let is_energised = sample.flags.has(SampleFlags::ENERGISED);
        assert!(sample.torque_nm.abs() <= MOST_NM, "{sample:?}");
        assert!(is_energised || sample.torque_nm == 0.0, "{sample:?}");
    }
    block.dropped
}
