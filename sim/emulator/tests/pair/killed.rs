//! Each task of comms killed in turn ends in a watchdog reset of comms alone, and a
//! reboot that is asked for in one of both.

#[allow(dead_code, reason = "another test uses the rest")]
#[path = "../drive_image/code.rs"]
mod code;

use crate::host::{Host, MS, boards, images, run, under_torque};
use code::{RETURN, bytes, store};
use crepitus_client::Transport as _;
use crepitus_emulator::Reset;
use std::time::Duration;

/// Name, exception, and a register whose write of 0 silences its interrupt: TIM2_SR,
/// OTG_FS_GAHBCFG, and none for what is only pended.
const TASKS: [(&str, u16, Option<u32>); 3] = [
    ("tick", 16 + 28, Some(0x4000_0010)),
    ("usb", 16 + 67, Some(0x5000_0008)),
    ("link", 16 + 69, None),
];

/// 4 × (160 + 1) clocks of 17 kHz, 37.9 ms, in ticks.
const SLOWEST_WATCHDOG: u64 = 38 * MS;

fn causes(host: &mut Host) -> [Vec<Reset>; 2] {
    let boards = boards(host);
    [boards.resets(), boards.comms().resets()]
        .map(|resets| resets.iter().map(|(_, cause)| *cause).collect())
}

#[test]
fn each_task_of_comms_that_returns_at_once_is_reset_by_the_watchdog() {
    for (name, exception, register) in TASKS {
        let Some(mut host) = under_torque() else {
            return;
        };
        let [_, image] = images().expect("they were there");
        let at = image.vector(exception).expect("a handler");
        let silence = register.map_or(Vec::new(), |register| store(register, 0));
        let handler = bytes(&[&silence[..], &[RETURN]].concat());
        let comms = boards(&mut host).comms_mut().mcu_mut();
        comms.set_watchdog_hz(17_000);
        comms.patch_flash(at, &handler);
        let pair = &mut host.transport_mut().pair;
        let ticks = (0..=SLOWEST_WATCHDOG + MS).find(|_| {
            pair.tick();
            !pair.boards().comms().resets().is_empty()
        });
        let ticks = ticks.expect(name);
        println!("{name}: reset after {ticks} ticks");
        assert!(!boards(&mut host).is_driven(), "{name}");
        assert_eq!(causes(&mut host), [vec![], vec![Reset::Watchdog]], "{name}");
    }
}

#[test]
fn a_reboot_restarts_both() {
    let Some(mut host) = crate::host::connected() else {
        return;
    };
    run(&mut host, 30);
    host.reboot().expect("it reboots");
    host.transport_mut().wait(Duration::from_millis(40));
    assert_eq!(
        causes(&mut host),
        [vec![Reset::Software], vec![Reset::Software]]
    );
    host.reconnect(Duration::from_secs(1))
        .expect("a connection");
    run(&mut host, 20);
    let handshake = *host.handshake();
    assert!(handshake.drive.is_some());
}
