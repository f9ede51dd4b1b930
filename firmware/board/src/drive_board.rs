//! The drive's board: which part is on which pin.

use crate::bridge::Bridge;
use crate::clocks;
use crate::converter::Converter;
use crate::enable_line::EnableLine;
use crate::encoder::Encoder;
use crate::identity::identity;
use crate::link::{BUFFERS, DmaBuffer, Link};
use crate::start::{Start, start};
use crate::ticks::{BeginOfTick, MiddleOfTick};
use crepitus_protocol::management::{Identity, Role};
use stm32f4xx_hal::pac::{IWDG, Peripherals};
use stm32f4xx_hal::prelude::*;

/// Its parts.
pub struct DriveBoard {
    /// Reset cause and start counter.
    pub start: Start,
    /// Identity for a hello.
    pub identity: Identity,
    /// PB0, read back on PB1.
    pub line: EnableLine,
    /// PA8, PB13, PA9, PB14; break on PB12.
    pub bridge: Bridge,
    /// PC0.
    pub converter: Converter,
    /// PA0, PA1.
    pub encoder: Encoder,
    /// PC6, PC7.
    pub link: Link,
    /// Starts `sample_encoder`.
    pub begin: BeginOfTick,
    /// Starts `command_motor`.
    pub middle: MiddleOfTick,
    /// Started last.
    pub watchdog: IWDG,
}

impl DriveBoard {
    /// Sets up the board with outputs off; ticks begin with
    /// [`ticks::start`](crate::ticks::start).
    pub fn new(chip: Peripherals, buffers: [DmaBuffer; BUFFERS]) -> Self {
        let mut rcc = clocks::start(chip.RCC);
        let start = start(&mut rcc, &chip.RNG);
        let a = chip.GPIOA.split(&mut rcc);
        let b = chip.GPIOB.split(&mut rcc);
        let c = chip.GPIOC.split(&mut rcc);
        // First what switches the motor.
        let line = EnableLine::new(b.pb0, b.pb1);
        let bridge = Bridge::new(
            chip.TIM1,
            (a.pa8, b.pb13),
            (a.pa9, b.pb14),
            b.pb12,
            &mut rcc,
        );
        Self {
            start,
            identity: identity(Role::Drive, &start),
            line,
            bridge,
            converter: Converter::new(chip.ADC1, &chip.ADC_COMMON, c.pc0, &mut rcc),
            encoder: Encoder::new(chip.TIM5, a.pa0, a.pa1, &mut rcc),
            link: Link::new(&chip.USART6, chip.DMA2, (c.pc6, c.pc7), buffers, &mut rcc),
            begin: BeginOfTick::new(chip.TIM4, &mut rcc),
            middle: MiddleOfTick::new(chip.TIM3, &mut rcc),
            watchdog: chip.IWDG,
        }
    }
}
