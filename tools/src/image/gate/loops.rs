//! Loops that gated interrupts reach, by their place in the source.
//!
//! Compilers inline, so a loop is identified by the function that holds it in
//! the source, not by its symbol in the image: of the inlined functions
//! that *all* its instructions have in common, the innermost that is not from
//! a library. In that function it is distinguished by its line, and by the
//! line in the library that it comes from. So a bound survives edits above it
//! and changes of inlining, and a new loop is a new one. Without debug
//! information it is the symbol and the address.

use super::findings::{Copies, Findings, Spot};
use super::layout::Root;
use super::{Gate, finding};
use crate::image::lines::Frame;
use crate::image::loops::Loop;
use crate::image::program::Function;

/// Origin of a loop in the source.
struct Origin {
    /// The function of the source that holds it.
    owner: String,
    /// Spot of the loop in that function.
    spot: Spot,
    /// Place of the loop, for display.
    place: String,
    /// The spot is in this repository.
    is_own: bool,
}

impl Gate<'_> {
    /// Records the loops of a function; endless ones are failures.
    pub(super) fn note_loops(
        &self,
        root: &Root<'_>,
        function: &Function,
        path: &dyn Fn(u32) -> Vec<String>,
        found: &mut Findings<'_>,
    ) {
        let handler = &root.interrupt.handler;
        for l in &function.loops {
            if !found.is_new("loop", l.address, l.instructions.len()) {
                continue;
            }
            if l.endless {
                found.report.failures.push(finding(
                    "loop",
                    format!("{handler} can reach a loop that never ends"),
                    path(l.address),
                    "an interrupt must return: take the loop out; where it waits for a reset \
                     that was asked for, list the function in `ends`",
                ));
                continue;
            }
            let Origin {
                owner,
                mut spot,
                place,
                is_own,
            } = self.origin(function, l);
            if let Spot::Line(.., nested) = &mut spot {
                let around = function.loops.iter().filter(|o| surrounds(o, l));
                let same = around.filter(|o| self.origin(function, o).place == place);
                *nested = same.count();
            }
            let loops = found.loops.entry(owner).or_default();
            loops.is_own |= is_own;
            if loops.path.is_empty() {
                loops.handler.clone_from(handler);
                loops.path = path(l.address);
            }
            let copies = loops.spots.entry(spot);
            copies.or_insert(Copies { place, count: 0 }).count += 1;
        }
    }

    fn origin(&self, function: &Function, l: &Loop) -> Origin {
        let common = self.common_frames(l);
        let own = common.iter().rposition(|frame| !frame.library);
        let holder = common.get(own.unwrap_or(0));
        match (holder, common.last()) {
            (Some(holder), Some(inner)) => {
                let library = if holder == inner {
                    String::new()
                } else {
                    inner.place()
                };
                let place = if library.is_empty() {
                    holder.place()
                } else {
                    format!("{} ({library})", holder.place())
                };
                // A symbol's name is the same with and without debug information.
                let name = match own {
                    Some(n) if n > 0 => holder.function.clone(),
                    _ => function.name().to_owned(),
                };
                Origin {
                    owner: name,
                    spot: Spot::Line(holder.line, library, 0),
                    place,
                    is_own: own.is_some(),
                }
            }
            _ => Origin {
                owner: function.name().to_owned(),
                spot: Spot::Address(l.address),
                place: format!("{:#010x}", l.address),
                is_own: false,
            },
        }
    }

    /// The frames that all instructions of a loop share, with the lines of its
    /// first one. Frames are the same if they were inlined at the same place.
    fn common_frames(&self, l: &Loop) -> Vec<Frame> {
        // Instructions made of several lines have no useful place.
        let telling = |frames: &Vec<Frame>| frames.last().is_some_and(|inner| inner.line > 0);
        let addresses = std::iter::once(&l.address).chain(&l.instructions);
        let frames = addresses.map(|&address| self.lines.frames(address));
        let mut frames = frames.filter(telling);
        let mut common = frames.next().unwrap_or_default();
        for other in frames {
            let same = |n: &usize| {
                let (Some(a), Some(b)) = (common.get(*n), other.get(*n)) else {
                    return false;
                };
                let outer = n.checked_sub(1);
                let site =
                    |frames: &[Frame]| outer.map(|m| (frames[m].file.clone(), frames[m].line));
                a.function == b.function && site(&common) == site(&other)
            };
            let shared = (0..common.len()).take_while(same).count();
            common.truncate(shared);
        }
        common
    }
}

fn surrounds(outer: &Loop, inner: &Loop) -> bool {
    outer.instructions.len() > inner.instructions.len()
        && outer.instructions.contains(&inner.address)
}
