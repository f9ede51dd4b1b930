//! Allowances of the budget file, looked up in the image.

use crate::image::body::{Leave, Target};
use crate::image::budget::{BoundedLoops, DynamicStack, ImageBudget, IndirectCalls};
use crate::image::program::{Function, Program};
use crate::image::report::Finding;
use crate::image::stack::Extra;
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

/// The allowances, and which of them were needed.
pub(super) struct Allowances<'a> {
    budget: &'a ImageBudget,
    shared: &'a [BoundedLoops],
    targets: BTreeMap<&'a str, Vec<u32>>,
    missing: Vec<Finding>,
    used: RefCell<BTreeSet<(&'static str, &'a str)>>,
}

impl<'a> Allowances<'a> {
    pub(super) fn new(
        program: &Program,
        budget: &'a ImageBudget,
        shared: &'a [BoundedLoops],
    ) -> Self {
        let mut targets: BTreeMap<&str, Vec<u32>> = BTreeMap::new();
        let mut missing = Vec::new();
        for entry in &budget.indirect {
            let known = targets.entry(&entry.function).or_default();
            for name in &entry.targets {
                let named = program.functions.values().filter(|f| f.is(name));
                let before = known.len();
                known.extend(named.map(|f| f.address));
                if known.len() == before {
                    missing.push(super::finding(
                        "budget",
                        format!("no function {name} in the image"),
                        vec![format!(
                            "targets of the indirect calls in {}",
                            entry.function
                        )],
                        "correct or remove the target",
                    ));
                }
            }
        }
        Self {
            budget,
            shared,
            targets,
            missing,
            used: RefCell::default(),
        }
    }

    /// Addresses to which the unknown calls of a function go.
    pub(super) fn targets(&self, function: &Function) -> Vec<u32> {
        let names = function.names.iter();
        let known = names.filter_map(|name| self.targets.get(name.as_str()));
        known.flatten().copied().collect()
    }

    /// The entry for a function's unknown calls.
    pub(super) fn indirect(&self, function: &Function) -> Option<&'a IndirectCalls> {
        let mut entries = self.budget.indirect.iter();
        let entry = entries.find(|e| function.is(&e.function))?;
        self.used.borrow_mut().insert(("indirect", &entry.function));
        Some(entry)
    }

    /// The entry for the loops of a function of the source.
    pub(super) fn loops(&self, function: &str) -> Option<&'a BoundedLoops> {
        let exact = self.all_loops().find(|e| e.function == function);
        let entry = exact.or_else(|| self.all_loops().find(|e| e.is_for(function)))?;
        self.keep(entry);
        Some(entry)
    }

    /// Bounds of this image and of all images; a function is in one of both.
    fn all_loops(&self) -> impl Iterator<Item = &'a BoundedLoops> {
        self.budget.loops.iter().chain(self.shared)
    }

    /// Returns whether there is an entry for the panics of a library.
    pub(super) fn panics(&self, library: &str) -> bool {
        let mut entries = self.budget.panics.iter();
        let entry = entries.find(|e| e.library == library);
        if let Some(entry) = entry {
            self.used.borrow_mut().insert(("panics", &entry.library));
        }
        entry.is_some()
    }

    /// The entry for a function that computes its stack pointer.
    pub(super) fn dynamic(&self, function: &Function) -> Option<&'a DynamicStack> {
        let mut entries = self.budget.dynamic_stack.iter();
        let entry = entries.find(|e| function.is(&e.function))?;
        self.used
            .borrow_mut()
            .insert(("dynamic_stack", &entry.function));
        Some(entry)
    }

    /// The entry for a function that control does not come back from.
    pub(super) fn ends(&self, function: &Function) -> bool {
        let entry = self.budget.ends.iter().find(|e| function.is(&e.function));
        if let Some(entry) = entry {
            self.used.borrow_mut().insert(("ends", &entry.function));
        }
        entry.is_some()
    }

    /// Stack of a function on top of its frame.
    pub(super) fn extra(&self, function: &Function) -> Extra {
        let dynamic = function
            .body
            .live()
            .any(|s| s.it.stack == crate::image::decode::Stack::Dynamic);
        let unknown = unknown_calls(function) > 0;
        Extra {
            dynamic: dynamic
                .then(|| self.dynamic(function))
                .flatten()
                .map(|e| e.bytes),
            targets: unknown
                .then(|| self.indirect(function))
                .flatten()
                .map(|_| self.targets(function)),
        }
    }

    /// Functions whose loops are bounded, but were not found.
    pub(super) fn without_loops(&self) -> Vec<&'a BoundedLoops> {
        let used = self.used.borrow();
        self.all_loops()
            .filter(|e| !used.contains(&("loops", &e.function)))
            .collect()
    }

    /// Functions of the bounds for all images that this image needed.
    pub(super) fn shared_loops(&self) -> BTreeSet<String> {
        let used = self.used.borrow();
        let shared = self.shared.iter().map(|e| &e.function);
        shared
            .filter(|function| used.contains(&("loops", function)))
            .cloned()
            .collect()
    }

    /// An entry is in order although nothing needed it.
    pub(super) fn keep(&self, entry: &'a BoundedLoops) {
        self.used.borrow_mut().insert(("loops", &entry.function));
    }

    /// Entries that nothing needed, and targets that do not exist.
    pub(super) fn stale(&self) -> Vec<Finding> {
        let used = self.used.borrow();
        let all = self
            .budget
            .allowances()
            .map(|(kind, function, _)| (kind, function));
        let stale = all.filter(|entry| !used.contains(entry));
        let stale = stale.map(|(kind, function)| {
            super::finding(
                "budget",
                format!("the entry in {kind} for {function} is not needed"),
                Vec::new(),
                "remove it: left alone it would let something new through",
            )
        });
        stale.chain(self.missing.iter().cloned()).collect()
    }
}

/// Number of calls and jumps of a function with unknown target.
pub(crate) fn unknown_calls(function: &Function) -> usize {
    let unknown = |step: &&crate::image::body::Step| {
        step.call == Some(Target::Unknown) || step.leave == Some(Leave::Tail(Target::Unknown))
    };
    function.body.live().filter(unknown).count()
}
