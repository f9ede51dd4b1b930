//! Decoded code of flash.

use super::plain::is_plain;
use crate::devices::flash::Flash;
use crate::image::{FLASH, FLASH_BYTES};
use rsemu::cpu::arm::v7m::isa::{Insn, decode, is_32bit};
use std::sync::Arc;

/// Half words that are decoded at once.
const PAGE: usize = 128;

/// An instruction of flash.
#[derive(Clone, Copy)]
pub(super) struct Decoded {
    pub(super) instruction: Insn,
    /// Bytes.
    pub(super) width: u32,
    /// Plain instructions from this one on, as far as they are known; 0 if this is
    /// none.
    pub(super) run: u8,
}

type Page = [Decoded; PAGE];

/// The code that has been executed so far, decoded.
pub(super) struct Code {
    flash: Arc<Flash>,
    /// Version of the content which is decoded.
    version: u64,
    pages: Vec<Option<Box<Page>>>,
}

impl Code {
    pub(super) fn new(flash: Arc<Flash>) -> Self {
        let pages = FLASH_BYTES / (2 * PAGE);
        Self {
            version: flash.version(),
            flash,
            pages: vec![None; pages],
        }
    }

    /// Drops what has been decoded if the content has changed.
    pub(super) fn refresh(&mut self) {
        let version = self.flash.version();
        if self.version != version {
            self.version = version;
            self.pages.fill(None);
        }
    }

    /// The instruction at an address, if that is in flash.
    #[inline]
    pub(super) fn at(&mut self, address: u32) -> Option<&Decoded> {
        let half = (address.wrapping_sub(FLASH) / 2) as usize;
        let page = self.pages.get_mut(half / PAGE)?;
        let page = match page {
            Some(page) => page,
            None => page.insert(decoded(&self.flash, half / PAGE)),
        };
        Some(&page[half % PAGE])
    }
}

fn decoded(flash: &Flash, number: usize) -> Box<Page> {
    let begin = 2 * PAGE * number;
    let end = FLASH_BYTES.min(begin + 2 * PAGE + 2);
    let bytes = flash.content(begin..end);
    let half = |place: usize| {
        let bytes = bytes.get(2 * place..2 * place + 2)?;
        Some(u16::from_le_bytes(bytes.try_into().ok()?))
    };
    let none = Decoded {
        instruction: Insn::Undefined,
        width: 2,
        run: 0,
    };
    let mut page = Box::new([none; PAGE]);
    for place in (0..PAGE).rev() {
        let Some(first) = half(place) else { continue };
        let is_wide = is_32bit(first);
        let Some(second) = (if is_wide { half(place + 1) } else { Some(0) }) else {
            continue;
        };
        let instruction = decode(first, second);
        let next = place + if is_wide { 2 } else { 1 };
        let rest = page.get(next).map_or(1, |next| next.run);
        page[place] = Decoded {
            instruction,
            width: if is_wide { 4 } else { 2 },
            run: if is_plain(&instruction) {
                rest.saturating_add(1)
            } else {
                0
            },
        };
    }
    page
}
