//! Functions reachable from a function, with the shortest call path.

use crate::image::program::{Function, Program};
use std::collections::{BTreeMap, BTreeSet, VecDeque};

/// The functions that a root reaches.
#[derive(Debug, Clone)]
pub struct Reach {
    /// Each with the call that reaches it first: caller and instruction. The
    /// root has none.
    from: BTreeMap<u32, Option<(u32, u32)>>,
}

impl Reach {
    /// Walks from `root`. `allowances` adds callees unknown from the code; calls
    /// of functions in `ends` are not followed.
    pub fn new(
        program: &Program,
        root: u32,
        allowances: &dyn Fn(&Function) -> Vec<u32>,
        ends: &dyn Fn(&Function) -> bool,
    ) -> Self {
        let mut from = BTreeMap::from([(root, None)]);
        let mut open = VecDeque::from([root]);
        while let Some(address) = open.pop_front() {
            let Some(function) = program.functions.get(&address) else {
                continue;
            };
            if address != root && ends(function) {
                continue;
            }
            let calls = program.calls(function).into_iter();
            let known = calls.filter_map(|(site, callee)| Some((site, callee?)));
            let more = allowances(function)
                .into_iter()
                .map(|callee| (address, callee));
            for (site, callee) in known.chain(more) {
                from.entry(callee).or_insert_with(|| {
                    open.push_back(callee);
                    Some((address, site))
                });
            }
        }
        Self { from }
    }

    /// The functions, by address.
    pub fn functions(&self) -> impl Iterator<Item = u32> {
        self.from.keys().copied()
    }

    /// The shortest way to a function, root first.
    pub fn path(&self, function: u32) -> Vec<u32> {
        let mut path = vec![function];
        let mut at = function;
        while let Some(Some((caller, _))) = self.from.get(&at) {
            path.push(*caller);
            at = *caller;
        }
        path.reverse();
        path
    }

    /// The instruction by which a function is reached.
    pub fn site(&self, function: u32) -> Option<u32> {
        self.from
            .get(&function)
            .copied()
            .flatten()
            .map(|(_, site)| site)
    }

    /// Groups of functions that call each other in a circle.
    pub fn recursion(
        &self,
        program: &Program,
        allowances: &dyn Fn(&Function) -> Vec<u32>,
    ) -> Vec<Vec<u32>> {
        let all: Vec<u32> = self.functions().collect();
        let index = |address: u32| all.binary_search(&address).ok();
        let callees = |address: &u32| {
            let Some(function) = program.functions.get(address) else {
                return Vec::new();
            };
            let known = program
                .calls(function)
                .into_iter()
                .filter_map(|(_, callee)| callee);
            let callees: BTreeSet<usize> = known
                .chain(allowances(function))
                .filter_map(index)
                .collect();
            callees.into_iter().collect()
        };
        let next: Vec<Vec<usize>> = all.iter().map(callees).collect();
        crate::image::components::cycles(&next, &vec![true; all.len()])
            .into_iter()
            .map(|group| group.into_iter().map(|n| all[n]).collect())
            .collect()
    }
}
