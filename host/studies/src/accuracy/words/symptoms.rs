//! The symptoms besides crepitus, as a table for the terminal and for a page of the
//! book.

use crate::accuracy::symptoms::SymptomPoint;
use crate::accuracy::symptoms::table::precisions_table;
use crate::accuracy::target::inputs::TICK_S;
use crepitus_pages::table::show::microseconds;
use crepitus_scene::scene::Precision;

/// Table of the symptoms at the device's tick, or the studied step that is nearest to it.
pub(super) fn table(points: &[SymptomPoint]) -> String {
    let away = |h: f64| (h / TICK_S).ln().abs();
    let steps = points.iter().map(|p| p.step_s);
    let Some(step_s) = steps.min_by(|a, b| away(*a).total_cmp(&away(*b))) else {
        return String::new();
    };
    let here = || points.iter().filter(|p| p.step_s == step_s);
    let double_of = |single: &SymptomPoint| {
        here().find(|p| {
            p.precision == Precision::F64.name()
                && (p.symptom, p.form) == (single.symptom, single.form)
        })
    };
    let single = here().filter(|p| p.precision == Precision::F32.name());
    let rows: Vec<_> = single.map(|p| (p, double_of(p))).collect();
    format!(
        "The other symptoms at a step of {}, against the reference:\n\n{}",
        microseconds(step_s),
        precisions_table(&rows).to_markdown()
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::symptoms::{SymptomPlan, points};
    use crate::{Cancelled, Watcher};

    fn point(
        form: Option<&'static str>,
        precision: &'static str,
        step_s: f64,
        unmatched: u64,
    ) -> SymptomPoint {
        SymptomPoint {
            symptom: "cogwheel",
            form,
            precision,
            step_s,
            events: 40,
            events_true: 40,
            unmatched,
            max_event_error_s: 1.5e-8,
            rms_event_error_s: 1e-9,
            max_tick_torque_error_nm: 2.5e-6,
            rms_tick_torque_error_nm: 3e-7,
            ns_per_step: 12.5,
            time_ratio: 6.25,
            time_spread: 0.01,
        }
    }

    /// Nobody waits for it.
    struct Alone;

    impl Watcher for Alone {
        fn progress(&mut self, _: f64) -> Result<(), Cancelled> {
            Ok(())
        }
    }

    /// All of a line but its last cell, which is a time.
    #[test]
    fn the_book_has_the_errors() {
        let plan = SymptomPlan {
            steps_s: &[TICK_S],
            precisions: &[Precision::F32, Precision::F64],
            repeats: 1,
        };
        let table = table(&points(&plan, &mut Alone).unwrap());
        let book = include_str!("../../../../../docs/accuracy.md");
        let lines: Vec<&str> = table
            .lines()
            .filter(|line| line.starts_with("| "))
            .skip(1)
            .collect();
        assert!(lines.len() >= 10, "{table}");
        for line in lines {
            let (errors, _) = line.trim_end_matches(" |").rsplit_once(" | ").unwrap();
            assert!(
                book.contains(errors),
                "docs/figures.sh makes it again: {line}"
            );
        }
    }

    #[test]
    fn a_line_has_both_precisions_at_the_tick() {
        let text = table(&[
            point(Some("time"), "f64", 1e-3, 0),
            point(Some("time"), "f64", 5e-5, 0),
            point(Some("time"), "f32", 5e-5, 2),
            point(Some("space"), "f32", 5e-5, 0),
        ]);
        assert!(text.contains("at a step of 50 µs"), "{text}");
        let lines: Vec<&str> = text.lines().filter(|l| l.starts_with('|')).collect();
        assert_eq!(lines.len(), 4, "{text}");
        assert_eq!(
            lines[2],
            "| cogwheel (time) | 40 | 1.5e-8 | 2.5e-6 | 3.0e-7 | 2 unmatched | 2.5e-6 | 3.0e-7 | 6.2 |"
        );
        assert!(lines[3].contains("| – | – | – | 1.5e-8 |"), "{text}");
        assert_eq!(table(&[]), "");
    }
}
