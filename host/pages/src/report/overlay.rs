//! Measured curves over those of a run: the figure, and how far they are apart.
//!
//! The run has far more rows than a measurement has samples, so the run is interpolated, linearly
//! between its rows, at the times of the samples; nothing is interpolated in what was measured.

use crate::plot::number::{count, rounded};
use crate::plot::page::Section;
use crate::plot::palette::{SHAFT, TORQUE};
use crate::plot::{Axis, Chart, Figure, Key, Panel, Paper, Point, Sign, Thinned, extent, stack};
use crepitus_scene::trace::Column;
use serde::Serialize;

const HEIGHT: f64 = 240.0;
const FOOT: f64 = 45.0;

/// Bins of a line: more than a chart has pixels.
const LINE: usize = 1600;

/// Quantity that can be measured and compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Angle of the joint.
    Angle,
    /// Velocity of the joint.
    Velocity,
    /// Torque of the model.
    Torque,
    /// Torque at the hand.
    HandTorque,
    /// Torque of the motor.
    MotorTorque,
}

impl Quantity {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::Angle,
        Self::Velocity,
        Self::Torque,
        Self::HandTorque,
        Self::MotorTorque,
    ];

    /// Column of the quantity in a trace, in the units of which it is compared.
    pub fn column(self) -> &'static str {
        match self {
            Self::Angle => "angle_rad",
            Self::Velocity => "omega_rad_s",
            Self::Torque => "torque_nm",
            Self::HandTorque => "hand_torque_nm",
            Self::MotorTorque => "motor_torque_nm",
        }
    }

    fn axis(self) -> &'static str {
        match self {
            Self::Angle => "Angle (°)",
            Self::Velocity => "Speed (°/s)",
            Self::Torque => "Torque (N·m)",
            Self::HandTorque => "Hand (N·m)",
            Self::MotorTorque => "Motor (N·m)",
        }
    }

    fn words(self) -> (&'static str, &'static str) {
        match self {
            Self::Angle => ("angle", "°"),
            Self::Velocity => ("speed", "°/s"),
            Self::Torque => ("torque", "N·m"),
            Self::HandTorque => ("torque at the hand", "N·m"),
            Self::MotorTorque => ("torque of the motor", "N·m"),
        }
    }

    /// Converts a value from the units of the column to those that are shown.
    fn shown(self, value: f64) -> f64 {
        match self {
            Self::Angle | Self::Velocity => value.to_degrees(),
            _ => value,
        }
    }
}

/// A measured curve: times of the run in s, strictly increasing, and a value for each in the units
/// of the quantity's column.
#[derive(Clone, Debug)]
pub struct Measured {
    /// Measured quantity.
    pub quantity: Quantity,
    /// The times.
    pub time_s: Vec<f64>,
    /// The values.
    pub value: Vec<f64>,
}

/// Difference of a measured curve from that of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Difference {
    /// The column of the trace, which names the unit of the differences.
    pub column: &'static str,
    /// Measured samples that lie within the run.
    pub points: u64,
    /// Measured samples that do not.
    pub outside: u64,
    /// Root mean square of measured − run.
    pub rms_difference: Option<f64>,
    /// Mean of measured − run.
    pub mean_difference: Option<f64>,
    /// Pearson's correlation; none where either curve is constant.
    pub correlation: Option<f64>,
}

/// A measured curve while the run streams by.
#[derive(Debug)]
pub(crate) struct Comparison {
    measured: Measured,
    index: usize,
    /// The measured sample that is due next.
    next: usize,
    before: Option<(f64, f64)>,
    line: Thinned,
    sums: Sums,
}

impl Comparison {
    /// None where the run has no such column.
    pub(crate) fn new(measured: Measured, columns: &[Column]) -> Option<Self> {
        let name = measured.quantity.column();
        Some(Self {
            index: columns.iter().position(|column| column.name == name)?,
            measured,
            next: 0,
            before: None,
            line: Thinned::new(LINE),
            sums: Sums::default(),
        })
    }

    pub(crate) fn row(&mut self, time_s: f64, values: &[f64]) {
        let value = values.get(self.index).copied().unwrap_or(f64::NAN);
        if !(time_s.is_finite() && value.is_finite()) {
            return;
        }
        let times = &self.measured.time_s;
        while let Some(at) = times.get(self.next).filter(|at| **at <= time_s) {
            let run = match self.before {
                _ if *at == time_s => Some(value),
                Some((t, v)) if *at >= t => Some(v + (value - v) * (at - t) / (time_s - t)),
                _ => None,
            };
            if let (Some(run), Some(measured)) = (run, self.measured.value.get(self.next)) {
                self.sums.take(*measured, run);
            }
            self.next += 1;
        }
        if times.first().is_some_and(|first| *first <= time_s)
            && times.last().is_some_and(|last| time_s <= *last)
        {
            self.line.push(time_s, self.measured.quantity.shown(value));
        }
        self.before = Some((time_s, value));
    }

    /// Rows are missing: nothing is interpolated over them.
    pub(crate) fn gap(&mut self) {
        self.before = None;
    }

    fn difference(&self) -> Difference {
        let all = self.measured.time_s.len() as u64;
        let sums = &self.sums;
        let of = |x: f64| (sums.count > 0).then_some(x);
        let spread = (sums.measured_squares * sums.run_squares).sqrt();
        Difference {
            column: self.measured.quantity.column(),
            points: sums.count,
            outside: all - sums.count,
            rms_difference: of((sums.difference_squares / sums.count as f64).sqrt()),
            mean_difference: of(sums.measured_mean - sums.run_mean),
            correlation: (spread > 0.0).then(|| (sums.products / spread).clamp(-1.0, 1.0)),
        }
    }

    fn within(&self, from: f64, to: f64) -> Vec<Point> {
        let Measured {
            quantity,
            time_s,
            value,
        } = &self.measured;
        let mut line = Thinned::new(LINE);
        for (time_s, value) in time_s.iter().zip(value) {
            if (from..=to).contains(time_s) {
                line.push(*time_s, quantity.shown(*value));
            }
        }
        line.points()
    }
}

/// Means and squares about them, updated pair by pair (Welford).
#[derive(Debug, Default)]
struct Sums {
    count: u64,
    measured_mean: f64,
    run_mean: f64,
    measured_squares: f64,
    run_squares: f64,
    products: f64,
    difference_squares: f64,
}

impl Sums {
    fn take(&mut self, measured: f64, run: f64) {
        self.count += 1;
        let share = 1.0 / self.count as f64;
        let (from_measured, from_run) = (measured - self.measured_mean, run - self.run_mean);
        self.measured_mean += share * from_measured;
        self.run_mean += share * from_run;
        self.measured_squares += from_measured * (measured - self.measured_mean);
        self.run_squares += from_run * (run - self.run_mean);
        self.products += from_measured * (run - self.run_mean);
        self.difference_squares += (measured - run).powi(2);
    }
}

/// Difference of each from the run.
pub(crate) fn differences(comparisons: &[Comparison]) -> Vec<Difference> {
    comparisons.iter().map(Comparison::difference).collect()
}

/// A table for each.
pub(crate) fn sections(comparisons: &[Comparison]) -> Vec<Section> {
    comparisons.iter().map(section).collect()
}

fn section(comparison: &Comparison) -> Section {
    let quantity = comparison.measured.quantity;
    let (name, unit) = quantity.words();
    let difference = comparison.difference();
    let value = |x: Option<f64>| {
        x.map_or_else(
            || "not known".to_owned(),
            |x| format!("{} {unit}", rounded(quantity.shown(x))),
        )
    };
    let row = |name: &str, value: String| (name.to_owned(), value);
    Section {
        title: format!("Measured {name} against this run"),
        rows: vec![
            row("samples compared", count(difference.points)),
            row("samples outside the run", count(difference.outside)),
            row("RMS difference", value(difference.rms_difference)),
            row("mean of measured − run", value(difference.mean_difference)),
            row(
                "correlation",
                difference
                    .correlation
                    .map_or_else(|| "not known".to_owned(), |r| format!("{r:.4}")),
            ),
        ],
    }
}

/// One panel for each curve that has samples within the run.
pub(crate) fn figure(comparisons: &[Comparison], paper: Paper) -> Option<Figure> {
    let drawn: Vec<(&Comparison, Vec<Point>, Vec<Point>)> = comparisons
        .iter()
        .filter(|comparison| comparison.sums.count > 0)
        .map(|comparison| {
            let run = comparison.line.points();
            let (from, to) = extent(run.iter().map(|p| p.x));
            (comparison, comparison.within(from, to), run)
        })
        .collect();
    let times = drawn.iter().flat_map(|(_, _, run)| run.iter().map(|p| p.x));
    let (from, to) = extent(times);
    let last = drawn.len().checked_sub(1)?;
    let panels = drawn
        .iter()
        .enumerate()
        .map(|(i, (comparison, measured, run))| {
            let y = Axis::covering(measured.iter().chain(run).map(|p| p.y), 5);
            let height = if i == last { HEIGHT + FOOT } else { HEIGHT };
            let title = comparison.measured.quantity.axis();
            Panel::new(height, Axis::linear(from, to, 8), (title, y), |plot| {
                plot.grid();
                // Wider, so that it shows even where the two agree.
                plot.line(measured, SHAFT, 3.0);
                plot.line(run, TORQUE, 1.25);
            })
            .x_title((i == last).then_some("Time (s)"))
        });
    let svg = stack(
        paper.width(960.0),
        "Measured curves over those of the run",
        panels.collect(),
    );
    let parts: Vec<String> = drawn
        .iter()
        .map(|(comparison, ..)| words(comparison))
        .collect();
    Some(Figure {
        name: "overlay",
        title: "Measured, and this run",
        legend: vec![
            Key::new(Sign::Line(TORQUE), "this run"),
            Key::new(Sign::Line(SHAFT), "measured"),
        ],
        charts: vec![Chart::full(svg)],
        caption: format!(
            "Measured curves over those of this run, where both are known. {} The run is interpolated at the times of \
             the measured samples.",
            parts.join(" ")
        ),
    })
}

fn words(comparison: &Comparison) -> String {
    let quantity = comparison.measured.quantity;
    let (name, unit) = quantity.words();
    let difference = comparison.difference();
    let rms = difference.rms_difference.unwrap_or(f64::NAN);
    let correlation = difference
        .correlation
        .map_or_else(String::new, |r| format!(", their correlation is {r:.3}"));
    format!(
        "The {name} differs by {} {unit} RMS over {} samples{correlation}.",
        rounded(quantity.shown(rms)),
        count(difference.points)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_scene::trace::ColumnKind;

    const COLUMNS: [Column; 2] = [
        Column {
            name: "t_s",
            kind: ColumnKind::Number,
        },
        Column {
            name: "torque_nm",
            kind: ColumnKind::Number,
        },
    ];

    fn compared(time_s: Vec<f64>, value: Vec<f64>, run: impl Fn(f64) -> f64) -> Comparison {
        let quantity = Quantity::Torque;
        let measured = Measured {
            quantity,
            time_s,
            value,
        };
        let mut comparison = Comparison::new(measured, &COLUMNS).expect("a column");
        for i in 0..=1000 {
            let t = f64::from(i) * 1e-3;
            comparison.row(t, &[t, run(t)]);
        }
        comparison
    }

    #[test]
    fn the_difference_is_that_of_the_curves() {
        // A line, so that interpolation is exact; off by a constant and by a ripple.
        let time_s: Vec<f64> = (0..400)
            .map(|i| f64::from(i) * 0.002_37 + 0.000_31)
            .collect();
        let ripple = |i: usize| if i.is_multiple_of(2) { 0.3 } else { -0.3 };
        let value: Vec<f64> = time_s
            .iter()
            .enumerate()
            .map(|(i, t)| 2.0 * t + 0.1 + ripple(i))
            .collect();
        let expected = {
            // Two passes, nothing shared.
            let run: Vec<f64> = time_s.iter().map(|t| 2.0 * t).collect();
            let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
            let (m, r) = (mean(&value), mean(&run));
            let dot = |a: &[f64], am: f64, b: &[f64], bm: f64| -> f64 {
                a.iter().zip(b).map(|(a, b)| (a - am) * (b - bm)).sum()
            };
            dot(&value, m, &run, r) / (dot(&value, m, &value, m) * dot(&run, r, &run, r)).sqrt()
        };
        let found = compared(time_s, value, |t| 2.0 * t).difference();
        assert_eq!((found.points, found.outside), (400, 0));
        let near = |found: Option<f64>, expected: f64| {
            assert!(
                (found.expect("known") - expected).abs() < 1e-12,
                "{found:?} {expected}"
            );
        };
        near(found.rms_difference, (0.01_f64 + 0.09).sqrt());
        near(found.mean_difference, 0.1);
        near(found.correlation, expected);
    }

    #[test]
    fn what_is_outside_is_not_compared_and_gaps_are_not_bridged() {
        let found = compared(vec![-1.0, 0.0, 0.5, 1.0, 1.5], vec![9.0; 5], |_| 9.0).difference();
        assert_eq!((found.points, found.outside), (3, 2));
        assert_eq!((found.rms_difference, found.correlation), (Some(0.0), None));
        let quantity = Quantity::Torque;
        let measured = Measured {
            quantity,
            time_s: vec![0.5, 1.5],
            value: vec![1.0, 1.0],
        };
        let mut comparison = Comparison::new(measured, &COLUMNS).expect("a column");
        comparison.row(0.0, &[0.0, 0.0]);
        comparison.gap();
        comparison.row(1.0, &[1.0, 0.0]);
        comparison.row(2.0, &[2.0, 1.0]);
        assert_eq!(comparison.difference().points, 1);
        assert_eq!(comparison.difference().rms_difference, Some(0.5));
        let nothing = compared(vec![5.0, 6.0], vec![1.0, 1.0], |_| 0.0);
        assert_eq!(nothing.difference().rms_difference, None);
        assert!(figure(&[nothing], Paper::Screen).is_none());
    }

    #[test]
    fn a_run_without_the_column_has_nothing_to_compare() {
        let measured = Measured {
            quantity: Quantity::HandTorque,
            time_s: vec![0.0],
            value: vec![0.0],
        };
        assert!(Comparison::new(measured, &COLUMNS).is_none());
    }
}
