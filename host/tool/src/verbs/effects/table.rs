//! The study as a table for the terminal.

use crepitus_scene::cpu_time::CLOCK;
use crepitus_scene::run::AddedTime;
use crepitus_study::effects::{EffectsStudy, Row};
use std::fmt::Write;

/// A line a variant.
pub(super) fn table(study: &EffectsStudy) -> String {
    let names: Vec<String> = study.rows.iter().map(Row::name).collect();
    let width = names.iter().map(|n| n.chars().count()).max().unwrap_or(0);
    // Writing to a String cannot fail.
    let mut text = format!(
        "{}: {} ticks of {} µs\n\n",
        study.title,
        study.ticks,
        micro(study.tick_s)
    );
    let _ = writeln!(
        text,
        "{:width$}  {:^24}  {:^45}  {:^25}",
        "",
        "the effect adds, mN·m",
        "the hand then feels, mN·m RMS, and in bands",
        "what that costs"
    );
    let _ = writeln!(
        text,
        "{:width$}  {:>8} {:>8} {:>6}  {:>8} {:>8} {:>9} {:>10} {:>6}  {:>11} {:>6} {:>6}",
        "variant",
        "RMS",
        "peak",
        "events",
        "in all",
        "10–50 Hz",
        "50–250 Hz",
        "250–450 Hz",
        "events",
        "ns per step",
        "added",
        "states",
    );
    for (row, name) in study.rows.iter().zip(&names) {
        let _ = write!(text, "{name:width$}  ");
        let _ = match row.ran() {
            None => writeln!(text, "{}", row.failure().unwrap_or("did not run")),
            Some(ran) => {
                let [low, middle, high] = ran.torque.bands_nm.map(milli);
                let added = row.added();
                let cell = |cell: Option<String>| cell.unwrap_or_default();
                writeln!(
                    text,
                    "{:>8} {:>8} {:>6}  {:>8} {low:>8} {middle:>9} {high:>10} {:>6}  {:>11.0} {:>6} {:>6}",
                    cell(added.map(|a| milli(a.rms_nm))),
                    cell(added.map(|a| milli(a.peak_nm))),
                    cell(added.map(|a| signed(a.events))),
                    milli(ran.torque.rms_nm),
                    ran.events,
                    row.ns_per_step,
                    cell(added.map(|a| cost(&a.time))),
                    cell(Some(match added {
                        Some(a) => signed(a.states),
                        None => row.states.to_string(),
                    })),
                )
            }
        };
    }
    let _ = writeln!(
        text,
        "\nCosts are {CLOCK}. \"<x\": the difference is below what can be measured, x ns."
    );
    text
}

/// What an effect adds to a step, ns; of a cost that is lost in the timings
/// its bound.
fn cost(added: &AddedTime) -> String {
    match added.ns_per_step {
        Some(ns) => format!("+{ns:.0}"),
        None if added.is_below_resolution() => format!("<{:.0}", added.ns_resolution.ceil()),
        None => "–".to_owned(),
    }
}

/// A torque in mN·m.
fn milli(nm: f64) -> String {
    let x = 1e3 * nm;
    if x.is_nan() {
        "–".to_owned()
    } else if x == 0.0 {
        "0".to_owned()
    } else if x < 0.0095 {
        format!("{x:.0e}")
    } else if x < 10.0 {
        format!("{x:.2}")
    } else if x < 1000.0 {
        format!("{x:.1}")
    } else {
        format!("{x:.0}")
    }
}

fn signed(n: i64) -> String {
    if n == 0 {
        "0".to_owned()
    } else {
        format!("{n:+}")
    }
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
    fn a_cost_is_never_negative() {
        let text = |ns_per_step, ns_resolution| {
            cost(&AddedTime {
                ns_per_step,
                ns_resolution,
            })
        };
        assert_eq!(text(Some(12.4), 1.0), "+12");
        assert_eq!(text(None, 2.3), "<3");
        assert_eq!(text(None, f64::NAN), "–");
    }

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
        assert_eq!(milli(3.0), "3000");
        assert_eq!((signed(-3), signed(0)), ("-3".to_owned(), "0".to_owned()));
        assert_eq!(micro(5e-5), "50");
    }
}
