//! The gate: an image against its budget.

mod allowances;
mod bounds;
mod code;
mod findings;
mod layout;
mod loops;
mod panics;
mod shared;
mod sizes;
mod stacks;

use crate::image::budget::{BoundedLoops, ImageBudget};
use crate::image::elf::Image;
use crate::image::error::ImageError;
use crate::image::lines::Lines;
use crate::image::memory::Region;
use crate::image::program::{Function, Program};
use crate::image::report::{Finding, Report};
use crate::image::vectors::Vectors;
use allowances::Allowances;

pub(crate) use allowances::unknown_calls;
pub use shared::needless_loops;

/// An analysed image, with its budget.
pub struct Gate<'a> {
    name_of_image: &'a str,
    image: &'a Image,
    vectors: &'a Vectors,
    program: &'a Program,
    lines: &'a Lines,
    memory: &'a [Region],
    budget: &'a ImageBudget,
    tolerance_percent: f64,
    allowances: Allowances<'a>,
}

/// Input of [`examine`].
#[derive(Clone, Copy)]
pub struct Subject<'a> {
    /// The image.
    pub image: &'a Image,
    /// Source lines of the image.
    pub lines: &'a Lines,
    /// The memories of its linker script.
    pub memory: &'a [Region],
    /// Budget of the image.
    pub budget: &'a ImageBudget,
    /// Bounds of loops for all images.
    pub shared_loops: &'a [BoundedLoops],
    /// Allowed growth of recorded sizes.
    pub tolerance_percent: f64,
}

/// Examines an image.
///
/// # Errors
///
/// [`ImageError`] if there is no vector table.
pub fn examine(name: &str, subject: Subject<'_>) -> Result<Report, ImageError> {
    let vectors = Vectors::read(subject.image)?;
    let program = Program::new(subject.image);
    let gate = Gate {
        name_of_image: name,
        image: subject.image,
        vectors: &vectors,
        program: &program,
        lines: subject.lines,
        memory: subject.memory,
        budget: subject.budget,
        tolerance_percent: subject.tolerance_percent,
        allowances: Allowances::new(&program, subject.budget, subject.shared_loops),
    };
    let mut report = Report {
        image: name.to_owned(),
        ..Report::default()
    };
    gate.check_layout(&mut report);
    let roots = gate.roots(&mut report);
    gate.check_stacks(&roots, &mut report);
    gate.check_code(&roots, &mut report);
    gate.check_sizes(&mut report);
    Ok(report)
}

impl Gate<'_> {
    /// An instruction's place for display: function, address, source line.
    fn place(&self, address: u32) -> String {
        let name = self.program.at(address).map_or("?", Function::name);
        let line = self.lines.at(address);
        let line = line.map_or_else(String::new, |line| format!(", {line}"));
        format!("{name} at {address:#010x}{line}")
    }

    fn name(&self, function: u32) -> String {
        let function = self.program.functions.get(&function);
        function.map_or("?", Function::name).to_owned()
    }
}

fn finding(check: &'static str, what: String, at: Vec<String>, todo: &str) -> Finding {
    Finding {
        check,
        what,
        at,
        todo: todo.to_owned(),
    }
}
