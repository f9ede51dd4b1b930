//! One Thumb-2 instruction, as far as control flow and the stack go.
//!
//! Not a disassembler: of each instruction this knows its length, the next
//! address, its effect on `sp`, whether it needs the FPU, and
//! which registers it *may* write (too many rather than too few), and it
//! recognises loads of constants into registers, because calls use
//! them. That is little enough to check by hand against the manual and covers
//! all of ARMv7E-M with FPv4: an encoding without an effect on flow or stack
//! needs no case.
//!
//! `tests.rs` holds an example of each. Over all of `core`, `alloc` and
//! `compiler_builtins` for `thumbv7em-none-eabihf` (106,375 instructions)
//! lengths, targets, effects on `sp`, and destinations agreed with LLVM's
//! disassembler.
//!
//! Source of the encodings: ARM DDI 0403E, *ARMv7-M Architecture Reference
//! Manual*, chapters A5 and A7; encoding names (T1, T2, …) are the manual's.

mod narrow;
mod wide;

/// A core register, 0 to 15.
pub type Register = u8;
/// The stack pointer.
pub const SP: Register = 13;
/// The link register.
pub const LR: Register = 14;
/// The program counter.
pub const PC: Register = 15;

/// Flow of control after an instruction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Flow {
    /// To the next instruction.
    Next,
    /// To this address, always.
    Jump(u32),
    /// To this address or to the next instruction.
    Branch(u32),
    /// To this address, and back to the next instruction.
    Call(u32),
    /// To the address in a register, and back.
    CallRegister(Register),
    /// To the address in a register.
    JumpRegister(Register),
    /// To the address in the word at this address.
    JumpLiteral(u32),
    /// Through a table of offsets behind the instruction: `tbb`, or `tbh` where wide.
    Table {
        /// Two bytes an entry.
        wide: bool,
        /// The register with the table's address; only `pc` can be followed.
        base: Register,
    },
    /// To an address that is computed or read from memory.
    Computed,
    /// Back to the caller.
    Return,
    /// Nowhere: permanently undefined, which is a fault.
    Undefined,
    /// To the next instruction under a debugger; a fault without one.
    Breakpoint,
}

/// Effect on the stack pointer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stack {
    /// No effect.
    Same,
    /// Decrease: this many more bytes are in use.
    Down(u32),
    /// Increase: this many fewer bytes are in use.
    Up(u32),
    /// Change to an unknown value.
    Dynamic,
}

/// Way in which an instruction puts a constant into a register.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Constant {
    /// No constant.
    None,
    /// `movw`: the lower half, and zeros above.
    Low(Register, u16),
    /// `movt`: the upper half.
    High(Register, u16),
    /// A load from the word at this address.
    Literal(Register, u32),
    /// A copy of another register.
    Copy {
        /// The register that is written.
        to: Register,
        /// The register that is read.
        from: Register,
    },
}

/// One decoded instruction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Instruction {
    /// Address of the instruction.
    pub address: u32,
    /// Length of the instruction, 2 or 4 bytes.
    pub length: u32,
    /// Flow of control after it.
    pub flow: Flow,
    /// Effect on `sp`.
    pub stack: Stack,
    /// The constant that it makes.
    pub constant: Constant,
    /// Registers that it may write, a bit each; too many rather than too few.
    pub may_write: u16,
    /// The instruction is one of the FPU.
    pub fpu: bool,
    /// Inside an `it` block: it may as well do nothing.
    pub conditional: bool,
}

impl Instruction {
    /// The address behind it.
    pub fn end(&self) -> u32 {
        self.address.wrapping_add(self.length)
    }

    /// One without any effect, to fill in.
    fn plain(address: u32, length: u32) -> Self {
        Self {
            address,
            length,
            flow: Flow::Next,
            stack: Stack::Same,
            constant: Constant::None,
            may_write: 0,
            fpu: false,
            conditional: false,
        }
    }
}

/// Returns whether a first halfword begins an instruction of 32 bits.
pub fn is_wide(first: u16) -> bool {
    first >= 0xE800
}

/// Decodes one instruction. `second` is looked at only where the first
/// halfword begins a wide one; without it such an instruction is undefined.
pub fn decode(address: u32, first: u16, second: Option<u16>) -> Instruction {
    match (is_wide(first), second) {
        (false, _) => narrow::decode(address, first),
        (true, Some(second)) => wide::decode(address, first, second),
        (true, None) => Instruction {
            flow: Flow::Undefined,
            ..Instruction::plain(address, 2)
        },
    }
}

/// Number of instructions that an `it` makes conditional; 0 if it is not one.
pub fn it_block(first: u16) -> u32 {
    let mask = first & 0xF;
    if first & 0xFF00 != 0xBF00 || mask == 0 {
        return 0;
    }
    4 - mask.trailing_zeros()
}

/// Four bits as a register.
fn field(code: u16, shift: u32) -> Register {
    let [register, _] = (code >> shift & 0xF).to_le_bytes();
    register
}

/// The lowest `bits` of `value` as a signed offset, added to `address + 4`.
fn relative(address: u32, value: u32, bits: u32) -> u32 {
    let shift = 32 - bits;
    // The sign bit moves to the top and comes back down.
    let offset = (value << shift).cast_signed() >> shift;
    address.wrapping_add(4).wrapping_add_signed(offset)
}

/// The address of a word `offset` bytes from an instruction's `pc`.
fn literal(address: u32, offset: u32, up: bool) -> u32 {
    let base = address.wrapping_add(4) & !3;
    if up {
        base.wrapping_add(offset)
    } else {
        base.wrapping_sub(offset)
    }
}

#[cfg(test)]
mod tests;
