//! Images: the flash content of an ELF file, and its symbols.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Where flash begins.
pub const FLASH: u32 = 0x0800_0000;

/// Bytes of flash.
pub const FLASH_BYTES: usize = 1 << 20;

/// Why an image cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImageError {
    /// The file cannot be read.
    #[error("{path}: {source}")]
    Read {
        /// The file.
        path: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
    /// Not an ELF file of 32 bits, little endian, for ARM; or truncated.
    #[error("no ELF image for ARM: {0}")]
    NoImage(&'static str),
    /// A segment is outside of flash.
    #[error("a segment at {0:#x} is outside of flash")]
    OutsideFlash(u32),
}

/// A symbol.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Symbol {
    /// Its address; for a function, without the Thumb bit.
    pub address: u32,
    /// Its size, bytes.
    pub size: u32,
}

/// An image.
#[derive(Clone, Debug, Default)]
pub struct Image {
    /// Content of flash.
    pub flash: Vec<u8>,
    symbols: BTreeMap<String, Symbol>,
}

impl Image {
    /// Reads a file.
    ///
    /// # Errors
    /// [`ImageError`].
    pub fn read(path: &Path) -> Result<Self, ImageError> {
        let bytes = std::fs::read(path).map_err(|source| ImageError::Read {
            path: path.to_owned(),
            source,
        })?;
        Self::of_elf(&bytes)
    }

    /// From bytes of flash, without any names.
    pub fn of_flash(flash: &[u8]) -> Self {
        Self {
            flash: flash.to_vec(),
            symbols: BTreeMap::new(),
        }
    }

    /// From the bytes of an ELF file.
    ///
    /// # Errors
    /// [`ImageError`].
    pub fn of_elf(bytes: &[u8]) -> Result<Self, ImageError> {
        let elf = Elf(bytes);
        let is_arm = bytes.starts_with(b"\x7fELF\x01\x01") && elf.half(18)? == 40;
        if !is_arm {
            return Err(ImageError::NoImage("its header says something else"));
        }
        let mut image = Self::default();
        let (table, count) = (elf.word(28)?, u32::from(elf.half(44)?));
        for n in 0..count {
            image.load(&elf, table + 32 * n)?;
        }
        image.name(&elf)?;
        Ok(image)
    }

    fn load(&mut self, elf: &Elf<'_>, header: u32) -> Result<(), ImageError> {
        const LOAD: u32 = 1;
        let (kind, offset) = (elf.word(header)?, elf.word(header + 4)?);
        let (address, size) = (elf.word(header + 12)?, elf.word(header + 16)?);
        if kind != LOAD || size == 0 {
            return Ok(());
        }
        let begin = address.checked_sub(FLASH).map(|begin| begin as usize);
        let range = begin.map(|begin| begin..begin + size as usize);
        let range = range.filter(|range| range.end <= FLASH_BYTES);
        let range = range.ok_or(ImageError::OutsideFlash(address))?;
        if self.flash.len() < range.end {
            self.flash.resize(range.end, 0xff);
        }
        self.flash[range].copy_from_slice(elf.bytes(offset, size)?);
        Ok(())
    }

    fn name(&mut self, elf: &Elf<'_>) -> Result<(), ImageError> {
        const SYMBOLS: u32 = 2;
        const FUNCTION: u8 = 2;
        let (table, count) = (elf.word(32)?, u32::from(elf.half(48)?));
        let section = |n: u32| table + 40 * n;
        for at in (0..count).map(section) {
            if elf.word(at + 4)? != SYMBOLS {
                continue;
            }
            let names = elf.word(section(elf.word(at + 24)?) + 16)?;
            let (begin, size) = (elf.word(at + 16)?, elf.word(at + 20)?);
            for symbol in (0..size / 16).map(|n| begin + 16 * n) {
                let name = elf.text(names + elf.word(symbol)?);
                let value = elf.word(symbol + 4)?;
                let is_function = elf.bytes(symbol + 12, 1)?.first().map(|info| info & 15);
                let address = value & !u32::from(is_function == Some(FUNCTION));
                let size = elf.word(symbol + 8)?;
                self.symbols.insert(name, Symbol { address, size });
            }
        }
        Ok(())
    }

    /// The symbol of that name.
    pub fn symbol(&self, name: &str) -> Option<Symbol> {
        self.symbols.get(name).copied()
    }

    /// All symbols, by name.
    pub fn symbols(&self) -> impl Iterator<Item = (&str, Symbol)> {
        self.symbols.iter().map(|(name, at)| (name.as_str(), *at))
    }

    /// The handler of an exception, from the vector table.
    pub fn vector(&self, exception: u16) -> Option<u32> {
        let begin = 4 * usize::from(exception);
        let bytes = self.flash.get(begin..begin + 4)?;
        Some(u32::from_le_bytes(bytes.try_into().ok()?) & !1)
    }
}

struct Elf<'a>(&'a [u8]);

impl<'a> Elf<'a> {
    fn bytes(&self, at: u32, count: u32) -> Result<&'a [u8], ImageError> {
        let begin = at as usize;
        let bytes = self.0.get(begin..begin + count as usize);
        bytes.ok_or(ImageError::NoImage("it is cut off"))
    }

    fn half(&self, at: u32) -> Result<u16, ImageError> {
        Ok(self
            .bytes(at, 2)?
            .iter()
            .rev()
            .fold(0, |all, byte| all << 8 | u16::from(*byte)))
    }

    fn word(&self, at: u32) -> Result<u32, ImageError> {
        Ok(self
            .bytes(at, 4)?
            .iter()
            .rev()
            .fold(0, |all, byte| all << 8 | u32::from(*byte)))
    }

    fn text(&self, at: u32) -> String {
        let rest = self.0.get(at as usize..).unwrap_or_default();
        let name = rest.split(|byte| *byte == 0).next().unwrap_or_default();
        String::from_utf8_lossy(name).into_owned()
    }
}
