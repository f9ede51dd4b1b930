//! The image of comms on its board: link, enable line, USB.
//!
//! ```text
//!   drive ── 4.2 Mbaud ──> USART6 ┌───────────┐ OTG_FS ══ host
//!         <────────────────       │ the image │
//!   motor supply <───── gate, PB0 └───────────┘ PB1: read-back of the gate
//! ```
//!
//! A character takes half a tick longer than on the wire, which lets the two
//! boards run one after the other.

use crate::character::Character;
use crate::drive_board::{CommsSide, HALF};
use crate::image::Image;
use crate::mcu::{Pin, Reset};
use crate::refusal::Refusal;
use crate::stm32f405::Stm32f405;
use crate::time::Time;
use crepitus_device::board::pins::comms;

/// The enable line: what drives it, and where it is read back.
const LINE: Pin = Pin::of(&comms::LINE);
const LINE_BACK: Pin = Pin::of(&comms::LINE_BACK);

/// The board.
pub struct CommsBoard {
    mcu: Stm32f405,
    resets: Vec<(Time, Reset)>,
    /// The line is stuck at this level.
    pub stuck_line: Option<bool>,
}

impl CommsBoard {
    /// The board with an image, just switched on.
    pub fn new(image: &Image) -> Self {
        Self {
            mcu: Stm32f405::new(image),
            resets: Vec::new(),
            stuck_line: None,
        }
    }

    /// The microcontroller.
    pub fn mcu(&self) -> &Stm32f405 {
        &self.mcu
    }

    /// The microcontroller, to break it, and for its USB.
    pub fn mcu_mut(&mut self) -> &mut Stm32f405 {
        &mut self.mcu
    }

    /// Resets the chip.
    pub fn reset(&mut self, reset: Reset) {
        self.resets.push((self.mcu.now(), reset));
        self.mcu.reset(reset);
    }

    /// Resets of the chip since the board was switched on.
    pub fn resets(&self) -> &[(Time, Reset)] {
        &self.resets
    }
}

/// A character as the other board gets it.
fn carried(character: Character) -> Character {
    Character {
        at: character.at + HALF.units(),
        ..character
    }
}

impl CommsSide for CommsBoard {
    fn run(&mut self, sent: Vec<Character>, end: Time, _: Time) -> Vec<Character> {
        for character in sent {
            self.mcu.link_feed(carried(character));
        }
        self.mcu.drive_pin(LINE_BACK, self.line_is_on());
        self.mcu.run_until(end);
        self.resets.extend(self.mcu.take_resets());
        self.mcu.link_take().into_iter().map(carried).collect()
    }

    fn line_is_on(&self) -> bool {
        self.stuck_line.unwrap_or_else(|| self.mcu.pin(LINE))
    }

    fn set_hung(&mut self, is_hung: bool) {
        self.mcu.set_hung(is_hung);
    }

    fn refusal(&self) -> Option<Refusal> {
        self.mcu.refusal()
    }
}
