//! Instructions of the floating-point unit (ARM DDI 0403E A7.7), with the library's
//! arithmetic.
//!
//! A handler's first one, which saves the registers of what it interrupts, is left to
//! the library.

use super::arithmetic::offset;
use super::executor::Executor;
use super::plain::LIST;
use rsemu::cpu::arm::v7m::fp::{self, fpscr};
use rsemu::cpu::arm::v7m::fpisa::{DataOp, FpInsn, UnaryOp};
use rsemu::cpu::arm::v7m::xpsr;
use rsemu::float::{Flags, Round};

/// Cycles besides the instruction's one: of a division or a root, and of a product
/// that is added.
const DIVISION: u64 = 13;
const ACCUMULATION: u64 = 2;

impl Executor<'_> {
    pub(super) fn float(&mut self, instruction: &FpInsn) -> Option<()> {
        if !self.has_floats {
            return None;
        }
        match *instruction {
            FpInsn::Data { op, d, n, m } => self.float_data(op, d, n, m)?,
            FpInsn::Unary { op, d, m } => {
                let a = self.s(m);
                let (value, flags) = match op {
                    UnaryOp::Mov => (a, Flags::NONE),
                    UnaryOp::Abs => (fp::abs(a), Flags::NONE),
                    UnaryOp::Neg => (fp::neg(a), Flags::NONE),
                    UnaryOp::Sqrt => fp::sqrt(a, fp::env(self.fpscr())),
                    UnaryOp::RintR | UnaryOp::RintZ | UnaryOp::RintX => return None,
                };
                self.finish(d, value, flags);
                self.cycles += if op == UnaryOp::Sqrt { DIVISION } else { 0 };
            }
            FpInsn::MovImm { d, imm } => self.floats.set(d, imm),
            FpInsn::Cmp {
                d,
                m,
                with_zero,
                signal_all,
            } => {
                let (a, b) = (self.s(d), if with_zero { 0 } else { self.s(m) });
                let old = self.fpscr();
                let (nzcv, flags) = fp::compare(a, b, signal_all, fp::env(old));
                self.floats.set_fpscr(old & !fpscr::FLAGS | nzcv);
                self.raise(flags);
            }
            FpInsn::CvtInt {
                d,
                m,
                to_int,
                signed,
                round_zero,
            } => {
                let (a, env) = (self.s(m), fp::env(self.fpscr()));
                let (value, flags) = match (to_int, round_zero) {
                    (false, _) => fp::from_fixed(a, 32, !signed, 0, env),
                    (true, false) => fp::to_fixed(a, 32, !signed, 0, env),
                    (true, true) => fp::to_fixed(a, 32, !signed, 0, env.round(Round::TowardZero)),
                };
                self.finish(d, value, flags);
            }
            FpInsn::MovCore {
                to_fp: true, rt, n, ..
            } => self.floats.set(n, self.get(rt)),
            FpInsn::MovCore { rt, n, .. } => {
                let value = self.s(n);
                self.set(rt, value);
            }
            FpInsn::MovCore2 {
                to_fp, rt, rt2, m, ..
            } => {
                if to_fp {
                    self.floats.set(m, self.get(rt));
                    self.floats.set(m + 1, self.get(rt2));
                } else {
                    let (low, high) = (self.s(m), self.s(m + 1));
                    self.set(rt, low);
                    self.set(rt2, high);
                }
                self.cycles += 1;
            }
            FpInsn::Sys { to_core, rt, .. } => {
                let old = self.fpscr();
                match (to_core, rt) {
                    (false, _) => self.floats.set_fpscr(self.get(rt) & fpscr::WRITABLE),
                    (true, 15) => {
                        let kept = self.xpsr & (!xpsr::FLAGS | xpsr::Q);
                        self.xpsr = kept | old & fpscr::FLAGS;
                    }
                    (true, _) => self.set(rt, old),
                }
            }
            FpInsn::Mem { .. } | FpInsn::Multi { .. } => self.float_memory(instruction)?,
            _ => return None,
        }
        self.floats.is_used = true;
        Some(())
    }

    fn float_data(&mut self, op: DataOp, d: u8, n: u8, m: u8) -> Option<()> {
        let (b, c, env) = (self.s(n), self.s(m), fp::env(self.fpscr()));
        // The sum of `a`, or of −`a`, and the rounded product, or its negative.
        let chained = |a: u32, is_negated: bool| {
            let (product, first) = fp::mul(b, c, env);
            let product = if is_negated {
                fp::neg(product)
            } else {
                product
            };
            let (value, second) = fp::add(a, product, env);
            (value, first | second)
        };
        let (value, flags) = match op {
            DataOp::Add => fp::add(b, c, env),
            DataOp::Sub => fp::sub(b, c, env),
            DataOp::Mul => fp::mul(b, c, env),
            DataOp::Nmul => {
                let (product, flags) = fp::mul(b, c, env);
                (fp::neg(product), flags)
            }
            DataOp::Div => fp::div(b, c, env),
            DataOp::Mla => chained(self.s(d), false),
            DataOp::Mls => chained(self.s(d), true),
            DataOp::Nmla => chained(fp::neg(self.s(d)), true),
            DataOp::Nmls => chained(fp::neg(self.s(d)), false),
            DataOp::Fma => fp::mul_add(self.s(d), b, c, env),
            DataOp::Fms => fp::mul_add(self.s(d), fp::neg(b), c, env),
            DataOp::Fnma => fp::mul_add(fp::neg(self.s(d)), fp::neg(b), c, env),
            DataOp::Fnms => fp::mul_add(fp::neg(self.s(d)), b, c, env),
            DataOp::Maxnm | DataOp::Minnm => return None,
        };
        self.finish(d, value, flags);
        self.cycles += match op {
            DataOp::Div => DIVISION,
            DataOp::Add | DataOp::Sub | DataOp::Mul | DataOp::Nmul => 0,
            _ => ACCUMULATION,
        };
        Some(())
    }

    /// Loads and stores of one, of two and of a list, never unaligned.
    fn float_memory(&mut self, instruction: &FpInsn) -> Option<()> {
        let (load, first, count, start, written_back) = match *instruction {
            FpInsn::Mem {
                load,
                d,
                rn,
                imm,
                add,
                double,
            } => {
                let base = if rn == 15 {
                    self.r[15] & !3
                } else {
                    self.get(rn)
                };
                (load, d, 1 + u8::from(double), offset(base, imm, add), None)
            }
            FpInsn::Multi {
                load,
                d,
                rn,
                count,
                add,
                writeback,
                ..
            } => {
                let base = self.get(rn);
                let end = offset(base, 4 * u32::from(count), add);
                let start = if add { base } else { end };
                (load, d, count, start, writeback.then_some((rn, end)))
            }
            _ => return None,
        };
        if !start.is_multiple_of(4) {
            return None;
        }
        let words = (start..).step_by(4).zip(first..).take(usize::from(count));
        if load {
            let mut values = [0; LIST];
            for ((address, _), value) in words.clone().zip(&mut values) {
                *value = self.load(address, 4, true)?;
            }
            for ((_, register), value) in words.zip(values) {
                self.floats.set(register, value);
            }
        } else {
            for (address, _) in words.clone() {
                if !self.may_store(address, 4) {
                    return None;
                }
            }
            for (address, register) in words {
                let value = self.s(register);
                self.store(address, 4, value)?;
            }
        }
        if let Some((register, end)) = written_back {
            self.set(register, end);
        }
        Some(())
    }

    fn s(&mut self, register: u8) -> u32 {
        self.floats.get(self.core, register)
    }

    fn fpscr(&mut self) -> u32 {
        self.floats.fpscr(self.core)
    }

    fn raise(&mut self, flags: Flags) {
        if !flags.is_empty() {
            let mut fpscr = self.fpscr();
            fp::accumulate(&mut fpscr, flags);
            self.floats.set_fpscr(fpscr);
        }
    }

    fn finish(&mut self, register: u8, value: u32, flags: Flags) {
        self.floats.set(register, value);
        self.raise(flags);
    }
}
