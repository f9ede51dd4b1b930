//! The chip without its core: an STM32F405 as far as the firmware uses it.
//!
//! | part | from |
//! |---|---|
//! | RCC, PWR, CRC, GPIO, TIM1 to TIM5, TIM8, TIM11, DMA, IWDG, DBGMCU | the library |
//! | FLASH, the breaks of TIM1 and TIM8, the input of TIM11, ADC1 to ADC3, USART6, OTG_FS, numbers of RNG | [`crate::devices`] |
//!
//! Wired: interrupts, the requests of USART6 to DMA2, the trigger outputs of
//! TIM2, TIM3 and TIM8 to the converters, the encoder's channels to TIM5, the watchdog
//! to the reset, and TIM1's trigger output to ITR0 of TIM3, TIM4 and TIM8, without the clocks that a
//! timer takes to follow it. Not wired: other timers to each other, pins to EXTI.

pub(crate) mod bus;
mod bus_map;
mod bus_waits;
pub(crate) mod clocks;
pub(crate) mod memory;
mod memory_lag;
pub(crate) mod part;
pub(crate) mod pins;
mod timed_flash;
pub(crate) mod waits;
pub(crate) mod wires;

use crate::devices::adc::{self, Adc, Adcs, Analog};
use crate::devices::brake::{self, Brake};
use crate::devices::crystal_meter::CrystalMeter;
use crate::devices::event_flags::EventFlags;
use crate::devices::flash::Flash;
use crate::devices::otg::{self, Otg};
use crate::devices::random::Random;
use crate::devices::registers::AsRegisters;
use crate::devices::usart::{Usart, Wires};
use crate::image::Image;
use crate::pins::{Mode, Pin};
use crate::refusal::Refusals;
use bus::{Bus, Now};
use clocks::{Clock, Rates};
use crepitus_device::board::pins::drive;
use part::{Gate, Library, Part, registers};
use pins::Pins;
use rsemu::core::device::Device;
use rsemu::core::props::Props;
use rsemu::core::wire::WireSource;
use rsemu::cpu::arm::v7m::ArmV7m;
use rsemu::dev::stm32::crc::{self, Crc};
use rsemu::dev::stm32::dma::{self, Dma};
use rsemu::dev::stm32::gpio::{Gpio, ResetValues};
use rsemu::dev::stm32::iwdg::Iwdg;
use rsemu::dev::stm32::pwr::{self, Pwr};
use rsemu::dev::stm32::rcc::{self, Frequencies, Rcc};
use rsemu::dev::stm32::tim::Tim;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use wires::{Latch, Nets};

/// Ports that the chip has.
const PORTS: u32 = 9;

/// Clocks of the crystal until crystal or PLL are ready: nominal 2 ms would
/// only cost time.
const READY_CLOCKS: u64 = 400;

/// CR1 of TIM1, and the timers that its trigger output may start (RM0090, TIMx internal trigger connection).
pub(crate) const TRIGGER: u32 = 0x4001_0000;
pub(crate) const TRIGGERED: [&str; 3] = ["TIM3", "TIM4", "TIM8"];

/// The parts that are accessed from outside of the chip.
pub(crate) struct Chip {
    pub(crate) bus: Arc<Bus>,
    pub(crate) rcc: Arc<Rcc>,
    pub(crate) flash: Arc<Flash>,
    pub(crate) ports: Vec<Arc<Gpio>>,
    /// Breaks of TIM1 and of TIM8.
    pub(crate) brakes: [Arc<Brake>; 2],
    pub(crate) adcs: Arc<Adcs>,
    pub(crate) analog: Arc<Analog>,
    pub(crate) pins: Arc<Pins>,
    pub(crate) usart: Arc<Usart>,
    pub(crate) otg: Arc<Otg>,
    pub(crate) dma: [Arc<Dma>; 2],
    /// Channels A and B of the encoder.
    pub(crate) quadrature: [WireSource; 2],
    /// The first use that the manual forbids.
    pub(crate) refusals: Arc<Refusals>,
    /// The watchdog has fired.
    pub(crate) watchdog_fired: Arc<AtomicBool>,
    /// The inputs of the reset flags.
    pub(crate) causes: wires::Causes,
    /// The interrupt lines that are high.
    pub(crate) raised: Arc<wires::Raised>,
}

/// The oscillators, with this crystal.
fn frequencies(crystal_hz: u64) -> Frequencies {
    Frequencies {
        hse: crystal_hz.max(1),
        ..Frequencies::default()
    }
}

/// A timer of the library.
fn timer(variant: &str, width: u32) -> Arc<Tim> {
    let reload = if width == 32 { u32::MAX } else { 0xffff };
    let props = Props::new()
        .with("variant", variant)
        .with("width", u64::from(width))
        .with("arr-reset", u64::from(reload));
    Arc::new(Tim::new(&props).expect("a timer that there is"))
}

impl Chip {
    /// A chip around a core.
    pub(crate) fn new(core: &ArmV7m, image: &Image) -> Self {
        let nets = Nets::new(core);
        let now = Now::default();
        let crystal_hz = u64::from(image.crystal_hz);
        let frequencies = frequencies(crystal_hz);
        let rcc = Arc::new(Rcc::with_config(
            rcc::Variant::F4,
            frequencies,
            READY_CLOCKS,
        ));
        let rates = Arc::new(Rates::new(rcc.clocks(), crystal_hz));
        let dma = [(); 2].map(|()| Arc::new(Dma::with_variant(dma::Variant::Stream)));
        let refusals = Arc::<Refusals>::default();
        let (bytes, options) = (&image.flash, image.option_bytes);
        let flash = Flash::new(bytes, options, now.clone(), refusals.clone());
        let flash_registers = Arc::new(AsRegisters(flash.clone()));
        let mut parts = vec![
            Part::of_library("RCC", 0x4002_3800, Clock::Crystal, None, rcc.clone()),
            Part::new(
                "FLASH",
                0x4002_3c00,
                Clock::Time,
                None,
                flash_registers,
                flash.clone(),
            ),
        ];
        let apb2_reset = Gate::apb1(28);
        let pwr = Arc::new(Pwr::with_config(pwr::Variant::F4, 0));
        parts.push(Part::of_library(
            "PWR",
            0x4000_7000,
            Clock::Core,
            apb2_reset,
            pwr,
        ));
        let random = Arc::new(Random::new());
        let (base, gate) = (0x5006_0800, Gate::ahb2(6));
        let random = Part::new("RNG", base, Clock::Pll48, gate, random.clone(), random);
        parts.push(random);
        let crc = Arc::new(Crc::build(crc::Variant::F4));
        parts.push(Part::of_library(
            "CRC",
            0x4002_3000,
            Clock::Core,
            Gate::ahb1(12),
            crc,
        ));
        let watchdog_fired = Latch::new();
        let watchdog = Arc::new(Iwdg::with_window(false));
        watchdog
            .connect("reset", nets.to(watchdog_fired.clone(), 0))
            .expect("it has a reset");
        parts.push(Part::of_library(
            "IWDG",
            0x4000_3000,
            Clock::Low,
            None,
            watchdog,
        ));
        let ports = Self::add_ports(&mut parts);
        let pins = Arc::new(Pins::new(&ports));
        let analog = Arc::new(Analog::new(pins.clone()));
        Self::add_dma(&mut parts, &nets, &dma, &refusals);
        let adcs = Self::add_adcs(&mut parts, &nets, &rates, &now, &analog);
        let brakes = [
            (brake::TIM1, 0x4001_0000, 0, [24, 25, 26, 27]),
            (brake::TIM8, 0x4001_0400, 1, [43, 44, 45, 46]),
        ];
        let advanced =
            brakes.map(|timer| Self::add_advanced_timer(&mut parts, &nets, &pins, timer));
        let (quadrature, mut triggered) = Self::add_timers(&mut parts, &nets, &adcs);
        triggered.push(advanced[1].1.clone());
        Self::wire_trigger(&nets, &advanced[0].1, &triggered);
        let brakes = advanced.map(|(brake, _)| brake);
        Self::add_crystal_meter(&mut parts, &nets, &rcc, &rates, crystal_hz);
        let usart = Self::add_usart(&mut parts, &nets, &rates, &now, (&dma[1], &pins));
        let otg = Self::add_otg(&mut parts, &nets, &rates, &now, &pins);
        let causes = wires::Causes::new(&nets, &rcc);
        let bus = Bus::new(parts, rates, now, rcc.clone(), dma.clone());
        Self::let_memory_lag(&bus, usart.clone());
        Self {
            bus: Arc::new(bus),
            rcc,
            flash,
            ports,
            brakes,
            adcs,
            analog,
            pins,
            usart,
            otg,
            dma,
            quadrature,
            refusals,
            watchdog_fired: watchdog_fired.flag(),
            causes,
            raised: nets.raised(),
        }
    }

    fn add_ports(parts: &mut Vec<Part>) -> Vec<Arc<Gpio>> {
        const NAMES: [&str; PORTS as usize] = [
            "GPIOA", "GPIOB", "GPIOC", "GPIOD", "GPIOE", "GPIOF", "GPIOG", "GPIOH", "GPIOI",
        ];
        // Pins of the debugger.
        let resets = |port| match port {
            0 => (0xa800_0000, 0, 0x6400_0000),
            1 => (0x0000_0280, 0x0000_00c0, 0x0000_0100),
            _ => (0, 0, 0),
        };
        (0..PORTS)
            .zip(NAMES)
            .map(|(port, name)| {
                let (moder, ospeedr, pupdr) = resets(port);
                let gpio = Arc::new(Gpio::with_reset(ResetValues {
                    moder,
                    ospeedr,
                    pupdr,
                }));
                let base = 0x4002_0000 + 0x400 * port;
                let gate = Gate::ahb1(port);
                parts.push(Part::of_library(
                    name,
                    base,
                    Clock::Core,
                    gate,
                    gpio.clone(),
                ));
                gpio
            })
            .collect()
    }

    fn add_dma(
        parts: &mut Vec<Part>,
        nets: &Nets<'_>,
        dma: &[Arc<Dma>; 2],
        refusals: &Arc<Refusals>,
    ) {
        const INTERRUPTS: [[u16; 8]; 2] = [
            [11, 12, 13, 14, 15, 16, 17, 47],
            [56, 57, 58, 59, 60, 68, 69, 70],
        ];
        let places = [("DMA1", 0x4002_6000, 21, 1), ("DMA2", 0x4002_6400, 22, 2)];
        for ((dma, interrupts), (name, base, bit, controller)) in
            dma.iter().zip(INTERRUPTS).zip(places)
        {
            for (stream, interrupt) in interrupts.into_iter().enumerate() {
                dma.connect_irq(stream, nets.interrupt(interrupt));
            }
            let gate = Gate::ahb1(bit);
            let checked = Arc::new(EventFlags {
                controller,
                registers: registers(&**dma),
                refusals: refusals.clone(),
            });
            let peripheral = Arc::new(Library(dma.clone()));
            parts.push(Part::new(
                name,
                base,
                Clock::Core,
                gate,
                checked,
                peripheral,
            ));
        }
    }

    fn add_adcs(
        parts: &mut Vec<Part>,
        nets: &Nets<'_>,
        rates: &Arc<Rates>,
        now: &Now,
        analog: &Arc<Analog>,
    ) -> Arc<Adcs> {
        let adcs = [1, 2, 3].map(|number| {
            let interrupt = nets.interrupt(18);
            let (rates, now, analog) = (rates.clone(), now.clone(), analog.clone());
            Arc::new(Adc::new(number, rates, now, interrupt, analog))
        });
        let adcs = Arc::new(Adcs(adcs));
        let registers = Arc::new(AsRegisters(adcs.clone()));
        let (clock, gate) = (Clock::Time, Gate::apb2(8));
        let part = Part::new("ADC", 0x4001_2000, clock, gate, registers, adcs.clone());
        parts.push(part);
        adcs
    }

    /// Adds a timer, by its break, address, bit of its clock, and interrupts: break, update,
    /// trigger, compare.
    fn add_advanced_timer(
        parts: &mut Vec<Part>,
        nets: &Nets<'_>,
        pins: &Arc<Pins>,
        (input, base, bit, [on_break, update, trigger, compare]): (
            brake::Input,
            u32,
            u32,
            [u16; 4],
        ),
    ) -> (Arc<Brake>, Arc<Tim>) {
        let timer = timer("advanced", 16);
        for (port, interrupt) in [
            ("irq-up", update),
            ("irq-trg", trigger),
            ("irq-cc", compare),
        ] {
            let connected = timer.connect(port, nets.interrupt(interrupt));
            connected.expect("an advanced timer has it");
        }
        let brake = Arc::new(Brake::new(
            input,
            registers(&*timer),
            Arc::new(Library(timer.clone())),
            nets.interrupt(on_break),
            pins.clone(),
        ));
        let (clock, gate) = (Clock::Timers2, Gate::apb2(bit));
        parts.push(Part::new(
            input.timer,
            base,
            clock,
            gate,
            brake.clone(),
            brake.clone(),
        ));
        (brake, timer)
    }

    /// Adds the timers of APB1; returns the inputs of TIM5, and those that TIM1 triggers.
    fn add_timers(
        parts: &mut Vec<Part>,
        nets: &Nets<'_>,
        adcs: &Arc<Adcs>,
    ) -> ([WireSource; 2], Vec<Arc<Tim>>) {
        const TIMERS: [(&str, u32, u32, u32, u16); 4] = [
            ("TIM2", 0x4000_0000, 0, 32, 28),
            ("TIM3", 0x4000_0400, 1, 16, 29),
            ("TIM4", 0x4000_0800, 2, 16, 30),
            ("TIM5", 0x4000_0c00, 3, 32, 50),
        ];
        let (mut quadrature, mut triggered) = (Vec::new(), Vec::new());
        for (name, base, bit, width, interrupt) in TIMERS {
            let timer = timer("general", width);
            let connected = timer.connect("irq", nets.interrupt(interrupt));
            connected.expect("every timer has an interrupt");
            if let Some((_, number)) = adc::TRIGGERS.iter().find(|(timer, _)| *timer == name) {
                let connected = timer.connect("trgo", nets.to(adcs.clone(), *number));
                connected.expect("every timer has a trigger output");
            }
            if name == "TIM5" {
                quadrature = ["ti1", "ti2"]
                    .map(|port| nets.to_device(&*timer, port))
                    .into();
            }
            if TRIGGERED.contains(&name) {
                triggered.push(timer.clone());
            }
            let gate = Gate::apb1(bit);
            parts.push(Part::of_library(name, base, Clock::Timers1, gate, timer));
        }
        (quadrature.try_into().expect("two channels"), triggered)
    }

    /// Wires TIM1's trigger output to the timers that it starts.
    fn wire_trigger(nets: &Nets<'_>, bridge: &Tim, triggered: &[Arc<Tim>]) {
        let trigger = nets.to_devices(triggered, "itr0");
        let connected = bridge.connect("trgo", trigger);
        connected.expect("an advanced timer has a trigger output");
    }

    fn let_memory_lag(bus: &Bus, receiver: Arc<Usart>) {
        bus.memory_lag.of(Box::new(move || receiver.next_arrival()));
    }

    fn add_crystal_meter(
        parts: &mut Vec<Part>,
        nets: &Nets<'_>,
        rcc: &Arc<Rcc>,
        rates: &Arc<Rates>,
        crystal_hz: u64,
    ) {
        let timer = timer("general", 16);
        let input = nets.to_device(&*timer, "ti1");
        let behind = (registers(&*timer), Arc::new(Library(timer)) as Arc<_>);
        let clock = (rates.clone(), crystal_hz);
        let meter = Arc::new(CrystalMeter::new(behind, input, registers(&**rcc), clock));
        let (clock, gate) = (Clock::Timers2, Gate::apb2(18));
        let part = Part::new("TIM11", 0x4001_4800, clock, gate, meter.clone(), meter);
        parts.push(part);
    }

    fn add_usart(
        parts: &mut Vec<Part>,
        nets: &Nets<'_>,
        rates: &Arc<Rates>,
        now: &Now,
        (dma, pins): (&Arc<Dma>, &Arc<Pins>),
    ) -> Arc<Usart> {
        const CHANNEL: u8 = 5;
        let wires = Wires {
            pins: pins.clone(),
            sends: Pin::of(&drive::LINK_SENDS),
            receives: Pin::of(&drive::LINK_RECEIVES),
            function: Mode::of(&drive::LINK_SENDS),
        };
        let requests = |streams: [usize; 2]| {
            streams
                .map(|stream| (dma.clone(), stream, CHANNEL))
                .to_vec()
        };
        let usart = Arc::new(Usart::new(
            rates.clone(),
            now.clone(),
            wires,
            nets.interrupt(71),
            requests([1, 2]),
            requests([6, 7]),
        ));
        let registers = Arc::new(AsRegisters(usart.clone()));
        let (clock, gate) = (Clock::Time, Gate::apb2(5));
        parts.push(Part::new(
            "USART6",
            0x4001_1400,
            clock,
            gate,
            registers,
            usart.clone(),
        ));
        usart
    }

    fn add_otg(
        parts: &mut Vec<Part>,
        nets: &Nets<'_>,
        rates: &Arc<Rates>,
        now: &Now,
        pins: &Arc<Pins>,
    ) -> Arc<Otg> {
        let interrupt = nets.interrupt(67);
        let otg = Arc::new(Otg::new(
            rates.clone(),
            now.clone(),
            pins.clone(),
            interrupt,
        ));
        let registers = Arc::new(AsRegisters(otg.clone()));
        let (clock, gate) = (Clock::Time, Gate::ahb2(7));
        let mut part = Part::new("OTG_FS", 0x5000_0000, clock, gate, registers, otg.clone());
        part.bytes = otg::BYTES;
        parts.push(part);
        otg
    }
}
