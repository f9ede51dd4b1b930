//! The image boots: clocks and timers come up as configured, nothing is used that is
//! not there, and two runs are the same.

use crate::host::{Host, examination, image};

/// Registers that say how the image has set up the chip.
fn set_up(host: &Host) -> impl Fn(u32) -> u32 {
    let mcu = host.board.mcu();
    move |address| mcu.peek(address).expect("a register")
}

#[test]
fn clocks_and_timers_come_up_as_configured() {
    let Some(image) = image() else { return };
    let mut host = Host::new(&image, &examination());
    host.run(100);
    let word = set_up(&host);
    // The PLL from the crystal is the system clock; its failure is watched.
    assert_eq!(word(0x4002_3808) >> 2 & 3, 2);
    assert_eq!(word(0x4002_3800) >> 19 & 1, 1, "CSS");
    // 8 MHz / M × N / P = 168 MHz.
    let pll = word(0x4002_3804);
    let (m, n, p) = (pll & 63, pll >> 6 & 511, 2 * ((pll >> 16 & 3) + 1));
    assert_eq!(8 * n / m / p, 168);
    assert_eq!(8 * n / m / (pll >> 24 & 15), 48);
    // Five wait states, though they cost nothing here.
    assert_eq!(word(0x4002_3c00) & 7, 5);
    // TIM1: centre-aligned, 20 kHz, running.
    assert_eq!(word(0x4001_0000) & 0x61, 0x21);
    assert_eq!(word(0x4001_002c), 4_200);
    // BDTR: dead time, break enabled, active low, no automatic output, locked.
    let bdtr = word(0x4001_0044);
    assert_eq!(bdtr & 0xff, 50);
    assert_eq!(bdtr >> 12 & 7, 0b001, "AOE, BKP, BKE");
    assert_eq!(bdtr >> 8 & 3, 2, "LOCK");
    assert_eq!(bdtr >> 15 & 1, 0, "MOE");
    // TIM5 counts every edge of both channels, in 32 bits.
    assert_eq!(word(0x4000_0c08) & 7, 3);
    assert_eq!(word(0x4000_0c2c), u32::MAX);
    // The link: 84 MHz / 20.
    assert_eq!(word(0x4001_1408), 0x14);
    assert_eq!(host.board.mcu().link_character_units(), 800);
    // One conversion a tick, none missed.
    assert_eq!(host.board.mcu().lost_triggers(), 0);
    assert_eq!(host.board.mcu().not_modelled(), [""; 0]);
    assert_eq!(host.board.resets(), []);
}

#[test]
fn ticks_are_fifty_microseconds_and_blocks_come_every_twenty() {
    let Some(image) = image() else { return };
    let mut host = Host::new(&image, &examination());
    host.run(600);
    let first = host.blocks.first().expect("a block").first_tick;
    let last = host.blocks.last().expect("a block");
    let count = u64::try_from(host.blocks.len()).unwrap();
    assert_eq!(last.end_tick() - first, 20 * count);
    // The tick of now, the block that is being filled, the one on the wire.
    assert!(
        (540..=600).contains(&last.end_tick()),
        "{}",
        last.end_tick()
    );
}

#[test]
fn two_runs_are_the_same_to_the_last_bit() {
    let Some(image) = image() else { return };
    let run = || {
        let mut host = Host::new(&image, &examination());
        host.arm();
        host.run(2_000);
        host.board.mcu().state_hash()
    };
    assert_eq!(run(), run());
}
