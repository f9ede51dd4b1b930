//! Two faults of sensors at once, of parts that are independent: who notices,
//! when, and the most that the hand can feel until then.

use crate::support::{Host, examination};
use crate::{PAGE, on_all_cores};
use crepitus_protocol::fault::FAULTS;
use crepitus_protocol::{Fault, State};
use crepitus_virtual_device::leg::CurrentPath::{Monitor, Sensor};
use crepitus_virtual_device::leg::CurrentSensor::{Gain, Offset, StuckAt};
use crepitus_virtual_device::leg::EncoderWiring::{Swapped, Unplugged};
use crepitus_virtual_device::{Board, Start};

/// A part, and what is wrong with it.
type Breakage = (&'static str, &'static str, fn(&mut Board));

/// The faults of the sensors: first those that every tick needs, then the slow ones and a read-back.
static BREAKAGES: [Breakage; 18] = [
    ("sensor", "shows nothing", |board| {
        board.leg_mut().set_current_sensor(Sensor, StuckAt(0.0));
    }),
    ("sensor", "is stuck at 1 A", |board| {
        board.leg_mut().set_current_sensor(Sensor, StuckAt(1.0));
    }),
    ("sensor", "shows half", |board| {
        board.leg_mut().set_current_sensor(Sensor, Gain(0.5));
    }),
    ("sensor", "has the wrong sign", |board| {
        board.leg_mut().set_current_sensor(Sensor, Gain(-1.0));
    }),
    ("sensor", DRIFTS, |board| {
        board.leg_mut().set_current_sensor(Sensor, Offset(DRIFT_A));
    }),
    ("monitor", "shows nothing", |board| {
        board.leg_mut().set_current_sensor(Monitor, StuckAt(0.0));
    }),
    ("monitor", "is stuck at 1 A", |board| {
        board.leg_mut().set_current_sensor(Monitor, StuckAt(1.0));
    }),
    ("monitor", "shows half", |board| {
        board.leg_mut().set_current_sensor(Monitor, Gain(0.5));
    }),
    ("monitor", "has the wrong sign", |board| {
        board.leg_mut().set_current_sensor(Monitor, Gain(-1.0));
    }),
    ("monitor", DRIFTS, |board| {
        board.leg_mut().set_current_sensor(Monitor, Offset(DRIFT_A));
    }),
    ("comparator", "is blind", |board| board.set_trip(false)),
    ("encoder", "is unplugged", |board| {
        board.leg_mut().set_encoder_wiring(Unplugged);
    }),
    ("encoder", "is swapped", |board| {
        board.leg_mut().set_encoder_wiring(Swapped);
    }),
    ("supply's sensor", "shows nothing", |board| {
        board.leg_mut().slow_sensors_mut().supply_v = Some(0.0);
    }),
    ("supply's sensor", "shows 27 V", |board| {
        board.leg_mut().slow_sensors_mut().supply_v = Some(27.0);
    }),
    ("temperature's sensor", "is unplugged", |board| {
        board.leg_mut().slow_sensors_mut().motor_c = -50.0;
    }),
    (JOINT_SENSOR, "is stuck", |board| {
        let turns = board.leg().joint_turns();
        board.leg_mut().slow_sensors_mut().joint_turns = Some(turns);
    }),
    ("read-back of the line of comms", "is off", |board| {
        board.set_comms_line_wire(false);
    }),
];

/// Number of breakages of the first kind.
const FAST: usize = 13;

/// A sensor of the current that drifts by less than the checks can tell, A, and what the torque
/// is then off by, N·m.
const DRIFT_A: f64 = 0.19;
const DRIFTS: &str = "drifts by 0.19 A";
const DRIFT_NM: f64 = 0.65;

/// The joint's sensor, which has to be fitted.
const JOINT_SENSOR: &str = "joint's sensor";

/// A joint: its static torque, N·m, and its parameters.
type Joint = (f64, &'static [(&'static str, f64)]);

const JOINTS: [Joint; 3] = [
    (0.4, &[]),
    (
        1.5,
        &[
            ("crepitus.inertia_kg_m2", 0.03),
            ("crepitus.static_torque_nm", 1.5),
            ("crepitus.kinetic_torque_nm", 1.3),
        ],
    ),
    (
        4.0,
        &[
            ("crepitus.inertia_kg_m2", 0.1),
            ("crepitus.static_torque_nm", 4.0),
            ("crepitus.kinetic_torque_nm", 3.5),
        ],
    ),
];

/// Ticks for which the hand goes on: 400 ms.
const TICKS: u64 = 8_000;

/// Two of them, of different parts.
type Pair = [&'static Breakage; 2];

/// Every pair, and with which joints: only the middle one where one is slow or a read-back.
fn pairs() -> impl Iterator<Item = (Pair, &'static [Joint])> {
    const MIDDLE: &[Joint] = &[JOINTS[1]];
    let places = (0..BREAKAGES.len()).flat_map(|n| (n + 1..BREAKAGES.len()).map(move |m| (n, m)));
    places.filter_map(|(n, m)| {
        let pair = [&BREAKAGES[n], &BREAKAGES[m]];
        let joints: &'static [Joint] = if m < FAST { &JOINTS } else { MIDDLE };
        (pair[0].0 != pair[1].0).then_some((pair, joints))
    })
}

/// Outcome of a pair.
#[derive(Clone, Copy, Debug, Default)]
struct Outcome {
    fault: Option<Fault>,
    /// Ticks until the bridge floated.
    ticks: u64,
    most_nm: f64,
}

/// The worst of some moments at which sensors break that both see the current, or
/// of one.
fn worst(values: &[(&str, f64)], pair: Pair) -> Outcome {
    let moments = if agree(pair[0], pair[1]) { 12 } else { 1 };
    (0..moments)
        .map(|n| outcome(values, pair, 23 * n))
        .reduce(|worst, got| {
            if got.most_nm > worst.most_nm {
                got
            } else {
                worst
            }
        })
        .unwrap_or_default()
}

fn outcome(values: &[(&str, f64)], pair: Pair, later: u64) -> Outcome {
    let mut host = Host::new(&examination(), &Start::default());
    host.run(400);
    for (name, value) in values {
        host.set(name, *value);
    }
    if pair.iter().any(|(part, ..)| *part == JOINT_SENSOR) {
        host.set("joint-sensor.fitted", 1.0);
    }
    host.arm();
    while host.device.board().leg().shaft().omega_rad_s < 0.9 {
        host.tick();
    }
    host.run(later);
    assert_eq!(host.device.board().drive().state(), State::Armed);
    for (_, _, breaks) in pair {
        breaks(host.device.board_mut());
    }
    let mut outcome = Outcome::default();
    for tick in 0..TICKS {
        host.tick();
        let board = host.device.board();
        outcome.most_nm = outcome.most_nm.max(board.leg().motor_nm().abs());
        if board.is_driven() {
            outcome.ticks = tick + 1;
        }
        let fault = board.drive().fault().or(board.comms().fault());
        outcome.fault = outcome.fault.or(fault);
    }
    outcome
}

/// The gear's short-time torque, N·m: no pair goes beyond it but two current
/// sensors that are wrong in the same way.
const GEAR_NM: f64 = 6.5;

/// Largest torque with two current sensors that are wrong in the same way, N·m.
const MOST_NM: f64 = 14.0;

/// Returns whether both sensors of the current are wrong in the same way.
fn agree(first: &Breakage, second: &Breakage) -> bool {
    (first.0, second.0) == ("sensor", "monitor") && first.1 == second.1
}

#[test]
fn pairs_of_independent_sensor_faults_are_bounded() {
    let mut wrong = Vec::new();
    let mut rows = vec![
        "| two faults | joint, N·m | noticed as | floats after, ticks | most N·m |".into(),
        "|---|---|---|---|---|".into(),
    ];
    let trials: Vec<_> = pairs()
        .flat_map(|(pair, joints)| joints.iter().map(move |joint| (pair, joint)))
        .collect();
    let outcomes = on_all_cores(trials.len(), |place| {
        let (pair, (_, values)) = trials[place];
        worst(values, pair)
    });
    for ((pair, (static_nm, _)), got) in trials.iter().zip(outcomes) {
        let [first, second] = pair;
        let name = format!("{} {}, {} {}", first.0, first.1, second.0, second.1);
        let noticed = got.fault.and_then(|fault| {
            let spec = FAULTS.iter().find(|spec| spec.fault == fault);
            spec.map(|spec| spec.name)
        });
        rows.push(format!(
            "| {name} | {static_nm} | {} | {} | {:.1} |",
            noticed.unwrap_or("nothing"),
            noticed.map_or(String::new(), |_| got.ticks.to_string()),
            got.most_nm
        ));
        let may_nm = if agree(first, second) {
            MOST_NM
        } else {
            GEAR_NM
        };
        if got.most_nm > may_nm {
            wrong.push(format!("{name}, {static_nm} N·m: {:.1} N·m", got.most_nm));
        }
        // What nothing notices does not exceed what the joint gives, and a drift.
        let drifts = pair.iter().any(|(_, what, _)| *what == DRIFTS);
        let unnoticed_nm = 2.0 * static_nm + 0.1 + if drifts { DRIFT_NM } else { 0.0 };
        if got.fault.is_none() && got.most_nm > unnoticed_nm {
            wrong.push(format!("{name}, {static_nm} N·m: not noticed"));
        }
    }
    println!("{} pairs with a joint", trials.len());
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    PAGE.hold("pairs", &rows);
}
