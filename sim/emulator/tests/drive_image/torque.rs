//! Arm, torque answers motion, stop.

use crate::host::{Host, examination, image};
use crepitus_protocol::State;
use crepitus_protocol::host::{Answer, Operation};

#[test]
fn it_arms_the_hand_feels_the_joint_and_it_stops() {
    let Some(image) = image() else { return };
    let mut host = Host::new(&image, &examination());
    assert!(!host.board.drive_is_on());
    host.arm();
    assert_eq!(host.board.comms().comms().state(), State::Armed);
    assert!(host.board.is_driven());
    host.run_until_torque();
    host.blocks.clear();
    host.run(4_000);
    let samples: Vec<_> = host.blocks.iter().flat_map(|block| block.samples).collect();
    // Flexion: torque opposes it, up to the static limit, and it slips.
    let most = samples.iter().map(|s| s.torque_nm).fold(0.0, f32::max);
    assert!((0.3..=0.4).contains(&most), "{most}");
    assert!(host.board.leg().shaft().omega_rad_s > 0.0);
    // The motor turns what was asked into torque.
    let asked: f32 = samples.iter().map(|s| s.torque_nm).sum();
    let driven: f32 = samples.iter().map(|s| f32::from(s.current_ma)).sum();
    let joint_nm_per_a = -1e3 * asked / driven;
    assert!((3.0..3.7).contains(&joint_nm_per_a), "{joint_nm_per_a}");
    assert_eq!(host.ask(Operation::Disarm), Ok(Answer::Done));
    // The next heartbeat says so.
    host.run(25);
    assert!(!host.board.drive_is_on());
    assert!(!host.board.line_is_on());
    // The drive reports it behind a block that is on its way.
    host.run(40);
    assert_eq!(host.board.comms().comms().state(), State::Disarmed);
}
