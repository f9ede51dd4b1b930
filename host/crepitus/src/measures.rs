//! Measures of an examination for people.

use crepitus_knee::examination::MeasureSpec;

/// A measure with its unit.
pub(crate) fn shown(spec: &MeasureSpec, value: f64) -> String {
    let digits = usize::from(spec.digits);
    let number = format!("{value:.digits$}");
    // A zero has no sign.
    let is_zero = number.bytes().all(|byte| b"-0.".contains(&byte));
    let number = if is_zero {
        number.replace('-', "")
    } else {
        number
    };
    match spec.unit {
        "" => number,
        "°" => number + "°",
        unit => format!("{number} {unit}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_knee::examination::Measure;

    #[test]
    fn numbers_have_their_digits_and_units() {
        for (measure, value, expected) in [
            (Measure::Catch, 62.4, "62°"),
            (Measure::PeakSpeed, 201.7, "202 °/s"),
            (Measure::Beats, 8.0, "8"),
            (Measure::BeatRate, 5.55, "5.5 Hz"),
            (Measure::Deficit, -0.2, "0°"),
            (Measure::Smoothness, -2.94, "-2.9"),
        ] {
            assert_eq!(shown(measure.spec(), value), expected);
        }
    }
}
