//! Writes ELF files: sections with their bytes, and symbols.

use object::Endianness;
use object::elf;
use object::write::elf::{FileHeader, ProgramHeader, SectionHeader, SectionIndex, Sym, Writer};

/// A section that is a segment of its own. Code comes first.
pub(crate) struct Piece {
    pub(crate) name: &'static str,
    pub(crate) address: u32,
    pub(crate) load: u32,
    pub(crate) bytes: Vec<u8>,
    pub(crate) size: u32,
}

impl Piece {
    pub(crate) fn new(name: &'static str, address: u32, load: u32, bytes: Vec<u8>) -> Self {
        let size = u32::try_from(bytes.len()).unwrap();
        Self {
            name,
            address,
            load,
            bytes,
            size,
        }
    }

    fn segment(&self, offset: u64) -> ProgramHeader {
        ProgramHeader {
            p_type: elf::PT_LOAD,
            p_flags: elf::PF_R,
            p_offset: offset,
            p_vaddr: self.address.into(),
            p_paddr: self.load.into(),
            p_filesz: self.bytes.len() as u64,
            p_memsz: self.size.into(),
            p_align: 4,
        }
    }

    fn section(&self, name: u32, offset: u64) -> SectionHeader {
        let (sh_type, more) = match self.name {
            ".text" => (elf::SHT_PROGBITS, elf::SHF_EXECINSTR),
            ".bss" => (elf::SHT_NOBITS, elf::SHF_WRITE),
            _ => (elf::SHT_PROGBITS, elf::SHF_ALLOC),
        };
        SectionHeader {
            sh_name: name,
            sh_type,
            sh_flags: elf::SHF_ALLOC | more,
            sh_addr: self.address.into(),
            sh_offset: offset,
            sh_size: self.size.into(),
            sh_link: 0,
            sh_info: 0,
            sh_addralign: 4,
            sh_entsize: 0,
        }
    }
}

/// A symbol in the first section.
pub(crate) struct Symbol {
    name: &'static str,
    address: u32,
    size: u32,
    function: bool,
}

impl Symbol {
    pub(crate) fn mapping(name: &'static str, address: u32) -> Self {
        Self {
            name,
            address,
            size: 0,
            function: false,
        }
    }

    pub(crate) fn function(name: &'static str, address: u32, size: u32) -> Self {
        Self {
            name,
            address,
            size,
            function: true,
        }
    }

    fn entry(&self, name: u32, section: SectionIndex) -> Sym {
        let kind = if self.function {
            elf::STT_FUNC
        } else {
            elf::STT_NOTYPE
        };
        Sym {
            section: Some(section.0),
            st_name: name,
            st_info: elf::SymbolInfo::new(elf::STB_LOCAL, kind),
            st_other: elf::SymbolOther(0),
            st_shndx: elf::SymbolSection(0),
            st_value: self.address.into(),
            st_size: self.size.into(),
        }
    }
}

pub(crate) fn elf(entry: u32, pieces: &[Piece], symbols: &[Symbol]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut w = Writer::new(Endianness::Little, false, &mut bytes);
    w.reserve_file_header();
    w.reserve_program_headers(u32::try_from(pieces.len()).unwrap());
    let offsets: Vec<u64> = pieces
        .iter()
        .map(|piece| w.reserve(piece.bytes.len() as u64, 4))
        .collect();
    w.reserve_null_section_index();
    let names: Vec<_> = pieces
        .iter()
        .map(|piece| w.add_section_name(piece.name.as_bytes()))
        .collect();
    let sections: Vec<_> = pieces.iter().map(|_| w.reserve_section_index()).collect();
    w.reserve_null_symbol_index();
    let strings: Vec<_> = symbols
        .iter()
        .map(|symbol| w.add_string(symbol.name.as_bytes()))
        .collect();
    for _ in symbols {
        w.reserve_symbol_index(Some(sections[0]));
    }
    w.reserve_symtab_section_index();
    w.reserve_symtab();
    w.reserve_strtab_section_index();
    w.reserve_strtab().unwrap();
    w.reserve_shstrtab_section_index();
    w.reserve_shstrtab().unwrap();
    w.reserve_section_headers();

    w.write_file_header(&FileHeader {
        os_abi: elf::ELFOSABI_NONE,
        abi_version: 0,
        e_type: elf::ET_EXEC,
        e_machine: elf::EM_ARM,
        e_entry: entry.into(),
        e_flags: elf::FileFlags(0x0500_0400),
    })
    .unwrap();
    w.write_align_program_headers();
    for (piece, offset) in pieces.iter().zip(&offsets) {
        w.write_program_header(&piece.segment(*offset));
    }
    for piece in pieces {
        w.write_align(4);
        w.write(&piece.bytes);
    }
    w.write_null_symbol();
    for (symbol, string) in symbols.iter().zip(strings) {
        let name = w.string_offset(Some(string));
        w.write_symbol(&symbol.entry(name, sections[0]));
    }
    w.write_strtab();
    w.write_shstrtab();
    w.write_null_section_header();
    for ((piece, offset), name) in pieces.iter().zip(&offsets).zip(names) {
        let name = w.section_name_offset(Some(name));
        w.write_section_header(&piece.section(name, *offset));
    }
    w.write_symtab_section_header(u32::try_from(symbols.len()).unwrap() + 1);
    w.write_strtab_section_header();
    w.write_shstrtab_section_header();
    bytes
}
