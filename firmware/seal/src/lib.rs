//! The seal of an image: the checksum of its flash, in a word of the vector table that
//! the core does not use. `cargo run` in `firmware/drive` and `firmware/comms` seals with
//! it before the image is flashed (`firmware/seal-and-run.sh`).
//!
//! ```text
//! seal = CRC-32 of the first 512 bytes of flash, with the seal as 0
//!                  ‖ the program: code, constants, initial values
//! ```
//!
//! The vector table is within the first 512 bytes; gaps are as erased, 0xff. The
//! firmware computes the same at every start (`firmware/board/src/identity.rs`).

#![forbid(unsafe_code)]

use crc::{CRC_32_ISO_HDLC, Crc};
use object::elf::{EM_ARM, FileHeader32, PT_LOAD};
use object::read::elf::{ElfFile, FileHeader, ProgramHeader};
use object::{LittleEndian, Object, ObjectSymbol};
use std::fmt;

/// Reason why a file cannot be sealed.
#[derive(Debug)]
#[non_exhaustive]
pub enum SealError {
    /// The file is not an ELF file that can be parsed.
    Elf(object::Error),
    /// The file is an ELF file, but for another machine.
    Machine,
    /// There is no vector table at the beginning of flash.
    NoVectors,
    /// The linker script of the firmware defines this symbol; the file does not have it.
    NoSymbol(&'static str),
}

impl fmt::Display for SealError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Elf(error) => write!(f, "not a readable ELF file: {error}"),
            Self::Machine => f.write_str("not a 32-bit little-endian ARM executable"),
            Self::NoVectors => f.write_str("no vector table at the beginning of flash"),
            Self::NoSymbol(name) => write!(
                f,
                "no symbol {name}: not an image of this firmware, or stripped"
            ),
        }
    }
}

impl std::error::Error for SealError {}

type File<'data> = ElfFile<'data, FileHeader32<LittleEndian>>;

/// Address at which flash begins.
const FLASH: u32 = 0x0800_0000;

/// Bytes from there that hold the vector table.
const VECTOR_BYTES: usize = 512;

/// The place of the seal in it: the eighth word, which ARMv7-M reserves.
const SEAL_AT: usize = 0x1c;

/// Seals an ELF file in its place; returns the seal.
///
/// # Errors
/// [`SealError`] if it is not an image of this firmware.
pub fn seal(elf: &mut [u8]) -> Result<u32, SealError> {
    let (seal, place) = computed(elf)?;
    let word = elf.get_mut(place..place + 4).ok_or(SealError::NoVectors)?;
    word.copy_from_slice(&seal.to_le_bytes());
    Ok(seal)
}

/// The seal that an ELF file should have, and its place in the file.
fn computed(elf: &[u8]) -> Result<(u32, usize), SealError> {
    let file = File::parse(elf).map_err(SealError::Elf)?;
    if file.elf_header().e_machine(LittleEndian) != EM_ARM {
        return Err(SealError::Machine);
    }
    let (mut flash, mut place) = (Vec::new(), None);
    for segment in file.elf_program_headers() {
        let content = segment.data(LittleEndian, elf).unwrap_or_default();
        let load = segment.p_paddr(LittleEndian).checked_sub(FLASH);
        let Some(begin) = load.filter(|_| segment.p_type(LittleEndian) == PT_LOAD) else {
            continue;
        };
        let (begin, end) = (begin as usize, begin as usize + content.len());
        if (begin..end).contains(&SEAL_AT) {
            let offset = segment.p_offset(LittleEndian) as usize;
            place = Some(offset + SEAL_AT - begin);
        }
        if flash.len() < end {
            flash.resize(end, 0xff);
        }
        flash[begin..end].copy_from_slice(content);
    }
    let place = place.ok_or(SealError::NoVectors)?;
    let symbol = |name| address(&file, name);
    let begin = symbol("__stext")?.wrapping_sub(FLASH) as usize;
    let data_bytes = symbol("__edata")?.wrapping_sub(symbol("__sdata")?);
    let end = symbol("__sidata")?
        .wrapping_add(data_bytes)
        .wrapping_sub(FLASH) as usize;
    if flash.len() < VECTOR_BYTES {
        flash.resize(VECTOR_BYTES, 0xff);
    }
    flash[SEAL_AT..SEAL_AT + 4].fill(0);
    let program = flash.get(begin..end).ok_or(SealError::NoVectors)?;
    let crc = Crc::<u32>::new(&CRC_32_ISO_HDLC);
    let mut digest = crc.digest();
    digest.update(&flash[..VECTOR_BYTES]);
    digest.update(program);
    Ok((digest.finalize(), place))
}

fn address(file: &File<'_>, name: &'static str) -> Result<u32, SealError> {
    let symbol = file.symbols().find(|symbol| symbol.name() == Ok(name));
    let address = symbol.and_then(|symbol| u32::try_from(symbol.address()).ok());
    address.ok_or(SealError::NoSymbol(name))
}
