//! Depth of the stack: inside a function, and along its calls.
//!
//! Inside a function every `push`, `vpush`, `sub sp` and write-back to `sp` is
//! followed along the control flow; a call is charged with the stack in use at
//! that instruction, not with the function's whole frame.

use crate::image::body::{Body, Leave, Target};
use crate::image::decode::Stack;
use std::collections::BTreeMap;

/// Deeper than any controller's stack: the count does not converge.
const ABSURD: u32 = 1 << 20;

/// A function's own use of the stack, in bytes.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Frame {
    /// The most that it uses by itself.
    pub deepest: u32,
    /// Stack in use at each call, and the callee; tail calls are calls, too.
    pub calls: Vec<(u32, u32)>,
    /// Addresses at which `sp` is set to something unknown, or grows in a loop.
    pub dynamic: Vec<u32>,
    /// The function has calls or jumps with unknown target.
    pub unknown_calls: bool,
}

/// Measures one function.
pub fn frame(body: &Body) -> Frame {
    let mut frame = Frame::default();
    let mut depth: Vec<Option<u32>> = vec![None; body.steps.len()];
    if let Some(entry) = depth.first_mut() {
        *entry = Some(0);
    }
    let mut open = vec![0];
    while let Some(n) = open.pop() {
        let (Some(step), Some(Some(before))) = (body.steps.get(n), depth.get(n).copied()) else {
            continue;
        };
        let after = match step.it.stack {
            Stack::Down(bytes) => before.saturating_add(bytes),
            // A conditional pop may leave the stack unchanged.
            Stack::Up(_) if step.it.conditional => before,
            Stack::Up(bytes) => before.saturating_sub(bytes),
            Stack::Same | Stack::Dynamic => before,
        };
        frame.deepest = frame.deepest.max(after);
        if after > ABSURD {
            frame.dynamic.push(step.it.address);
            frame.deepest = before;
            break;
        }
        for &next in &step.next {
            if let Some(known) = depth.get_mut(next)
                && known.is_none_or(|known| known < after)
            {
                *known = Some(after);
                open.push(next);
            }
        }
    }
    for (step, depth) in body.steps.iter().zip(depth) {
        let Some(depth) = depth else { continue };
        if step.it.stack == Stack::Dynamic {
            frame.dynamic.push(step.it.address);
        }
        let tail = match step.leave {
            Some(Leave::Tail(target)) => Some(target),
            _ => None,
        };
        for target in [step.call, tail].into_iter().flatten() {
            match target {
                Target::Known(address) => frame.calls.push((depth, address)),
                Target::Unknown => frame.unknown_calls = true,
            }
        }
    }
    frame
}

/// The worst use of the stack from a function on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Worst {
    /// Bytes.
    pub bytes: u32,
    /// The functions of the worst path with their own share, from the root.
    pub path: Vec<(u32, u32)>,
    /// Functions that keep the number from being an upper bound: recursive,
    /// with a stack pointer that is computed, or with unknown calls.
    pub open: Vec<u32>,
}

/// The worst bytes from a function on, and the call that makes them so.
type Walked = (u32, Option<(u32, u32)>);

/// Adds up frames along calls.
pub struct Depths<'a> {
    frames: &'a BTreeMap<u32, Frame>,
    extra: &'a dyn Fn(u32) -> Extra,
    /// `None` while a function is being walked.
    known: BTreeMap<u32, Option<Walked>>,
    recursive: Vec<u32>,
}

/// Properties of a function beyond its frame.
#[derive(Debug, Clone, Default)]
pub struct Extra {
    /// An allowance for a computed stack pointer: bytes on top of the frame.
    pub dynamic: Option<u32>,
    /// Targets of its unknown calls.
    pub targets: Option<Vec<u32>>,
}

impl<'a> Depths<'a> {
    /// Stacks of these functions; `extra` adds the budget's allowances.
    pub fn new(frames: &'a BTreeMap<u32, Frame>, extra: &'a dyn Fn(u32) -> Extra) -> Self {
        Self {
            frames,
            extra,
            known: BTreeMap::new(),
            recursive: Vec::new(),
        }
    }

    /// The worst from a function on.
    pub fn worst(&mut self, root: u32) -> Worst {
        let bytes = self.walk(root);
        let mut path = Vec::new();
        let mut at = Some((0, root));
        while let Some((_, function)) = at {
            let below = match self.known.get(&function) {
                Some(Some((_, below))) => *below,
                _ => None,
            };
            let own = below.map_or_else(
                || self.frames.get(&function).map_or(0, |f| f.deepest),
                |(depth, _)| depth,
            );
            path.push((function, own));
            at = below.filter(|_| path.len() < self.frames.len());
        }
        Worst {
            bytes,
            path,
            open: self.open(root),
        }
    }

    fn walk(&mut self, function: u32) -> u32 {
        match self.known.get(&function) {
            Some(Some((bytes, _))) => return *bytes,
            Some(None) => {
                self.recursive.push(function);
                return 0;
            }
            None => {}
        }
        let Some(frame) = self.frames.get(&function) else {
            return 0;
        };
        self.known.insert(function, None);
        let extra = (self.extra)(function);
        let more = extra.dynamic.unwrap_or(0);
        let mut worst = (frame.deepest, None);
        let allowances = extra.targets.unwrap_or_default();
        let allowances = allowances.into_iter().map(|target| (frame.deepest, target));
        for (depth, callee) in frame.calls.iter().copied().chain(allowances) {
            let bytes = depth.saturating_add(self.walk(callee));
            if bytes > worst.0 {
                worst = (bytes, Some((depth, callee)));
            }
        }
        worst.0 = worst.0.saturating_add(more);
        self.known.insert(function, Some(worst));
        worst.0
    }

    /// Functions below `root` that leave the number open.
    fn open(&self, root: u32) -> Vec<u32> {
        let mut seen = std::collections::BTreeSet::new();
        let mut todo = vec![root];
        while let Some(function) = todo.pop() {
            let Some(frame) = self.frames.get(&function) else {
                continue;
            };
            if seen.insert(function) {
                todo.extend(frame.calls.iter().map(|&(_, callee)| callee));
                todo.extend((self.extra)(function).targets.unwrap_or_default());
            }
        }
        seen.retain(|function| {
            let extra = (self.extra)(*function);
            let frame = self.frames.get(function);
            self.recursive.contains(function)
                || frame.is_some_and(|f| f.unknown_calls && extra.targets.is_none())
                || frame.is_some_and(|f| !f.dynamic.is_empty() && extra.dynamic.is_none())
        });
        seen.into_iter().collect()
    }
}
