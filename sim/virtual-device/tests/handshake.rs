//! Arming, lease and commit, model-checked: both controllers' own code through every
//! run in which one frame fails in one of six ways, through disarms at instants of every
//! phase, restarts at those of arming and of a commit, the latter also with a frame that fails,
//! and through runs in which two frames fail. (Every order of tasks in a commit:
//! `crepitus-device`, `idle`.)
//!
//! A run is a host that arms, commits, and disarms. Nothing in it is random, so a
//! run is given by what fails: which frame, on which wire, is lost, comes late or
//! comes again, or which controller restarts at which tick. A run without faults tells
//! which frames there are. [`support::oracle`] watches every tick; what is reported
//! to the host has to be true, and everything has to come back.
//!
//! `CREPITUS_LONG=1` tries every pair of faults of the link.

mod support;

use crepitus_protocol::counters::DriveCounter;
use crepitus_protocol::host::{Answer, Operation, Refusal};
use crepitus_protocol::management::ResetCause;
use crepitus_protocol::{Revision, State, Values};
use crepitus_virtual_device::board::Controller;
use crepitus_virtual_device::faults::Fate;
use crepitus_virtual_device::{Board, Start};
use support::oracle::Oracle;
use support::{Host, examination, set};

/// Possible fates of a frame. The drive accepts what is 400 ticks old.
const FATES: [Fate; 6] = [
    Fate::Lost,
    Fate::Late(45),
    Fate::Late(450),
    Fate::Again(0),
    Fate::Again(300),
    Fate::Again(1_200),
];

/// Start-up times of a controller: within a heartbeat, and slow, ticks.
const START_UP_TICKS: [u64; 2] = [2, 240];

/// Ticks between two instants at which a controller restarts: no multiple of a
/// millisecond's 20.
const RESTART_EVERY: usize = 7;

/// Ticks between two such instants where a frame fails, too.
const RESTART_WITH_FAILURE_EVERY: usize = 67;

/// Ticks after a commit's answer in which a controller still restarts.
const AFTER_COMMIT_TICKS: u64 = 60;

/// One of the two wires.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Way {
    Down,
    Up,
}

/// A fault of the link: the frame of this number, from the request to arm on.
type Failure = (Way, u64, Fate);

fn injector(board: &mut Board, way: Way) -> &mut crepitus_virtual_device::FaultInjector {
    match way {
        Way::Down => &mut board.down().injector,
        Way::Up => &mut board.up().injector,
    }
}

/// Answers that the host received.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Told {
    arming: Option<Result<Answer, Refusal>>,
    commit: Option<Result<Answer, Refusal>>,
}

struct Run {
    host: Host,
    /// Frames of each wire before the request.
    before: [u64; 2],
    begun: u64,
}

impl Run {
    /// A device that nobody has armed, about to be armed.
    fn new() -> Self {
        let mut host = Host::new(&examination(), &Start::default());
        let kept = *host.device.board().comms().values();
        host.oracle = Some(Oracle::new(host.device.board(), kept));
        host.run(400);
        host.open();
        assert_eq!(host.ask(Operation::Zero), Ok(Answer::Done));
        host.renew_every = Some(1_000);
        let board = host.device.board_mut();
        let before = [Way::Down, Way::Up].map(|way| injector(board, way).passed());
        let begun = board.now();
        Self {
            host,
            before,
            begun,
        }
    }

    /// An armed one, about to commit.
    fn armed() -> Self {
        let mut run = Self::new();
        assert_eq!(run.host.ask(Operation::Arm), Ok(Answer::Done));
        let board = run.host.device.board_mut();
        run.before = [Way::Down, Way::Up].map(|way| injector(board, way).passed());
        run.begun = board.now();
        run
    }

    fn with(failures: &[Failure]) -> Self {
        Self::new().fails(failures)
    }

    fn fails(mut self, failures: &[Failure]) -> Self {
        for &(way, number, fate) in failures {
            let number = self.before[way as usize] + number;
            let board = self.host.device.board_mut();
            injector(board, way).fates.insert(number, fate);
        }
        self
    }

    fn board(&self) -> &Board {
        self.host.device.board()
    }

    /// Arms, commits, and disarms; what is reported has to be true.
    fn play(&mut self) -> Told {
        let armings = self.host.drive_count(DriveCounter::Armings);
        let arming = self.host.try_ask(Operation::Arm, 1);
        if arming == Some(Ok(Answer::Done)) {
            assert_eq!(self.board().drive().state(), State::Armed);
        } else if arming.is_some() {
            // What was refused does not come true later.
            for _ in 0..600 {
                self.host.tick();
                assert!(!self.board().is_driven(), "torque after {arming:?}");
            }
        }
        let commit = self.commit();
        let armed = self.host.drive_count(DriveCounter::Armings) - armings;
        assert!(armed <= 1, "armed {armed} times by one request");
        self.host.ask(Operation::Disarm).expect("is never refused");
        // Comms answers at once, and switches its line off in its next millisecond.
        self.host.run(25);
        assert!(
            !self.board().line_is_on(Controller::Comms),
            "its line is on"
        );
        Told { arming, commit }
    }

    /// Torque stays off, by both controllers, whatever comes late or again.
    fn stay_off(&mut self) {
        // The drive hears of it within a heartbeat or two that fail.
        for tick in 0..1_300 {
            self.host.tick();
            let board = self.board();
            assert!(!board.is_driven(), "torque after a disarm");
            assert!(
                !board.line_is_on(Controller::Comms),
                "the line of comms is on"
            );
            let is_off = matches!(board.drive().state(), State::Disarmed | State::Faulted);
            let its_line = board.line_is_on(Controller::Drive);
            assert!(tick < 100 || is_off && !its_line, "the drive is not off");
        }
    }

    /// Values of the commit, and the revision from which they are committed.
    fn proposal(&self) -> (Revision, Values) {
        let comms = self.board().comms();
        let (base, mut values) = (comms.revision(), *comms.values());
        set(&mut values, "crepitus.static_torque_nm", 0.5);
        (base, values)
    }

    fn commit(&mut self) -> Option<Result<Answer, Refusal>> {
        let (base, values) = self.proposal();
        let oracle = self.host.oracle.as_mut().expect("an oracle");
        oracle.propose(&values);
        let commits = self.host.drive_count(DriveCounter::Commits);
        let commit = self.host.try_ask(Operation::Commit { base, values }, 1);
        if let Some(Ok(answer)) = commit {
            let Answer::Committed { revision } = answer else {
                panic!("{answer:?}");
            };
            let oracle = self.host.oracle.as_ref().expect("an oracle");
            oracle.committed(revision, &values);
            let comms = self.board().comms();
            assert_eq!((comms.revision(), comms.values()), (revision, &values));
            assert_eq!(self.board().drive().revision(), revision);
            let made = self.host.drive_count(DriveCounter::Commits) - commits;
            assert_eq!(made, 1, "one commit");
        }
        commit
    }

    /// The link is good: everything comes back within 3 s.
    fn recover(&mut self) {
        let end = self.board().now() + 60_000;
        loop {
            assert!(self.board().now() < end, "it does not come back");
            self.host.run(100);
            if self.host.ask(Operation::ClearFault).is_ok()
                && self.host.ask(Operation::Arm) == Ok(Answer::Done)
            {
                break;
            }
        }
        let status = self.host.status();
        let faults = (status.drive_fault, status.comms_fault);
        assert_eq!((status.state, faults), (State::Armed, (0, 0)));
        let (revision, values) = self.host.parameters();
        let drive = self.board().drive();
        let in_force = (drive.revision(), drive.values());
        assert_eq!(in_force, (revision, Some(&values)));
    }
}

/// Frames of each wire in a run without faults, and its ticks.
fn frames() -> ([u64; 2], u64) {
    let mut run = Run::new();
    let told = run.play();
    assert_eq!(told.arming, Some(Ok(Answer::Done)));
    assert!(matches!(told.commit, Some(Ok(_))), "{told:?}");
    frames_since(run)
}

/// Frames of each wire in a commit without faults, and its ticks.
fn frames_of_commit() -> ([u64; 2], u64) {
    let mut run = Run::armed();
    let commit = run.commit();
    assert!(matches!(commit, Some(Ok(_))), "{commit:?}");
    frames_since(run)
}

fn frames_since(mut run: Run) -> ([u64; 2], u64) {
    let board = run.host.device.board_mut();
    let after = [Way::Down, Way::Up].map(|way| injector(board, way).passed());
    let ticks = board.now() - run.begun;
    ([after[0] - run.before[0], after[1] - run.before[1]], ticks)
}

/// Every fault of a frame of a run.
fn failures() -> Vec<Failure> {
    failures_of(frames().0)
}

fn failures_of(frames: [u64; 2]) -> Vec<Failure> {
    let mut all = Vec::new();
    for (way, frames) in [Way::Down, Way::Up].into_iter().zip(frames) {
        for number in 0..frames {
            all.extend(FATES.map(|fate| (way, number, fate)));
        }
    }
    all
}

/// Plays runs, and counts those in which it was not reported to the host that all was done.
fn play_all<'a>(runs: impl Iterator<Item = Vec<&'a Failure>>) -> (u32, u32) {
    let (mut played, mut not_done) = (0, 0);
    for failures in runs {
        let failures: Vec<_> = failures.into_iter().copied().collect();
        let outcome = std::panic::catch_unwind(|| {
            let mut run = Run::with(&failures);
            let told = run.play();
            run.stay_off();
            run.recover();
            told
        });
        let Ok(told) = outcome else {
            panic!("in the run with {failures:?}");
        };
        played += 1;
        let is_done = told.arming == Some(Ok(Answer::Done)) && matches!(told.commit, Some(Ok(_)));
        not_done += u32::from(!is_done);
    }
    println!("{played} runs, {not_done} in which arming or the commit was not confirmed");
    (played, not_done)
}

#[test]
fn any_one_frame_may_fail() {
    let failures = failures();
    let (played, not_done) = play_all(failures.iter().map(|failure| vec![failure]));
    assert!(played > 400, "{played}");
    // One frame that fails is made up for.
    assert_eq!(not_done, 0);
}

#[test]
fn any_two_frames_may_fail() {
    let failures = failures();
    let is_long = std::env::var_os("CREPITUS_LONG").is_some_and(|long| long != "0");
    // Else one in 35: strides that have no divisor in common with the fates.
    let (first, second) = if is_long { (1, 1) } else { (5, 7) };
    let pairs = (0..failures.len()).step_by(first).flat_map(|i| {
        let later = (i + 1..failures.len()).step_by(second);
        let pairs = later.map(move |j| (i, j));
        pairs.map(|(i, j)| vec![&failures[i], &failures[j]])
    });
    let (played, _) = play_all(pairs);
    assert!(played > 2_500, "{played}");
}

/// Every instant of a disarm while arming is under way, with a frame that fails.
#[test]
fn a_disarm_overtakes_arming_at_any_time() {
    let failures = failures();
    let mut played = 0;
    for at in (0..700).step_by(37) {
        for failure in failures.iter().filter(|(way, ..)| *way == Way::Down) {
            let outcome = std::panic::catch_unwind(|| {
                let mut run = Run::with(&[*failure]);
                let arm = run.host.request(Operation::Arm);
                run.host.say(&arm);
                run.host.run(at);
                run.host.ask(Operation::Disarm).expect("is never refused");
                run.host.run(25);
                run.stay_off();
            });
            assert!(
                outcome.is_ok(),
                "disarmed {at} ticks after the request, {failure:?}"
            );
            played += 1;
        }
    }
    println!("{played} runs");
    assert!(played > 2_000, "{played}");
}

/// A controller that restarts ends the torque, and it does not come back by itself.
#[test]
fn either_controller_may_restart_at_any_time() {
    let (_, ticks) = frames();
    let (mut played, mut armed_before) = (0, 0);
    for controller in [Controller::Drive, Controller::Comms] {
        for start_up_ticks in START_UP_TICKS {
            for at in (0..ticks).step_by(RESTART_EVERY) {
                let case = format!("{controller:?} restarts {at} ticks after the request");
                armed_before += u32::from(restart(controller, at, start_up_ticks, &case));
                played += 1;
            }
        }
    }
    println!("{played} runs, {armed_before} of them with torque when it happened");
    assert!(played > 300 && armed_before > 50);
}

/// Returns whether there was torque when it happened.
fn restart(controller: Controller, at: u64, start_up_ticks: u64, case: &str) -> bool {
    let mut run = Run::new();
    let host = &mut run.host;
    let arm = host.request(Operation::Arm);
    host.say(&arm);
    host.run(at);
    let was_armed = host.device.board().drive().state() == State::Armed;
    // The oracle knows only a device that does not restart.
    host.oracle = None;
    let board = host.device.board_mut();
    board.reset_for(controller, ResetCause::Requested, start_up_ticks);
    assert!(!board.is_driven(), "{case}: torque in a reset");
    for _ in 0..2_000 {
        host.tick();
        assert!(!host.device.board().is_driven(), "{case}: torque after it");
    }
    if controller == Controller::Comms {
        host.reconnect();
    }
    if controller == Controller::Drive {
        assert_eq!(host.ask(Operation::Zero), Ok(Answer::Done), "{case}");
    }
    host.ask(Operation::Disarm).expect("is never refused");
    run.host.renew_every = Some(1_000);
    run.recover();
    was_armed
}

/// A controller that restarts in a commit or soon after ends the torque, and both have the same
/// whole set of values again.
#[test]
fn either_controller_may_restart_at_any_time_of_a_commit() {
    let (_, ticks) = frames_of_commit();
    let (mut played, mut committed) = (0, 0);
    for controller in [Controller::Drive, Controller::Comms] {
        for start_up_ticks in START_UP_TICKS {
            for at in (0..ticks + AFTER_COMMIT_TICKS).step_by(RESTART_EVERY) {
                let case = format!("{controller:?} restarts {at} ticks after the commit");
                let run = Run::armed();
                committed += u32::from(restart_in_commit(
                    run,
                    controller,
                    (at, start_up_ticks),
                    &case,
                ));
                played += 1;
            }
        }
    }
    println!("{played} runs of {ticks} ticks, {committed} of them committed");
    assert!(played > 50 && committed > 10 && committed < played);
}

/// Restarts in a commit of which a frame is lost, comes late or comes again.
#[test]
fn either_controller_may_restart_in_a_commit_of_which_a_frame_fails() {
    let (frames, ticks) = frames_of_commit();
    let (mut played, mut committed) = (0, 0);
    for (n, failure) in failures_of(frames).into_iter().enumerate() {
        // Other instants for each, so that all are met by some.
        let first = 5 * n % RESTART_WITH_FAILURE_EVERY;
        let instants = (0..ticks + AFTER_COMMIT_TICKS).skip(first);
        for at in instants.step_by(RESTART_WITH_FAILURE_EVERY) {
            for controller in [Controller::Drive, Controller::Comms] {
                let case = format!("{controller:?} restarts {at} ticks after it, {failure:?}");
                let run = Run::armed().fails(&[failure]);
                let times = (at, START_UP_TICKS[0]);
                committed += u32::from(restart_in_commit(run, controller, times, &case));
                played += 1;
            }
        }
    }
    println!("{played} runs of {ticks} ticks, {committed} of them committed");
    assert!(played > 200 && committed > 10 && committed < played);
}

/// Returns whether it was reported to the host that the commit is in force.
fn restart_in_commit(
    mut run: Run,
    controller: Controller,
    (at, start_up_ticks): (u64, u64),
    case: &str,
) -> bool {
    let (base, proposed) = run.proposal();
    let kept = *run.board().comms().values();
    let host = &mut run.host;
    // The oracle knows only a device that does not restart.
    host.oracle = None;
    let request = host.request(Operation::Commit {
        base,
        values: proposed,
    });
    host.say(&request);
    let mut answer = None;
    for tick in 0..at + 2_000 {
        if tick == at {
            let board = host.device.board_mut();
            board.reset_for(controller, ResetCause::Requested, start_up_ticks);
        }
        host.tick();
        let board = host.device.board();
        assert!(tick < at || !board.is_driven(), "{case}: torque after it");
        let in_force = board.drive().values();
        let is_whole = in_force.is_none_or(|values| [kept, proposed].contains(values));
        assert!(is_whole, "{case}: {in_force:?}");
        let reply = (host.take_replies().into_iter()).find(|reply| reply.number == request.number);
        answer = answer.or(reply.map(|reply| reply.answer));
    }
    let is_committed = matches!(answer, Some(Ok(Answer::Committed { .. })));
    if controller == Controller::Comms {
        host.reconnect();
    } else {
        assert_eq!(
            host.ask_patiently(Operation::Zero),
            Ok(Answer::Done),
            "{case}"
        );
    }
    host.ask(Operation::Disarm).expect("is never refused");
    run.recover();
    let values = *run.board().comms().values();
    if controller == Controller::Comms {
        // The commit was not saved.
        assert_eq!(values, kept, "{case}");
    } else {
        let is_kept = values == kept && !is_committed;
        assert!(values == proposed || is_kept, "{case}");
    }
    is_committed
}
