//! Bad wires between the controllers: every mixture of loss, corruption,
//! duplication, delay and cut, on both at once.
//!
//! In every tick [`support::oracle`] holds the device to what must be true. In
//! each cell a host arms and commits whatever comes to its mind while the wires
//! are bad, and once they are good again everything has to work as before,
//! without restarting anything.

mod support;

use crepitus_protocol::counters::{CommsCounter, DriveCounter};
use crepitus_protocol::host::{Answer, Operation, Refusal};
use crepitus_protocol::{DeviceSettings, State, Values};
use crepitus_virtual_device::{Faults, Start};
use fastrand::Rng;
use std::time::Instant;
use support::oracle::Oracle;
use support::{Host, examination, random_values};

const LOSSES: [f64; 4] = [0.0, 0.05, 0.3, 0.7];
const CORRUPTIONS: [f64; 3] = [0.0, 0.05, 0.3];
const DUPLICATIONS: [f64; 2] = [0.0, 0.3];
const DELAYS: [u32; 3] = [0, 60, 500];
const CUTS_MS: [u64; 4] = [0, 30, 150, 400];

/// Ticks of bad wires before the cut, and after it: 500 ms.
const BAD_TICKS: u64 = 10_000;

/// Wires that are cut.
const CUT_WIRES: [[bool; 2]; 3] = [[true, true], [true, false], [false, true]];

/// Ticks within which a host gets everything back: 3 s.
const RECOVERY_TICKS: u64 = 60_000;

/// Results of a cell, or of some.
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    cells: u32,
    driven_ticks: u64,
    commits: u32,
    refused: u32,
    faults: u32,
    stale: u32,
    lost: u32,
    received: u32,
    longest: [u64; 2],
    recovery_ticks: u64,
}

impl Sum {
    fn add(&mut self, other: &Self) {
        self.cells += other.cells;
        self.driven_ticks += other.driven_ticks;
        self.commits += other.commits;
        self.refused += other.refused;
        self.faults += other.faults;
        self.stale += other.stale;
        self.lost += other.lost;
        self.received += other.received;
        for (longest, other) in self.longest.iter_mut().zip(other.longest) {
            *longest = (*longest).max(other);
        }
        self.recovery_ticks = self.recovery_ticks.max(other.recovery_ticks);
    }
}

#[test]
fn whatever_the_wires_do_nothing_goes_wrong_and_everything_comes_back() {
    let begun = Instant::now();
    println!(
        "loss  delay cells driven_s commits refused faults  stale   lost received after_heartbeat after_renewal back_ms"
    );
    let (mut total, mut seed) = (Sum::default(), 0);
    for loss in LOSSES {
        for delay_ticks in DELAYS {
            let mut sum = Sum::default();
            for corruption in CORRUPTIONS {
                for duplication in DUPLICATIONS {
                    for cut_ms in CUTS_MS {
                        let faults = Faults {
                            loss,
                            corruption,
                            duplication,
                            delay_ticks,
                            // Cells without loss have whole frames only.
                            truncation: loss / 10.0,
                            is_cut: false,
                        };
                        seed += 1;
                        sum.add(&Cell::new(seed, faults).run(cut_ms * 20));
                    }
                }
            }
            print(&format!("{loss:<5} {delay_ticks:>5}"), &sum);
            total.add(&sum);
        }
    }
    print("all        ", &total);
    println!("in {:.1} s", begun.elapsed().as_secs_f64());
    assert!(total.cells >= 200);
    // Faults of the wire reach all that the grid is to show.
    assert!(total.commits > 0 && total.refused > 0 && total.faults > 0);
    assert!(total.stale > 0 && total.lost > 0);
    assert!(total.longest[0] >= 90 && total.longest[1] >= 4_900);
}

fn print(name: &str, sum: &Sum) {
    println!(
        "{name} {:>5} {:>8} {:>7} {:>7} {:>6} {:>6} {:>6} {:>8} {:>15} {:>13} {:>7}",
        sum.cells,
        sum.driven_ticks / 20_000,
        sum.commits,
        sum.refused,
        sum.faults,
        sum.stale,
        sum.lost,
        sum.received,
        sum.longest[0],
        sum.longest[1],
        sum.recovery_ticks / 20,
    );
}

struct Cell {
    host: Host,
    rng: Rng,
    faults: Faults,
    refused: u32,
}

impl Cell {
    fn new(seed: u64, faults: Faults) -> Self {
        let start = Start {
            seed,
            ..Start::default()
        };
        let mut host = Host::new(&examination(), &start);
        let kept = *host.device.board().comms().values();
        host.oracle = Some(Oracle::new(host.device.board(), kept));
        Self {
            host,
            rng: Rng::with_seed(seed),
            faults,
            refused: 0,
        }
    }

    fn run(mut self, cut_ticks: u64) -> Sum {
        self.host.run(400);
        self.host.subscribe();
        self.host.arm();
        self.wires(self.faults);
        self.meddle(BAD_TICKS);
        if cut_ticks > 0 {
            let [down, up] = CUT_WIRES[self.rng.usize(0..CUT_WIRES.len())];
            let board = self.host.device.board_mut();
            board.down().injector.faults.is_cut = down;
            board.up().injector.faults.is_cut = up;
            self.meddle(cut_ticks);
            self.wires(self.faults);
        }
        self.meddle(BAD_TICKS);
        self.wires(Faults::default());
        let recovery_ticks = self.recover();
        self.balance();
        let host = &self.host;
        let oracle = host.oracle.as_ref().expect("an oracle");
        Sum {
            cells: 1,
            driven_ticks: oracle.driven_ticks,
            commits: host.drive_count(DriveCounter::Commits),
            refused: self.refused,
            faults: host.drive_count(DriveCounter::Faults) + host.comms_count(CommsCounter::Faults),
            stale: host.drive_count(DriveCounter::StaleHeartbeats),
            lost: host.comms_count(CommsCounter::LostSamples),
            received: host.comms_count(CommsCounter::ReceivedSamples),
            longest: oracle.longest,
            recovery_ticks,
        }
    }

    fn wires(&mut self, faults: Faults) {
        let board = self.host.device.board_mut();
        board.down().injector.faults = faults;
        board.up().injector.faults = faults;
    }

    /// A host that does not wait for better times.
    fn meddle(&mut self, ticks: u64) {
        let end = self.host.device.board().now() + ticks;
        while self.host.device.board().now() < end {
            if self.host.device.board().drive().state() != State::Armed {
                self.host.renew_every = Some(1_000);
                self.host.try_ask(Operation::ClearFault, 1);
                self.host.try_ask(Operation::Arm, 1);
            }
            match self.rng.u8(0..16) {
                0..9 => self.commit_something(),
                9 => {
                    self.host.try_ask(Operation::Status, 1);
                }
                10 => {
                    self.host.try_ask(Operation::Disarm, 1);
                }
                // The host forgets to renew.
                11 => self.host.renew_every = None,
                _ => {}
            }
            let pause = self.rng.u64(0..1_000);
            self.host.run(pause);
        }
    }

    fn commit_something(&mut self) {
        let comms = self.host.device.board().comms();
        let (mut base, values) = (comms.revision(), *comms.values());
        if self.rng.u8(0..6) == 0 {
            let values = random_values::forbidden(&mut self.rng, &values);
            assert!(DeviceSettings::of(&values).is_err());
            let answer = self.host.try_ask(Operation::Commit { base, values }, 1);
            assert!(!matches!(answer, Some(Ok(_))), "{answer:?}");
            self.refused += 1;
            return;
        }
        let values = random_values::allowed(&mut self.rng, &values);
        if self.rng.u8(0..6) == 0 {
            base.0 += 7;
            let answer = self.host.try_ask(Operation::Commit { base, values }, 1);
            assert!(!matches!(answer, Some(Ok(_))), "{answer:?}");
            self.refused += 1;
            return;
        }
        self.propose(&values);
        let answer = self.host.try_ask(Operation::Commit { base, values }, 1);
        let oracle = self.host.oracle.as_mut().expect("an oracle");
        match answer {
            Some(Ok(Answer::Committed { revision })) => oracle.committed(revision, &values),
            Some(Err(Refusal::Values(error))) => panic!("{error:?} of {values:?}"),
            // The commit may still take effect.
            None | Some(Err(Refusal::Unconfirmed)) => {}
            Some(_) => oracle.withdraw(),
        }
    }

    fn propose(&mut self, values: &Values) {
        if let Some(oracle) = &mut self.host.oracle {
            oracle.propose(values);
        }
    }

    /// The wires are good: what a host has to do until all is as it was.
    fn recover(&mut self) -> u64 {
        self.host.renew_every = Some(1_000);
        let begun = self.host.device.board().now();
        let end = begun + RECOVERY_TICKS;
        let mut last = None;
        loop {
            assert!(
                self.host.device.board().now() < end,
                "{:?}: {last:?}",
                self.faults
            );
            self.host
                .ask(Operation::Disarm)
                .expect("disarming is never refused");
            if self.host.ask(Operation::ClearFault).is_err() {
                self.host.run(200);
                continue;
            }
            self.host.run(100);
            let answer = self.host.ask(Operation::Arm);
            if answer.is_ok() {
                break;
            }
            last = Some(answer);
        }
        let back = self.host.device.board().now() - begun;
        let status = self.host.status();
        assert_eq!(
            (status.state, status.drive_fault, status.comms_fault),
            (State::Armed, 0, 0)
        );
        assert_eq!(status.in_force, status.revision);
        let (revision, values) = self.host.parameters();
        let drive = self.host.device.board().drive();
        assert_eq!(
            (drive.revision(), drive.values()),
            (revision, Some(&values))
        );
        let next = random_values::allowed(&mut self.rng, &values);
        self.propose(&next);
        let answer = self.host.ask(Operation::Commit {
            base: revision,
            values: next,
        });
        assert!(matches!(answer, Ok(Answer::Committed { .. })), "{answer:?}");
        let received = self.host.accounting.expect("a subscription").received;
        self.host.run(2_000);
        let more = self.host.accounting.expect("a subscription").received - received;
        assert!(more >= 1_900, "{more} samples in 2,000 ticks");
        back
    }

    /// Accounts for every sample.
    fn balance(&self) {
        let host = &self.host;
        let drive = |counter| u64::from(host.drive_count(counter));
        let comms = |counter| u64::from(host.comms_count(counter));
        let accounting = host.accounting.expect("a subscription");
        let handed_over = drive(DriveCounter::Produced) - drive(DriveCounter::Dropped);
        let accounted = comms(CommsCounter::ReceivedSamples) + comms(CommsCounter::LostSamples);
        // A block in the drive's queue, and one on the wire.
        let on_the_way = handed_over.checked_sub(accounted);
        assert!(
            on_the_way.is_some_and(|samples| samples <= 40),
            "{:?}: {handed_over} samples handed over, {accounted} accounted for",
            self.faults
        );
        // The wires were good until the subscription: nothing was lost before.
        assert_eq!(
            comms(CommsCounter::SentSamples) + comms(CommsCounter::DroppedSamples),
            comms(CommsCounter::ReceivedSamples) - accounting.first_tick,
            "sent and dropped is what was received"
        );
        let on_the_way = comms(CommsCounter::SentSamples) - accounting.received;
        assert!(
            on_the_way <= 120,
            "{on_the_way} samples between comms and host"
        );
        assert_eq!(comms(CommsCounter::DriveRestarts), 0);
    }
}
