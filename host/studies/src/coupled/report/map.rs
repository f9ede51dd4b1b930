//! The map: of each gear and lag a panel, stiffness up, damping of the cuff to
//! the right.

use crate::coupled::{Cell, CoupledStudy, DAMPINGS, GEARS, LAGS, Onset, STIFFNESSES, Verdict};
use crepitus_pages::plot::palette::{AXIS, Ink, LEVEL, TEXT};
use crepitus_pages::plot::{Drawing, Svg};
use crepitus_scene::preset::joints;
use maud::{Markup, html};

/// All in CSS pixels.
const CELL: (f64, f64) = (24.0, 11.0);
const LEFT: f64 = 58.0;
const TOP: f64 = 74.0;
/// Gaps between panels.
const GAP: (f64, f64) = (22.0, 40.0);
const LEGEND: f64 = 92.0;

/// Inks that only this map has.
pub(super) const INKS: [Ink; 3] = [
    Ink::new("quiet", "#d6eaf6", "#16323f"),
    Ink::new("settles", "#82bde2", "#19566f"),
    Ink::new("rings", "#a8320c", "#e2663a"),
];

/// Ink of a cell; none of one that no device takes.
fn ink(verdict: Verdict) -> Option<Ink> {
    let [quiet, settles, rings] = INKS;
    match verdict {
        Verdict::Quiet => Some(quiet),
        Verdict::Settles => Some(settles),
        Verdict::Rings => Some(rings),
        Verdict::Refused => None,
    }
}

/// Line style of a criterion.
struct Line {
    width: f64,
    dashes: Option<&'static str>,
}

const COLGATE_SCHENKEL: Line = Line {
    width: 2.0,
    dashes: None,
};
const LINEAR: Line = Line {
    width: 2.0,
    dashes: Some("3 2"),
};
const ABBOTT_OKAMURA: Line = Line {
    width: 3.5,
    dashes: Some("1.5 4"),
};
const DIOLAITI: Line = Line {
    width: 1.2,
    dashes: Some("8 3"),
};
const PRESET: Line = Line {
    width: 1.0,
    dashes: Some("1 2"),
};

impl Line {
    fn path(&self, d: &str, title: &str) -> Markup {
        html! {
            path d=(d) fill="none" stroke=(TEXT) stroke-width=(self.width) stroke-dasharray=[self.dashes] {
                @if !title.is_empty() { title { (title) } }
            }
        }
    }
}

pub(super) fn svg(study: &CoupledStudy) -> Svg {
    let (width, height) = (panel_width(), panel_height());
    let lags = LAGS.iter().fold(0.0, |n, _| n + 1.0);
    let gears = GEARS.iter().fold(0.0, |n, _| n + 1.0);
    let all = (
        LEFT + lags * (width + GAP.0),
        TOP + gears * (height + GAP.1) + LEGEND,
    );
    let columns = study.onsets.iter();
    let panels = study.cells.chunks(DAMPINGS.len() * STIFFNESSES.len());
    let panels: Vec<(&[Cell], Vec<&Onset>)> = panels
        .enumerate()
        .map(|(n, cells)| {
            let of_panel = columns.clone().skip(n * DAMPINGS.len());
            (cells, of_panel.take(DAMPINGS.len()).collect())
        })
        .collect();
    let place = |n: usize| {
        let (row, column) = (n / LAGS.len(), n % LAGS.len());
        (
            LEFT + column as f64 * (width + GAP.0),
            TOP + row as f64 * (height + GAP.1),
        )
    };
    let mut drawing = Drawing::default();
    drawing.push(&html! {
        g font-size="11" {
            text fill=(LEVEL) x="8" y="16" { "stiffness of the rendered spring, N·m/rad, against the damping of the cuff, N·m·s/rad" }
            @for (n, lag) in LAGS.iter().enumerate() {
                text font-weight="600" fill=(TEXT) x=(place(n).0) y="38" { (lag.name()) }
                text fill=(LEVEL) x=(place(n).0) y="52" {
                    "mean lag " (format!("{:.0}", lag.mean_s() * 1e6)) " µs"
                }
            }
            @for (n, (cells, onsets)) in panels.iter().enumerate() {
                (panel(place(n), cells, onsets, n % LAGS.len() == 0))
            }
            (legend(all.1 - LEGEND + 8.0))
        }
    });
    drawing.svg(
        all,
        "Where the shaft stays quiet after the hand has stopped",
    )
}

fn panel_width() -> f64 {
    DAMPINGS.len() as f64 * CELL.0
}

fn panel_height() -> f64 {
    STIFFNESSES.len() as f64 * CELL.1
}

/// Up from the foot of a panel to a stiffness, in cells.
fn rise(stiffness: f64) -> f64 {
    let [first, second, ..] = STIFFNESSES;
    let [.., last] = STIFFNESSES;
    // The steps are half an octave.
    let step = 0.5 * 2.0_f64.ln();
    debug_assert!((second / first).ln() < 2.0 * step);
    (stiffness.clamp(first / 1.2, last * 1.2) / first).ln() / step + 0.5
}

fn panel(at: (f64, f64), cells: &[Cell], onsets: &[&Onset], is_first: bool) -> Markup {
    let (x0, y0) = at;
    let foot = y0 + panel_height();
    let columns = cells.chunks(STIFFNESSES.len());
    let bar = |n: usize, stiffness: f64| {
        let x = x0 + n as f64 * CELL.0;
        let y = foot - rise(stiffness) * CELL.1;
        format!("M{x:.1} {y:.1}h{:.1}", CELL.0)
    };
    let within = |stiffness: f64| {
        let [first, ..] = STIFFNESSES;
        let [.., last] = STIFFNESSES;
        stiffness > first / 1.2 && stiffness < last * 1.2
    };
    html! {
        @if is_first && let Some(cell) = cells.first() {
            text font-weight="600" fill=(TEXT) x="8" y=(y0 - 6.0) { "gear’s friction: " (cell.setting.gear.name) }
        }
        @for (column, cells) in columns.enumerate() {
            @for (row, cell) in cells.iter().enumerate() {
                rect fill=[ink(cell.verdict)] fill-opacity=[cell.verdict.eq(&Verdict::Refused).then_some(0)]
                    x=(x0 + column as f64 * CELL.0) y=(foot - (row as f64 + 1.0) * CELL.1)
                    width=(CELL.0 - 1.0) height=(CELL.1 - 1.0) {
                    title {
                        (cell.setting.stiffness_nm_per_rad) " N·m/rad, cuff "
                        (cell.setting.damping_nms_per_rad) ": " (cell.verdict.name())
                        (format!(", {:.0} µrad, {:.0} mN·m", 1e6 * cell.ripple_rad, 1e3 * cell.ripple_nm))
                    }
                }
            }
        }
        @for preset in joints() {
            @let y = foot - rise(preset.parameters.stiffness_nm_per_rad) * CELL.1;
            (PRESET.path(&format!("M{x0} {y:.1}h{}", panel_width()), preset.name))
        }
        @for (n, onset) in onsets.iter().enumerate() {
            @if within(onset.criteria.colgate_schenkel) {
                (COLGATE_SCHENKEL.path(&bar(n, onset.criteria.colgate_schenkel), "Colgate and Schenkel"))
            }
            @if within(onset.criteria.linear) {
                (LINEAR.path(&bar(n, onset.criteria.linear), "linear, without friction"))
            }
            @if within(onset.criteria.abbott_okamura) {
                (ABBOTT_OKAMURA.path(&bar(n, onset.criteria.abbott_okamura), "Abbott and Okamura"))
            }
            @if within(onset.criteria.diolaiti) {
                (DIOLAITI.path(&bar(n, onset.criteria.diolaiti), "Diolaiti et al."))
            }
        }
        rect fill="none" stroke=(AXIS) x=(x0 - 0.5) y=(y0 - 0.5) width=(panel_width()) height=(panel_height()) {}
        @for stiffness in STIFFNESSES.iter().step_by(4) {
            @if is_first {
                text text-anchor="end" fill=(TEXT) x=(x0 - 4.0) y=(foot - rise(*stiffness) * CELL.1 + 4.0) { (stiffness) }
            }
        }
        @for (n, damping) in DAMPINGS.iter().enumerate() {
            text text-anchor="middle" fill=(TEXT) x=(x0 + (n as f64 + 0.5) * CELL.0) y=(foot + 12.0) { (damping) }
        }
    }
}

fn legend(y: f64) -> Markup {
    let patches = ["quiet: two counts or less", "settles", "rings"];
    let lines = [
        ((8.0, 28.0), COLGATE_SCHENKEL, "b/τ, Colgate and Schenkel"),
        ((198.0, 28.0), LINEAR, "linear, without any friction"),
        (
            (408.0, 28.0),
            PRESET,
            "fine 320, coarse 400, bone-on-bone 500",
        ),
        ((8.0, 49.0), ABBOTT_OKAMURA, "counts, Abbott and Okamura"),
        (
            (198.0, 49.0),
            DIOLAITI,
            "friction left, Diolaiti et al. (where not drawn: beyond the panel)",
        ),
    ];
    html! {
        @for (n, (ink, words)) in INKS.iter().zip(patches).enumerate() {
            @let x = 8.0 + 190.0 * n as f64;
            rect fill=(ink) x=(x) y=(y) width="22" height="13" {}
            text fill=(TEXT) x=(x + 28.0) y=(y + 11.0) { (words) }
        }
        @for ((x, down), line, words) in lines {
            (line.path(&format!("M{x} {}h22", y + down), ""))
            text fill=(TEXT) x=(x + 28.0) y=(y + down + 4.0) { (words) }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stiffness_of_the_map_stands_in_the_middle_of_its_cell() {
        for (n, stiffness) in STIFFNESSES.iter().enumerate() {
            assert!((rise(*stiffness) - (n as f64 + 0.5)).abs() < 0.05);
        }
    }

    #[test]
    fn the_legend_names_every_preset_with_its_stiffness() {
        let legend = legend(0.0).into_string();
        for preset in joints() {
            let name = format!("{} {}", preset.name, preset.parameters.stiffness_nm_per_rad);
            assert!(legend.contains(&name), "{name}");
        }
    }
}
