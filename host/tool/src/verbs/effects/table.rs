//! The study as a table for the terminal.

use crepitus_scene::cpu_time::CLOCK;
use crepitus_study::effects::EffectsStudy;
use crepitus_study::effects::effects_table::effects_table;
use crepitus_table::show::milli;

/// A line a variant.
pub(super) fn table(study: &EffectsStudy) -> String {
    format!(
        "{}: {} ticks of {} µs\n\n{}\nCosts are {CLOCK}. \"<x\": the difference is below what can be measured, \
         x ns.\n",
        study.title,
        study.ticks,
        micro(study.tick_s),
        effects_table(&study.rows).to_text()
    )
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
