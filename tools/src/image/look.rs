//! Survey of what a function can reach, without a budget: for finding one's way in an
//! image, and for the first budget file.

use crate::image::elf::Image;
use crate::image::error::ImageError;
use crate::image::gate::unknown_calls;
use crate::image::panics::is_panic;
use crate::image::program::{Function, Program};
use crate::image::reach::Reach;
use crate::image::stack::{Depths, Extra};
use crate::image::vectors::Vectors;
use serde::Serialize;
use std::fmt::Write;

/// One root.
#[derive(Debug, Clone, Serialize)]
pub struct Look {
    /// Name of the root.
    pub root: String,
    /// Worst stack of the root, in bytes.
    pub stack: u32,
    /// That is a lower bound only.
    pub at_least: bool,
    /// The shortest way to a panic, if there is one.
    pub panics: Option<Vec<String>>,
    /// The functions that it reaches, up to panics.
    pub functions: Vec<Row>,
}

/// One function.
#[derive(Debug, Clone, Serialize)]
pub struct Row {
    /// Name of the function.
    pub name: String,
    /// Address of the function.
    pub address: u32,
    /// Instructions that its entry reaches.
    pub instructions: usize,
    /// The function's own use of the stack, in bytes.
    pub frame: u32,
    /// Number of its loops.
    pub loops: usize,
    /// Number of its calls whose target is unknown from the code.
    pub unknown_calls: usize,
}

/// Looks from the functions named, or from every handler of the vector table.
///
/// # Errors
///
/// [`ImageError`] if there is no such function, or no vector table.
pub fn look(image: &Image, roots: &[String]) -> Result<Vec<Look>, ImageError> {
    let program = Program::new(image);
    let mut addresses = Vec::new();
    for name in roots {
        let function = program.named(name).ok_or_else(|| ImageError::NoFunction {
            name: name.clone(),
            near: near(&program, name),
        })?;
        addresses.push(function.address);
    }
    if roots.is_empty() {
        let vectors = Vectors::read(image)?;
        addresses.push(vectors.reset());
        addresses.extend(vectors.handlers().map(|(_, function)| function));
        addresses.sort_unstable();
        addresses.dedup();
    }
    let extra = |_| Extra::default();
    let mut depths = Depths::new(&program.frames, &extra);
    let looks = addresses.into_iter().map(|root| {
        let worst = depths.worst(root);
        from(&program, root, worst.bytes, !worst.open.is_empty())
    });
    Ok(looks.collect())
}

fn from(program: &Program, root: u32, stack: u32, at_least: bool) -> Look {
    let panics = |f: &Function| f.names.iter().any(|name| is_panic(name));
    let reach = Reach::new(program, root, &|_| Vec::new(), &panics);
    let name = |address: u32| {
        let function = program.functions.get(&address);
        function.map_or("?", Function::name).to_owned()
    };
    let functions: Vec<&Function> = reach
        .functions()
        .filter_map(|address| program.functions.get(&address))
        .collect();
    let paths = functions.iter().filter(|f| f.address != root && panics(f));
    let shortest = paths.map(|f| reach.path(f.address)).min_by_key(Vec::len);
    Look {
        root: name(root),
        stack,
        at_least,
        panics: shortest.map(|path| path.into_iter().map(name).collect()),
        functions: functions.iter().map(|f| row(program, f)).collect(),
    }
}

fn row(program: &Program, function: &Function) -> Row {
    Row {
        name: function.name().to_owned(),
        address: function.address,
        instructions: function.body.live().count(),
        frame: program
            .frames
            .get(&function.address)
            .map_or(0, |f| f.deepest),
        loops: function.loops.len(),
        unknown_calls: unknown_calls(function),
    }
}

/// A function whose name contains the one asked for.
fn near(program: &Program, name: &str) -> Option<String> {
    let names = program.functions.values().flat_map(|f| &f.names);
    let lower = name.to_lowercase();
    names
        .into_iter()
        .find(|n| n.to_lowercase().contains(&lower))
        .cloned()
}

/// Returns the looks as text for people.
pub fn render(looks: &[Look]) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = write(&mut text, looks);
    text
}

fn write(out: &mut String, looks: &[Look]) -> std::fmt::Result {
    for look in looks {
        let mark = if look.at_least { "≥" } else { "" };
        writeln!(out, "{}: worst stack {mark}{} bytes", look.root, look.stack)?;
        match &look.panics {
            Some(path) => writeln!(out, "  can panic: {}", path.join(" > "))?,
            None => writeln!(out, "  cannot panic, as far as its calls are known")?,
        }
        writeln!(out, "     address  instr  frame  loops  unknown calls")?;
        for row in &look.functions {
            writeln!(
                out,
                "  {:#010x} {:>6} {:>6} {:>6} {:>6}  {}",
                row.address, row.instructions, row.frame, row.loops, row.unknown_calls, row.name
            )?;
        }
        writeln!(out)?;
    }
    Ok(())
}
