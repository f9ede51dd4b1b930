//! The tables of the map. Numbers read back to the same bits; what is not
//! known is `nan`.

use super::cell::Cell;
use super::setting::Setting;
use super::study::{Margin, Onset};
use crepitus_pages::table::show::fixed;
use crepitus_pages::table::{Cell as TableCell, Table};

/// `cells.csv`: one row a cell of the map.
pub fn cells(cells: &[Cell]) -> Table<'_, Cell> {
    setting(Table::of(cells), |cell| &cell.setting)
        .column("stiffness_nm_per_rad", |cell| {
            cell.setting.stiffness_nm_per_rad
        })
        .column("verdict", |cell| cell.verdict.name())
        .column("ripple_rad", |cell| cell.ripple_rad)
        .column("ripple_nm", |cell| cell.ripple_nm)
}

/// `onsets.csv`: one row a column of the map; an onset that was not found is
/// `nan`.
pub fn onsets(onsets: &[Onset]) -> Table<'_, Onset> {
    let stiffness = fixed::<0>;
    setting(Table::of(onsets), |onset| &onset.setting)
        .column("onset_nm_per_rad", |onset| match onset.measured {
            Some(measured) => measured.into(),
            None => TableCell::from(f64::NAN).shown_as(format!("> {}", stiffness(onset.most))),
        })
        .headed("measured")
        .rounded(stiffness)
        .column("most_nm_per_rad", |onset| onset.most)
        .column("colgate_schenkel_nm_per_rad", |onset| {
            onset.criteria.colgate_schenkel
        })
        .headed("Colgate–S.")
        .rounded(stiffness)
        .column("abbott_okamura_nm_per_rad", |onset| {
            onset.criteria.abbott_okamura
        })
        .column("diolaiti_nm_per_rad", |onset| onset.criteria.diolaiti)
        .headed("Diolaiti")
        .rounded(|x| format!("{x:.3e}"))
        .column("linear_nm_per_rad", |onset| onset.criteria.linear)
        .headed("linear")
        .rounded(stiffness)
}

/// `margins.csv`: presets, and the paper's joint with other effects.
pub fn margins(margins: &[Margin]) -> Table<'_, Margin> {
    setting(Table::of(margins), |margin| &margin.setting)
        .column("with", |margin| margin.setting.extra.name)
        .column("stiffness_nm_per_rad", |margin| {
            margin.setting.stiffness_nm_per_rad
        })
        .column("verdict", |margin| margin.verdict.name())
        .column("onset_over_stiffness", |margin| {
            margin.onset.unwrap_or(f64::NAN)
        })
        .column("most_over_stiffness", |margin| margin.most)
}

/// The columns of a setting.
fn setting<'r, R>(table: Table<'r, R>, of: impl Fn(&'r R) -> &'r Setting + Copy) -> Table<'r, R> {
    table
        .column("preset", move |row| of(row).preset.name)
        .people("gear’s friction", move |row| of(row).gear.name)
        .column("gear_friction_nm", move |row| of(row).gear.friction_nm)
        .column("load_loss", move |row| of(row).gear.load_loss)
        .column("friction_left_nm", move |row| of(row).gear.left_nm())
        .column("lag_s", move |row| of(row).lag.mean_s())
        .column("cuff_damping_nms_per_rad", move |row| {
            of(row).damping_nms_per_rad
        })
        .headed("cuff")
}
