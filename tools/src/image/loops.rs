//! Loops of a function.
//!
//! A group of steps that reach each other is a loop. Taking away the edges
//! that lead back to its entry leaves the loops inside it, and so on down.
//! This finds natural loops with their nesting; a group that can be entered in
//! more than one place is a loop as well, and counts as one.

use crate::image::body::{Body, Leave, Step, Target};
use crate::image::components::cycles;

/// One loop.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Loop {
    /// Address of its first instruction.
    pub address: u32,
    /// Addresses of its instructions, without those that leave it by returning.
    pub instructions: Vec<u32>,
    /// No way out of it leads anywhere: it never ends.
    pub endless: bool,
}

/// All loops that the function's entry reaches, outer before inner.
pub fn loops(body: &Body) -> Vec<Loop> {
    let mut next: Vec<Vec<usize>> = body.steps.iter().map(|s| s.next.clone()).collect();
    let reached = body.reached();
    let ends = ends(body, &next, &reached);
    let mut found = Vec::new();
    let mut open = vec![reached];
    while let Some(alive) = open.pop() {
        for group in cycles(&next, &alive) {
            let mut inside = vec![false; body.steps.len()];
            for &node in &group {
                inside[node] = true;
            }
            let header = header(body, &group, &inside, &alive);
            let way_out = |&node: &usize| {
                let step = &body.steps[node];
                leaves(step) || step.next.iter().any(|&to| !inside[to] && ends[to])
            };
            found.push(Loop {
                address: body.steps[header].it.address,
                instructions: group
                    .iter()
                    .filter(|&&n| stays(body, n))
                    .map(|&n| body.steps[n].it.address)
                    .collect(),
                endless: !group.iter().any(way_out),
            });
            for &node in &group {
                next[node].retain(|&to| to != header);
            }
            open.push(inside);
        }
    }
    found.sort_by_key(|l| (l.address, std::cmp::Reverse(l.instructions.len())));
    found
}

/// Step at which a loop is entered: from outside it, or at the function's beginning.
fn header(body: &Body, group: &[usize], inside: &[bool], alive: &[bool]) -> usize {
    let mut entered = vec![false; inside.len()];
    entered[0] = true;
    for (from, step) in body.steps.iter().enumerate() {
        if alive[from] && !inside[from] {
            for &to in &step.next {
                entered[to] = true;
            }
        }
    }
    let first = group.first().copied().unwrap_or_default();
    group
        .iter()
        .copied()
        .find(|&node| entered[node])
        .unwrap_or(first)
}

/// Returns whether a step is of the loop's own making: a conditional return, and the
/// `it` before it, stand in a loop but belong to the function around it.
fn stays(body: &Body, n: usize) -> bool {
    let conditional = |n: usize| body.steps.get(n).is_some_and(|s| s.it.conditional);
    let is_it = !conditional(n) && conditional(n + 1);
    !is_it && !leaves(&body.steps[n])
}

/// Returns whether a step can leave the function.
fn leaves(step: &Step) -> bool {
    matches!(
        step.leave,
        Some(Leave::Return | Leave::Tail(Target::Known(_) | Target::Unknown))
    )
}

/// Returns for each step whether there is a way from it to leave, or into some loop: everything but
/// a dead end.
fn ends(body: &Body, next: &[Vec<usize>], reached: &[bool]) -> Vec<bool> {
    let mut ends: Vec<bool> = body.steps.iter().map(leaves).collect();
    for group in cycles(next, reached) {
        for node in group {
            ends[node] = true;
        }
    }
    // Mostly one pass: code runs towards higher addresses.
    loop {
        let mut news = false;
        for n in (0..next.len()).rev() {
            if !ends[n] && next[n].iter().any(|&to| ends[to]) {
                ends[n] = true;
                news = true;
            }
        }
        if !news {
            return ends;
        }
    }
}
