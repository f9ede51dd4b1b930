//! The vector table: which code an interrupt really starts.

use crate::image::elf::Image;
use crate::image::error::ImageError;

/// Content of the table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Vectors {
    /// Address of the table.
    pub address: u32,
    /// The stack pointer at reset.
    pub stack: u32,
    /// All words, the stack pointer included.
    words: Vec<u32>,
}

impl Vectors {
    /// Reads the section `.vector_table`.
    ///
    /// # Errors
    ///
    /// [`ImageError::NoVectors`] if there is none.
    pub fn read(image: &Image) -> Result<Self, ImageError> {
        let section = image
            .section(".vector_table")
            .ok_or(ImageError::NoVectors)?;
        let words: Vec<u32> = section
            .bytes
            .chunks_exact(4)
            .filter_map(|word| Some(u32::from_le_bytes(word.try_into().ok()?)))
            .collect();
        match words.as_slice() {
            [stack, _reset, ..] => Ok(Self {
                address: section.address,
                stack: *stack,
                words,
            }),
            _ => Err(ImageError::NoVectors),
        }
    }

    /// The function that an interrupt starts; numbers below 0 are exceptions
    /// as CMSIS counts them (`SysTick` -1, `PendSV` -2, `HardFault` -13).
    pub fn handler(&self, irq: i16) -> Option<u32> {
        let index = usize::try_from(i32::from(irq) + 16).ok()?;
        let word = *self.words.get(index)?;
        (index > 0 && word != 0).then_some(word & !1)
    }

    /// Number and function of every vector but the one of reset.
    pub fn handlers(&self) -> impl Iterator<Item = (i16, u32)> {
        (-14..)
            .zip(self.words.iter().skip(2))
            .filter(|(_, word)| **word != 0)
            .map(|(irq, word)| (irq, word & !1))
    }

    /// The function that starts at reset.
    pub fn reset(&self) -> u32 {
        self.words.get(1).map_or(0, |word| word & !1)
    }
}
