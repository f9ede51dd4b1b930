//! Causes of the faults of what changes slowly.

use crate::breakage::board;
use crate::case::Moment::{Arming, Disarmed};
use crate::case::{Case, case};
use crate::support::Host;
use crepitus_virtual_device::leg::SlowSensors;

fn sensors(host: &mut Host) -> &mut SlowSensors {
    board(host).leg_mut().slow_sensors_mut()
}

fn mend(host: &mut Host) {
    *sensors(host) = SlowSensors::default();
    board(host).set_slow_converter(true);
}

fn sag(host: &mut Host, _: u64) {
    sensors(host).supply_v = Some(17.9);
}

fn surge(host: &mut Host, _: u64) {
    sensors(host).supply_v = Some(30.2);
}

pub(super) fn supply_low() -> Vec<Case> {
    vec![
        case("the supply sags", sag, mend),
        case(
            "it is off at arming",
            |host, _| sensors(host).supply_v = Some(0.0),
            mend,
        )
        .when(Arming),
        case(
            "the converter does not run",
            |host, _| board(host).set_slow_converter(false),
            mend,
        ),
    ]
}

pub(super) fn supply_high() -> Vec<Case> {
    vec![
        case("the clamp takes nothing", surge, mend),
        case("the wrong supply", surge, mend).when(Disarmed),
    ]
}

pub(super) fn motor_hot() -> Vec<Case> {
    vec![
        case("it is hot", |host, _| sensors(host).motor_c = 70.5, mend),
        case(
            "its sensor is unplugged",
            |host, _| sensors(host).motor_c = -50.0,
            mend,
        ),
    ]
}

const FITTED: &[(&str, f64)] = &[("joint-sensor.fitted", 1.0)];

pub(super) fn joint_mismatch() -> Vec<Case> {
    let with_sensor = |case: Case| Case {
        values: FITTED,
        ..case
    };
    vec![
        with_sensor(case(
            "the coupling slips by 4.5°",
            |host, _| sensors(host).slipped_rad = 4.5_f64.to_radians(),
            mend,
        )),
        with_sensor(case(
            "the other way",
            |host, _| sensors(host).slipped_rad = -4.5_f64.to_radians(),
            mend,
        )),
        with_sensor(case(
            "the sensor has no supply",
            |host, _| sensors(host).joint_turns = Some(0.0),
            mend,
        )),
    ]
}

/// Overloads where 3.2 N·m may last.
pub(super) fn overload() -> Vec<Case> {
    let of = |name, values| Case {
        values,
        phases: 0..2,
        ..case(name, |_, _| {}, |_| {})
    };
    vec![
        of(
            "4.35 N·m on average",
            &[
                ("crepitus.inertia_kg_m2", 0.1),
                ("crepitus.static_torque_nm", 4.4),
                ("crepitus.kinetic_torque_nm", 4.0),
                ("crepitus.static_torque_nm", 4.5),
                ("crepitus.kinetic_torque_nm", 4.2),
            ],
        )
        .lag(4_000),
        // The sum is full after one and a half seconds.
        of(
            "4.2 N·m on average",
            &[
                ("crepitus.inertia_kg_m2", 0.1),
                ("crepitus.static_torque_nm", 4.4),
                ("crepitus.kinetic_torque_nm", 4.0),
            ],
        )
        .lag(9_000),
    ]
}
