//! A swing in a table of time, angle and current, as a recording of even ticks.

use super::angle_table::AngleColumns;
use super::columns::Columns;
use super::{FileError, above_zero, refused};
use crate::brace::{Recording, Sample};
use std::path::Path;

/// Tick of such a recording, s: a step of the estimator.
const TICK_S: f64 = 5e-4;

/// Angle of its count, rad: finer than any encoder.
const RAD_PER_COUNT: f64 = 1e-6;

/// Longest table, s.
const MOST_S: f64 = 600.0;

/// Longest interval between two rows that is bridged, s.
const LONGEST_S: f64 = 0.012;

/// Angle and current of a swing in a table. Errors name what to give as the program's options.
#[derive(Clone, Debug)]
pub struct SwingColumns {
    /// Columns of time and angle.
    pub table: AngleColumns,
    /// Column of the motor's current, A; found by its name if it is left out.
    pub current: Option<String>,
    /// Torque at the joint per ampere without losses, N·m/A: torque constant times gear ratio.
    pub nm_per_a: f64,
}

/// Torque at the joint per ampere of the reference brace, N·m/A.
pub const NM_PER_A: f64 = 3.3454;

/// Reads a table.
pub(super) fn read(
    file: &Path,
    columns: &SwingColumns,
    warn: &mut dyn FnMut(&str),
) -> Result<Recording, FileError> {
    let table = &columns.table;
    table.check()?;
    above_zero("--nm-per-a", columns.nm_per_a)?;
    let named = Columns::of(file)?;
    let angles = table.angles(file, &named, warn)?;
    // Without a column the motor was off.
    let current = named.find(
        columns.current.as_deref(),
        &["current", "current a"],
        ("currents", "--current"),
    );
    let currents = current.map(|column| angles.numbers(file, &column.name, "current"));
    let currents = currents.ok().transpose()?;
    let intervals = angles.time_s.windows(2).map(|pair| pair[1] - pair[0]);
    let longest_s = intervals.fold(0.0, f64::max);
    if longest_s > LONGEST_S {
        return Err(refused(format!(
            "{}: {:.0} ms between two rows, expected {:.0} ms at most: the cuffs ring at 10 Hz and the teeth strike within \
             milliseconds; record at 200 Hz or more, better 1 kHz",
            file.display(),
            1e3 * longest_s,
            1e3 * LONGEST_S
        )));
    }
    let lasts_s = angles.time_s.last().copied().unwrap_or(0.0);
    if lasts_s > MOST_S {
        return Err(refused(format!(
            "{}: {lasts_s:.0} s, expected {MOST_S:.0} s at most: cut out the releases; is the unit of the times right \
             (--time-unit)?",
            file.display()
        )));
    }
    Ok(Recording {
        samples: samples(&angles.time_s, &angles.angle_rad, currents.as_deref()),
        tick_s: TICK_S,
        rad_per_count: RAD_PER_COUNT,
        torque_constant_nm_per_a: columns.nm_per_a,
        gear_ratio: 1.0,
    })
}

/// Samples at even ticks: a cubic through four neighbours (Catmull & Rom 1974), the current of the row before.
fn samples(time_s: &[f64], angle_rad: &[f64], current_a: Option<&[f64]>) -> Vec<Sample> {
    let mut samples = Vec::new();
    let last = time_s.len().saturating_sub(2);
    let mut row = 0;
    for tick in 0.. {
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
