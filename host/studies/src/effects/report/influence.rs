//! Influence against cost: a sign an effect, both axes logarithmic.

use crate::effects::row::Added;
use crate::effects::{EffectsStudy, Row};
use crepitus_scene::cpu_time::CLOCK;
use crepitus_scene::run::AddedTime;

use super::{look, spots};
use crate::accuracy::report::measure::Measure;
use crepitus_pages::plot::number::rounded;
use crepitus_pages::plot::palette::TEXT;
use crepitus_pages::plot::{Anchor, Axis, Chart, Figure, Panel, Paper, Plot, extent, stack};

/// CSS pixels.
const WIDTH: f64 = 960.0;
const HEIGHT: f64 = 520.0;

/// An influence below this counts as zero, N·m.
const NOTHING_NM: f64 = 1e-7;

/// Positions of values outside the axes.
struct Floor {
    /// A cost below the timing noise, ns.
    ns: f64,
    /// An influence of zero, N·m.
    nm: f64,
}

impl Floor {
    fn place(&self, added: &Added) -> (f64, f64) {
        let ns = added.time.ns_per_step.unwrap_or(self.ns);
        (ns, added.rms_nm.max(self.nm))
    }
}

/// The figure; nothing without a variant that ran.
pub(super) fn figure(study: &EffectsStudy, paper: Paper) -> Option<Figure> {
    let rows: Vec<(&Row, &Added)> = study
        .rows
        .iter()
        .filter_map(|row| Some((row, row.added()?)))
        .filter(|(_, added)| added.time.ns_resolution.is_finite() && added.rms_nm.is_finite())
        .collect();
    if rows.is_empty() {
        return None;
    }
    let (x, y, floor) = axes(&rows);
    let lines = Measure::HeldTorque.lines().iter();
    let panel = Panel::new(HEIGHT, x, ("Influence (N·m RMS)", y), |plot| {
        draw(plot, &rows, &floor);
    })
    .x_title(Some("Cost (ns a step, on one core of this machine)"))
    .names(
        lines
            .map(|line| (line.value, line.label.to_owned()))
            .collect(),
    );
    let label = "RMS torque that each effect adds at the hand, against its cost";
    Some(Figure {
        name: "influence-and-cost",
        title: "Influence against cost",
        legend: look::legend(rows.iter().map(|(row, _)| *row)),
        charts: vec![Chart::full(stack(paper.wide(WIDTH), label, vec![panel]))],
        caption: format!(
            "Up: how much an effect changes the torque at the hand, as the RMS of the difference between the run with \
             it and the run without. Right: what it adds to a step, {CLOCK}. What stands up and to the left gives \
             much for little. A sign with an arrow to the left: the cost is below what these timings can tell; with \
             an arrow down: no influence at all. +1, +2: with the effects that need it, or that it needs."
        ),
    })
}

fn draw(plot: &mut Plot, rows: &[(&Row, &Added)], floor: &Floor) {
    plot.grid();
    for line in Measure::HeldTorque.lines() {
        plot.across(line.value);
    }
    let names: Vec<String> = rows.iter().map(|(row, _)| look::short(row)).collect();
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
        let style = look::of(row.change);
        if sign.arrow {
            plot.over.arrow_left(sign.at, style.ink);
        }
        if added.rms_nm <= floor.nm {
            plot.over.arrow_down(sign.at, style.ink);
        }
        let title = format!(
            "{}: {} N·m RMS, {}",
            row.name(),
            rounded(added.rms_nm),
            cost(&added.time)
        );
        plot.over.marker(sign.at, style, true, &title);
    }
    let places = spots::place(&signs, plot.frame());
    for (sign, at) in signs.iter().zip(places) {
        plot.over.label(at, Anchor::Start, TEXT, sign.name);
    }
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
    Axis::one_two_five(low, high)
}
