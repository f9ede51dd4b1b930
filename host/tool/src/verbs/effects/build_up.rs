//! One effect after the other as a table for the terminal.

use crepitus_study::effects::build_up::{Measured, Rung};
use std::fmt::Write;

/// A line a set of effects; nothing if there is none.
pub(super) fn table(rungs: &[Rung]) -> String {
    if rungs.is_empty() {
        return String::new();
    }
    let name = |rung: &Rung| match rung.added {
        "" => "the joint alone".to_owned(),
        added => format!("and {added}"),
    };
    let width = rungs
        .iter()
        .map(|r| name(r).chars().count())
        .max()
        .unwrap_or(0);
    // Writing to a String cannot fail.
    let mut text = format!(
        "one after the other (second half of each run, torque at the hand without its slow part)\n\n\
         {:width$}  {:>15} {:>10}  {:>10}  {:>10}  {:>18}  {:>18}\n",
        "", "ripple, mN·m pp", "RMS", "lag, ms", "stick, ms", "break to break, ms", "shaft, rad/s"
    );
    for rung in rungs {
        let _ = write!(text, "{:width$}  ", name(rung));
        let _ = match (&rung.measured, &rung.failure) {
            (Some(measured), _) => writeln!(text, "{}", line(measured)),
            (None, failure) => writeln!(text, "{}", failure.as_deref().unwrap_or("did not run")),
        };
    }
    text.push('\n');
    text
}

fn line(m: &Measured) -> String {
    let none = || "–".to_owned();
    let between = match (m.shortest_s, m.longest_s) {
        (Some(low), Some(high)) => format!("{:.2} to {:.2}", 1e3 * low, 1e3 * high),
        _ => none(),
    };
    format!(
        "{:>15.1} {:>10.2}  {:>10.2}  {:>10}  {between:>18}  {:>18}",
        1e3 * m.ripple_nm,
        1e3 * m.ripple_rms_nm,
        1e3 * m.lag_s,
        m.stick_s.map_or_else(none, |s| format!("{:.2}", 1e3 * s)),
        format!("{:.3} to {:.3}", m.slowest_rad_s, m.fastest_rad_s),
    )
}
