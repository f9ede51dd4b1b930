//! Constants in registers, so that a call through a register with a constant
//! value is treated as a direct call.
//!
//! Compilers make such calls to save space (`movw`, `movt`, then `blx` several
//! times) and linkers to reach far (`movw`, `movt`, `bx` in a veneer). A
//! register is known if every path to the instruction gives it the same
//! value, and unknown after anything that *may* write it.

use crate::image::body::{Body, Leave, Target};
use crate::image::decode::{Constant, Flow, Instruction, Register};
use crate::image::elf::Image;

/// Known values of `r0` to `r14`; the outer `None`: not reached yet.
type Known = [Option<u32>; 15];

/// Registers that a called function may change: r0 to r3, r12, lr.
const CALL_CHANGES: u16 = 0x500F;

/// Replaces unknown targets by those known from constants.
pub fn resolve(image: &Image, body: &mut Body) {
    let unknown = |target| target == Some(Target::Unknown);
    let open = body
        .steps
        .iter()
        .any(|step| unknown(step.call) || matches!(step.leave, Some(Leave::Tail(Target::Unknown))));
    if !open {
        return;
    }
    let before = flow(image, body);
    for (step, known) in body.steps.iter_mut().zip(before) {
        let target = |register: Register| {
            let value = (*known.as_ref()?.get(usize::from(register))?)?;
            // Without the Thumb bit it would be a fault.
            (value & 1 == 1).then_some(Target::Known(value & !1))
        };
        match step.it.flow {
            Flow::CallRegister(register) => {
                step.call = target(register).or(step.call);
            }
            Flow::JumpRegister(register) => {
                step.leave = target(register).map(Leave::Tail).or(step.leave);
            }
            _ => {}
        }
    }
}

/// Known values before each step.
fn flow(image: &Image, body: &Body) -> Vec<Option<Known>> {
    let mut before: Vec<Option<Known>> = vec![None; body.steps.len()];
    if let Some(entry) = before.first_mut() {
        *entry = Some([None; 15]);
    }
    let mut open = vec![0];
    while let Some(n) = open.pop() {
        let (Some(step), Some(Some(known))) = (body.steps.get(n), before.get(n)) else {
            continue;
        };
        let after = after(image, &step.it, step.call.is_some(), *known);
        for &next in &step.next {
            if let Some(known) = before.get_mut(next)
                && meet(known, &after)
            {
                open.push(next);
            }
        }
    }
    before
}

/// Intersects known values; returns whether that is a change.
fn meet(known: &mut Option<Known>, other: &Known) -> bool {
    let Some(registers) = known else {
        *known = Some(*other);
        return true;
    };
    let mut news = false;
    for (register, other) in registers.iter_mut().zip(other) {
        if register.is_some() && register != other {
            *register = None;
            news = true;
        }
    }
    news
}

fn after(image: &Image, it: &Instruction, call: bool, before: Known) -> Known {
    let mut known = before;
    let written = it.may_write | if call { CALL_CHANGES } else { 0 };
    for (n, register) in known.iter_mut().enumerate() {
        if written >> n & 1 == 1 {
            *register = None;
        }
    }
    let get = |register: Register| before.get(usize::from(register)).copied().flatten();
    let made = match it.constant {
        Constant::None => None,
        Constant::Low(to, half) => Some((to, Some(u32::from(half)))),
        Constant::High(to, half) => {
            let low = get(to).map(|value| value & 0xFFFF);
            Some((to, low.map(|low| u32::from(half) << 16 | low)))
        }
        Constant::Literal(to, word) => Some((to, image.constant_word(word))),
        Constant::Copy { to, from } => Some((to, get(from))),
    };
    // Inside an `it` block it may not be executed.
    if let Some((to, value)) = made
        && !it.conditional
        && let Some(register) = known.get_mut(usize::from(to))
    {
        *register = value;
    }
    known
}
