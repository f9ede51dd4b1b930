//! Images made by hand: functions as halfwords, put where a linker would put
//! them.
#![allow(dead_code)] // Each test file uses a part of it.

mod file;

use crepitus_tools::image::budget::Budget;
use crepitus_tools::image::lines::Lines;
use crepitus_tools::image::{Image, Report, Subject, examine, memory};
use file::{Piece, Symbol};
use std::path::Path;

pub(crate) const FLASH: u32 = 0x0800_0000;
pub(crate) const MEMORY: &str = "MEMORY { FLASH : ORIGIN = 0x08000000, LENGTH = 64K
                                   RAM : ORIGIN = 0x20000000, LENGTH = 16K }";
/// Functions stand this far apart.
const SLOT: u32 = 0x100;
const TEXT: u32 = FLASH + 0x400;

pub(crate) const NOP: u16 = 0xBF00;
pub(crate) const BX_LR: u16 = 0x4770;
pub(crate) const BLX_R3: u16 = 0x4798;
pub(crate) const PUSH_R7_LR: u16 = 0xB580;
pub(crate) const POP_R7_PC: u16 = 0xBD80;
pub(crate) const SUBS_R0: u16 = 0x3801;
pub(crate) const UDF: u16 = 0xDEFE;
/// `b .`
pub(crate) const FOREVER: u16 = 0xE7FE;

/// A part of a function.
pub(crate) enum Part {
    Code(Vec<u16>),
    Data(Vec<u8>),
    /// `bl`, or `b.w`, to the function of this number.
    Call(usize),
    Jump(usize),
}

pub(crate) struct Function {
    pub(crate) name: &'static str,
    pub(crate) parts: Vec<Part>,
}

/// A function of plain instructions.
pub(crate) fn function(name: &'static str, code: &[u16]) -> Function {
    parts(name, vec![Part::Code(code.to_vec())])
}

pub(crate) fn parts(name: &'static str, parts: Vec<Part>) -> Function {
    Function { name, parts }
}

/// An interrupt that calls others, with 8 bytes of stack.
pub(crate) fn calls(name: &'static str, callees: &[usize]) -> Function {
    let mut all = vec![Part::Code(vec![PUSH_R7_LR])];
    all.extend(callees.iter().map(|&n| Part::Call(n)));
    all.push(Part::Code(vec![POP_R7_PC]));
    parts(name, all)
}

/// An image to be made. Function 0 is the reset handler, 1 the default
/// handler, 2 the interrupt 0.
pub(crate) struct Maker {
    pub(crate) functions: Vec<Function>,
    pub(crate) handlers: Vec<usize>,
    pub(crate) bss: u32,
    pub(crate) load: u32,
}

impl Maker {
    /// `IRQ0` and what it calls: functions from number 3 on.
    pub(crate) fn new(interrupt: Function, others: Vec<Function>) -> Self {
        let reset = function("Reset", &[FOREVER]);
        let default = function("DefaultHandler", &[FOREVER]);
        let mut functions = vec![reset, default, interrupt];
        functions.extend(others);
        Self {
            functions,
            handlers: vec![2],
            bss: 64,
            load: FLASH,
        }
    }

    pub(crate) fn address(n: usize) -> u32 {
        TEXT + SLOT * u32::try_from(n).unwrap()
    }

    fn vectors(&self) -> Vec<u8> {
        let mut words = vec![0x2000_4000];
        words.extend([Self::address(0) | 1]);
        words.extend([Self::address(1) | 1; 14]);
        words.extend(self.handlers.iter().map(|&n| Self::address(n) | 1));
        words
            .iter()
            .flat_map(|word: &u32| word.to_le_bytes())
            .collect()
    }

    /// Code, and its symbols.
    fn text(&self) -> (Vec<u8>, Vec<Symbol>) {
        let mut text = Vec::new();
        let mut symbols = Vec::new();
        for (n, function) in self.functions.iter().enumerate() {
            let start = Self::address(n);
            text.resize((start - TEXT) as usize, 0);
            for part in &function.parts {
                let at = TEXT + u32::try_from(text.len()).unwrap();
                let halves = match part {
                    Part::Code(halves) => halves.clone(),
                    Part::Call(to) => branch(at, Self::address(*to), 0xD000),
                    Part::Jump(to) => branch(at, Self::address(*to), 0x9000),
                    Part::Data(bytes) => {
                        symbols.push(Symbol::mapping("$d", at));
                        text.extend(bytes);
                        continue;
                    }
                };
                symbols.push(Symbol::mapping("$t", at));
                text.extend(halves.iter().flat_map(|half| half.to_le_bytes()));
            }
            let end = TEXT + u32::try_from(text.len()).unwrap();
            symbols.push(Symbol::mapping("$d", end));
            symbols.push(Symbol::function(function.name, start | 1, end - start));
        }
        (text, symbols)
    }

    pub(crate) fn elf(&self) -> Vec<u8> {
        let (text, symbols) = self.text();
        let bss = Piece::new(".bss", 0x2000_0000, 0x2000_0000, Vec::new());
        file::elf(
            Self::address(0) | 1,
            &[
                Piece::new(".text", TEXT, self.load + 0x400, text),
                Piece::new(".vector_table", FLASH, self.load, self.vectors()),
                Piece {
                    size: self.bss,
                    ..bss
                },
            ],
            &symbols,
        )
    }

    pub(crate) fn image(&self) -> Image {
        Image::parse(&self.elf()).unwrap()
    }

    /// The report against a budget for the interrupt `IRQ0` and `more`.
    pub(crate) fn report(&self, more: &str) -> Report {
        examined(&self.image(), &budget(more))
    }
}

/// A budget that allows any size, with `IRQ0` gated.
pub(crate) fn budget(more: &str) -> String {
    format!(
        "[images.it]\nelf = \"it.elf\"\nmemory = \"memory.x\"\n\
         [images.it.recorded]\nflash = 100_000 # bytes\nram = 100_000\nstack = 100_000\n\
         [[images.it.interrupts]]\nhandler = \"IRQ0\"\nirq = 0\npriority = 1\n{more}"
    )
}

pub(crate) fn examined(image: &Image, budget: &str) -> Report {
    let budget = Budget::parse(Path::new("budget.toml"), budget).unwrap();
    let subject = Subject {
        image,
        lines: &Lines::default(),
        memory: &memory::parse(MEMORY).unwrap(),
        budget: &budget.images["it"],
        shared_loops: &budget.loops,
        tolerance_percent: budget.tolerance_percent,
    };
    examine("it", subject).unwrap()
}

/// Failures of a report: check and finding, a line each.
pub(crate) fn failures(report: &Report) -> Vec<String> {
    let failures = report.failures.iter();
    failures
        .map(|f| format!("{}: {}", f.check, f.what))
        .collect()
}

/// `bl` (0xD000) or `b.w` (0x9000).
fn branch(from: u32, to: u32, kind: u16) -> Vec<u16> {
    let offset = to.wrapping_sub(from.wrapping_add(4));
    let bit = |at: u32| offset >> at & 1;
    let s = bit(24);
    let j = |at: u32| (bit(at) ^ s ^ 1) & 1;
    let first = 0xF000 | s << 10 | offset >> 12 & 0x3FF;
    let second = u32::from(kind) | j(23) << 13 | j(22) << 11 | offset >> 1 & 0x7FF;
    [first, second]
        .map(|half| u16::try_from(half).unwrap())
        .to_vec()
}
