//! A session from the first handshake to the stop.

use crate::host::{MS, arm, boards, client, connected, images, leg, run, ticks_until_off};
use crepitus_client::Event;
use crepitus_emulator::Pair;
use crepitus_protocol::management::ResetCause;
use crepitus_protocol::parameters::id::STATIC_TORQUE;
use crepitus_protocol::{Revision, State};
use crepitus_virtual_device::leg::CurrentPath;
use std::time::Duration;

/// The value that tests set.
const OTHER: f64 = 0.625;

#[test]
fn the_handshake_names_both_controllers_and_the_scene_s_parameters_apply() {
    let Some(mut host) = connected() else { return };
    let handshake = host.handshake();
    assert_eq!(handshake.comms.reset, ResetCause::Power);
    let drive = handshake.drive.expect("the drive has answered, too");
    assert_eq!(drive.reset, ResetCause::Power);
    run(&mut host, 30);
    let status = host.status().expect("a status");
    assert_eq!(status.state, State::Disarmed);
    assert_eq!(
        (status.revision, status.in_force),
        (Revision(1), Revision(1))
    );
    assert_eq!(status.saved, Some(Revision(1)));
    let counters = host.counters().expect("counters");
    println!("{counters:?}");
    let boards = boards(&mut host);
    assert_eq!(boards.errors(), []);
    for mcu in [boards.mcu(), boards.comms().mcu()] {
        assert_eq!(mcu.not_modelled(), Vec::<String>::new());
    }
}

#[test]
fn parameters_change_while_samples_stream_and_none_is_lost() {
    let Some(mut host) = connected() else { return };
    // Until the drive has its parameters.
    run(&mut host, 30);
    host.subscribe().expect("a subscription");
    let mut revisions = Vec::new();
    for n in 1..=4_u8 {
        let value = OTHER + f64::from(n) / 64.0;
        host.set(&[(STATIC_TORQUE, value)]).expect("a commit");
        for event in run(&mut host, 30) {
            if let Event::Block(arrival) = event {
                assert_eq!(arrival.missing, 0);
                if revisions.last() != Some(&arrival.block.revision) {
                    revisions.push(arrival.block.revision);
                }
            }
        }
        let (_, values) = host.parameters().expect("parameters");
        assert_eq!(values.get(STATIC_TORQUE), Some(value));
    }
    assert_eq!(revisions, [1, 2, 3, 4, 5].map(Revision));
    let accounting = host.accounting().expect("a subscription");
    println!("{accounting:?}");
    assert_eq!((accounting.dropped(), accounting.lost_on_line()), (0, 0));
    assert!(accounting.received() >= 20 * 120);
    let traffic = host.transport_mut().pair.traffic();
    println!("{traffic:?}");
}

#[test]
fn parameters_that_are_saved_are_there_after_power_was_off() {
    let Some(mut host) = connected() else { return };
    let revision = host.set(&[(STATIC_TORQUE, OTHER)]).expect("a commit");
    host.save().expect("saved");
    assert_eq!(host.status().expect("a status").saved, Some(revision));
    // Another one, which is not saved.
    host.set(&[(STATIC_TORQUE, 0.25)]).expect("a commit");
    host.transport_mut().pair.power_cycle();
    host.reconnect(Duration::from_secs(1))
        .expect("a connection");
    run(&mut host, 20);
    let (again, values) = host.parameters().expect("parameters");
    assert_eq!((again, values.get(STATIC_TORQUE)), (revision, Some(OTHER)));
    let status = host.status().expect("a status");
    assert_eq!((status.in_force, status.saved), (revision, Some(revision)));
}

#[test]
fn a_board_from_the_factory_prepares_its_flash_and_has_the_defaults() {
    let Some([drive, comms]) = images() else {
        return;
    };
    let mut pair = Pair::new(&drive, &comms, leg());
    // Two erasures, in which the core of comms stands; the drive need not run.
    pair.boards_mut().mcu_mut().set_hung(true);
    pair.plug_in().expect("a device");
    let ms = pair.now() / MS;
    assert!((800..900).contains(&ms), "{ms} ms");
    let mut host = client(pair);
    let status = host.status().expect("a status");
    assert_eq!((status.saved, status.drive_present), (None, false));
    host.save().expect("there is room");
}

#[test]
fn torque_answers_motion_until_the_stop() {
    let Some(mut host) = connected() else { return };
    arm(&mut host);
    let begin = boards(&mut host).leg().count();
    let answers = (0..100).any(|_| {
        run(&mut host, 5);
        let leg = boards(&mut host).leg();
        let turned = leg.count().wrapping_sub(begin);
        turned.abs() > 100 && leg.current_a(CurrentPath::Sensor).abs() > 0.05
    });
    assert!(answers, "the leg moves, and the motor answers");
    host.stop().expect("stopped");
    // Comms answers at once, and sets its line with its next tick.
    let ticks = ticks_until_off(&mut host, MS, true);
    println!("stop: off {ticks} ticks after the answer");
    // The state of the drive comes with its next status, which waits behind telemetry.
    run(&mut host, 10);
    let boards = boards(&mut host);
    assert!(!boards.comms_line_is_on() && !boards.line_is_on());
    assert_eq!(host.status().expect("a status").state, State::Disarmed);
}
