//! The tables of the study.

use super::loop_gain::Margin;
use super::{Coil, Measured, Row};
use crepitus_pages::table::Table;
use crepitus_pages::table::show::{fixed, scaled};

/// The steps of the chain.
pub fn steps(rows: &[Row]) -> Table<'_, Row> {
    let measured =
        |of: fn(&Measured) -> f64| move |row: &Row| row.measured.as_ref().map_or(f64::NAN, of);
    let coil = |of: fn(&Coil) -> f64| {
        move |row: &Row| {
            let coil = row.measured.as_ref().and_then(|m| m.coil);
            coil.as_ref().map_or(f64::NAN, of)
        }
    };
    Table::of(rows)
        .people("", |row: &Row| row.step.name().to_owned())
        .remark(|row: &Row| row.failure.clone())
        .people("hand, m/s² rms", measured(|m| m.acceleration_m_s2))
        .rounded(fixed::<4>)
        .people("level, dB (±10)", measured(|m| m.level_db))
        .rounded(fixed::<1>)
        .people("of T/r, %", measured(|m| m.share.unwrap_or(f64::NAN)))
        .rounded(scaled::<100, 2>)
        .people(
            "correlation",
            measured(|m| m.likeness.map_or(f64::NAN, |l| l.correlation)),
        )
        .rounded(fixed::<3>)
        .people(
            "lag, ms",
            measured(|m| m.likeness.map_or(f64::NAN, |l| l.lag_s)),
        )
        .rounded(scaled::<1000, 2>)
        .people(
            "its own events",
            measured(|m| m.own_likeness.map_or(f64::NAN, |l| l.correlation)),
        )
        .rounded(fixed::<3>)
        .people("coil, A rms", coil(|c| c.current_a))
        .rounded(fixed::<3>)
        .people("mW", coil(|c| c.power_w))
        .rounded(scaled::<1000, 1>)
        .people("mass, mm", coil(|c| c.excursion_mm))
        .rounded(fixed::<3>)
}

/// The margins of the loop.
pub fn margins(margins: &[Margin]) -> Table<'_, Margin> {
    Table::of(margins)
        .people("hand", |m: &Margin| m.hand.to_owned())
        .people("cuff, N·m/rad", |m: &Margin| m.cuff_nm_per_rad)
        .rounded(fixed::<0>)
        .people("late, ticks", |m: &Margin| f64::from(m.late_ticks))
        .rounded(fixed::<0>)
        .people("|L| at gain 1", |m: &Margin| m.largest)
        .rounded(fixed::<3>)
        .people("stable to gain", |m: &Margin| m.stable_to)
        .rounded(fixed::<2>)
        .people("then at, Hz", |m: &Margin| m.at_hz)
        .rounded(fixed::<1>)
}
