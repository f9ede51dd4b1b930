//! One cause: from an armed device to a fault, and back.

use crate::case::{Case, Moment};
use crate::support::{Host, examination};
use crepitus_protocol::fault::{Detector, FaultSpec};
use crepitus_protocol::host::{Answer, Operation, Refusal};
use crepitus_protocol::link::DriveRefusal;
use crepitus_protocol::{Fault, State};
use crepitus_virtual_device::Start;

/// Ticks for which the cause is watched after the fault: 100 ms.
const AFTER_TICKS: u64 = 2_000;

/// Ticks after which a fault that was not noticed is none: an overload takes two
/// seconds.
const MOST_TICKS: u64 = 60_000;

/// Measured times and torque: the worst of all phases.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Times {
    /// Ticks from the cause until the bridge floated for good.
    pub(crate) floats: u64,
    /// Ticks from the cause until the fault was latched.
    pub(crate) latched: u64,
    /// The largest torque of the motor meanwhile, N·m.
    pub(crate) most_nm: f64,
}

/// Tries a case at each of its phases.
pub(crate) fn run(spec: &FaultSpec, case: &Case) -> Times {
    let mut worst = Times::default();
    for phase in case.phases.clone() {
        let context = format!("{}, {}, phase {phase}", spec.name, case.name);
        let times = Trial {
            host: ready(case, phase),
            spec,
            case,
            context: &context,
            most_nm: 0.0,
        }
        .run();
        worst.floats = worst.floats.max(times.floats);
        worst.latched = worst.latched.max(times.latched);
        worst.most_nm = worst.most_nm.max(times.most_nm);
    }
    worst
}

/// A device at the moment of the cause.
fn ready(case: &Case, phase: u64) -> Host {
    let mut host = Host::new(&examination(), &Start::default());
    host.run(400);
    host.subscribe();
    for (name, value) in case.values {
        host.set(name, *value);
    }
    assert_eq!(host.ask_patiently(Operation::Zero), Ok(Answer::Done));
    if case.moment == Moment::Armed {
        host.arm();
        // What has just happened is seen by what was before.
        (case.settled)(&host);
        let settled = (0..40_000).any(|_| {
            host.tick();
            (case.settled)(&host)
        });
        assert!(settled, "{}: the moment comes", case.name);
        assert_eq!(
            host.device.board().drive().state(),
            State::Armed,
            "{}",
            case.name
        );
    }
    host.run(phase);
    host
}

struct Trial<'a> {
    host: Host,
    spec: &'a FaultSpec,
    case: &'a Case,
    context: &'a str,
    /// The largest torque of the motor so far, N·m.
    most_nm: f64,
}

impl Trial<'_> {
    fn run(mut self) -> Times {
        let times = match self.case.moment {
            Moment::Armed | Moment::Disarmed => self.provoke(),
            Moment::Arming => self.provoke_arming(),
        };
        self.stays();
        self.recovers();
        times
    }

    /// Returns whether the fault is the one that its detector is in.
    fn is_latched(&self) -> bool {
        let board = self.host.device.board();
        let fault = match self.spec.detector {
            Detector::Drive => board.drive().fault(),
            Detector::Comms => board.comms().fault(),
        };
        fault == Some(self.spec.fault)
    }

    /// A tick with the cause.
    fn tick(&mut self, since: u64) -> bool {
        (self.case.cause)(&mut self.host, since);
        if since == 0 {
            self.host.device.board_mut().up().falsify = self.case.falsify;
        }
        self.host.tick();
        let board = self.host.device.board();
        self.most_nm = self.most_nm.max(board.leg().motor_nm().abs());
        board.is_driven()
    }

    fn times(&self, floats: u64, latched: u64) -> Times {
        Times {
            floats,
            latched,
            most_nm: self.most_nm,
        }
    }

    fn provoke(&mut self) -> Times {
        let was_armed = self.case.moment == Moment::Armed;
        let (mut floats, mut latched) = (0, None);
        let (mut since, mut onset) = (0, None);
        while latched.is_none_or(|latched| since < latched + AFTER_TICKS) {
            if self.tick(since) {
                // The bridge floats in the next tick, or later.
                floats = since + 2;
            } else if was_armed {
                floats = floats.max(1);
            }
            if (self.case.onset)(&self.host) {
                onset.get_or_insert(since);
            }
            since += 1;
            if latched.is_none() && self.is_latched() {
                latched = Some(since);
            }
            assert!(
                latched.is_some() || since < MOST_TICKS,
                "{}: not noticed; drive {:?}, comms {:?}, driven for {floats} ticks",
                self.context,
                self.host.device.board().drive().fault(),
                self.host.device.board().comms().fault(),
            );
        }
        let onset = onset.unwrap_or(0);
        self.times(
            floats.saturating_sub(onset),
            latched.unwrap_or(since).saturating_sub(onset),
        )
    }

    /// The cause is there before, and arming finds it.
    fn provoke_arming(&mut self) -> Times {
        self.host.renew_every = Some(1_000);
        let request = self.host.request(Operation::Arm);
        self.host.say(&request);
        let (mut driven, mut latched) = (None, None);
        let (mut floats, mut since) = (0, 0);
        while latched.is_none_or(|latched| since < latched + AFTER_TICKS) {
            if self.tick(since) {
                floats = since + 2 - *driven.get_or_insert(since);
            }
            since += 1;
            if latched.is_none() && self.is_latched() {
                latched = Some(since);
            }
            assert!(since < MOST_TICKS, "{}: not noticed", self.context);
        }
        let answer = self.host.answer_to(&request).expect("an answer");
        let code = self.spec.fault.code();
        assert!(
            [
                Err(Refusal::Drive(DriveRefusal::Faulted { code })),
                Err(Refusal::Faulted { code })
            ]
            .contains(&answer),
            "{}: {answer:?}",
            self.context
        );
        assert!(!self.host.device.board().is_driven(), "{}", self.context);
        self.times(floats, latched.unwrap_or(since))
    }

    /// The fault stays, whatever the host asks for.
    fn stays(&mut self) {
        if !self.host.device.board().comms_runs() {
            return;
        }
        if !self.host.device.is_plugged_in() {
            self.host.reconnect();
        }
        for since in 0..AFTER_TICKS {
            assert!(
                !self.tick(since + MOST_TICKS),
                "{}: driven again",
                self.context
            );
        }
        assert!(self.is_latched(), "{}: not latched", self.context);
        self.arming_is_refused();
    }

    fn arming_is_refused(&mut self) {
        let answer = self.host.ask_patiently(Operation::Arm);
        let board = self.host.device.board();
        let codes = [board.drive().fault(), board.comms().fault()]
            .map(|fault| fault.map_or(0, Fault::code));
        assert!(
            matches!(answer, Err(Refusal::Faulted { code }) if codes.contains(&code))
                || answer == Err(Refusal::DriveSilent),
            "{}: {answer:?} with {codes:?}",
            self.context
        );
        assert!(!self.host.device.board().is_driven(), "{}", self.context);
        assert!(codes.contains(&self.spec.fault.code()), "{}", self.context);
    }

    /// Repaired and cleared, it works as before.
    fn recovers(&mut self) {
        (self.case.repair)(&mut self.host);
        self.host.run(1_000);
        if !self.host.device.is_plugged_in() {
            self.host.reconnect();
        }
        let status = self.host.status();
        assert_eq!(
            status.state,
            State::Faulted,
            "{}: a repair clears nothing",
            self.context
        );
        self.arming_is_refused();
        assert_eq!(
            self.host.ask_patiently(Operation::ClearFault),
            Ok(Answer::Done),
            "{}",
            self.context
        );
        self.host.run(200);
        let status = self.host.status();
        assert_eq!(
            (status.state, status.drive_fault, status.comms_fault),
            (State::Disarmed, 0, 0),
            "{}",
            self.context
        );
        self.host.arm();
        self.host.run(400);
        assert_eq!(self.host.status().state, State::Armed, "{}", self.context);
        assert!(self.host.device.board().is_driven(), "{}", self.context);
        assert_eq!(
            self.host.ask(Operation::Disarm),
            Ok(Answer::Done),
            "{}",
            self.context
        );
        self.host.run(100);
        assert!(!self.host.device.board().is_driven(), "{}", self.context);
    }
}
