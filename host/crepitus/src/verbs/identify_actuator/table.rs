//! Identified parameters beside those in use, as a table, as JSON and as a commit.

use crate::failure::Failure;
use crepitus_identify::Estimate;
use crepitus_identify::actuator::Actuator;
use crepitus_model::render::effects::vibration_actuator::VibrationActuatorSettings;
use crepitus_pages::table::Table;
use crepitus_protocol::parameters::find;
use serde_json::{Value, json};

/// One parameter.
#[derive(Debug)]
pub(super) struct Row {
    /// Name on the device; `None` for what is no parameter.
    parameter: Option<&'static str>,
    /// Name for people.
    name: &'static str,
    unit: &'static str,
    estimate: Estimate,
    in_use: Option<f64>,
    source: &'static str,
}

/// Source of a value.
const CHIRP: &str = "chirp";
const WEIGHED: &str = "weighed";
const CHIRP_AND_WEIGHT: &str = "chirp, weight";
const BOTH_CHIRPS: &str = "both chirps";

/// All that was identified; parameters first.
pub(super) fn rows(
    found: &Actuator,
    in_use: &VibrationActuatorSettings,
    is_weighed: bool,
) -> Vec<Row> {
    let row = |parameter, name, unit, estimate, in_use, source| Row {
        parameter,
        name,
        unit,
        estimate,
        in_use,
        source,
    };
    let (mass, force) = if is_weighed {
        (WEIGHED, CHIRP_AND_WEIGHT)
    } else {
        (BOTH_CHIRPS, BOTH_CHIRPS)
    };
    let given = |parameter, unit, estimate, in_use, source| {
        row(
            Some(parameter),
            parameter,
            unit,
            estimate,
            Some(in_use),
            source,
        )
    };
    vec![
        given(
            "vibration-actuator.resonance_hz",
            "Hz",
            found.resonance_hz,
            in_use.resonance_hz,
            CHIRP,
        ),
        given(
            "vibration-actuator.damping_ratio",
            "1",
            found.damping_ratio,
            in_use.damping_ratio,
            CHIRP,
        ),
        given(
            "vibration-actuator.moving_mass_g",
            "g",
            found.moving_mass_kg.times(1e3),
            in_use.moving_mass_g,
            mass,
        ),
        given(
            "vibration-actuator.force_constant_n_per_a",
            "N/A",
            found.force_constant_n_per_a,
            in_use.force_constant_n_per_a,
            force,
        ),
        given(
            "vibration-actuator.resistance_ohm",
            "Ω",
            found.resistance_ohm,
            in_use.resistance_ohm,
            CHIRP,
        ),
        row(
            None,
            "damping ratio of the flexure alone",
            "1",
            found.mechanical_damping_ratio,
            None,
            CHIRP,
        ),
        row(
            None,
            "inductance",
            "mH",
            found.inductance_h.times(1e3),
            None,
            CHIRP,
        ),
        row(
            None,
            "delay of the measurement",
            "µs",
            found.delay_s.times(1e6),
            None,
            CHIRP,
        ),
    ]
}

/// Returns the rows as a table; `compared` says what the values of comparison are.
pub(super) fn text(rows: &[Row], compared: &str) -> String {
    Table::of(rows)
        .people("parameter", |row| row.name)
        .people("value", |row| rounded(&row.estimate))
        .right()
        .people("95 %", |row| {
            format!("± {}", significant(row.estimate.half_width, 2))
        })
        .people("unit", |row| row.unit)
        .people(compared, |row| {
            row.in_use
                .map_or_else(|| "–".to_owned(), |value| significant(value, 4))
        })
        .right()
        .people("source", |row| row.source)
        .to_text()
}

/// Further facts that people should see.
pub(super) fn facts(found: &Actuator) -> String {
    format!(
        "{:.2} V moved the mass by ±{:.2} mm; noise of the current {:.1} mA, {:.2} % of it unexplained.\n",
        found.amplitude_v,
        1e3 * found.excursion_m,
        1e3 * found.noise_a,
        100.0 * found.unexplained
    )
}

/// Returns the values of the actuator as JSON.
pub(super) fn summary(found: &Actuator, rows: &[Row], notes: &[String]) -> Value {
    let values: Vec<Value> = (rows.iter())
        .map(|row| {
            json!({
                "name": row.name,
                "parameter": row.parameter,
                "unit": row.unit,
                "value": row.estimate.value,
                "half_width": row.estimate.half_width,
                "in_use": row.in_use,
                "source": row.source,
            })
        })
        .collect();
    json!({
        "values": values,
        "amplitude_v": found.amplitude_v,
        "excursion_mm": 1e3 * found.excursion_m,
        "noise_ma": 1e3 * found.noise_a,
        "unexplained_share": found.unexplained,
        "mass_is_checked": found.mass_is_checked,
        "notes": notes,
    })
}

/// The commit: numbers of the parameters with their values.
pub(super) fn changes(rows: &[Row]) -> Result<Vec<(u8, f64)>, Failure> {
    (rows.iter())
        .filter_map(|row| Some((row.parameter?, row.estimate.value)))
        .map(|(name, value)| {
            let (id, _) = find(name)
                .ok_or_else(|| Failure::Work(format!("this program has no parameter {name}")))?;
            Ok((id, value))
        })
        .collect()
}

/// Returns the value, rounded to the second digit of its uncertainty.
fn rounded(estimate: &Estimate) -> String {
    let place = estimate.half_width.abs().log10().floor();
    if !place.is_finite() {
        return significant(estimate.value, 4);
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "0 to 9"
    )]
    let decimals = (1.0 - place).clamp(0.0, 9.0) as usize;
    format!("{:.decimals$}", estimate.value)
}

/// Returns the value with this number of significant digits.
fn significant(value: f64, digits: i32) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    #[expect(clippy::cast_possible_truncation, reason = "an exponent of ten")]
    let place = value.abs().log10().floor() as i32;
    let decimals = usize::try_from(digits - 1 - place).unwrap_or(0);
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_have_the_digits_that_are_known() {
        let shown = |value, half_width| rounded(&Estimate { value, half_width });
        assert_eq!(shown(35.01234, 0.0132), "35.012");
        assert_eq!(shown(1.799_99, 0.000_21), "1.79999");
        assert_eq!(shown(60.0, 0.6), "60.00");
        assert_eq!(shown(123.4, 25.0), "123");
        assert_eq!(shown(1.25, 0.0), "1.250");
        for (value, text) in [(0.013, "0.013"), (0.6, "0.60"), (25.3, "25"), (0.0, "0")] {
            assert_eq!(significant(value, 2), text);
        }
    }
}
