//! Faults of the vibration actuator's coil: each switches off the actuator and leaves the
//! motor on.

use crate::PAGE;
use crate::breakage::board;
use crate::support::{Host, set, with_actuator};
use crepitus_protocol::coil::COIL_FAULTS;
use crepitus_protocol::host::{Answer, Operation};
use crepitus_protocol::telemetry::CoilCurrent;
use crepitus_protocol::{CoilFault, State};
use crepitus_virtual_device::Start;
use crepitus_virtual_device::board::Controller;
use crepitus_virtual_device::leg::{CoilFaults, CurrentSensor};

/// Phases at which each is tried, ticks apart.
const PHASES: u64 = 10;
const APART_TICKS: u64 = 37;

/// A cause, and its repair.
struct Cause {
    fault: CoilFault,
    name: &'static str,
    values: &'static [(&'static str, f64)],
    breaks: fn(&mut Host),
}

fn faults(host: &mut Host, faults: CoilFaults) {
    board(host).leg_mut().set_coil_faults(faults);
}

fn sensor(host: &mut Host, sensor: CurrentSensor) {
    faults(
        host,
        CoilFaults {
            sensor,
            ..CoilFaults::default()
        },
    );
}

fn mend(host: &mut Host) {
    faults(host, CoilFaults::default());
    board(host).set_coil_converter(true);
}

const CAUSES: [Cause; 9] = [
    Cause {
        fault: CoilFault::Driver,
        name: "its driver pulls nFAULT low, or the wire is broken",
        values: &[],
        breaks: |host| {
            faults(
                host,
                CoilFaults {
                    driver_fails: true,
                    ..CoilFaults::default()
                },
            );
        },
    },
    Cause {
        fault: CoilFault::CurrentMissing,
        name: "the converter stops",
        values: &[],
        breaks: |host| board(host).set_coil_converter(false),
    },
    Cause {
        fault: CoilFault::Short,
        name: "0.3 Ω across its wires",
        values: &[],
        breaks: |host| {
            faults(
                host,
                CoilFaults {
                    short_ohm: Some(0.3),
                    ..CoilFaults::default()
                },
            );
        },
    },
    Cause {
        fault: CoilFault::Short,
        name: "the sensor is stuck at the end of its range",
        values: &[],
        breaks: |host| sensor(host, CurrentSensor::StuckAt(3.3)),
    },
    Cause {
        fault: CoilFault::Open,
        name: "a wire is broken",
        values: &[],
        breaks: |host| {
            faults(
                host,
                CoilFaults {
                    is_open: true,
                    ..CoilFaults::default()
                },
            );
        },
    },
    Cause {
        fault: CoilFault::Open,
        name: "the sensor is stuck at zero",
        values: &[],
        breaks: |host| sensor(host, CurrentSensor::StuckAt(0.0)),
    },
    Cause {
        fault: CoilFault::CurrentMismatch,
        name: "the sensor is wired the wrong way round",
        values: &[],
        breaks: |host| sensor(host, CurrentSensor::Gain(-1.0)),
    },
    Cause {
        fault: CoilFault::CurrentMismatch,
        name: "the sensor is stuck at 0.4 A",
        values: &[],
        breaks: |host| sensor(host, CurrentSensor::StuckAt(0.4)),
    },
    Cause {
        fault: CoilFault::Hot,
        name: "the sensor shows 0.1 A too much",
        values: &[("vibration-actuator.continuous_current_a", 0.05)],
        breaks: |host| sensor(host, CurrentSensor::Offset(0.1)),
    },
];

/// Armed, with a grating joint whose bone rings on the actuator.
fn ready(values: &[(&str, f64)]) -> Host {
    let mut host = Host::new(&with_actuator(), &Start::default());
    host.run(400);
    host.subscribe();
    host.commit(|all| {
        set(all, "bone-shaping.render", 1.0);
        set(all, "bone-shaping.output", 1.0);
        set(all, "vibration-actuator.render", 1.0);
        set(all, "vibration-actuator.gain", 2.0);
        for (name, value) in values {
            set(all, name, *value);
        }
    })
    .expect("a commit");
    assert_eq!(host.ask_patiently(Operation::Zero), Ok(Answer::Done));
    host.arm();
    assert!(host.device.board().coil_is_driven());
    host.run(4_000);
    assert_eq!(host.device.board().drive().coil_fault(), None);
    host
}

/// A short circuit is one as soon as there is a voltage.
fn until_loud(host: &mut Host) {
    let is_loud = |host: &Host| {
        let volts = host.device.board().leg().coil_v();
        volts.is_some_and(|volts| volts.abs() > 1.0)
    };
    let came = (0..20_000).any(|_| {
        host.tick();
        is_loud(host)
    });
    assert!(came);
}

/// Ticks until the coil is not driven, and until the fault is latched.
fn provoke(host: &mut Host, cause: &Cause) -> (u64, u64) {
    let spec = CoilFault::find(cause.fault.code()).expect("a fault");
    let (mut driven, mut latched) = (0, None);
    (cause.breaks)(host);
    for since in 1..=u64::from(spec.within_ticks) + 400 {
        host.tick();
        let board = host.device.board();
        if board.coil_is_driven() {
            driven = since + 1;
        }
        if let Some(fault) = board.drive().coil_fault() {
            assert_eq!(fault, cause.fault, "{}", cause.name);
            latched.get_or_insert(since);
        }
        assert_eq!(board.drive().state(), State::Armed, "{}", cause.name);
        assert_eq!(board.drive().fault(), None, "{}", cause.name);
        if latched.is_some_and(|at| since > at + 200) {
            break;
        }
    }
    let latched = latched.unwrap_or_else(|| panic!("{}: not noticed", cause.name));
    (driven, latched)
}

/// The fault stays until it is cleared, and the motor goes on.
fn stays_until_cleared(host: &mut Host, cause: &Cause) {
    assert!(host.device.board().is_driven(), "{}", cause.name);
    let status = host.status();
    assert_eq!(
        (status.state, status.drive_fault, status.coil_fault),
        (State::Armed, 0, cause.fault.code()),
        "{}",
        cause.name
    );
    host.run(100);
    let coil = host.last_block.expect("a block").coil_currents;
    assert_eq!(coil, [CoilCurrent::NONE; 4], "{}", cause.name);
    mend(host);
    for clears in [false, true] {
        assert_eq!(host.ask(Operation::Disarm), Ok(Answer::Done));
        host.run(200);
        if clears {
            let cleared = host.ask_patiently(Operation::ClearFault);
            assert_eq!(cleared, Ok(Answer::Done), "{}", cause.name);
            assert_eq!(host.device.board().drive().coil_fault(), None);
        }
        host.arm();
        host.run(400);
        assert_eq!(host.device.board().coil_is_driven(), clears);
        assert!(host.device.board().is_driven());
    }
}

#[test]
fn every_fault_of_the_coil_switches_it_off_in_time_and_leaves_the_motor() {
    let mut rows = vec![
        "| fault | cause | may take, ticks | not driven after | latched after |".into(),
        "|---|---|---|---|---|".into(),
    ];
    for spec in &COIL_FAULTS {
        let causes = CAUSES.iter().filter(|cause| cause.fault == spec.fault);
        let before = rows.len();
        for cause in causes {
            let phases = if cause.fault == CoilFault::Hot {
                1
            } else {
                PHASES
            };
            let (mut driven, mut latched) = (0, 0);
            for phase in 0..phases {
                let mut host = ready(cause.values);
                host.run(phase * APART_TICKS);
                if cause.fault == CoilFault::Short {
                    until_loud(&mut host);
                }
                let times = provoke(&mut host, cause);
                (driven, latched) = (driven.max(times.0), latched.max(times.1));
                if phase == 0 {
                    stays_until_cleared(&mut host, cause);
                }
            }
            let row = format!(
                "| {} | {} | {} | {driven} | {latched} |",
                spec.name, cause.name, spec.within_ticks
            );
            println!("{row}");
            rows.push(row);
            assert!(
                driven <= u64::from(spec.within_ticks),
                "{}: {driven}",
                cause.name
            );
        }
        assert!(rows.len() > before, "{} has no cause", spec.name);
    }
    PAGE.hold("coil", &rows);
}

#[test]
fn whatever_ends_the_torque_silences_the_coil() {
    type End = (&'static str, fn(&mut Host), u64);
    let ends: [End; 6] = [
        ("disarmed", Host::disarm, 60),
        (
            "the stop is pressed",
            |host| board(host).leg_mut().press_stop(true),
            1,
        ),
        (
            "the drive's line falls",
            |host| board(host).set_stuck(Controller::Drive, Some(false)),
            1,
        ),
        (
            "the line of comms falls",
            |host| board(host).set_stuck(Controller::Comms, Some(false)),
            1,
        ),
        (
            "comms hangs",
            |host| board(host).hang(Controller::Comms),
            101,
        ),
        (
            "the motor's converter stops",
            |host| {
                board(host)
                    .set_converter(crepitus_virtual_device::leg::CurrentPath::Monitor, false);
            },
            5,
        ),
    ];
    for (name, ends, within) in ends {
        let mut host = ready(&[]);
        ends(&mut host);
        host.run(within);
        for _ in 0..2_000 {
            assert!(!host.device.board().coil_is_driven(), "{name}");
            host.tick();
        }
        // Not by the gate alone.
        assert!(!host.device.board().coil_is_commanded(), "{name}");
        assert_eq!(host.device.board().drive().coil_fault(), None, "{name}");
    }
}

/// The gate at nSLEEP does so, as the pins of the drive stay as they were.
#[test]
fn a_drive_that_hangs_has_its_coil_put_to_sleep_by_comms() {
    let mut host = ready(&[]);
    board(&mut host).hang(Controller::Drive);
    host.run(150);
    for _ in 0..2_000 {
        host.tick();
        let board = host.device.board();
        assert!(board.coil_is_commanded() && !board.coil_is_driven());
    }
}

#[test]
fn it_is_driven_with_the_torque_and_not_while_arming_pushes() {
    let mut host = ready(&[]);
    host.disarm();
    host.run(200);
    host.renew_every = Some(1_000);
    let request = host.request(Operation::Arm);
    host.say(&request);
    let mut ticks_before = 0;
    while host.device.board().drive().state() != State::Armed {
        assert!(!host.device.board().coil_is_commanded());
        host.tick();
        ticks_before += 1;
    }
    assert!(ticks_before > 300);
    host.run(2);
    assert!(host.device.board().coil_is_driven());
}

#[test]
fn an_actuator_that_is_off_is_silent_and_measures_nothing() {
    let mut host = Host::new(&with_actuator(), &Start::default());
    host.run(400);
    host.subscribe();
    assert_eq!(host.ask_patiently(Operation::Zero), Ok(Answer::Done));
    host.arm();
    for _ in 0..4_000 {
        host.tick();
        assert!(!host.device.board().coil_is_driven());
    }
    assert_eq!(
        host.last_block.expect("a block").coil_currents,
        [CoilCurrent::NONE; 4]
    );
    // On and off again while armed: it fades out, and is asleep from then on.
    host.set("vibration-actuator.render", 1.0);
    host.run(4_000);
    assert!(host.device.board().coil_is_driven());
    let coil = host.last_block.expect("a block").coil_currents;
    assert!(coil.iter().all(|current| *current != CoilCurrent::NONE));
    host.set("vibration-actuator.render", 0.0);
    host.run(1_200);
    assert!(!host.device.board().coil_is_driven());
    assert_eq!(
        host.last_block.expect("a block").coil_currents,
        [CoilCurrent::NONE; 4]
    );
    assert_eq!(host.device.board().drive().state(), State::Armed);
}
