//! Tasks that interrupt `idle` between any two of its locks.
//!
//! Comms is a model of a few lines here: it repeats its latest commit until the drive reports it in force,
//! or refused. It restarts at any time, and what it has sent may arrive late.

use super::*;
use crate::drive::command::{Command, Inputs};
use crate::drive::link_task::LinkTask;
use crate::drive::prepare::Start;
use crate::drive::rendering::Rendering;
use crate::drive::slow_checks::SlowInput;
use crate::drive::{Boot, Parts};
use crepitus_protocol::counters::DriveCounter;
use crepitus_protocol::crash::Part;
use crepitus_protocol::frame::{self, FRAME_BYTES, FrameBuffer, SoftwareCrc};
use crepitus_protocol::link::{FromDrive, Heartbeat, ToDrive};
use crepitus_protocol::parameters::id;
use crepitus_protocol::pieces::{self, Piece};
use crepitus_protocol::{Decoder, Lane, Revision, TICK_US, Values};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use std::collections::VecDeque;
use std::vec::Vec;

/// The longest that the drive may take for a commit, ticks: the queued blocks, and pieces that are sent again.
const PATIENCE_TICKS: u32 = 20_000;

/// A commit, and the boot of comms that sends it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Commit {
    start: u16,
    revision: Revision,
    /// Limit of the torque, N·m, of this commit only; of a refused one beyond the range.
    torque_nm: f64,
}

impl Commit {
    fn is_valid(&self) -> bool {
        self.torque_nm < 10.0
    }

    #[expect(clippy::cast_possible_truncation, reason = "as the drive does")]
    fn limit_nm(&self) -> f32 {
        self.torque_nm as f32
    }

    fn values(&self) -> Values {
        let mut values = Values::default();
        values.set(id::TORQUE_LIMIT, self.torque_nm);
        values
    }

    fn pieces(&self) -> Vec<ToDrive> {
        let values = self.values();
        let sent = pieces::to_send(&values.0);
        let [count, ..] = sent.count_ones().to_le_bytes();
        (0..32)
            .filter(|index| sent >> index & 1 == 1)
            .filter_map(|index| Piece::of(&values.0, index))
            .map(|piece| ToDrive::Commit {
                revision: self.revision,
                seal: pieces::seal(&values.0, self.start),
                pieces: count,
                piece,
            })
            .collect()
    }
}

/// An event at comms or on the link.
#[derive(Clone, Copy, Debug)]
enum Event {
    /// Another commit.
    Commit { is_valid: bool },
    /// Comms starts again, with what is saved.
    Restart,
    /// All pieces of this commit, which was sent before, arrive once more: late ones.
    Late { ago: usize },
}

fn event() -> impl Strategy<Value = Event> {
    prop_oneof![
        4 => any::<bool>().prop_map(|is_valid| Event::Commit { is_valid }),
        2 => Just(Event::Restart),
        3 => (0..4_usize).prop_map(|ago| Event::Late { ago }),
    ]
}

/// The drive's tasks, and comms at the other end of the link.
struct Bench<'a> {
    rendering: Rendering,
    command: Command,
    link: LinkTask<FrameBuffer>,
    commits: Commits,
    plan: Option<Prepared>,
    // Shared without a lock, also with `idle`.
    exchange: &'a Exchange,
    counters: &'a Counters,
    /// The torque limit of what was in force, one after the other, N·m.
    in_force: Vec<f32>,
    /// The latest commit of comms, and all before.
    latest: Commit,
    sent: Vec<Commit>,
    /// The drive has said that it is in force, or refused.
    is_known: bool,
    /// Messages to send, and the number of the next heartbeat.
    queue: VecDeque<ToDrive>,
    beat: u8,
    from_drive: Decoder,
    seen_tick: u64,
    /// Events, each with its tick.
    events: VecDeque<(u32, Event)>,
    ticks: u32,
    /// Ticks for which `idle` is interrupted at each lock.
    interrupted: Vec<u32>,
    locks: usize,
}

impl<'a> Bench<'a> {
    fn new(
        start: &Start,
        (exchange, counters): (&'a Exchange, &'a Counters),
        events: Vec<(u32, Event)>,
        interrupted: Vec<u32>,
    ) -> Self {
        let boot = Boot::default();
        let saved = Commit {
            start: 1,
            revision: Revision(1),
            torque_nm: 1.0,
        };
        Self {
            rendering: Rendering::new(&start.reader, 0, &start.prepared.rendering),
            command: Command::new(&start.motor, &start.prepared.command, &boot),
            link: LinkTask::new(boot.identity, boot.start),
            commits: Commits::default(),
            plan: None,
            exchange,
            counters,
            in_force: Vec::new(),
            latest: saved,
            sent: std::vec![saved],
            is_known: false,
            queue: VecDeque::new(),
            beat: 0,
            from_drive: Decoder::new(),
            seen_tick: 0,
            events: events.into(),
            ticks: 0,
            interrupted,
            locks: 0,
        }
    }

    fn happens(&mut self, event: Event) {
        match event {
            Event::Commit { is_valid } => {
                let number = f64::from(u16::try_from(self.sent.len()).unwrap());
                self.latest.revision = self.latest.revision.next();
                self.latest.torque_nm = if is_valid { 1.0 } else { 1e3 } + 1e-3 * number;
            }
            // With what it had saved at first: the same numbers again.
            Event::Restart => {
                let start = self.latest.start + 1;
                self.latest = Commit {
                    start,
                    ..self.sent[0]
                };
            }
            Event::Late { ago } => {
                let Some(place) = self.sent.len().checked_sub(1 + ago) else {
                    return;
                };
                self.queue.extend(self.sent[place].pieces());
                return;
            }
        }
        self.is_known = false;
        self.sent.push(self.latest);
    }

    fn tick(&mut self) {
        self.ticks += 1;
        while let Some((_, event)) = self.events.pop_front_if(|(at, _)| *at <= self.ticks) {
            self.happens(event);
        }
        if self.rendering.tick(self.exchange) {
            let plan = self.plan.as_ref().map(|plan| &plan.rendering);
            self.rendering.take_over(plan, self.exchange);
        }
        let inputs = Inputs {
            current_a: Some(0.0),
            monitor_a: Some(0.0),
            interval_us: TICK_US,
            slow: SlowInput::in_turn(self.command.next_tick(), 24.0, 25.0, 0.0),
            coil_a: Some(0.0),
            ..Inputs::default()
        };
        let plan = self.plan.as_ref().map(|plan| &plan.command);
        let commits = self.counters.get(DriveCounter::Commits);
        self.command
            .tick(&inputs, plan, self.exchange, self.counters, |_| {});
        if self.counters.get(DriveCounter::Commits) != commits {
            self.takes_effect();
        }
        self.talks();
    }

    fn takes_effect(&mut self) {
        let plan = self.plan.as_ref().unwrap();
        let limit_nm = plan.rendering.torque_limit_nm;
        let sent = |commit: &&Commit| {
            commit.revision == plan.command.revision && commit.limit_nm() == limit_nm
        };
        let commit = self.sent.iter().find(sent);
        assert!(
            commit.is_some_and(Commit::is_valid),
            "{limit_nm} N·m: {commit:?}"
        );
        self.in_force.push(limit_nm);
    }

    fn talks(&mut self) {
        if self.ticks.is_multiple_of(20) {
            self.beat = self.beat.wrapping_add(1);
            self.send(&ToDrive::Heartbeat(Heartbeat {
                seen_tick: self.seen_tick,
                start: self.latest.start,
                number: self.beat,
                ..Heartbeat::default()
            }));
        }
        if self.queue.is_empty() && !self.is_known {
            self.queue.extend(self.latest.pieces());
        }
        if self.ticks.is_multiple_of(7)
            && let Some(piece) = self.queue.pop_front()
        {
            self.send(&piece);
        }
        let mut parts = Parts {
            command: &mut self.command,
            commits: &mut self.commits,
        };
        let spare = || Some([0; FRAME_BYTES]);
        let crash = |number| Part {
            number,
            words: None,
        };
        let made = self
            .link
            .next_frame(&mut SoftwareCrc, crash, spare, &mut parts, self.counters);
        for byte in made.into_iter().flat_map(|made| made.frame()) {
            if let Some(Ok(body)) = self.from_drive.push(byte)
                && body.lane() == Some(Lane::FromDrive)
                && let Some(FromDrive::Status(status)) = body.message()
            {
                self.seen_tick = status.tick;
                if status.comms_start == Some(self.latest.start) {
                    let refused = status.refused.map(|(revision, _)| revision);
                    self.hears(status.revision, refused);
                }
            }
        }
    }

    fn hears(&mut self, revision: Revision, refused: Option<Revision>) {
        let latest = self.latest;
        if revision == latest.revision {
            assert_eq!(self.in_force.last(), Some(&latest.limit_nm()), "{latest:?}");
            self.is_known = true;
        }
        if refused == Some(latest.revision) {
            assert!(!latest.is_valid(), "{latest:?}");
            self.is_known = true;
        }
    }

    fn send(&mut self, message: &ToDrive) {
        let frame = frame::encode(Lane::ToDrive, message).unwrap();
        let mut parts = Parts {
            command: &mut self.command,
            commits: &mut self.commits,
        };
        self.link
            .received(&mut SoftwareCrc, &frame, &mut parts, self.counters);
    }

    /// The tasks run before a lock of `idle`.
    fn interrupts(&mut self) {
        let places = self.interrupted.len();
        let ticks = self.interrupted[self.locks % places];
        self.locks += 1;
        for _ in 0..ticks {
            self.tick();
        }
    }
}

impl Shared for Bench<'_> {
    fn command<R>(&mut self, work: impl FnOnce(&mut Command) -> R) -> R {
        self.interrupts();
        work(&mut self.command)
    }

    fn commits<R>(&mut self, work: impl FnOnce(&mut Commits) -> R) -> R {
        self.interrupts();
        work(&mut self.commits)
    }
}

impl Plans for Bench<'_> {
    fn parts(&mut self) -> &mut impl Shared {
        self
    }

    fn store(&mut self, plan: Prepared) {
        self.interrupts();
        self.plan = Some(plan);
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        failure_persistence: None, rng_seed: RngSeed::Fixed(1), cases: 400, ..ProptestConfig::default()
    })]

    /// Checks that what is reported as in force is, and that the last commit takes effect or is refused.
    #[test]
    fn what_happens_between_the_locks_of_idle_loses_no_commit(
        events in prop::collection::vec((0..3_000_u32, event()), 0..12),
        interrupted in prop::collection::vec(prop_oneof![Just(0), 0..40_u32, 0..900_u32], 1..9),
    ) {
        let mut events = events;
        events.sort_by_key(|(tick, _)| *tick);
        let (mut preparation, start) = Preparation::new().unwrap();
        let (exchange, counters) = (&Exchange::new(0), &Counters::new());
        let mut bench = Bench::new(&start, (exchange, counters), events, interrupted);
        let mut gathered = Reassembly::default();
        let mut last_event = 0;
        while !bench.events.is_empty() || !bench.is_known {
            prepare_pending(&mut preparation, &mut gathered, &mut bench, exchange, counters);
            bench.tick();
            if !bench.events.is_empty() {
                last_event = bench.ticks;
            }
            prop_assert!(bench.ticks - last_event < PATIENCE_TICKS, "{:?} is not known", bench.latest);
        }
    }
}
