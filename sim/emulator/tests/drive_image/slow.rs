//! Slow inputs through the image: supply, temperature of the motor and the joint's own
//! angle, each at three points, from the voltage at its pin to the status that a host reads.

use crate::host::{Host, examination, image};
use crate::symptoms::commit;
use crepitus_protocol::host::{Answer, Operation};
use crepitus_protocol::measured::Measured;
use crepitus_protocol::parameters::id::JOINT_SENSOR;
use crepitus_scene::values::values;
use crepitus_virtual_device::leg::SlowSensors;

/// Ticks until all three are read and the status is sent: 10 ms.
const SETTLED: u64 = 200;

/// A count of the converter, in units of the status: of the supply 13 mV, of the motor 0.08 °C, of
/// the joint 0.09°, beside what gear and links twist; and one for rounding.
const SUPPLY_CV: u16 = 2;
const MOTOR_C: u16 = 1;
const JOINT_CDEG: u16 = 30;

fn measured(host: &mut Host, set: impl FnOnce(&mut SlowSensors)) -> Measured {
    set(host.board.leg_mut().slow_sensors_mut());
    host.run(SETTLED);
    match host.ask(Operation::Status) {
        Ok(Answer::Status(status)) => status.measured,
        other => panic!("no status but {other:?}"),
    }
}

#[test]
fn the_supply_is_what_is_at_its_pin() {
    let Some(image) = image() else { return };
    let mut host = Host::new(&image, &examination());
    for (volts, expected) in [(18.5, 1_850), (24.0, 2_400), (29.5, 2_950_u16)] {
        let shown = measured(&mut host, |slow| slow.supply_v = Some(volts));
        assert!(shown.supply_cv.abs_diff(expected) <= SUPPLY_CV, "{shown:?}");
    }
}

#[test]
fn the_temperature_of_the_motor_is_what_is_at_its_pin() {
    let Some(image) = image() else { return };
    let mut host = Host::new(&image, &examination());
    for (celsius, expected) in [(-15.0, -15), (25.0, 25), (68.0, 68_i16)] {
        let shown = measured(&mut host, |slow| slow.motor_c = celsius);
        assert!(shown.motor_c.abs_diff(expected) <= MOTOR_C, "{shown:?}");
    }
}

#[test]
fn the_joint_s_own_angle_is_what_is_at_its_pin() {
    let Some(image) = image() else { return };
    let mut host = Host::new(&image, &examination());
    let mut fitted = values(&examination()).expect("values");
    fitted.set(JOINT_SENSOR, 1.0);
    // Until the drive has those of the scene.
    host.run(1_000);
    commit(&mut host, fitted);
    assert_eq!(host.ask(Operation::Zero), Ok(Answer::Done));
    let mut before = 0;
    for (degrees, expected) in [(0.0, 0), (1.5, 150), (4.0, 400_u16)] {
        let slip = f64::to_radians(degrees);
        let shown = measured(&mut host, |slow| slow.slipped_rad = slip);
        let span = shown.joint_cdeg.expect("a sensor and a zero");
        assert!(span.abs_diff(expected) <= JOINT_CDEG, "{shown:?}");
        assert!(span >= before, "{span} after {before}");
        before = span;
    }
}
