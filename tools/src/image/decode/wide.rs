//! Instructions of 32 bits (A5.3).

use super::{Constant, Flow, Instruction, PC, SP, Stack, field, literal, relative};

pub(super) fn decode(address: u32, first: u16, second: u16) -> Instruction {
    let mut it = Instruction::plain(address, 4);
    it.may_write = named(first, second);
    match first >> 9 {
        // 1110 100x x0: ldm, stm; x1: ldrd, strd, exclusive, table branch
        0b111_0100 if first & 0x40 == 0 => multiple(&mut it, first, second),
        0b111_0100 => dual(&mut it, first, second),
        // 1110 101: shifted registers
        0b111_0101 if field(second, 8) == SP => it.stack = Stack::Dynamic,
        // 111x 11: coprocessors, of which 10 and 11 are the FPU
        0b111_0110 | 0b111_0111 | 0b111_1110 | 0b111_1111 => coprocessor(&mut it, first, second),
        // 1111 0
        0b111_1000..=0b111_1011 if second & 0x8000 != 0 => branch(&mut it, first, second),
        0b111_1000..=0b111_1011 => immediate(&mut it, first, second),
        // 1111 100: loads and stores of one register
        0b111_1100 => single(&mut it, first, second),
        // The other shifted registers; 1111 101: registers, multiplication
        _ => {}
    }
    it
}

/// Every field that can name a register that is written.
fn named(first: u16, second: u16) -> u16 {
    1 << field(first, 0) | 1 << field(second, 12) | 1 << field(second, 8) | 1 << field(second, 0)
}

/// A write-back of `amount` to the base register.
fn write_back(first: u16, up: bool, amount: u32) -> Stack {
    match (field(first, 0) == SP, up) {
        (false, _) => Stack::Same,
        (true, true) => Stack::Up(amount),
        (true, false) => Stack::Down(amount),
    }
}

/// `ldm`, `stm`, among them `push.w` and `pop.w`.
fn multiple(it: &mut Instruction, first: u16, second: u16) {
    let load = first & 0x10 != 0;
    if first & 0x20 != 0 {
        let up = first & 0x80 != 0;
        it.stack = write_back(first, up, second.count_ones() * 4);
    }
    it.may_write = 1 << field(first, 0);
    if load {
        it.may_write |= second;
        if second & 0x8000 != 0 {
            it.flow = if field(first, 0) == SP {
                Flow::Return
            } else {
                Flow::Computed
            };
        }
    }
}

/// `ldrd`, `strd`, the exclusives, `tbb` and `tbh`.
fn dual(it: &mut Instruction, first: u16, second: u16) {
    if first & 0xFFF0 == 0xE8D0 && second & 0xFFE0 == 0xF000 {
        it.may_write = 0;
        it.flow = Flow::Table {
            wide: second & 0x10 != 0,
            base: field(first, 0),
        };
    } else if first & 0x20 != 0 {
        let up = first & 0x80 != 0;
        it.stack = write_back(first, up, u32::from(second & 0xFF) * 4);
    }
}

/// The FPU's loads and stores write back like any other; `vpush`, `vpop`.
fn coprocessor(it: &mut Instruction, first: u16, second: u16) {
    it.fpu = matches!(second >> 8 & 0xF, 10 | 11);
    if first & 0xFE00 == 0xEC00 && first & 0x20 != 0 {
        let up = first & 0x80 != 0;
        it.stack = write_back(first, up, u32::from(second & 0xFF) * 4);
    }
}

/// Branches and the instructions of the system.
fn branch(it: &mut Instruction, first: u16, second: u16) {
    let bit = |code: u16, at: u32| u32::from(code >> at & 1);
    let (s, j1, j2) = (bit(first, 10), bit(second, 13), bit(second, 11));
    let low = u32::from(second & 0x7FF) << 1;
    let far = || {
        // I1 = not (J1 xor S), I2 = not (J2 xor S)
        let (i1, i2) = (j1 ^ s ^ 1, j2 ^ s ^ 1);
        let value = s << 24 | i1 << 23 | i2 << 22 | u32::from(first & 0x3FF) << 12 | low;
        relative(it.address, value, 25)
    };
    match second & 0xD000 {
        0xD000 => {
            it.flow = Flow::Call(far());
            it.may_write = 0;
        }
        0x9000 => it.flow = Flow::Jump(far()),
        // b<c>.w, where the condition is neither of the two that mean something else
        0x8000 if first & 0x0380 != 0x0380 => {
            let value = s << 20 | j2 << 19 | j1 << 18 | u32::from(first & 0x3F) << 12 | low;
            it.flow = Flow::Branch(relative(it.address, value, 21));
        }
        // udf.w
        0x8000 if first & 0xFFF0 == 0xF7F0 && second & 0xF000 == 0xA000 => {
            it.flow = Flow::Undefined;
        }
        // msr msp, msr psp
        0x8000 if first & 0xFFF0 == 0xF380 && matches!(second & 0xFF, 8 | 9) => {
            it.stack = Stack::Dynamic;
        }
        0x8000 => {}
        // blx to A32 code, which this core does not have
        _ => it.flow = Flow::Undefined,
    }
}

/// Data processing with an immediate.
fn immediate(it: &mut Instruction, first: u16, second: u16) {
    let to = field(second, 8);
    // i:imm3:imm8
    let imm12 = (first & 0x400) << 1 | (second & 0x7000) >> 4 | second & 0xFF;
    let imm16 = (first & 0xF) << 12 | imm12;
    let from_sp = field(first, 0) == SP;
    it.may_write = 1 << to;
    match (first & 0xFBF0, first & 0xFBE0) {
        (0xF240, _) => it.constant = Constant::Low(to, imm16),
        (0xF2C0, _) => it.constant = Constant::High(to, imm16),
        _ if to != SP => {}
        // addw, subw; add.w, sub.w
        (0xF200, _) if from_sp => it.stack = Stack::Up(u32::from(imm12)),
        (0xF2A0, _) if from_sp => it.stack = Stack::Down(u32::from(imm12)),
        (_, 0xF100) if from_sp => it.stack = Stack::Up(expand(imm12)),
        (_, 0xF1A0) if from_sp => it.stack = Stack::Down(expand(imm12)),
        _ => it.stack = Stack::Dynamic,
    }
}

/// `ThumbExpandImm` (A5.3.2).
fn expand(imm12: u16) -> u32 {
    let byte = u32::from(imm12 & 0xFF);
    match imm12 >> 8 {
        0 => byte,
        1 => byte << 16 | byte,
        2 => byte << 24 | byte << 8,
        3 => byte << 24 | byte << 16 | byte << 8 | byte,
        _ => (byte & 0x7F | 0x80).rotate_right(u32::from(imm12 >> 7)),
    }
}

/// Loads and stores of one register.
fn single(it: &mut Instruction, first: u16, second: u16) {
    let (base, to) = (field(first, 0), field(second, 12));
    let load = first & 0x10 != 0;
    let word = first & 0xFF60 == 0xF840;
    // Preload hints name `pc` as the register that they do not load.
    let loads = load && (word || to != PC);
    // Immediate of 8 bits with P, U, W; the one of 12 bits has bit 7 of the
    // first halfword set, and so has a literal above.
    let short = first & 0x80 == 0 && base != PC && second & 0x800 != 0;
    if short && second & 0x100 != 0 {
        it.stack = write_back(first, second & 0x200 != 0, u32::from(second & 0xFF));
    }
    if !loads {
        return;
    }
    let from_pool = (base == PC).then(|| {
        let offset = u32::from(second & 0xFFF);
        literal(it.address, offset, first & 0x80 != 0)
    });
    match (to, from_pool) {
        (PC, Some(word)) => it.flow = Flow::JumpLiteral(word),
        (PC, None) if base == SP && it.stack != Stack::Same => it.flow = Flow::Return,
        (PC, None) => it.flow = Flow::Computed,
        (SP, _) => it.stack = Stack::Dynamic,
        (to, Some(at)) if word => it.constant = Constant::Literal(to, at),
        _ => {}
    }
}
