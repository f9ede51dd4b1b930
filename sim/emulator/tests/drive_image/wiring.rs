//! Every mismatch of image and board is named: registers are changed in a
//! running image, one at a time.

use crate::host::{Host, examination, image};
use crepitus_emulator::Time;
use crepitus_protocol::counters::DriveCounter;
use crepitus_protocol::host::{Answer, Operation};

const GPIOA_MODER: u32 = 0x4002_0000;
const GPIOB_PUPDR: u32 = 0x4002_040c;
const GPIOC_AFRL: u32 = 0x4002_0820;
const GPIOC_MODER: u32 = 0x4002_0800;
const TIM1_CR1: u32 = 0x4001_0000;
const TIM1_CCMR1: u32 = 0x4001_0018;
const TIM1_CCER: u32 = 0x4001_0020;
const TIM1_CCR1: u32 = 0x4001_0034;
const TIM3_CNT: u32 = 0x4000_0424;
const TIM5_CCER: u32 = 0x4000_0c20;
const ADC1_SQR3: u32 = 0x4001_2034;
const ADC3_SMPR2: u32 = 0x4001_2210;
const USART6_BRR: u32 = 0x4001_1408;

/// Register, its new value from the old one, and what the board says.
type Change = (u32, fn(u32) -> u32, &'static str);

const CHANGES: [Change; 17] = [
    (
        GPIOA_MODER,
        |was| was & !3,
        "PA0 is input, pull-up; its wire, encoder A, TIM5 CH1, needs AF2, pull-up",
    ),
    (
        GPIOA_MODER,
        |was| was & !(3 << 16),
        "PA8 is input, pull-down; its wire, upper switch of half A, TIM1 CH1, needs AF1, pull-down",
    ),
    (
        GPIOB_PUPDR,
        |was| was & !(3 << 24),
        "PB12 is AF1, no pull; its wire, break line, TIM1 BKIN, needs AF1, pull-down",
    ),
    (
        GPIOB_PUPDR,
        |was| was & !(3 << 2) | 1 << 2,
        "PB1 is input, pull-up; its wire, read-back of the enable line, needs input, pull-down",
    ),
    (
        GPIOC_MODER,
        |was| was & !3,
        "PC0 is input, no pull; its wire, amplifier of the sensor, ADC1 IN10, needs analog",
    ),
    (
        GPIOC_AFRL,
        |was| was & !(15 << 24) | 3 << 24,
        "PC6 is AF3, no pull; its wire, link to comms, USART6 TX, needs AF8",
    ),
    (
        GPIOC_AFRL,
        |was| was & !(15 << 28) | 3 << 28,
        "PC7 is AF3, pull-up; its wire, link from comms, USART6 RX, needs AF8, pull-up",
    ),
    // CC1NP alone: both follow the reference.
    (
        TIM1_CCER,
        |was| was | 1 << 3,
        "shoot-through: both switches of half A are closed at once",
    ),
    // CC2P and CC2NP: in the dead time.
    (
        TIM1_CCER,
        |was| was | 1 << 5 | 1 << 7,
        "shoot-through: both switches of half B are closed at once",
    ),
    (
        TIM1_CCMR1,
        |was| was & !(1 << 3),
        "TIM1 does not make the PWM of the bridge: channel 1 is not in PWM mode 1 with preload",
    ),
    // CKD.
    (
        TIM1_CR1,
        |was| was | 2 << 8,
        "a dead time of 1190 ns; the bridge needs 200 to 500 ns",
    ),
    (
        TIM1_CCR1,
        |_| 4_190,
        "a switch of the bridge switches while ADC1 samples",
    ),
    (
        ADC1_SQR3,
        |_| 11,
        "ADC1 samples channel 11, to which none of its inputs is wired",
    ),
    (
        ADC3_SMPR2,
        |_| 0,
        "ADC3 samples channel 3 for 142 ns; its source needs 714 ns",
    ),
    (
        USART6_BRR,
        |_| 0x15,
        "a character of USART6 takes 840 units of time; one of the link takes 800",
    ),
    (TIM5_CCER, |was| was | 1 << 1, "TIM5 has counted "),
    // Last, as it is not undone: the counter goes on.
    (TIM3_CNT, |was| (was + 1_000) % 4_200, "ADC1 samples "),
];

#[test]
fn every_mismatch_is_named() {
    /// Limit of the wait, half ticks: before the watchdog resets the hung core.
    const MOST_HALVES: usize = 200;
    let Some(image) = image() else { return };
    let mut host = Host::new(&image, &examination());
    host.arm();
    // The leg moves, so that the encoder counts.
    host.run_until_torque();
    // What the program would write is not written over the changes.
    host.board.mcu_mut().set_hung(true);
    for (register, change, says) in CHANGES {
        let mcu = host.board.mcu_mut();
        let was = mcu.peek(register).expect("a register");
        mcu.poke(register, change(was));
        let now = mcu.now();
        let is_named = |host: &Host| {
            let errors = host.board.errors().iter();
            errors
                .filter(|(at, _)| *at >= now)
                .any(|(_, error)| error.to_string().starts_with(says))
        };
        for _ in 0..MOST_HALVES {
            host.board.half(None);
            if is_named(&host) {
                break;
            }
        }
        assert!(is_named(&host), "{register:#x}: no {says}");
        host.board.mcu_mut().poke(register, was);
    }
    assert!(host.board.resets().is_empty());
}

#[test]
fn outputs_that_nothing_drives_are_named() {
    let Some(image) = image() else { return };
    let mut host = Host::new(&image, &examination());
    host.run(100);
    // PB13, the lower switch of half A: neither the timer's nor pulled down.
    let mcu = host.board.mcu_mut();
    let mode = mcu.peek(GPIOB_PUPDR - 0x0c).expect("a register");
    mcu.poke(GPIOB_PUPDR - 0x0c, mode & !(3 << 26));
    let pull = mcu.peek(GPIOB_PUPDR).expect("a register");
    mcu.poke(GPIOB_PUPDR, pull & !(3 << 26));
    host.board.half(None);
    let errors: Vec<String> = host
        .board
        .errors()
        .iter()
        .map(|(_, error)| error.to_string())
        .collect();
    let says = "a switch of half A is neither driven nor pulled down";
    assert!(errors.iter().any(|error| error == says), "{errors:?}");
}

/// The bridge's timer starts those of the coil and of the tasks in the same clock, however long the core
/// waits for flash: no store of the program enables them.
#[test]
fn timers_start_together() {
    const STARTED: [(u32, &str); 3] = [
        (TIM3_CNT - 0x24, "TIM3"),
        (0x4000_0800, "TIM4"),
        (0x4001_0400, "TIM8"),
    ];
    let Some(image) = image() else { return };
    for models_flash in [false, true] {
        let mut host = Host::new(&image, &examination());
        let mcu = host.board.mcu_mut();
        if models_flash {
            mcu.model_flash();
        }
        mcu.listen(&STARTED.map(|(cr1, _)| cr1));
        host.run(1_000);
        let mcu = host.board.mcu_mut();
        let stores = mcu.take_accesses();
        let enables = stores.iter().filter(|it| it.is_write && it.value & 1 == 1);
        assert_eq!(enables.count(), 0);
        for (cr1, name) in STARTED {
            assert_eq!(mcu.peek(cr1).map(|word| word & 1), Some(1), "{name}");
        }
        // Centre-aligned both, they count alike.
        let counts = [TIM1_CR1, 0x4001_0400].map(|base| mcu.load(base + 0x24));
        assert_eq!(counts[0], counts[1]);
        assert!(host.board.errors().is_empty(), "{:?}", host.board.errors());
    }
}

/// A byte that the stream has counted is not taken before it is in memory: whenever bytes come, in steps of
/// 0.1 µs through the 2.4 µs of one.
#[test]
fn a_byte_that_is_not_in_memory_yet_is_left() {
    let Some(image) = image() else { return };
    for late in (0..24).map(|step| Time::from_units(step * 34)) {
        let mut host = Host::late(&image, &examination(), &[], late);
        host.board.mcu_mut().set_memory_lag(24);
        host.run(1_500);
        let Ok(Answer::Counters(counters)) = host.ask(Operation::Counters) else {
            panic!("no counters");
        };
        let count = |counter: DriveCounter| counters.drive[counter.index()];
        assert!(count(DriveCounter::Frames) > 60, "{late:?}");
        assert_eq!(count(DriveCounter::Discarded), 0, "{late:?}");
    }
}
