//! A swing in a table of time, angle and current, as a recording of even ticks.

use super::Arguments;
use crate::angle_table::factor;
use crate::cli::above_zero;
use crate::failure::Failure;
use crepitus_identify::brace::{Recording, Sample};
use std::path::Path;

/// Tick of such a recording, s: a step of the estimator.
const TICK_S: f64 = 5e-4;

/// Angle of its count, rad: finer than any encoder.
const RAD_PER_COUNT: f64 = 1e-6;

/// Longest interval between two rows that is bridged, s.
const LONGEST_S: f64 = 0.012;

/// Reads a table.
pub(super) fn read(file: &Path, arguments: &Arguments) -> Result<Recording, Failure> {
    let table = &arguments.table;
    table.check()?;
    factor("--nm-per-a", arguments.nm_per_a)?;
    above_zero("--nm-per-a", arguments.nm_per_a)?;
    let angles = table.angles(file)?;
    let currents = match &arguments.current {
        Some(column) => Some(table.numbers(file, &angles, &[column], ("current", "--current"))?),
        None => table
            .numbers(file, &angles, &["current_a"], ("current", "--current"))
            .ok(),
    };
    let intervals = angles.time_s.windows(2).map(|pair| pair[1] - pair[0]);
    let longest_s = intervals.fold(0.0, f64::max);
    if longest_s > LONGEST_S {
        return Err(Failure::Input(format!(
            "{}: {:.0} ms between two rows, expected {:.0} ms at most: the cuffs ring at 10 Hz and the teeth strike within \
             milliseconds; record at 200 Hz or more, better 1 kHz",
            file.display(),
            1e3 * longest_s,
            1e3 * LONGEST_S
        )));
    }
    Ok(Recording {
        samples: samples(&angles.time_s, &angles.angle_rad, currents.as_deref()),
        tick_s: TICK_S,
        rad_per_count: RAD_PER_COUNT,
        torque_constant_nm_per_a: arguments.nm_per_a,
        gear_ratio: 1.0,
    })
}

/// Samples at even ticks: a cubic through four neighbours (Catmull & Rom 1974), the current of the row before.
fn samples(time_s: &[f64], angle_rad: &[f64], current_a: Option<&[f64]>) -> Vec<Sample> {
    let mut samples = Vec::new();
    let last = time_s.len().saturating_sub(2);
    let mut row = 0;
    for tick in 0.. {
        #[expect(clippy::cast_precision_loss, reason = "ticks of a recording")]
        let now_s = tick as f64 * TICK_S;
        while row < last && time_s[row + 1] <= now_s {
            row += 1;
        }
        if now_s > time_s[row + 1] {
            break;
        }
        let slope = |at: usize| {
            let (before, after) = (at.saturating_sub(1), (at + 1).min(last + 1));
            (angle_rad[after] - angle_rad[before]) / (time_s[after] - time_s[before])
        };
        let lasts_s = time_s[row + 1] - time_s[row];
        let x = (now_s - time_s[row]) / lasts_s;
        let (from, to) = (angle_rad[row], angle_rad[row + 1]);
        let (leaves, arrives) = (lasts_s * slope(row), lasts_s * slope(row + 1));
        let angle = from
            + x * (leaves
                + x * ((3.0 * (to - from) - 2.0 * leaves - arrives)
                    + x * (2.0 * (from - to) + leaves + arrives)));
        #[expect(
            clippy::cast_possible_truncation,
            reason = "a cast from float saturates"
        )]
        let (count, current) = (
            (angle / RAD_PER_COUNT).floor() as i32,
            current_a.map(|current| current[row] as f32),
        );
        samples.push(Sample {
            tick,
            count,
            current_a: current,
            is_lost: false,
        });
    }
    samples
}
