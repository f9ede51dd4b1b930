//! The program: its functions, their calls, and those that never return.

use crate::image::body::{Body, Leave, Target};
use crate::image::constants;
use crate::image::elf::Image;
use crate::image::loops::{Loop, loops};
use crate::image::stack::{Frame, frame};
use crate::image::sweep::sweep;
use std::collections::{BTreeMap, BTreeSet};

/// A function.
#[derive(Debug, Clone)]
pub struct Function {
    /// Address of the function.
    pub address: u32,
    /// Names of the function.
    pub names: Vec<String>,
    /// Control flow; nothing follows a call that never returns.
    pub body: Body,
    /// Loops of the function.
    pub loops: Vec<Loop>,
}

impl Function {
    /// The name to show.
    pub fn name(&self) -> &str {
        // Prefer this name to weak aliases of the default handler.
        let telling = self.names.iter().find(|n| n.starts_with("DefaultHandler"));
        telling
            .or(self.names.first())
            .map_or("(no name)", String::as_str)
    }

    /// Returns whether one of its names is this one.
    pub fn is(&self, name: &str) -> bool {
        self.names.iter().any(|n| n == name)
    }
}

/// All functions of an image.
#[derive(Debug, Clone)]
pub struct Program {
    /// Functions, by address.
    pub functions: BTreeMap<u32, Function>,
    /// Their frames, by address.
    pub frames: BTreeMap<u32, Frame>,
    /// The functions that may return.
    pub returning: BTreeSet<u32>,
    /// Some instruction belongs to the FPU.
    pub uses_fpu: bool,
}

impl Program {
    /// Analyses an image.
    pub fn new(image: &Image) -> Self {
        let instructions = sweep(image);
        let mut functions = BTreeMap::new();
        let mut starts = image.functions.iter().peekable();
        while let Some((&address, symbol)) = starts.next() {
            let next = starts.peek().map(|(next, _)| **next);
            let section = image.section_at(address);
            let limit = section.map_or(address, crate::image::elf::Section::end);
            let end = match symbol.size {
                0 => next.unwrap_or(limit).min(limit),
                size => address.saturating_add(size),
            };
            let mut body = Body::new(image, &instructions, &(address..end));
            constants::resolve(image, &mut body);
            let function = Function {
                address,
                names: symbol.names.clone(),
                body,
                loops: Vec::new(),
            };
            functions.insert(address, function);
        }
        let mut program = Self {
            functions,
            frames: BTreeMap::new(),
            returning: BTreeSet::new(),
            uses_fpu: instructions.iter().any(|it| it.fpu),
        };
        program.cut_after_calls_without_return();
        for function in program.functions.values_mut() {
            function.loops = loops(&function.body);
        }
        let frames = program.functions.iter();
        program.frames = frames
            .map(|(&address, function)| (address, program.settled(frame(&function.body))))
            .collect();
        program
    }

    /// The function whose code is at an address.
    pub fn at(&self, address: u32) -> Option<&Function> {
        let (_, function) = self.functions.range(..=address).next_back()?;
        let last = function.body.steps.last()?;
        (address < last.it.end()).then_some(function)
    }

    /// The function of a name.
    pub fn named(&self, name: &str) -> Option<&Function> {
        self.functions.values().find(|f| f.is(name))
    }

    /// The calls of a function: address of the instruction, and the callee, or
    /// nothing where that is unknown. Jumps into other functions are calls.
    pub fn calls(&self, function: &Function) -> Vec<(u32, Option<u32>)> {
        let mut calls = Vec::new();
        for step in function.body.live() {
            let tail = match step.leave {
                Some(Leave::Tail(target)) => Some(target),
                _ => None,
            };
            for target in [step.call, tail].into_iter().flatten() {
                let callee = match target {
                    Target::Known(address) => self.at(address).map(|f| f.address),
                    Target::Unknown => None,
                };
                calls.push((step.it.address, callee));
            }
        }
        calls
    }

    /// Callees as the addresses of functions; a call to no function is unknown.
    fn settled(&self, mut frame: Frame) -> Frame {
        for (_, callee) in &mut frame.calls {
            match self.at(*callee) {
                Some(function) => *callee = function.address,
                None => frame.unknown_calls = true,
            }
        }
        frame
    }

    /// Removes the flow after calls that never return, until nothing
    /// changes: a function that only calls such functions does not return either.
    fn cut_after_calls_without_return(&mut self) {
        loop {
            let returning = self.find_returning();
            let mut cuts = Vec::new();
            for function in self.functions.values() {
                for (n, step) in function.body.steps.iter().enumerate() {
                    let Some(Target::Known(target)) = step.call else {
                        continue;
                    };
                    let open = !step.next.is_empty() || step.leave.is_some();
                    let callee = self.at(target);
                    let gone = callee.is_some_and(|f| !returning.contains(&f.address));
                    if gone && open && !step.it.conditional {
                        cuts.push((function.address, n));
                    }
                }
            }
            if cuts.is_empty() {
                self.returning = returning;
                return;
            }
            for (address, n) in cuts {
                if let Some(function) = self.functions.get_mut(&address)
                    && let Some(step) = function.body.steps.get_mut(n)
                {
                    step.next.clear();
                    step.leave = None;
                }
            }
        }
    }

    /// The functions that may return: by themselves, or by jumping into one
    /// that does.
    fn find_returning(&self) -> BTreeSet<u32> {
        let mut returning = BTreeSet::new();
        let mut by_tail = Vec::new();
        for function in self.functions.values() {
            for step in function.body.live() {
                match step.leave {
                    Some(Leave::Return | Leave::Tail(Target::Unknown)) => {
                        returning.insert(function.address);
                    }
                    Some(Leave::Tail(Target::Known(to))) => match self.at(to) {
                        Some(callee) => by_tail.push((function.address, callee.address)),
                        None => {
                            returning.insert(function.address);
                        }
                    },
                    Some(Leave::RunsOut) | None => {}
                }
            }
        }
        loop {
            let before = returning.len();
            for &(from, to) in &by_tail {
                if returning.contains(&to) {
                    returning.insert(from);
                }
            }
            if returning.len() == before {
                return returning;
            }
        }
    }
}
