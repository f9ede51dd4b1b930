//! The files: numbers read back to the same bits; what is not known is `nan`.

use super::cell::Cell;
use super::setting::Setting;
use super::study::{CoupledStudy, Margin};
use std::fmt::Write;

const SETTING: &str =
    "preset,gear_friction_nm,load_loss,friction_left_nm,lag_s,cuff_damping_nms_per_rad";

/// `cells.csv`: one row a cell of the map.
pub fn cells(cells: &[Cell]) -> String {
    let mut text = format!("{SETTING},stiffness_nm_per_rad,verdict,ripple_rad,ripple_nm\n");
    for cell in cells {
        setting(&mut text, &cell.setting);
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            ",{},{},{},{}",
            number(cell.setting.stiffness_nm_per_rad),
            cell.verdict.name(),
            number(cell.ripple_rad),
            number(cell.ripple_nm)
        );
    }
    text
}

/// `onsets.csv`: one row a column of the map; an onset that was not found is
/// `nan`.
pub fn onsets(study: &CoupledStudy) -> String {
    let mut text = format!(
        "{SETTING},onset_nm_per_rad,most_nm_per_rad,colgate_schenkel_nm_per_rad,\
         abbott_okamura_nm_per_rad,diolaiti_nm_per_rad,linear_nm_per_rad\n"
    );
    for onset in &study.onsets {
        setting(&mut text, &onset.setting);
        let of = &onset.criteria;
        for value in [
            onset.measured.unwrap_or(f64::NAN),
            onset.most,
            of.colgate_schenkel,
            of.abbott_okamura,
            of.diolaiti,
            of.linear,
        ] {
            text.push(',');
            text.push_str(&number(value));
        }
        text.push('\n');
    }
    text
}

/// `margins.csv`: presets, and the paper's joint with other effects.
pub fn margins(study: &CoupledStudy) -> String {
    let mut text = format!(
        "{SETTING},with,stiffness_nm_per_rad,verdict,onset_over_stiffness,most_over_stiffness\n"
    );
    for Margin {
        setting: at,
        verdict,
        onset,
        most,
    } in study.presets.iter().chain(&study.extras)
    {
        setting(&mut text, at);
        let _ = writeln!(
            text,
            ",{},{},{},{},{}",
            at.extra.name,
            number(at.stiffness_nm_per_rad),
            verdict.name(),
            number(onset.unwrap_or(f64::NAN)),
            number(*most)
        );
    }
    text
}

fn setting(text: &mut String, at: &Setting) {
    text.push_str(at.preset.name);
    for value in [
        at.gear.friction_nm,
        at.gear.load_loss,
        at.gear.left_nm(),
        at.lag.mean_s(),
        at.damping_nms_per_rad,
    ] {
        text.push(',');
        text.push_str(&number(value));
    }
}

fn number(x: f64) -> String {
    if x.is_finite() {
        ryu::Buffer::new().format_finite(x).to_owned()
    } else if x.is_nan() {
        "nan".to_owned()
    } else {
        "inf".to_owned()
    }
}
