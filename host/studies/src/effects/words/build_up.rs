//! One effect after the other as a table for the terminal.

use crate::effects::build_up::{Measured, Rung};
use crepitus_pages::table::Table;
use crepitus_pages::table::show::{UNKNOWN, fixed, scaled};

/// A line a set of effects; nothing if there is none.
pub(super) fn table(rungs: &[Rung]) -> String {
    if rungs.is_empty() {
        return String::new();
    }
    let measured =
        |of: fn(&Measured) -> f64| move |rung: &Rung| rung.measured.as_ref().map_or(f64::NAN, of);
    let range = |of: fn(&Measured) -> Option<String>| {
        move |rung: &Rung| {
            let text = rung.measured.as_ref().and_then(of);
            text.unwrap_or_else(|| UNKNOWN.to_owned())
        }
    };
    let table = Table::of(rungs)
        .people("", |rung| match rung.added {
            "" => "the joint alone".to_owned(),
            added => format!("and {added}"),
        })
        .remark(|rung| match (&rung.measured, &rung.failure) {
            (Some(_), _) => None,
            (None, why) => Some(why.clone().unwrap_or_else(|| "did not run".to_owned())),
        })
        .people("ripple, mN·m pp", measured(|m| m.ripple_nm))
        .rounded(scaled::<1000, 1>)
        .people("RMS", measured(|m| m.ripple_rms_nm))
        .rounded(scaled::<1000, 2>)
        .people("lag, ms", measured(|m| m.lag_s))
        .rounded(scaled::<1000, 2>)
        .people("stick, ms", measured(|m| m.stick_s.unwrap_or(f64::NAN)))
        .rounded(scaled::<1000, 2>)
        .people(
            "break to break, ms",
            range(|m| {
                let (low, high) = m.shortest_s.zip(m.longest_s)?;
                Some(format!("{:.2} to {:.2}", 1e3 * low, 1e3 * high))
            }),
        )
        .right()
        .people(
            "shaft, rad/s",
            range(|m| {
                let (low, high) = (fixed::<3>(m.slowest_rad_s), fixed::<3>(m.fastest_rad_s));
                Some(format!("{low} to {high}"))
            }),
        )
        .right();
    format!(
        "one after the other (second half of each run, torque at the hand without its slow part)\n\n{}\n",
        table.to_text()
    )
}
