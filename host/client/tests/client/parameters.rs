//! Parameters: read, set, rejected, saved.

use crate::support::{Port, client, connected, device, ms, pump_for, refusal};
use crepitus_client::{Client, Error};
use crepitus_protocol::host::Refusal;
use crepitus_protocol::parameters::{self, id};
use crepitus_protocol::{Revision, ValueError, Values};

fn place(name: &str) -> u8 {
    parameters::find(name).unwrap().0
}

#[test]
fn a_set_is_one_commit_and_leaves_the_others_alone() {
    let (shared, mut client) = connected();
    let (revision, before) = client.parameters().unwrap();
    assert_eq!((revision, before), (Revision(1), Values::default()));
    let changes = [(id::KINETIC_TORQUE, 0.3), (id::STATIC_TORQUE, 0.8)];
    assert_eq!(client.set(&changes).unwrap(), Revision(2));
    let (revision, after) = client.parameters().unwrap();
    let mut expected = before;
    for (id, value) in changes {
        expected.set(id, value);
    }
    assert_eq!((revision, after), (Revision(2), expected));
    assert_eq!(shared.borrow().drive.revision(), Revision(2));
    let status = client.status().unwrap();
    assert_eq!(
        (status.revision, status.in_force),
        (Revision(2), Revision(2))
    );
    assert_eq!(status.saved, None);
}

#[test]
fn invalid_values_are_rejected_with_the_valid_ones() {
    let (_, mut client) = connected();
    let restart = place("crepitus.restart");
    for (changes, error, text) in [
        (
            &[(id::TORQUE_LIMIT, 9.0)][..],
            ValueError::OutOfRange { id: 26 },
            "invalid value limits.torque_nm = 9: must be between 0 and 4.5 N·m; nothing was changed",
        ),
        (
            &[(id::STATIC_TORQUE, f64::NAN)],
            ValueError::OutOfRange { id: 4 },
            "invalid value crepitus.static_torque_nm = NaN: must be between 0 and 1e6 N·m; \
             nothing was changed",
        ),
        (
            &[(restart, 2.0)],
            ValueError::OutOfRange { id: 5 },
            "invalid value crepitus.restart = 2: must be `elastic` or `from-kinetic`; \
             nothing was changed",
        ),
        (
            &[(id::KINETIC_TORQUE, 0.7)],
            ValueError::KineticAboveStatic,
            "crepitus.kinetic_torque_nm = 0.7 is above crepitus.static_torque_nm = 0.4: \
             lower the first or raise the second; nothing was changed",
        ),
        (
            &[(id::KINETIC_TORQUE, 0.38), (id::STIFFNESS, 4000.0)],
            ValueError::Unguarded,
            "crepitus.kinetic_torque_nm = 0.38 is too close to crepitus.static_torque_nm = 0.4, with \
             crepitus.stiffness_nm_per_rad = 4000 and encoder.lines = 512: a hand that reverses \
             during a slip would get more energy than the slip takes out of the spring. One count \
             of the encoder is 35.7 µrad, and may be 0.4 µrad: lower the kinetic torque or the \
             stiffness, or raise the static torque; nothing was changed",
        ),
        (
            &[(id::STATIC_TORQUE, 5.0)],
            ValueError::StaticAboveLimit,
            "crepitus.static_torque_nm = 5 is above limits.torque_nm = 4.5: lower the first; the \
             second is 4.5 N·m at most; nothing was changed",
        ),
    ] {
        let failed = client.set(changes).unwrap_err();
        assert_eq!(failed.to_string(), text);
        assert_eq!(refusal::<()>(Err(failed)), Refusal::Values(error));
    }
    assert_eq!(
        client.parameters().unwrap(),
        (Revision(1), Values::default())
    );
    assert_eq!(
        client.set(&[(255, 0.0)]).unwrap_err(),
        Error::UnknownParameter { id: 255 }
    );
}

/// A client that is overtaken by another one whenever it commits.
mod overtaking {
    use super::*;
    use crepitus_client::{Transport, TransportError};
    use std::time::Duration;

    /// Transport that, before a frame as long as a commit goes out, lets the other client
    /// set what is next in its list.
    pub(super) struct Overtaken {
        pub(super) inner: Port,
        pub(super) other: Client<Port>,
        pub(super) changes: Vec<(u8, f64)>,
    }

    impl Transport for Overtaken {
        fn send(&mut self, bytes: &[u8]) -> Result<(), TransportError> {
            if bytes.len() > 200
                && let Some(change) = self.changes.pop()
            {
                self.other.set(&[change]).unwrap();
            }
            self.inner.send(bytes)
        }

        fn receive(&mut self, to: &mut [u8], patience: Duration) -> Result<usize, TransportError> {
            self.inner.receive(to, patience)
        }

        fn now(&self) -> Duration {
            self.inner.now()
        }

        fn wait(&mut self, time: Duration) {
            self.inner.wait(time);
        }

        fn reopen(&mut self) -> Result<(), TransportError> {
            self.inner.reopen()
        }

        fn name(&self) -> String {
            self.inner.name()
        }
    }
}

fn overtaken(changes: &[(u8, f64)]) -> Client<overtaking::Overtaken> {
    let (shared, port) = device();
    let other = client(port, 2);
    let mut changes = changes.to_vec();
    changes.reverse();
    let transport = overtaking::Overtaken {
        inner: Port::new(&shared),
        other,
        changes,
    };
    Client::connect_with(transport, crate::support::options(1))
        .map_err(|error| error.to_string())
        .unwrap()
}

#[test]
fn a_set_is_retried_after_a_concurrent_commit() {
    let inertia = place("crepitus.inertia_kg_m2");
    let mut client = overtaken(&[(inertia, 0.02), (inertia, 0.03), (inertia, 0.04)]);
    assert_eq!(
        client.set(&[(id::STATIC_TORQUE, 0.5)]).unwrap(),
        Revision(5)
    );
    let (_, values) = client.parameters().unwrap();
    assert_eq!(values.get(inertia), Some(0.04));
    assert_eq!(values.get(id::STATIC_TORQUE), Some(0.5));
}

#[test]
fn a_set_fails_after_too_many_concurrent_commits() {
    let inertia = place("crepitus.inertia_kg_m2");
    let mut client = overtaken(&[0.02, 0.03, 0.04, 0.05].map(|value| (inertia, value)));
    assert!(matches!(
        refusal(client.set(&[(id::STATIC_TORQUE, 0.5)])),
        Refusal::Stale {
            revision: Revision(5)
        }
    ));
}

#[test]
fn a_set_does_not_undo_what_another_host_has_just_set() {
    let mut client = overtaken(&[(id::STATIC_TORQUE, 0.9)]);
    let error = client.set(&[(id::STATIC_TORQUE, 0.5)]).unwrap_err();
    assert_eq!(
        error.to_string(),
        "cannot set crepitus.static_torque_nm to 0.5: another host has just changed it \
         from 0.4 to 0.9 (revision 2); nothing was set; check its new value and set it again"
    );
    let mut client = overtaken(&[(id::STATIC_TORQUE, 0.5)]);
    assert_eq!(
        client.set(&[(id::STATIC_TORQUE, 0.5)]).unwrap(),
        Revision(3)
    );
}

#[test]
fn an_unconfirmed_commit_is_reported() {
    let (shared, mut client) = connected();
    shared.borrow_mut().link_is_cut = true;
    assert_eq!(
        refusal(client.set(&[(id::STATIC_TORQUE, 0.5)])),
        Refusal::Unconfirmed
    );
    shared.borrow_mut().link_is_cut = false;
    pump_for(&mut client, ms(30));
    // The commit was applied meanwhile.
    let status = client.status().unwrap();
    assert_eq!(
        (status.revision, status.in_force),
        (Revision(2), Revision(2))
    );
}
