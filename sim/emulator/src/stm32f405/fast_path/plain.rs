//! Instructions that the fast path has.

use rsemu::cpu::arm::v7m::fpisa::FpInsn;
use rsemu::cpu::arm::v7m::isa::{ExtendOp, HintOp, Insn};

/// The most registers of a list.
pub(super) const LIST: usize = 32;

/// `FPSCR` in `vmrs` and `vmsr`.
const FPSCR: u8 = 1;

/// Returns whether the fast path has an instruction. That it can be executed there is
/// decided when it is.
pub(super) fn is_plain(instruction: &Insn) -> bool {
    match instruction {
        Insn::DataProc { op, rd, .. } => *rd != 15 || op.is_test(),
        Insn::LoadStore { unpriv, .. } => !unpriv,
        Insn::LoadStoreMultiple { list, .. } => *list != 0,
        Insn::Extend { op, .. } => !matches!(op, ExtendOp::Sxtb16 | ExtendOp::Uxtb16),
        Insn::Hint { op } => matches!(op, HintOp::Nop | HintOp::Yield | HintOp::Preload),
        Insn::ShiftReg { .. }
        | Insn::Adr { .. }
        | Insn::MovImm16 { .. }
        | Insn::Branch { .. }
        | Insn::BranchLink { .. }
        | Insn::Bx { .. }
        | Insn::Blx { .. }
        | Insn::Cbz { .. }
        | Insn::TableBranch { .. }
        | Insn::It { .. }
        | Insn::LoadLiteral { .. }
        | Insn::LoadStoreDual { .. }
        | Insn::Mul { .. }
        | Insn::MulLong { .. }
        | Insn::Div { .. }
        | Insn::Misc { .. }
        | Insn::Bitfield { .. }
        | Insn::Barrier { .. } => true,
        Insn::Fp(instruction) => is_plain_float(instruction),
        _ => false,
    }
}

/// Returns whether the fast path has an instruction of the floating-point unit.
fn is_plain_float(instruction: &FpInsn) -> bool {
    match *instruction {
        FpInsn::CvtHalf { .. } | FpInsn::CvtFixed { .. } => false,
        FpInsn::MovCore { rt, .. } => rt < 13,
        FpInsn::MovCore2 { rt, rt2, m, .. } => rt < 13 && rt2 < 13 && m < 31,
        FpInsn::Sys { to_core, rt, reg } => reg == FPSCR && (rt < 13 || to_core && rt == 15),
        FpInsn::Multi { rn, d, count, .. } => {
            rn != 15 && count > 0 && usize::from(d) + usize::from(count) <= LIST
        }
        _ => !instruction.needs_v5(),
    }
}
