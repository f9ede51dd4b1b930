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
    /// PB0, read back on PB1.
    pub line: EnableLine,
    /// PB10: that of comms.
    pub comms_line: OtherLine,
    /// PA8, PB13, PA9, PB14; break on PB12.
    pub bridge: Bridge,
    /// PC8, PC9; break on PA6.
    pub coil: Coil,
    /// PC0, PC1; PC3, PA2, PC2; PA3.
    pub converters: Converters,
    /// PA0, PA1.
    pub encoder: Encoder,
    /// PC6, PC7.
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
        let coil = Coil::new(chip.TIM8, (c.pc8, c.pc9), a.pa6, &mut rcc);
        let option_bytes = chip.FLASH.optcr().read().bits();
        let (identity, self_test) = identity(Role::Drive, &start, option_bytes);
        Self {
            start,
            identity,
            self_test,
            line,
            comms_line: OtherLine::new(b.pb10),
            bridge,
            coil,
            converters: Converters::new(
                (chip.ADC1, chip.ADC2, chip.ADC3),
                &chip.ADC_COMMON,
                (c.pc0, c.pc1),
                (c.pc3, a.pa2, c.pc2),
                a.pa3,
                &mut rcc,
            ),
            encoder: Encoder::new(chip.TIM5, a.pa0, a.pa1, &mut rcc),
            link: Link::new(&chip.USART6, chip.DMA2, (c.pc6, c.pc7), buffers, &mut rcc),
            crc_unit: CrcUnit::new(chip.CRC, &mut rcc),
            black_box: BlackBox::new(),
            begin: BeginOfTick::new(chip.TIM4, &mut rcc),
            middle: MiddleOfTick::new(chip.TIM3, &mut rcc),
            clock: FreeClock::start(chip.TIM2, &mut rcc),
            watchdog: chip.IWDG,
        }
    }
}
