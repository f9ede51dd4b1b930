//! Common parts of the reports of a run and of a recording: tables, and the
//! torque levels that are marked.

use crepitus_model::{Restart, Settings};
use crepitus_pages::report::{Section, TorqueLevels};
use crepitus_scene::run::TorqueSummary;

/// The torque levels that a report marks.
pub(crate) fn torque_levels(settings: &Settings) -> TorqueLevels {
    let p = &settings.parameters;
    let elastic = TorqueLevels::elastic(p.kinetic_torque_nm, p.static_torque_nm);
    match settings.restart {
        Restart::Elastic => elastic,
        Restart::FromKinetic => TorqueLevels {
            restart_nm: elastic.kinetic_nm,
            ..elastic
        },
    }
}

/// A torque over time.
pub(crate) fn torque_section(title: &str, t: &TorqueSummary) -> Section {
    section(
        title,
        [
            ("smallest", nm(t.min_nm)),
            ("mean", nm(t.mean_nm)),
            ("largest", nm(t.max_nm)),
            ("root mean square", nm(t.rms_nm)),
        ],
    )
}

/// A table of what is reported and its value.
pub(crate) fn section(
    title: &str,
    rows: impl IntoIterator<Item = (impl Into<String>, String)>,
) -> Section {
    Section {
        title: title.to_owned(),
        rows: rows
            .into_iter()
            .map(|(name, value)| (name.into(), value))
            .collect(),
    }
}

/// Numbers with their names: 1 break, 2 sticks.
pub(crate) fn counts(of: &[(u64, &str)]) -> String {
    let counted = of.iter().map(|(count, name)| match count {
        1 => format!("1 {name}"),
        _ => format!("{count} {name}s"),
    });
    counted.collect::<Vec<_>>().join(", ")
}

/// A torque.
pub(crate) fn nm(x: f64) -> String {
    format!("{:.5} N·m", rounded(x))
}

/// An energy.
pub(crate) fn millijoule(x: f64) -> String {
    format!("{:.5} mJ", rounded(x * 1e3))
}

/// Rounded to five digits behind the point; a zero has no sign.
fn rounded(x: f64) -> f64 {
    (x * 1e5).round() / 1e5 + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_is_not_many() {
        let text = counts(&[(0, "break"), (1, "stick"), (2, "reverse")]);
        assert_eq!(text, "0 breaks, 1 stick, 2 reverses");
    }
}
