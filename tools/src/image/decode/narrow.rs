//! Instructions of 16 bits (A5.2).

use super::{Constant, Flow, Instruction, LR, PC, Register, SP, Stack, literal, relative};

pub(super) fn decode(address: u32, code: u16) -> Instruction {
    let mut it = Instruction::plain(address, 2);
    let low = u32::from(code & 0xFF);
    match code >> 8 {
        // add, cmp, mov of high registers; bx, blx
        0x44..=0x47 => high_registers(&mut it, code),
        // ldr rt, [pc, #imm8 * 4]
        0x48..=0x4F => {
            let to = register(code >> 8);
            it.constant = Constant::Literal(to, literal(address, low * 4, true));
            it.may_write = 1 << to;
        }
        // add sp, #imm7 * 4; sub sp, #imm7 * 4
        0xB0 if code & 0x80 == 0 => it.stack = Stack::Up((low & 0x7F) * 4),
        0xB0 => it.stack = Stack::Down((low & 0x7F) * 4),
        // cbz, cbnz
        0xB1 | 0xB3 | 0xB9 | 0xBB => {
            let offset = u32::from(code >> 9 & 1) << 6 | u32::from(code >> 3 & 0x1F) << 1;
            it.flow = Flow::Branch(address.wrapping_add(4).wrapping_add(offset));
        }
        // push {list, lr}
        0xB4 | 0xB5 => it.stack = Stack::Down((code & 0x1FF).count_ones() * 4),
        // pop {list, pc}
        0xBC | 0xBD => {
            it.stack = Stack::Up((code & 0x1FF).count_ones() * 4);
            it.may_write = code & 0xFF;
            if code & 0x100 != 0 {
                it.flow = Flow::Return;
            }
        }
        0xBE => it.flow = Flow::Breakpoint,
        // ldm rn!, {list}
        0xC8..=0xCF => it.may_write = code & 0xFF | 1 << register(code >> 8),
        0xDE => it.flow = Flow::Undefined,
        // svc
        0xDF => it.may_write = 0x100F,
        // b<c>
        0xD0..=0xDD => it.flow = Flow::Branch(relative(address, low << 1, 9)),
        // b
        0xE0..=0xE7 => {
            it.flow = Flow::Jump(relative(address, u32::from(code & 0x7FF) << 1, 12));
        }
        // The rest writes a low register at most, and names it in one of two places.
        _ => it.may_write = 1 << register(code) | 1 << register(code >> 8),
    }
    it
}

fn high_registers(it: &mut Instruction, code: u16) {
    let from = super::field(code, 3);
    // D:Rdn
    let to = super::field(code >> 4 & 8 | code & 7, 0);
    match code >> 8 {
        0x47 if code & 0x80 != 0 => {
            it.flow = Flow::CallRegister(from);
        }
        0x47 => it.flow = jump(from),
        0x45 => {}
        0x46 if to == PC => it.flow = jump(from),
        _ if to == PC => it.flow = Flow::Computed,
        _ if to == SP => it.stack = Stack::Dynamic,
        op => {
            it.may_write = 1 << to;
            if op == 0x46 {
                it.constant = Constant::Copy { to, from };
            }
        }
    }
}

fn jump(from: Register) -> Flow {
    if from == LR {
        Flow::Return
    } else {
        Flow::JumpRegister(from)
    }
}

/// The lowest three bits as a register.
fn register(bits: u16) -> Register {
    super::field(bits & 7, 0)
}
