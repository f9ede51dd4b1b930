//! Influence against cost: a sign an effect, both axes logarithmic.

use crepitus_study::effects::results::Added;
use crepitus_study::effects::{EffectsStudy, Row};

use super::{hand, spots};
use crate::ReportError;
use crate::accuracy::measure::Measure;
use crate::accuracy::overlay::{Anchor, Overlay};
use crate::axis::{Axis, extent};
use crate::canvas::{Area, Fault, Panel, svg_with};
use crate::figure::{Chart, Figure};
use crate::number::rounded;
use crate::palette::{LEVEL, TEXT};

/// CSS pixels.
const SIZE: (u32, u32) = (960, 520);
/// Room for the names of the perceptual lines at the right.
const RIGHT: u32 = 176;

/// A cost below this share of the scene's whole step is lost in the timings,
/// however quiet the machine.
const NOISE: f64 = 0.01;
/// A smaller influence than this is none, N·m.
const NOTHING_NM: f64 = 1e-7;

/// What the axes can show.
struct Floor {
    /// A cost up to this is lost in the timings, ns; where it stands.
    least_ns: f64,
    ns: f64,
    nm: f64,
}

impl Floor {
    fn hides(&self, added: &Added) -> bool {
        added.ns_per_step <= self.least_ns
    }

    fn place(&self, added: &Added) -> (f64, f64) {
        let ns = if self.hides(added) {
            self.ns
        } else {
            added.ns_per_step
        };
        (ns, added.rms_nm.max(self.nm))
    }
}

/// The figure; nothing without a variant that ran.
pub(super) fn figure(study: &EffectsStudy) -> Result<Option<Figure>, ReportError> {
    let rows: Vec<(&Row, &Added)> = study
        .rows
        .iter()
        .filter_map(|row| Some((row, row.added()?)))
        .filter(|(_, added)| added.ns_per_step.is_finite() && added.rms_nm.is_finite())
        .collect();
    if rows.is_empty() {
        return Ok(None);
    }
    let svg = svg_with(
        SIZE,
        "RMS torque that each effect adds at the hand, against its cost",
        |area| draw(area, study, &rows),
    )?;
    Ok(Some(Figure {
        name: "influence-and-cost",
        title: "Influence against cost",
        legend: hand::legend(rows.iter().map(|(row, _)| *row)),
        charts: vec![Chart {
            heading: None,
            svg,
            half: false,
        }],
        caption: format!(
            "Up: how much an effect changes the torque at the hand, as the RMS of the difference between the run with \
             it and the run without. Right: the time that it adds to a step. What stands up and to the left gives \
             much for little. A sign with an arrow to the left: no cost above {} % of the scene's step, less than these \
             timings can tell; with an arrow down: no influence at all. +1, +2: with the effects that need it, or that \
             it needs.",
            rounded(100.0 * noise(study))
        ),
    }))
}

fn draw(area: &Area, study: &EffectsStudy, rows: &[(&Row, &Added)]) -> Result<String, Fault> {
    let (x, y, floor) = axes(study, rows);
    let mut plot = Panel {
        x,
        y,
        x_title: Some("Cost (ns a step, on one core of this machine)"),
        y_title: "Influence (N·m RMS)",
        right: RIGHT,
    }
    .on(area)?;
    plot.grid()?;
    let mut over = Overlay::default();
    for line in Measure::Torque.lines() {
        plot.across(line.value, LEVEL, 5)?;
        let (x, y) = plot.at((plot.x().high(), line.value));
        over.text((x + 28, y), Anchor::Start, LEVEL, line.label);
    }
    let (left, bottom) = plot.at((plot.x().low(), plot.y().low()));
    let (right, top) = plot.at((plot.x().high(), plot.y().high()));
    let names: Vec<String> = rows.iter().map(|(row, _)| hand::short(row)).collect();
    let signs: Vec<spots::Sign<'_>> = rows
        .iter()
        .zip(&names)
        .map(|((_, added), name)| spots::Sign {
            at: plot.at(floor.place(added)),
            name,
            arrow: floor.hides(added),
        })
        .collect();
    for ((row, added), sign) in rows.iter().zip(&signs) {
        let hand = hand::of(row.change);
        if sign.arrow {
            over.arrow_left(sign.at, hand.ink);
        }
        if added.rms_nm <= floor.nm {
            over.arrow_down(sign.at, hand.ink);
        }
        let title = format!(
            "{}: {} N·m RMS, {} ns a step",
            row.name(),
            rounded(added.rms_nm),
            rounded(added.ns_per_step)
        );
        over.marker(sign.at, hand, true, &title);
    }
    for (sign, at) in signs
        .iter()
        .zip(spots::place(&signs, (left, top, right, bottom)))
    {
        over.text(at, Anchor::Start, TEXT, sign.name);
    }
    Ok(over.finish())
}

/// The share of the scene's step below which a cost is lost in the timings.
fn noise(study: &EffectsStudy) -> f64 {
    study.time_spread().max(NOISE)
}

/// Both axes, and where what is next to nothing stands on them.
fn axes(study: &EffectsStudy, rows: &[(&Row, &Added)]) -> (Axis, Axis, Floor) {
    let step_ns = study.whole().map_or(f64::NAN, |row| row.ns_per_step);
    let least_ns = if step_ns.is_finite() {
        (noise(study) * step_ns).max(1e-3)
    } else {
        1.0
    };
    let costs = rows.iter().map(|(_, a)| a.ns_per_step);
    let (least, most) = extent(costs.filter(|ns| *ns > least_ns));
    let (least, most) = if least <= most {
        (least, most)
    } else {
        (least_ns, 10.0 * least_ns)
    };
    let hidden = rows.iter().any(|(_, a)| a.ns_per_step <= least_ns);
    let floor_ns = if hidden { least / 3.0 } else { least };
    let lines = Measure::Torque.lines().iter().map(|line| line.value);
    let influences = rows.iter().map(|(_, a)| a.rms_nm);
    let (low, high) = extent(influences.filter(|nm| *nm > NOTHING_NM).chain(lines));
    let nothing = rows.iter().any(|(_, a)| a.rms_nm <= NOTHING_NM);
    let floor_nm = if nothing { low / 4.0 } else { low };
    let floor = Floor {
        least_ns,
        ns: floor_ns,
        nm: floor_nm,
    };
    (
        round(floor_ns / 1.5, most * 2.0),
        Axis::decades(floor_nm / 2.5, high * 2.0, 8),
        floor,
    )
}

/// An axis with ticks at 1, 2 and 5 where there are few decades.
fn round(low: f64, high: f64) -> Axis {
    if high / low > 300.0 {
        return Axis::decades(low, high, 6);
    }
    let marks: Vec<f64> = (-2..8)
        .flat_map(|exponent| [1.0, 2.0, 5.0].map(|m| m * 10_f64.powi(exponent)))
        .collect();
    Axis::logarithmic(low, high, &marks)
}
