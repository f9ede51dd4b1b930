//! The `[effects.…]` tables of a scene with the identified values.

use crate::brace::{Brace, Quantity};
use std::fmt::Write;

/// Returns the tables in the order of the chain. A quantity that is not visible is left out, so
/// that the scene has its default, and is named in a comment.
pub fn tables(brace: &Brace) -> String {
    let mut text = String::new();
    let mut effects: Vec<&str> = Quantity::ALL.iter().map(|q| q.effect()).collect();
    let mut seen = std::collections::HashSet::new();
    effects.retain(|effect| seen.insert(*effect));
    for effect in effects {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "[effects.{effect}]");
        for quantity in Quantity::ALL.iter().filter(|q| q.effect() == effect) {
            let spec = quantity.spec();
            let key = spec.key;
            let _ = match brace.value(*quantity) {
                Some(estimate) => writeln!(
                    text,
                    "{key} = {:.6}  # ± {:.2e} {}, 95 %",
                    estimate.value.clamp(spec.min, spec.max),
                    estimate.half_width,
                    spec.unit
                ),
                None => writeln!(text, "# {key}: not visible in the recording"),
            };
        }
        text.push('\n');
    }
    text.truncate(text.trim_end().len());
    text.push('\n');
    text
}
