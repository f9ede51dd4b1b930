//! The image as the linker left it: segments, sections, functions, and which
//! bytes are code.

use crate::image::error::ImageError;
use object::elf::{EM_ARM, FileHeader32, PT_LOAD};
use object::read::elf::{ElfFile, FileHeader, ProgramHeader};
use object::{LittleEndian, Object, ObjectSection, ObjectSymbol, SectionFlags, SymbolKind};
use std::collections::BTreeMap;

type File<'data> = ElfFile<'data, FileHeader32<LittleEndian>>;

/// A part of the file that is programmed or reserved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Segment {
    /// Load address.
    pub load: u32,
    /// Address at run time.
    pub address: u32,
    /// Bytes to program.
    pub file_size: u32,
    /// Bytes at run time.
    pub memory_size: u32,
}

/// A section that takes memory while the program runs.
#[derive(Debug, Clone)]
pub struct Section {
    /// Name of the section.
    pub name: String,
    /// Address of the section.
    pub address: u32,
    /// Size of the section in bytes.
    pub size: u32,
    /// The section holds instructions.
    pub executable: bool,
    /// The program may write to it.
    pub writable: bool,
    /// Content in the file; empty for `.bss` and the like.
    pub bytes: Vec<u8>,
}

/// A function by its symbols.
#[derive(Debug, Clone)]
pub struct Symbol {
    /// Demangled, without hash; several where symbols share an address.
    pub names: Vec<String>,
    /// Size of the function in bytes; 0 if the symbol has none.
    pub size: u32,
}

/// Kind of the bytes from a mapping symbol on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Content {
    /// Thumb instructions.
    Code,
    /// Literals, jump tables, padding.
    Data,
}

/// An image.
#[derive(Debug, Clone)]
pub struct Image {
    /// Loadable segments.
    pub segments: Vec<Segment>,
    /// Sections that take memory.
    pub sections: Vec<Section>,
    /// Functions by address, without the Thumb bit.
    pub functions: BTreeMap<u32, Symbol>,
    /// Mapping symbols by address.
    pub mapping: BTreeMap<u32, Content>,
}

impl Image {
    /// Reads an ELF file.
    ///
    /// # Errors
    ///
    /// [`ImageError`] if it is not an ELF file for this machine, or is stripped.
    pub fn parse(bytes: &[u8]) -> Result<Self, ImageError> {
        let file = File::parse(bytes)?;
        if file.elf_header().e_machine(LittleEndian) != EM_ARM {
            return Err(ImageError::Machine);
        }
        let mut image = Self {
            segments: segments(&file),
            sections: sections(&file)?,
            functions: BTreeMap::new(),
            mapping: BTreeMap::new(),
        };
        image.take_symbols(&file);
        if image.mapping.is_empty() {
            return Err(ImageError::Stripped);
        }
        Ok(image)
    }

    fn take_symbols(&mut self, file: &File) {
        for symbol in file.symbols() {
            let (Ok(name), Ok(address)) = (symbol.name(), u32::try_from(symbol.address())) else {
                continue;
            };
            let content = match name.get(..2) {
                Some("$t") => Some(Content::Code),
                Some("$d") => Some(Content::Data),
                _ => None,
            };
            if let Some(content) = content {
                // An empty range of data ends where code begins.
                let known = self.mapping.entry(address).or_insert(content);
                if content == Content::Code {
                    *known = content;
                }
            } else if symbol.kind() == SymbolKind::Text && symbol.is_definition() {
                let function = self.functions.entry(address & !1).or_insert(Symbol {
                    names: Vec::new(),
                    size: 0,
                });
                // Clones of one function differ in a hash only.
                let name = format!("{:#}", rustc_demangle::demangle(name));
                if !function.names.contains(&name) {
                    function.names.push(name);
                }
                let size = u32::try_from(symbol.size()).unwrap_or(u32::MAX);
                function.size = function.size.max(size);
            }
        }
    }

    /// The section at an address.
    pub fn section_at(&self, address: u32) -> Option<&Section> {
        self.sections
            .iter()
            .find(|s| address >= s.address && address - s.address < s.size)
    }

    /// A word that the program cannot change: from a section that is not
    /// writable, or from among instructions.
    pub fn constant_word(&self, address: u32) -> Option<u32> {
        let section = self.section_at(address)?;
        if section.writable && !section.executable {
            return None;
        }
        section.word(address)
    }

    /// The section of a name.
    pub fn section(&self, name: &str) -> Option<&Section> {
        self.sections.iter().find(|s| s.name == name)
    }
}

impl Section {
    /// The address behind it.
    pub fn end(&self) -> u32 {
        self.address.saturating_add(self.size)
    }

    /// Bytes at an address, if the file holds them.
    pub fn at<const N: usize>(&self, address: u32) -> Option<[u8; N]> {
        let from = usize::try_from(address.checked_sub(self.address)?).ok()?;
        let bytes = self.bytes.get(from..from.checked_add(N)?)?;
        bytes.try_into().ok()
    }

    /// The word at an address.
    pub fn word(&self, address: u32) -> Option<u32> {
        self.at(address).map(u32::from_le_bytes)
    }

    /// The halfword at an address.
    pub fn half(&self, address: u32) -> Option<u16> {
        self.at(address).map(u16::from_le_bytes)
    }
}

fn segments(file: &File) -> Vec<Segment> {
    let e = LittleEndian;
    file.elf_program_headers()
        .iter()
        .filter(|header| header.p_type(e) == PT_LOAD)
        .map(|header| Segment {
            load: header.p_paddr(e),
            address: header.p_vaddr(e),
            file_size: header.p_filesz(e),
            memory_size: header.p_memsz(e),
        })
        .collect()
}

fn sections(file: &File) -> Result<Vec<Section>, ImageError> {
    use object::elf::{SHF_ALLOC, SHF_EXECINSTR, SHF_WRITE};
    let mut sections = Vec::new();
    for section in file.sections() {
        let SectionFlags::Elf { sh_flags, .. } = section.flags() else {
            continue;
        };
        let (Ok(address), Ok(size)) = (
            u32::try_from(section.address()),
            u32::try_from(section.size()),
        ) else {
            continue;
        };
        let has = |flag| sh_flags.contains(flag);
        if has(SHF_ALLOC) && size > 0 {
            sections.push(Section {
                name: section.name()?.to_owned(),
                address,
                size,
                executable: has(SHF_EXECINSTR),
                writable: has(SHF_WRITE),
                bytes: section.data()?.to_vec(),
            });
        }
    }
    Ok(sections)
}
