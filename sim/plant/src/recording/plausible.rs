//! Plausibility of angles: range, speed, marks of missing samples, wraps, dropouts, and titles of
//! tables that have no angles.

use super::{AngleUnit, Angles, Place, Source};
use crate::Extremes;

/// Angles of a joint that are believed without a word, in deg.
pub const JOINT_DEG: std::ops::RangeInclusive<f64> = -30.0..=180.0;

/// Speed of a joint that is believed without a word, in deg/s: a kick reaches 1700.
pub const JOINT_DEG_S: f64 = 2000.0;

/// A step from one sample to the next that is noise, whatever the speed of it, in deg.
const NOISE_DEG: f64 = 1.0;

/// Steps from one sample to the next that a counter makes where it wraps, in deg.
const WRAP_DEG: std::ops::RangeInclusive<f64> = 300.0..=400.0;

/// Longest run of samples at zero that is taken for a dropout.
const DROPOUT_SAMPLES: usize = 5;

/// Line of each row: rows that follow each other line by line need no entry of their own.
#[derive(Debug, Default)]
pub(super) struct RowLines {
    /// Index of the first row of a run, and its line.
    runs: Vec<(usize, u64)>,
}

impl RowLines {
    pub(super) fn push(&mut self, index: usize, line: u64) {
        if self.runs.is_empty() || self.at(index) != line {
            self.runs.push((index, line));
        }
    }

    pub(super) fn at(&self, index: usize) -> u64 {
        let run = self.runs.partition_point(|(first, _)| *first <= index);
        let run = run.checked_sub(1).and_then(|run| self.runs.get(run));
        run.map_or(0, |(first, line)| line + (index - first) as u64)
    }
}

/// Samples with their unit and their places.
pub(super) struct Readings<'a> {
    pub(super) source: &'a Source<'a>,
    pub(super) angles: &'a Angles,
    pub(super) unit: AngleUnit,
    pub(super) time_s: &'a [f64],
    /// The angles as they are in the file.
    pub(super) number: &'a [f64],
    pub(super) lines: &'a RowLines,
}

impl Readings<'_> {
    fn place(&self, index: usize) -> Place {
        let Source {
            path, angle_column, ..
        } = *self.source;
        Place::cell(path, self.lines.at(index), angle_column)
    }

    /// Warnings about what no joint does.
    pub(super) fn warnings(&self) -> Vec<String> {
        let marks = self.marks();
        let dropouts = self.dropouts();
        let is_odd = |index: usize| {
            let number = self.number.get(index).copied().unwrap_or_default();
            is_mark(number) || dropouts.binary_search(&index).is_ok()
        };
        let mut warnings = Vec::new();
        if let Some(&first) = marks.first() {
            warnings.push(format!(
                "{}: {} looks like a mark of a missing sample ({} in all), and is taken for an angle; leave such \
                 cells empty and write max_gap_s",
                self.place(first),
                self.number.get(first).copied().unwrap_or_default(),
                marks.len()
            ));
        }
        if let Some(&first) = dropouts.first() {
            warnings.push(format!(
                "{}: the angle drops to exactly 0 between samples far from it ({} in all); if samples were lost \
                 there, leave the cells empty and write max_gap_s",
                self.place(first),
                dropouts.len()
            ));
        }
        warnings.extend(self.range());
        warnings.extend(self.steps(&is_odd));
        warnings
    }

    /// Samples that are marks of a missing one: 999 and the like, with either sign.
    fn marks(&self) -> Vec<usize> {
        let all = self.number.iter().enumerate();
        all.filter(|(_, number)| is_mark(**number))
            .map(|(index, _)| index)
            .collect()
    }

    /// Samples of short runs at exactly zero, far from the samples on both sides.
    fn dropouts(&self) -> Vec<usize> {
        let at = |index: usize| self.number.get(index).copied();
        let deg = |number: f64| self.unit.to_deg(number);
        let (mut found, mut index) = (Vec::new(), 0);
        while let Some(number) = at(index) {
            let start = index;
            index += 1;
            if number != 0.0 {
                continue;
            }
            while at(index) == Some(0.0) {
                index += 1;
            }
            let before = start.checked_sub(1).and_then(at);
            let (Some(before), Some(after)) = (before, at(index)) else {
                continue;
            };
            if index - start > DROPOUT_SAMPLES || before * after <= 0.0 {
                continue;
            }
            // Steps just before and just after it, as a motion through zero would have.
            let own = start
                .checked_sub(2)
                .and_then(at)
                .map_or(0.0, |x| before - x);
            let next = at(index + 1).map_or(0.0, |x| x - after);
            let step = deg(own).abs().max(deg(next).abs());
            if deg(before.abs().min(after.abs())) > 4.0 * step + NOISE_DEG {
                found.extend(start..index);
            }
        }
        found
    }

    fn joint_deg(&self, number: f64) -> f64 {
        self.angles.factor * self.unit.to_deg(number) + self.angles.offset_deg
    }

    /// The farthest of the angles that are unusual.
    fn range(&self) -> Option<String> {
        let beyond = |deg: f64| (deg - JOINT_DEG.end()).max(JOINT_DEG.start() - deg);
        let (mut count, mut farthest) = (0, None);
        let mut extremes = Extremes::default();
        for (index, number) in self.number.iter().enumerate() {
            if is_mark(*number) {
                continue;
            }
            let deg = self.joint_deg(*number);
            extremes.add(deg);
            if beyond(deg) > 0.0 {
                count += 1;
                if farthest.is_none_or(|(_, most)| beyond(deg) > beyond(most)) {
                    farthest = Some((index, deg));
                }
            }
        }
        let (index, deg) = farthest?;
        let Extremes { low, high } = extremes;
        let advice = if self.unit == AngleUnit::Rad && high.abs().max(low.abs()) > 360.0 {
            "; if the file is in degrees, write unit = \"deg\""
        } else if JOINT_DEG.contains(&-low) && JOINT_DEG.contains(&-high) {
            "; where the file counts flexion as negative, write sign = -1"
        } else {
            "; check the column, the unit and offset_deg"
        };
        Some(format!(
            "{}: the joint would be at {deg:.1} deg, where {} to {} deg is usual ({count} samples beyond, this is the \
             farthest){advice}",
            self.place(index),
            JOINT_DEG.start(),
            JOINT_DEG.end()
        ))
    }

    /// The first step by a whole turn, and the fastest of the others.
    fn steps(&self, is_odd: &impl Fn(usize) -> bool) -> Vec<String> {
        let (mut wrap, mut wraps) = (None, 0);
        let (mut fastest, mut fast) = (None, 0);
        let times = self.time_s.array_windows();
        let pairs = self.number.array_windows().zip(times).enumerate();
        for (index, ([one, two], [from_s, to_s])) in pairs {
            let step = self.unit.to_deg(two - one);
            // Nearly all.
            if step.abs() < NOISE_DEG || is_odd(index) || is_odd(index + 1) {
                continue;
            }
            if WRAP_DEG.contains(&step.abs()) {
                wraps += 1;
                wrap.get_or_insert((index + 1, step));
                continue;
            }
            let deg_s = self.angles.factor * step / (to_s - from_s);
            if deg_s.abs() > JOINT_DEG_S {
                fast += 1;
                if fastest.is_none_or(|(_, most): (usize, f64)| deg_s.abs() > most.abs()) {
                    fastest = Some((index + 1, deg_s));
                }
            }
        }
        let wrap = wrap.map(|(index, step_deg)| {
            format!(
                "{}: the angle steps by {step_deg:.1} deg ({wraps} such in all): it wraps; unwrap the column",
                self.place(index)
            )
        });
        let fastest = fastest.map(|(index, deg_s)| {
            format!(
                "{}: the angle changes by {deg_s:.0} deg/s, where up to {JOINT_DEG_S} is usual ({fast} such steps, \
                 this is the fastest); check the sample",
                self.place(index)
            )
        });
        wrap.into_iter().chain(fastest).collect()
    }
}

/// Returns whether a number is one that programs write for a missing sample.
pub(super) fn is_mark(number: f64) -> bool {
    const MARKS: [f64; 6] = [999.0, 9_999.0, 99_999.0, 999_999.0, 9_999_999.0, 999.9];
    MARKS.contains(&number.abs())
}

/// Returns whether a table of this title has no angles.
pub(super) fn is_no_angle(title: &str) -> bool {
    const WHOLE: &str = "speed velocity control error positionerrors perr markererror force moment \
                         actuationforce actuationspeed actuationpower stresstermweight \
                         inversedynamicsgeneralizedforces";
    const ENDINGS: &str = "speeds velocities accelerations controls errors excitations activations forces \
                           moments powers perr actuationforce dudt markererrors";
    let bare: String = title
        .chars()
        .filter(|c| c.is_alphabetic())
        .flat_map(char::to_lowercase)
        .collect();
    WHOLE.split(' ').any(|whole| whole == bare)
        || ENDINGS.split(' ').any(|ending| bare.ends_with(ending))
}

/// Returns whether a column of this name has no angles.
pub(super) fn is_no_angle_name(name: &str) -> bool {
    const ENDINGS: &str = "/speed _speed _velocity _vel _moment _force _torque _power _acc _acceleration _u \
                           _error";
    let name = name.to_lowercase();
    ENDINGS.split(' ').any(|ending| name.ends_with(ending))
}
