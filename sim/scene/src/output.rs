//! The files of a run: `trace.csv` and `events.csv`.

mod events_csv;
mod trace_csv;

pub use events_csv::EventsCsv;
pub use trace_csv::TraceCsv;

use crepitus_model::Phase;

/// Appends `x` with enough digits to read back the same bits.
fn push_number(line: &mut String, x: f64) {
    if x.is_finite() {
        line.push_str(ryu::Buffer::new().format_finite(x));
    } else {
        // A number that no run should show, kept visible.
        line.push_str(if x.is_nan() {
            "nan"
        } else if x > 0.0 {
            "inf"
        } else {
            "-inf"
        });
    }
}

/// Name of a phase that a trace holds as -1, 0 or +1.
fn phase_name(sign: f64) -> &'static str {
    Phase::from_sign(if sign > 0.0 {
        1
    } else if sign < 0.0 {
        -1
    } else {
        0
    })
    .name()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_back_to_the_same_bits() {
        let mut x = 1.234e-30_f64;
        for _ in 0..2000 {
            x *= -1.0371;
            let mut line = String::new();
            push_number(&mut line, x);
            assert_eq!(
                line.parse::<f64>().unwrap().to_bits(),
                x.to_bits(),
                "{line}"
            );
        }
    }
}
