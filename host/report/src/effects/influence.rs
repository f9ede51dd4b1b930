//! Influence against cost: a sign an effect, both axes logarithmic.

use crepitus_scene::cpu_time::CLOCK;
use crepitus_scene::run::AddedTime;
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

/// A smaller influence than this is none, N·m.
const NOTHING_NM: f64 = 1e-7;

/// Where stands what the axes cannot show.
struct Floor {
    /// A cost that is below what the timings can tell, ns.
    ns: f64,
    /// An influence that is none, N·m.
    nm: f64,
}

impl Floor {
    fn place(&self, added: &Added) -> (f64, f64) {
        let ns = added.time.ns_per_step.unwrap_or(self.ns);
        (ns, added.rms_nm.max(self.nm))
    }
}

/// The figure; nothing without a variant that ran.
pub(super) fn figure(study: &EffectsStudy) -> Result<Option<Figure>, ReportError> {
    let rows: Vec<(&Row, &Added)> = study
        .rows
        .iter()
        .filter_map(|row| Some((row, row.added()?)))
        .filter(|(_, added)| added.time.ns_resolution.is_finite() && added.rms_nm.is_finite())
        .collect();
    if rows.is_empty() {
        return Ok(None);
    }
    let svg = svg_with(
        SIZE,
        "RMS torque that each effect adds at the hand, against its cost",
        |area| draw(area, &rows),
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
             it and the run without. Right: what it adds to a step, {CLOCK}. What stands up and to the left gives \
             much for little. A sign with an arrow to the left: the cost is below what these timings can tell; with \
             an arrow down: no influence at all. +1, +2: with the effects that need it, or that it needs."
        ),
    }))
}

fn draw(area: &Area, rows: &[(&Row, &Added)]) -> Result<String, Fault> {
    let (x, y, floor) = axes(rows);
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
    for line in Measure::HeldTorque.lines() {
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
            arrow: added.time.is_below_resolution(),
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
            "{}: {} N·m RMS, {}",
            row.name(),
            rounded(added.rms_nm),
            cost(&added.time)
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

/// A cost in words; of one that is lost in the timings its bound.
fn cost(added: &AddedTime) -> String {
    match added.ns_per_step {
        Some(ns) => format!("{} ns a step", rounded(ns)),
        None => format!(
            "a cost below what can be measured ({} ns a step)",
            rounded(added.ns_resolution)
        ),
    }
}

/// Both axes, and where what is next to nothing stands on them.
fn axes(rows: &[(&Row, &Added)]) -> (Axis, Axis, Floor) {
    let costs = rows.iter().filter_map(|(_, a)| a.time.ns_per_step);
    let (least, most) = extent(costs);
    let (least, most) = if least <= most {
        (least, most)
    } else {
        (1.0, 10.0)
    };
    let hidden = rows.iter().any(|(_, a)| a.time.is_below_resolution());
    let floor_ns = if hidden { least / 3.0 } else { least };
    let lines = Measure::HeldTorque.lines().iter().map(|line| line.value);
    let influences = rows.iter().map(|(_, a)| a.rms_nm);
    let (low, high) = extent(influences.filter(|nm| *nm > NOTHING_NM).chain(lines));
    let nothing = rows.iter().any(|(_, a)| a.rms_nm <= NOTHING_NM);
    let floor_nm = if nothing { low / 4.0 } else { low };
    let floor = Floor {
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
