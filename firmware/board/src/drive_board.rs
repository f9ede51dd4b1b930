//! The drive's board: which part is on which pin.

use crate::bridge::Bridge;
use crate::clocks;
use crate::coil::Coil;
use crate::converter::Converters;
use crate::crash::BlackBox;
use crate::crc_unit::CrcUnit;
use crate::enable_line::{EnableLine, OtherLine};
use crate::encoder::Encoder;
use crate::identity::identity;
use crate::link::{BUFFERS, DmaBuffer, Link};
use crate::pins::Ports;
use crate::pins::drive::Pins;
use crate::start::{Start, start};
use crate::ticks::{BeginOfTick, FreeClock, MiddleOfTick};
use crepitus_device::self_test::SelfTest;
use crepitus_protocol::management::{Identity, Role};
use stm32f4xx_hal::pac::{IWDG, Peripherals};
use stm32f4xx_hal::prelude::*;

/// Parts of the drive's board.
pub struct DriveBoard {
    /// Reset cause and start counter.
    pub start: Start,
    /// Identity for a hello.
    pub identity: Identity,
    /// Result of the self-test.
    pub self_test: SelfTest,
    /// Crystal as measured, Hz.
    pub crystal_hz: u32,
    /// Enable line.
    pub line: EnableLine,
    /// That of comms.
    pub comms_line: OtherLine,
    /// Bridge of the motor.
    pub bridge: Bridge,
    /// Driver of the vibration actuator's coil.
    pub coil: Coil,
    /// Currents and what changes slowly.
    pub converters: Converters,
    /// Encoder of the motor.
    pub encoder: Encoder,
    /// Link to comms.
    pub link: Link,
    /// Checksums of frames.
    pub crc_unit: CrcUnit,
    /// Stores the last ticks.
    pub black_box: BlackBox,
    /// Starts `sample_encoder`.
    pub begin: BeginOfTick,
    /// Starts `command_motor`.
    pub middle: MiddleOfTick,
    /// Measures the time between two ticks.
    pub clock: FreeClock,
    /// Started last.
    pub watchdog: IWDG,
}

impl DriveBoard {
    /// Sets up the board with outputs off; ticks begin with
    /// [`ticks::start`](crate::ticks::start).
    pub fn new(chip: Peripherals, buffers: [DmaBuffer; BUFFERS]) -> Self {
        let (mut rcc, crystal_hz) = clocks::start(chip.RCC, &chip.TIM11);
        let start = start(&mut rcc, &chip.RNG);
        let pins = Pins::of(Ports {
            a: chip.GPIOA.split(&mut rcc),
            b: chip.GPIOB.split(&mut rcc),
            c: chip.GPIOC.split(&mut rcc),
        });
        // First what switches the motor.
        let line = EnableLine::new(pins.line, pins.line_back);
        let bridge = Bridge::new(
            chip.TIM1,
            (pins.upper_a, pins.lower_a),
            (pins.upper_b, pins.lower_b),
            pins.breaks,
            &mut rcc,
        );
        let inputs = (pins.coil_in1, pins.coil_in2);
        let coil = Coil::new(chip.TIM8, inputs, pins.coil_fault, &mut rcc);
        let (sends, receives) = (pins.link_sends, pins.link_receives);
        let option_bytes = chip.FLASH.optcr().read().bits();
        let (identity, self_test) = identity(Role::Drive, &start, option_bytes, crystal_hz);
        Self {
            start,
            identity,
            self_test,
            crystal_hz,
            line,
            comms_line: OtherLine::new(pins.comms_line),
            bridge,
            coil,
            converters: Converters::new(
                (chip.ADC1, chip.ADC2, chip.ADC3),
                &chip.ADC_COMMON,
                [
                    pins.sensor.into_analog().erase(),
                    pins.monitor.into_analog().erase(),
                    pins.supply.into_analog().erase(),
                    pins.motor.into_analog().erase(),
                    pins.joint.into_analog().erase(),
                    pins.coil.into_analog().erase(),
                ],
                &mut rcc,
            ),
            encoder: Encoder::new(chip.TIM5, pins.encoder_a, pins.encoder_b, &mut rcc),
            link: Link::new(
                &chip.USART6,
                chip.DMA2,
                (sends, receives),
                buffers,
                &mut rcc,
            ),
            crc_unit: CrcUnit::new(chip.CRC, &mut rcc),
            black_box: BlackBox::new(),
            begin: BeginOfTick::new(chip.TIM4, &mut rcc),
            middle: MiddleOfTick::new(chip.TIM3, &mut rcc),
            clock: FreeClock::start(chip.TIM2, &mut rcc),
            watchdog: chip.IWDG,
        }
    }
}
