//! All instructions of an image, in the order of their addresses.
//!
//! Mapping symbols mark instructions, literals and jump tables, so a linear
//! sweep stays aligned.

use crate::image::decode::{Flow, Instruction, decode, is_wide, it_block};
use crate::image::elf::{Content, Image, Section};

/// Decodes every stretch of code.
pub fn sweep(image: &Image) -> Vec<Instruction> {
    let mut instructions = Vec::new();
    for section in image.sections.iter().filter(|s| s.executable) {
        let marks = image.mapping.range(section.address..section.end());
        let starts: Vec<(u32, Content)> = marks.map(|(&at, &content)| (at, content)).collect();
        for (n, &(from, content)) in starts.iter().enumerate() {
            let to = starts.get(n + 1).map_or(section.end(), |&(at, _)| at);
            if content == Content::Code {
                stretch(section, from, to, &mut instructions);
            }
        }
    }
    instructions.sort_by_key(|it| it.address);
    instructions
}

fn stretch(section: &Section, from: u32, to: u32, instructions: &mut Vec<Instruction>) {
    let mut address = from;
    let mut conditional = 0;
    while address < to {
        let Some(first) = section.half(address) else {
            return;
        };
        let second = is_wide(first).then(|| section.half(address + 2)).flatten();
        let mut it = decode(address, first, second);
        if conditional > 0 {
            conditional -= 1;
            it.conditional = true;
            if let Flow::Jump(target) = it.flow {
                it.flow = Flow::Branch(target);
            }
        } else {
            conditional = it_block(first);
        }
        address = it.end();
        instructions.push(it);
    }
}
