//! Texts for users.

use crate::support::golden;
use crepitus_client::values::{full_name, parse_value, show_value};
use crepitus_client::{Holder, Refused, RequestKind, TransportError, coil_fault_text, fault_text};
use crepitus_protocol::coil::COIL_FAULTS;
use crepitus_protocol::fault::FAULTS;
use crepitus_protocol::host::Refusal;
use crepitus_protocol::link::DriveRefusal;
use crepitus_protocol::parameters::{self, Kind, PARAMETERS};
use crepitus_protocol::{DeviceSettings, Revision, Session, ValueError, Values};
use std::time::Duration;

#[test]
fn every_fault_has_a_remedy() {
    let mut lines: Vec<_> = FAULTS
        .iter()
        .map(|spec| fault_text(spec.fault.code()))
        .collect();
    lines.push(fault_text(200));
    lines.extend(COIL_FAULTS.map(|spec| coil_fault_text(spec.fault.code())));
    lines.push(coil_fault_text(200));
    golden("faults", &lines.join("\n"));
}

#[test]
fn every_refusal_has_a_remedy() {
    let drive = [
        DriveRefusal::NoParameters,
        DriveRefusal::NoLease,
        DriveRefusal::Faulted { code: 13 },
        DriveRefusal::Armed,
        DriveRefusal::NoEncoder,
        DriveRefusal::Aborted,
        DriveRefusal::NotZeroed,
        DriveRefusal::OutsideRange,
        DriveRefusal::NotArmed,
        DriveRefusal::NoActuator,
        DriveRefusal::ChirpOutOfRange,
        DriveRefusal::ChirpPlaying,
    ];
    let values = [
        ValueError::OutOfRange { id: 2 },
        ValueError::OutOfRange { id: 5 },
        ValueError::OutOfRange { id: 200 },
        ValueError::KineticAboveStatic,
        ValueError::StaticAboveLimit,
        ValueError::NarrowRange,
        ValueError::NeedsDisarmed { id: 6 },
    ];
    let others = [
        Refusal::Stale {
            revision: Revision(7),
        },
        Refusal::Leased {
            by: Session(0x00c0_ffee),
        },
        Refusal::DriveSilent,
        Refusal::Unconfirmed,
        Refusal::Faulted { code: 2 },
        Refusal::Armed,
        Refusal::Busy,
        Refusal::Storage,
        Refusal::Aborted,
    ];
    let text = |request, refusal, values| {
        Refused {
            request,
            refusal,
            values,
        }
        .to_string()
    };
    let mut lines = Vec::new();
    for error in values {
        let values = Some(Values::default());
        lines.push(text(RequestKind::Commit, Refusal::Values(error), values));
    }
    lines.push(text(RequestKind::Commit, Refusal::Unconfirmed, None));
    for refusal in others.into_iter().chain(drive.map(Refusal::Drive)) {
        for request in [RequestKind::Arm, RequestKind::Zero] {
            lines.push(text(request, refusal, None));
        }
    }
    golden("refusals", &lines.join("\n"));
}

/// On the wire a broken rule of the effects has no name: the text has it all the same.
#[test]
fn a_broken_rule_of_the_effects_is_told() {
    let text = |changes: &[(&str, f64)]| {
        let mut values = Values::default();
        for (name, value) in changes {
            let (id, _) = parameters::find(name).expect("a parameter");
            values.set(id, *value);
        }
        let error = DeviceSettings::of(&values).expect_err("a broken rule");
        assert_eq!(error, ValueError::Contradiction);
        Refused {
            request: RequestKind::Commit,
            refusal: Refusal::Values(error),
            values: Some(values),
        }
        .to_string()
    };
    let actuator = [("bone-shaping.render", 1.0), ("bone-shaping.output", 1.0)];
    let reflex = [
        ("spasticity.render", 1.0),
        ("spasticity.form", 1.0),
        ("spasticity.velocity_shift_s", 0.01),
    ];
    let stiff = [
        ("lead-pipe.render", 1.0),
        ("lead-pipe.torque_nm", 4.5),
        ("lead-pipe.presliding_deg", 0.2),
    ];
    let lines = [text(&actuator), text(&reflex), text(&stiff)];
    assert!(
        lines[0].contains("needs vibration-actuator"),
        "{}",
        lines[0]
    );
    assert!(lines[1].contains("velocity_shift_s"), "{}", lines[1]);
    assert!(lines[2].contains("N·m/rad together"), "{}", lines[2]);
}

#[test]
fn every_port_error_has_a_remedy() {
    let port = || "/dev/ttyACM0".to_owned();
    let detail = || "I/O error".to_owned();
    let holder = Holder {
        pid: 4_321,
        program: "minicom".into(),
    };
    let errors = [
        TransportError::NotFound { port: port() },
        TransportError::Busy {
            port: port(),
            holder: Some(holder.clone()),
        },
        TransportError::Busy {
            port: port(),
            holder: None,
        },
        TransportError::Hangs {
            port: port(),
            holder: Some(holder),
        },
        TransportError::Forgotten { port: port() },
        TransportError::Denied {
            port: port(),
            group: "dialout".into(),
        },
        TransportError::OthersTerminal { port: port() },
        TransportError::NotSerial { port: port() },
        TransportError::Open {
            port: port(),
            detail: detail(),
        },
        TransportError::Stalled {
            port: port(),
            patience: Duration::from_millis(250),
        },
        TransportError::Lost {
            port: port(),
            detail: detail(),
        },
    ];
    golden("ports", &errors.map(|error| error.to_string()).join("\n"));
}

#[test]
fn values_are_read_as_they_are_shown() {
    for parameter in &PARAMETERS {
        let mut values = vec![parameter.default()];
        match parameter.kind {
            Kind::Number(spec) => values.extend([
                spec.min,
                spec.max,
                1.0 / 3.0,
                5e-324,
                -0.0,
                1e300,
                123_456.789_012_345_67,
            ]),
            Kind::Choice(_) => values.extend([0.0, 1.0]),
        }
        for value in values {
            let text = show_value(parameter, value);
            assert!(text.len() < 25, "{text}");
            let read = parse_value(parameter, &format!(" {text}\n")).unwrap();
            assert_eq!(read.to_bits(), value.to_bits(), "{text}");
        }
    }
    let (_, restart) = parameters::find("crepitus.restart").unwrap();
    assert_eq!(show_value(restart, 1.0), "from-kinetic");
    assert_eq!(full_name(restart), "crepitus.restart");
}

#[test]
fn invalid_texts_are_rejected_with_the_valid_values() {
    let text = |name: &str, value: &str| {
        let (_, parameter) = parameters::find(name).unwrap();
        parse_value(parameter, value).unwrap_err().to_string()
    };
    assert_eq!(
        text("crepitus.static_torque_nm", "0,4"),
        "invalid crepitus.static_torque_nm: expected a number between 0 and 1e6 N·m, got `0,4`"
    );
    assert_eq!(
        text("friction-compensation.share", "inf"),
        "invalid friction-compensation.share: expected a number between 0 and 0.9, got `inf`"
    );
    assert_eq!(
        text("crepitus.restart", "1"),
        "invalid crepitus.restart: expected `elastic` or `from-kinetic`, got `1`"
    );
}
