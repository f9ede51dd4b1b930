//! Semantics and cycles of the plain instructions (ARM DDI 0403E A7.7).
//!
//! Nothing is changed before it is certain that the instruction can be executed
//! here: `None` leaves the core as it was.

use super::Executed;
use super::arithmetic::{extended, it_state, low_word, offset, shift, sum};
use super::code::{Code, Decoded};
use super::executor::Executor;
use rsemu::cpu::arm::v7m::isa::{BitfieldOp, Cond, DpOp, ExtendOp, Insn, MiscOp, Operand, Size};
use rsemu::cpu::arm::v7m::sys::ccr;
use rsemu::cpu::arm::v7m::xpsr;

impl Executor<'_> {
    /// Executes instructions until these cycles have passed, or one is not plain.
    pub(super) fn run(&mut self, code: &mut Code, most: u64, mut each: impl FnMut(&Executed)) {
        while self.cycles < most {
            let pc = self.r[15];
            let Some(decoded) = code.at(pc).filter(|decoded| decoded.run > 0) else {
                return;
            };
            let begin = self.cycles;
            if self.step(pc, decoded).is_none() {
                (self.r[15], self.cycles) = (pc, begin);
                return;
            }
            let waits = self.timing.instruction(begin, pc, decoded.width);
            self.cycles += waits;
            each(&Executed {
                pc,
                begin,
                cycles: self.cycles - begin,
                waits,
            });
        }
    }

    #[inline]
    fn step(&mut self, pc: u32, decoded: &Decoded) -> Option<()> {
        self.may_fetch(pc, decoded.width)?;
        let it = it_state(self.xpsr);
        // The program counter reads as four more, whatever the width.
        self.r[15] = pc.wrapping_add(4);
        let next = pc.wrapping_add(decoded.width);
        self.has_branched = false;
        self.cycles += 1;
        if it == 0 {
            self.execute(&decoded.instruction, pc, false)?;
        } else if Cond(it >> 4).passes(self.xpsr) {
            // In an IT block 16-bit instructions do not set flags.
            self.execute(&decoded.instruction, pc, decoded.width == 2)?;
        }
        if it != 0 && !matches!(decoded.instruction, Insn::It { .. }) {
            // The last of a block has no mask left.
            let next = it & 0xe0 | it << 1 & 0x1f;
            self.set_it_state(if next << 4 == 0 { 0 } else { next });
        }
        if !self.has_branched {
            self.r[15] = next;
        }
        Some(())
    }

    /// Executes the instruction at `pc`; a quiet one does not set flags.
    #[inline]
    #[expect(clippy::too_many_lines, reason = "an arm for each instruction")]
    fn execute(&mut self, instruction: &Insn, pc: u32, is_quiet: bool) -> Option<()> {
        match *instruction {
            Insn::DataProc {
                op,
                s,
                rd,
                rn,
                operand,
            } => self.process(op, s && (!is_quiet || op.is_test()), rd, rn, operand),
            Insn::ShiftReg { ty, s, rd, rn, rm } => {
                let amount = self.get(rm) & 0xff;
                let (result, carry) = shift(ty, amount, self.get(rn), self.flag(xpsr::C));
                self.set(rd, result);
                if s && !is_quiet {
                    self.set_nz(result);
                    self.set_flag(xpsr::C, carry);
                }
            }
            Insn::Adr { rd, imm, add } => {
                let address = offset(self.r[15] & !3, imm, add);
                self.set(rd, address);
            }
            Insn::MovImm16 { top, rd, imm } => {
                let imm = u32::from(imm);
                let value = if top {
                    self.get(rd) & 0xffff | imm << 16
                } else {
                    imm
                };
                self.set(rd, value);
            }
            Insn::Branch { cond, offset } => {
                if cond.is_none_or(|cond| cond.passes(self.xpsr)) {
                    self.branch(self.r[15].wrapping_add_signed(offset));
                }
            }
            Insn::BranchLink { offset } => {
                self.r[14] = pc.wrapping_add(4) | 1;
                self.branch(self.r[15].wrapping_add_signed(offset));
            }
            Insn::Bx { rm } => self.jump(self.get(rm))?,
            Insn::Blx { rm } => {
                self.jump(self.get(rm))?;
                self.r[14] = pc.wrapping_add(2) | 1;
            }
            Insn::Cbz {
                nonzero,
                rn,
                offset,
            } => {
                if (self.get(rn) != 0) == nonzero {
                    self.branch(self.r[15].wrapping_add(offset));
                }
            }
            Insn::TableBranch { rn, rm, half } => {
                let bytes = if half { 2 } else { 1 };
                let address = self.get(rn).wrapping_add(self.get(rm).wrapping_mul(bytes));
                let entry = self.load(address, bytes, true)?;
                self.branch(self.r[15].wrapping_add(2 * entry));
            }
            Insn::It { cond, mask } => self.set_it_state(cond.0 << 4 | mask),
            Insn::LoadStore { .. } => self.load_or_store(instruction)?,
            Insn::LoadLiteral {
                size,
                signed,
                rt,
                imm,
                add,
            } => {
                let address = offset(self.r[15] & !3, imm, add);
                let value = extended(self.load(address, size.bytes(), false)?, size, signed);
                if rt == 15 {
                    self.jump(value)?;
                }
                self.set(rt, value);
            }
            Insn::LoadStoreDual { .. } => self.dual(instruction)?,
            Insn::LoadStoreMultiple {
                load,
                rn,
                list,
                wback,
                before,
            } => {
                let span = 4 * list.count_ones();
                let base = self.get(rn);
                let end = offset(base, span, !before);
                let start = if before { end } else { base };
                let written_back = wback.then_some((rn, end));
                if load {
                    self.load_multiple(start, list, written_back)?;
                } else {
                    self.store_multiple(start, list, written_back)?;
                }
            }
            Insn::Mul {
                rd,
                rn,
                rm,
                ra,
                sub,
                s,
            } => {
                let product = self.get(rn).wrapping_mul(self.get(rm));
                let result = match ra {
                    None => product,
                    Some(ra) => offset(self.get(ra), product, !sub),
                };
                self.set(rd, result);
                if s && !is_quiet {
                    self.set_nz(result);
                }
            }
            Insn::MulLong { .. } => self.multiply_long(instruction),
            Insn::Div { signed, rd, rn, rm } => {
                let (a, b) = (self.get(rn), self.get(rm));
                if b == 0 && self.ccr & ccr::DIV_0_TRP != 0 {
                    return None;
                }
                let quotient = match (b, signed) {
                    (0, _) => 0,
                    (_, true) => a
                        .cast_signed()
                        .wrapping_div(b.cast_signed())
                        .cast_unsigned(),
                    (_, false) => a / b,
                };
                self.set(rd, quotient);
                self.cycles += 2;
            }
            Insn::Extend {
                op,
                rd,
                rn,
                rm,
                rotate,
            } => {
                let value = self.get(rm).rotate_right(u32::from(rotate));
                let (size, signed) = match op {
                    ExtendOp::Sxtb => (Size::Byte, true),
                    ExtendOp::Sxth => (Size::Half, true),
                    ExtendOp::Uxtb => (Size::Byte, false),
                    _ => (Size::Half, false),
                };
                let sum = if rn == 15 { 0 } else { self.get(rn) };
                self.set(rd, sum.wrapping_add(extended(value, size, signed)));
            }
            Insn::Misc { op, rd, rm } => {
                let value = self.get(rm);
                let result = match op {
                    MiscOp::Clz => value.leading_zeros(),
                    MiscOp::Rbit => value.reverse_bits(),
                    MiscOp::Rev => value.swap_bytes(),
                    MiscOp::Rev16 => value.swap_bytes().rotate_right(16),
                    MiscOp::Revsh => extended(value.swap_bytes() >> 16, Size::Half, true),
                };
                self.set(rd, result);
            }
            Insn::Bitfield {
                op,
                rd,
                rn,
                lsb,
                width,
            } => self.bit_field(
                op,
                rd,
                rn,
                u32::from(lsb) & 31,
                u32::from(width).clamp(1, 32),
            ),
            Insn::Hint { .. } | Insn::Barrier { .. } => {}
            Insn::Fp(instruction) => self.float(&instruction)?,
            _ => return None,
        }
        Some(())
    }

    fn process(&mut self, op: DpOp, s: bool, rd: u8, rn: u8, operand: Operand) {
        let carry_in = self.flag(xpsr::C);
        let (b, carry) = match operand {
            Operand::Imm { value, carry } => (value, carry.unwrap_or(carry_in)),
            Operand::Reg { rm, shift: by } => {
                shift(by.ty, u32::from(by.amount), self.get(rm), carry_in)
            }
        };
        let a = self.get(rn);
        let logic = |result| (result, carry, self.flag(xpsr::V));
        let (result, carry, overflow) = match op {
            DpOp::And | DpOp::Tst => logic(a & b),
            DpOp::Bic => logic(a & !b),
            DpOp::Orr => logic(a | b),
            DpOp::Orn => logic(a | !b),
            DpOp::Eor | DpOp::Teq => logic(a ^ b),
            DpOp::Mov => logic(b),
            DpOp::Mvn => logic(!b),
            DpOp::Add | DpOp::Cmn => sum(a, b, false),
            DpOp::Adc => sum(a, b, carry_in),
            DpOp::Sub | DpOp::Cmp => sum(a, !b, true),
            DpOp::Sbc => sum(a, !b, carry_in),
            DpOp::Rsb => sum(!a, b, true),
        };
        if !op.is_test() {
            self.set(rd, result);
        }
        if s {
            self.set_nz(result);
            self.set_flag(xpsr::C, carry);
            self.set_flag(xpsr::V, overflow);
        }
    }

    fn multiply_long(&mut self, instruction: &Insn) {
        let Insn::MulLong {
            signed,
            accumulate,
            rdlo,
            rdhi,
            rn,
            rm,
            umaal,
        } = *instruction
        else {
            return;
        };
        let (a, b) = (self.get(rn), self.get(rm));
        let (low, high) = (u64::from(self.get(rdlo)), u64::from(self.get(rdhi)));
        let product = if signed && !umaal {
            (i64::from(a.cast_signed()) * i64::from(b.cast_signed())).cast_unsigned()
        } else {
            u64::from(a) * u64::from(b)
        };
        let added = match (umaal, accumulate) {
            (true, _) => low + high,
            (false, true) => high << 32 | low,
            (false, false) => 0,
        };
        let result = product.wrapping_add(added);
        self.set(rdlo, low_word(result));
        self.set(rdhi, low_word(result >> 32));
        self.cycles += 1;
    }

    fn bit_field(&mut self, op: BitfieldOp, rd: u8, rn: u8, lsb: u32, width: u32) {
        let mask = u32::MAX >> (32 - width);
        let field = self.get(rn) >> lsb & mask;
        let others = self.get(rd) & !(mask << lsb);
        let value = match op {
            BitfieldOp::Ubfx => field,
            BitfieldOp::Sbfx => {
                let unused = 32 - width;
                ((field << unused).cast_signed() >> unused).cast_unsigned()
            }
            BitfieldOp::Bfi => others | (self.get(rn) & mask) << lsb,
            BitfieldOp::Bfc => others,
        };
        self.set(rd, value);
    }
}
