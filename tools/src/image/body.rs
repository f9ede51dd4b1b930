//! The control flow inside one function, instruction by instruction.

use crate::image::decode::{Flow, Instruction, PC};
use crate::image::elf::Image;
use std::ops::Range;

/// Target of a call, or of a jump out of a function.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// This address.
    Known(u32),
    /// Unknown from the code.
    Unknown,
}

/// Way in which an instruction leaves its function.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Leave {
    /// Back to the caller.
    Return,
    /// Into another function that returns in its place.
    Tail(Target),
    /// The code ends without a jump or return.
    RunsOut,
}

/// An instruction in its function.
#[derive(Debug, Clone)]
pub struct Step {
    /// The instruction.
    pub it: Instruction,
    /// Indices of the steps that can follow.
    pub next: Vec<usize>,
    /// The function that it calls.
    pub call: Option<Target>,
    /// Way in which it leaves the function, if it does.
    pub leave: Option<Leave>,
}

/// The steps of a function, in the order of their addresses; the first is its
/// entry.
#[derive(Debug, Clone, Default)]
pub struct Body {
    /// All steps, reached or not.
    pub steps: Vec<Step>,
}

impl Body {
    /// The flow through the instructions of a function that takes `range`.
    pub fn new(image: &Image, instructions: &[Instruction], range: &Range<u32>) -> Self {
        let from = instructions.partition_point(|it| it.address < range.start);
        let to = instructions.partition_point(|it| it.address < range.end);
        let own = instructions.get(from..to).unwrap_or_default();
        let steps = (0..own.len()).map(|n| Step::new(image, own, n)).collect();
        Self { steps }
    }

    /// Returns for each step whether the entry reaches it.
    pub fn reached(&self) -> Vec<bool> {
        let mut reached = vec![false; self.steps.len()];
        let mut open = vec![0];
        while let Some(n) = open.pop() {
            if let (Some(step), Some(seen)) = (self.steps.get(n), reached.get_mut(n))
                && !*seen
            {
                *seen = true;
                open.extend(&step.next);
            }
        }
        reached
    }

    /// The steps that the entry reaches.
    pub fn live(&self) -> impl Iterator<Item = &Step> {
        let reached = self.reached();
        let steps = self.steps.iter().zip(reached);
        steps.filter_map(|(step, reached)| reached.then_some(step))
    }
}

impl Step {
    fn new(image: &Image, own: &[Instruction], n: usize) -> Self {
        let it = own[n];
        let mut step = Self {
            it,
            next: Vec::new(),
            call: None,
            leave: None,
        };
        let mut goes_on = it.conditional;
        match it.flow {
            Flow::Next | Flow::Breakpoint => goes_on = true,
            Flow::Jump(target) => step.jump(own, target),
            Flow::Branch(target) => {
                step.jump(own, target);
                goes_on = true;
            }
            Flow::Call(target) => {
                step.call = Some(Target::Known(target));
                goes_on = true;
            }
            Flow::CallRegister(_) => {
                step.call = Some(Target::Unknown);
                goes_on = true;
            }
            Flow::JumpLiteral(word) => match image.constant_word(word) {
                Some(target) => step.jump(own, target & !1),
                None => step.leave = Some(Leave::Tail(Target::Unknown)),
            },
            Flow::Table { wide, base: PC } => step.table(image, own, n, wide),
            Flow::Table { .. } | Flow::Computed | Flow::JumpRegister(_) => {
                step.leave = Some(Leave::Tail(Target::Unknown));
            }
            Flow::Return => step.leave = Some(Leave::Return),
            Flow::Undefined => {}
        }
        if goes_on {
            step.fall_through(image, own, n);
        }
        step
    }

    fn jump(&mut self, own: &[Instruction], target: u32) {
        match own.binary_search_by_key(&target, |it| it.address) {
            Ok(index) => self.next.push(index),
            Err(_) => self.leave = Some(Leave::Tail(Target::Known(target))),
        }
    }

    fn fall_through(&mut self, image: &Image, own: &[Instruction], n: usize) {
        let end = self.it.end();
        if own.get(n + 1).is_some_and(|next| next.address == end) {
            self.next.push(n + 1);
        } else if self.leave.is_none() {
            // Assembly may run into the next function on purpose.
            self.leave = Some(if image.functions.contains_key(&end) {
                Leave::Tail(Target::Known(end))
            } else {
                Leave::RunsOut
            });
        }
    }

    /// Follows the offsets behind a `tbb` or `tbh`, as far as the data goes.
    fn table(&mut self, image: &Image, own: &[Instruction], n: usize, wide: bool) {
        let base = self.it.end();
        let mut end = own.get(n + 1).map_or(base, |next| next.address);
        let mut at = base;
        let size = if wide { 2 } else { 1 };
        while at + size <= end {
            let Some(section) = image.section_at(at) else {
                break;
            };
            let offset = if wide {
                section.half(at).map(u32::from)
            } else {
                section.at::<1>(at).map(|[byte]| u32::from(byte))
            };
            at += size;
            let target = base + 2 * offset.unwrap_or(0);
            // What does not lead to an instruction fills the table up.
            if let Ok(index) = own.binary_search_by_key(&target, |it| it.address) {
                if !self.next.contains(&index) {
                    self.next.push(index);
                }
                end = end.min(target.max(at));
            }
        }
        if self.next.is_empty() {
            self.leave = Some(Leave::Tail(Target::Unknown));
        }
    }
}
