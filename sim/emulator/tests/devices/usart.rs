//! The link's USART: a character counts where its pin is connected at the end of it.

use crate::bench::Bench;
use crepitus_emulator::{Character, Time};

const RCC_AHB1ENR: u32 = 0x4002_3830;
const RCC_APB2ENR: u32 = 0x4002_3844;
const GPIOC_MODER: u32 = 0x4002_0800;
const GPIOC_AFRL: u32 = 0x4002_0820;
const SR: u32 = 0x4001_1400;
const DR: u32 = 0x4001_1404;
const BRR: u32 = 0x4001_1408;
const CR1: u32 = 0x4001_140c;

const ORE: u32 = 1 << 3;
const RXNE: u32 = 1 << 5;

/// PC6 and PC7: alternate function 8.
fn connect(bench: &mut Bench) {
    bench.write(GPIOC_AFRL, 0x8800_0000);
    bench.write(GPIOC_MODER, 2 << 12 | 2 << 14);
}

fn disconnect(bench: &mut Bench) {
    bench.write(GPIOC_MODER, 0);
}

/// A receiver and a sender that are on, without their pins.
fn switched_on() -> Bench {
    let mut bench = Bench::new();
    bench.set(RCC_AHB1ENR, 1 << 2);
    bench.set(RCC_APB2ENR, 1 << 5);
    bench.write(BRR, 1 << 4 | 4);
    bench.write(CR1, 1 << 13 | 1 << 3 | 1 << 2);
    bench
}

/// Puts a character on the wire that ends after so many microseconds.
fn feed(bench: &mut Bench, byte: u8, us: u64) {
    let at = (bench.0.now() + Time::from_us(us)).units();
    let is_broken = false;
    bench.0.link_feed(Character {
        at,
        byte,
        is_broken,
    });
}

#[test]
fn what_ends_after_its_pin_is_connected_is_received() {
    let mut bench = switched_on();
    feed(&mut bench, 0x5a, 20);
    connect(&mut bench);
    bench.run_us(25);
    assert_eq!(bench.read(SR) & RXNE, RXNE);
    assert_eq!(bench.read(DR), 0x5a);
}

#[test]
fn what_ends_while_its_pin_is_something_else_is_lost() {
    let mut bench = switched_on();
    connect(&mut bench);
    feed(&mut bench, 0x5a, 20);
    disconnect(&mut bench);
    bench.run_us(25);
    assert_eq!(bench.read(SR) & RXNE, 0);
}

#[test]
fn what_comes_while_a_character_waits_is_lost() {
    let mut bench = switched_on();
    connect(&mut bench);
    feed(&mut bench, 0x5a, 20);
    feed(&mut bench, 0xa5, 40);
    bench.run_us(25);
    assert_eq!(bench.read(SR) & (RXNE | ORE), RXNE);
    bench.run_us(20);
    assert_eq!(bench.read(SR) & (RXNE | ORE), RXNE | ORE);
    assert_eq!(bench.read(DR), 0x5a);
    // Reading both has cleared both.
    assert_eq!(bench.read(SR) & (RXNE | ORE), 0);
}

#[test]
fn what_is_sent_without_its_pin_is_on_no_wire() {
    let mut bench = switched_on();
    bench.write(DR, 0x11);
    bench.run_us(25);
    assert!(bench.0.link_take().is_empty());
    connect(&mut bench);
    bench.write(DR, 0x22);
    bench.run_us(25);
    let sent = bench.0.link_take();
    let bytes: Vec<u8> = sent.iter().map(|character| character.byte).collect();
    assert_eq!(bytes, [0x22]);
}
