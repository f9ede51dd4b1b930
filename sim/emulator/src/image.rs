//! Images: the part of an ELF file that lies in flash, and its symbols.

use crepitus_device::board::CRYSTAL_HZ;
use crepitus_files::input::{self, InputError};
use object::elf::{EM_ARM, PT_LOAD};
use object::read::elf::{ElfFile32, FileHeader as _, ProgramHeader as _};
use object::{LittleEndian, Object as _, SymbolKind};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Start address of flash.
pub const FLASH: u32 = 0x0800_0000;

/// Bytes of flash.
pub const FLASH_BYTES: usize = 1 << 20;

/// Reason why an image cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImageError {
    /// The file cannot be read.
    #[error("{path}: {source}")]
    Read {
        /// Path of the file.
        path: PathBuf,
        /// Cause.
        source: InputError,
    },
    /// Not a little-endian ELF file of 32 bits, or cut off.
    #[error("not an ELF image: {0}")]
    Invalid(#[from] object::Error),
    /// An ELF file for another architecture.
    #[error("not an ELF image for ARM")]
    NotArm,
    /// A segment is longer than the file.
    #[error("an ELF image that is cut off")]
    CutOff,
    /// A segment lies where there is no flash.
    #[error("a segment at {0:#x} is outside of flash")]
    OutsideFlash(u32),
}

/// A symbol.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Symbol {
    /// Address; of a function, without the bit that says Thumb.
    pub address: u32,
    /// Bytes.
    pub size: u32,
}

/// Option bytes of the board, as in `FLASH_OPTCR`: brown-out level 3, a watchdog that
/// software starts, no protection.
const OPTION_BYTES: u32 = 0x0fff_aae1;

/// Longest file of an image, bytes: most of it is for a debugger.
const MOST_BYTES: u64 = 256 << 20;

/// An image.
#[derive(Clone, Debug)]
pub struct Image {
    /// Contents of flash, from its beginning.
    pub flash: Vec<u8>,
    /// The option bytes of the chip that it is programmed into.
    pub option_bytes: u32,
    /// The crystal of the board that it is programmed into, Hz. A board without one is not modelled.
    pub crystal_hz: u32,
    symbols: BTreeMap<String, Symbol>,
}

impl Image {
    /// Reads a file.
    ///
    /// # Errors
    /// [`ImageError`].
    pub fn read(path: &Path) -> Result<Self, ImageError> {
        let bytes = input::read(path, MOST_BYTES).map_err(|source| ImageError::Read {
            path: path.to_owned(),
            source,
        })?;
        Self::of_elf(&bytes)
    }

    /// Makes an image from bytes of flash, without any names.
    pub fn of_flash(flash: &[u8]) -> Self {
        Self {
            flash: flash.to_vec(),
            option_bytes: OPTION_BYTES,
            crystal_hz: CRYSTAL_HZ,
            symbols: BTreeMap::new(),
        }
    }

    /// Makes an image from the bytes of an ELF file.
    ///
    /// # Errors
    /// [`ImageError`].
    pub fn of_elf(bytes: &[u8]) -> Result<Self, ImageError> {
        let elf = ElfFile32::<LittleEndian>::parse(bytes)?;
        if elf.elf_header().e_machine(LittleEndian) != EM_ARM {
            return Err(ImageError::NotArm);
        }
        let mut image = Self::of_flash(&[]);
        for segment in elf.elf_program_headers() {
            if segment.p_type(LittleEndian) == PT_LOAD {
                let content = segment.data(LittleEndian, bytes);
                let content = content.map_err(|()| ImageError::CutOff)?;
                image.load(segment.p_paddr(LittleEndian), content)?;
            }
        }
        image.symbols = elf.symbols().filter_map(|symbol| named(&symbol)).collect();
        Ok(image)
    }

    fn load(&mut self, address: u32, content: &[u8]) -> Result<(), ImageError> {
        if content.is_empty() {
            return Ok(());
        }
        let begin = address.checked_sub(FLASH).map(|begin| begin as usize);
        let begin = begin.filter(|begin| begin + content.len() <= FLASH_BYTES);
        self.put(begin.ok_or(ImageError::OutsideFlash(address))?, content);
        Ok(())
    }

    /// Puts bytes at an offset in flash.
    ///
    /// # Panics
    /// If the chip cannot be loaded with so many.
    pub fn put(&mut self, begin: usize, content: &[u8]) {
        let end = begin + content.len();
        if self.flash.len() < end {
            self.flash.resize(end, 0xff);
        }
        self.flash[begin..end].copy_from_slice(content);
    }

    /// The symbol of that name.
    pub fn symbol(&self, name: &str) -> Option<Symbol> {
        self.symbols.get(name).copied()
    }

    /// All symbols, by name.
    pub fn symbols(&self) -> impl Iterator<Item = (&str, Symbol)> {
        self.symbols.iter().map(|(name, at)| (name.as_str(), *at))
    }

    /// The handler of an exception, as the table of vectors says.
    pub fn vector(&self, exception: u16) -> Option<u32> {
        let begin = 4 * usize::from(exception);
        let bytes = self.flash.get(begin..begin + 4)?;
        Some(u32::from_le_bytes(bytes.try_into().ok()?) & !1)
    }
}

/// A symbol by its name, if it has one.
fn named<'a>(symbol: &impl object::ObjectSymbol<'a>) -> Option<(String, Symbol)> {
    let thumb = u32::from(symbol.kind() == SymbolKind::Text);
    let address = u32::try_from(symbol.address()).ok()? & !thumb;
    let size = u32::try_from(symbol.size()).ok()?;
    Some((symbol.name().ok()?.to_owned(), Symbol { address, size }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use object::elf::EM_X86_64;

    /// A header for `machine` and one segment of `size` bytes at `address`.
    fn elf(machine: object::elf::Machine, address: u32, size: u32) -> Vec<u8> {
        let mut bytes = b"\x7fELF\x01\x01\x01".to_vec();
        bytes.resize(16, 0);
        for half in [2, machine.0] {
            bytes.extend(half.to_le_bytes());
        }
        for word in [1_u32, 0, 52, 0, 0] {
            bytes.extend(word.to_le_bytes());
        }
        for half in [52_u16, 32, 1, 40, 0, 0] {
            bytes.extend(half.to_le_bytes());
        }
        for word in [PT_LOAD.0, 84, address, address, size, size, 4, 4] {
            bytes.extend(word.to_le_bytes());
        }
        bytes.extend([1, 2, 3, 4]);
        bytes
    }

    #[test]
    fn a_segment_lies_at_its_load_address() {
        let image = Image::of_elf(&elf(EM_ARM, FLASH + 2, 4)).expect("an image");
        assert_eq!(image.flash, [0xff, 0xff, 1, 2, 3, 4]);
    }

    #[test]
    fn every_refusal_has_its_reason() {
        let refused = |bytes: &[u8]| Image::of_elf(bytes).expect_err("refused").to_string();
        assert!(refused(b"no image").starts_with("not an ELF image: "));
        assert_eq!(
            refused(&elf(EM_X86_64, FLASH, 4)),
            "not an ELF image for ARM"
        );
        assert_eq!(
            refused(&elf(EM_ARM, FLASH, 5)),
            "an ELF image that is cut off"
        );
        let last = FLASH + u32::try_from(FLASH_BYTES).expect("a megabyte") - 3;
        for address in [0x2000_0000, FLASH - 1, last] {
            let reason = refused(&elf(EM_ARM, address, 4));
            assert_eq!(
                reason,
                format!("a segment at {address:#x} is outside of flash")
            );
        }
    }
}
