//! Fast path: plain instructions without the library, which spends most of its time
//! not with the instruction but with locks, the memory map and the MPU's regions.
//!
//! An instruction is plain if it is a common one and touches registers, RAM and flash
//! only. The fast path runs while no exception can be taken, and ends
//! before an instruction that is not plain, may fault or is refused by the MPU: the
//! library executes that. Result and cycles are the library's;
//! `tests/timing/fast_path.rs` compares them for random instructions.

mod accesses;
mod arithmetic;
mod code;
mod executor;
mod float_registers;
mod floats;
mod instructions;
mod memory;
mod permissions;
mod plain;
mod timing;

use crate::chip::Chip;
use crate::chip::memory::Memory;
use crate::chip::waits::Waits;
use crate::chip::wires::Raised;
use code::Code;
use executor::Executor;
use float_registers::Floats;
use memory::Windows;
use permissions::Permissions;
use rsemu::cpu::arm::v7m::sys::{Exception, Sys, control, fpccr};
use rsemu::cpu::arm::v7m::{ArmV7m, Regs, xpsr};
use std::sync::Arc;
use timing::Timing;

/// Least number of plain instructions in a row: with fewer, reading and writing the library's
/// registers takes longer than its step.
const SHORTEST_RUN: u8 = 2;

/// Known state of the core while the fast path runs.
#[derive(Clone, Copy)]
struct Context {
    /// Unaligned accesses and divisions by zero may fault.
    ccr: u32,
    /// The floating-point unit owes no saving of its registers.
    has_floats: bool,
    /// Use of the floating-point unit is noted, for the next exception.
    notes_floats: bool,
    /// DWT counts cycles.
    is_counted: bool,
    /// Priority of the exception that waits, if one does.
    pending: Option<i32>,
}

/// An instruction that was executed.
pub(super) struct Executed {
    pub(super) pc: u32,
    /// Cycles from the begin of the run to its own.
    pub(super) begin: u64,
    /// Waits included.
    pub(super) cycles: u64,
    pub(super) waits: u64,
}

/// The fast path of a chip.
pub(super) struct FastPath {
    code: Code,
    permissions: Permissions,
    windows: Windows,
    raised: Arc<Raised>,
    waits: Arc<Waits>,
}

impl FastPath {
    pub(super) fn new(chip: &Chip, memory: &Memory) -> Self {
        Self {
            code: Code::new(chip.flash.clone()),
            permissions: Permissions::default(),
            windows: Windows::new(chip, memory),
            raised: chip.raised.clone(),
            waits: chip.bus.waits.clone(),
        }
    }

    /// Executes plain instructions from the cycle `clock` on, until `most` have passed,
    /// and passes each to `each`. Returns the cycles, at most one instruction's more; 0
    /// if the library has to go on.
    pub(super) fn run(
        &mut self,
        core: &ArmV7m,
        clock: u64,
        most: u64,
        each: impl FnMut(&Executed),
    ) -> u64 {
        let mut registers = core.regs();
        self.code.refresh();
        let run = self.code.at(registers.r[15]).map_or(0, |code| code.run);
        if run < SHORTEST_RUN || registers.faultmask || registers.xpsr & xpsr::T == 0 {
            return 0;
        }
        let is_privileged = registers.in_handler() || registers.control & control::NPRIV == 0;
        let Some(context) = core.with_sys(|sys| self.context(sys, is_privileged)) else {
            return 0;
        };
        let waits = context.pending;
        if waits.is_some_and(|priority| priority < core.execution_priority()) || core.is_asleep() {
            return 0;
        }
        let mut executor = Executor {
            r: registers.r,
            xpsr: registers.xpsr,
            cycles: 0,
            has_branched: false,
            ccr: context.ccr,
            is_privileged,
            has_floats: context.has_floats,
            floats: Floats::default(),
            core,
            permissions: &mut self.permissions,
            windows: &self.windows,
            timing: Timing::new(&self.waits, clock),
        };
        executor.run(&mut self.code, most, each);
        let cycles = executor.cycles;
        if cycles > 0 {
            (registers.r, registers.xpsr) = (executor.r, executor.xpsr);
            if executor.floats.is_used {
                executor.floats.write_back(core);
                if context.notes_floats {
                    registers.control |= control::FPCA;
                }
            }
            select_stack(&mut registers);
            core.set_regs(registers);
            if context.is_counted {
                core.with_sys(|sys| sys.tick_cyccnt(cycles));
            }
        }
        cycles
    }

    /// `None` if more can happen than instructions.
    fn context(&mut self, sys: &Sys, is_privileged: bool) -> Option<Context> {
        let is_handled = |number| {
            let exception = Exception(number);
            sys.is_active(exception) || sys.is_pending(exception)
        };
        // Left to the library: making the exception of a line pending, counting with
        // SysTick, and priorities at which the MPU may be off.
        if !self.raised.all(is_handled)
            || sys.syst_csr & super::SYSTICK_ENABLE != 0
            || sys.is_active(Exception::HARD_FAULT)
            || sys.is_active(Exception::NMI)
        {
            return None;
        }
        self.permissions.refresh(sys);
        Some(Context {
            ccr: sys.ccr,
            has_floats: sys.fp_enabled(is_privileged) && sys.fpccr & fpccr::LSPACT == 0,
            notes_floats: sys.fpccr & fpccr::ASPEN != 0,
            is_counted: sys.cyccnt_enabled(),
            pending: sys.highest_pending().map(|(_, priority)| priority),
        })
    }
}

/// Puts `r13` where the library takes it from: the stack in use.
fn select_stack(registers: &mut Regs) {
    if !registers.in_handler() && registers.control & control::SPSEL != 0 {
        registers.psp = registers.r[13];
    } else {
        registers.msp = registers.r[13];
    }
}
