//! Commits that are not allowed, and change nothing.

use crate::support::{Host, set};
use crate::{connected, rendering};
use crepitus_protocol::counters::DriveCounter;
use crepitus_protocol::host::{Operation, Refusal};
use crepitus_protocol::parameters::{self, Kind, PARAMETERS, When};
use crepitus_protocol::{Revision, State, ValueError, Values};

/// Refusal of a commit, if any; a refused commit has to leave everything as it was.
fn refusal(host: &mut Host, change: impl FnOnce(&mut Values)) -> Option<Refusal> {
    let before = host.parameters();
    let commits = host.drive_count(DriveCounter::Commits);
    let refused = host.commit(change).err();
    if refused.is_some() {
        assert_eq!(host.parameters(), before);
        host.run(200);
        assert_eq!(host.drive_count(DriveCounter::Commits), commits);
        assert_eq!(host.device.board().drive().revision(), before.0);
        assert_eq!(host.device.board().drive().values(), Some(&before.1));
    }
    refused
}

fn id(name: &str) -> u8 {
    let (id, _) = parameters::find(name).expect("a parameter");
    id
}

#[test]
fn every_value_outside_its_range_is_refused_by_its_id_armed_or_not() {
    for ready in [connected, rendering] {
        let mut host = ready();
        for parameter in &PARAMETERS {
            let mut bad = vec![f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0];
            match parameter.kind {
                Kind::Number(spec) => bad.extend([spec.max * (1.0 + 1e-12), spec.min - 1e-12]),
                Kind::Choice(choice) => bad.extend([0.5, [2.0, 3.0][choice.names.len() - 2]]),
            }
            for value in bad {
                if let Kind::Number(spec) = parameter.kind
                    && (spec.min..=spec.max).contains(&value)
                {
                    continue;
                }
                let expected = Refusal::Values(ValueError::OutOfRange { id: parameter.id });
                let refused = refusal(&mut host, |values| values.set(parameter.id, value));
                assert_eq!(refused, Some(expected), "{} = {value}", parameter.key());
            }
        }
    }
}

#[test]
fn values_that_contradict_each_other_are_refused() {
    for ready in [connected, rendering] {
        let mut host = ready();
        for (name, value, error) in [
            (
                "crepitus.static_torque_nm",
                0.1,
                ValueError::KineticAboveStatic,
            ),
            (
                "crepitus.kinetic_torque_nm",
                0.5,
                ValueError::KineticAboveStatic,
            ),
            // Two counts above (Ts − Tk)/kr: more than the guard can guard.
            ("crepitus.kinetic_torque_nm", 0.38, ValueError::Unguarded),
            (
                "crepitus.stiffness_nm_per_rad",
                4000.0,
                ValueError::Unguarded,
            ),
            (
                "crepitus.static_torque_nm",
                4.6,
                ValueError::StaticAboveLimit,
            ),
            ("limits.torque_nm", 0.3, ValueError::StaticAboveLimit),
        ] {
            let refused = refusal(&mut host, |values| set(values, name, value));
            assert_eq!(refused, Some(Refusal::Values(error)), "{name} = {value}");
        }
    }
}

#[test]
fn what_was_made_from_other_parameters_is_refused() {
    let mut host = rendering();
    let (base, values) = host.parameters();
    host.set("crepitus.static_torque_nm", 0.5);
    let (revision, now) = host.parameters();
    for base in [base, Revision::NONE, Revision(77), Revision(u32::MAX)] {
        let answer = host.ask(Operation::Commit { base, values });
        assert_eq!(answer, Err(Refusal::Stale { revision }));
        assert_eq!(host.parameters(), (revision, now));
    }
}

#[test]
fn some_parameters_only_change_without_torque() {
    let mut host = rendering();
    for parameter in &PARAMETERS {
        let Kind::Number(spec) = parameter.kind else {
            continue;
        };
        if parameter.when == When::Always {
            continue;
        }
        let others = [0.9, 1.1].map(|factor| factor * spec.default);
        let middle = f64::midpoint(spec.min, spec.max);
        let mut others = others.into_iter().chain([middle]);
        let other = others.find(|other| *other != spec.default && *other >= spec.min);
        let other = other.expect("another value");
        let id = parameter.id;
        let refused = refusal(&mut host, |values| values.set(id, other));
        assert_eq!(
            refused,
            Some(Refusal::Values(ValueError::NeedsDisarmed { id })),
            "{}",
            spec.key
        );
    }
    assert_eq!(host.status().state, State::Armed);
    host.ask(Operation::Disarm)
        .expect("disarming is never refused");
    for name in [
        "encoder.lines",
        "motor.resistance_ohm",
        "limits.speed_rad_s",
    ] {
        let (_, values) = host.parameters();
        let value = values.get(id(name)).expect("a value") * 0.99;
        host.set(name, value);
    }
    host.arm();
    host.run(10_000);
    assert_eq!(
        host.status().state,
        State::Armed,
        "with other numbers of the motor"
    );
}
