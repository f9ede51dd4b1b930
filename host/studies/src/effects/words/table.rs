//! The study as a table for the terminal.

use crate::effects::effects_table::{cost, effects_table};
use crate::effects::variant::Change;
use crate::effects::{EffectsStudy, Row};
use crepitus_pages::table::Table;
use crepitus_pages::table::show::{UNKNOWN, fixed, milli, scaled, signed};
use crepitus_scene::cpu_time::CLOCK;

/// Effects that the scene does not have and that are listed all the same: those that would be felt most.
const OTHERS: usize = 3;

/// A line a variant.
pub(super) fn table(study: &EffectsStudy) -> String {
    format!(
        "{}: {} ticks of {} µs\n\n{}\nCosts are {CLOCK}. \"<x\": the difference is below what can be measured, \
         x ns. {}\n",
        study.title,
        study.ticks,
        micro(study.tick_s),
        effects_table(&study.rows).to_text(),
        counted(study)
    )
}

/// Sentence on what was counted.
pub(super) fn counted(study: &EffectsStudy) -> String {
    if study.loop_instructions.is_nan() {
        return "Instructions were not counted: that needs valgrind.".to_owned();
    }
    format!(
        "The loop around them, which no effect pays for, has {:.0} instructions a step.",
        study.loop_instructions
    )
}

/// The scene's effects by what the hand feels of them, then those of the others that would be felt most.
pub(super) fn short(study: &EffectsStudy) -> String {
    let rows = study.by_vibration();
    let own = rows.iter().filter(|(row, _)| row.change == Change::Without);
    let others = rows
        .iter()
        .filter(|(row, _)| row.change == Change::With)
        .take(OTHERS);
    let rows: Vec<(&Row, f64)> = own.chain(others).copied().collect();
    let vibration =
        |(row, _): &(&Row, f64)| row.ran().map_or(f64::NAN, |ran| ran.torque.vibration_nm());
    Table::of(&rows)
        .people("variant", |(row, _)| row.name())
        .people("10 to 450 Hz, mN·m RMS", vibration)
        .rounded(milli)
        .people("change", |(_, change_nm)| *change_nm)
        .rounded(scaled::<1000, 1>)
        .people("ns/step", |(row, _)| {
            row.added()
                .map_or(UNKNOWN.to_owned(), |added| cost(&added.time))
        })
        .right()
        .people("instructions", |(row, _)| {
            row.added().map_or(f64::NAN, |added| added.instructions)
        })
        .rounded(fixed::<0>)
        .people("states", |(row, _)| row.added().map(|added| added.states))
        .rounded(signed)
        .to_text()
}

/// A torque with its unit.
pub(super) fn torque(nm: f64) -> String {
    if nm >= 1.0 {
        format!("{nm:.2} N·m")
    } else {
        format!("{} mN·m", milli(nm))
    }
}

/// A step in µs, without the digits that rounding added.
fn micro(step_s: f64) -> String {
    let text = format!("{:.6}", step_s * 1e6);
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn torques_are_short() {
        for (nm, text) in [
            (0.0, "0 mN·m"),
            (1.234e-7, "1e-4 mN·m"),
            (1.234e-3, "1.23 mN·m"),
            (0.01234, "12.3 mN·m"),
            (0.5, "500.0 mN·m"),
            (12.345, "12.35 N·m"),
            (f64::NAN, "– mN·m"),
        ] {
            assert_eq!(torque(nm), text);
        }
        assert_eq!(micro(5e-5), "50");
    }
}
