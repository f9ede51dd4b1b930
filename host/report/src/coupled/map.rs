//! The map: of each gear and lag a panel, stiffness up, damping of the cuff to
//! the right.

use crate::palette::{self, Variable};
use crepitus_model::joint::presets::PRESETS;
use crepitus_study::coupled::{
    Cell, CoupledStudy, DAMPINGS, GEARS, LAGS, Onset, STIFFNESSES, Verdict,
};
use maud::{Markup, PreEscaped, html};

/// All in CSS pixels.
const CELL: (f64, f64) = (24.0, 11.0);
const LEFT: f64 = 58.0;
const TOP: f64 = 74.0;
/// Between panels.
const GAP: (f64, f64) = (22.0, 40.0);
const LEGEND: f64 = 92.0;

const STYLE: &str = "svg{font-family:system-ui,-apple-system,\"Segoe UI\",Roboto,\"Noto Sans\",\
sans-serif;font-size:11px}text{fill:var(--text)}.bold{font-weight:600}.soft{fill:var(--level)}\
.end{text-anchor:end}.middle{text-anchor:middle}.quiet{fill:var(--quiet)}.settles{fill:var(--settles)}\
.rings{fill:var(--rings)}.refused{fill:none}.frame{fill:none;stroke:var(--axis)}\
.criterion{stroke:var(--text);stroke-width:2;fill:none}.linear{stroke-dasharray:3 2}\
.counts{stroke-width:3.5;stroke-dasharray:1.5 4}.rubbing{stroke-width:1.2;stroke-dasharray:8 3}\
.own{stroke:var(--text);stroke-width:1;stroke-dasharray:1 2;fill:none}";

const fn colour(name: &'static str, light: &'static str, dark: &'static str) -> Named {
    Named { name, light, dark }
}

/// A colour that only this map has.
struct Named {
    name: &'static str,
    light: &'static str,
    dark: &'static str,
}

const COLOURS: [Named; 3] = [
    colour("quiet", "#d6eaf6", "#16323f"),
    colour("settles", "#82bde2", "#19566f"),
    colour("rings", "#a8320c", "#e2663a"),
];

fn variables() -> Vec<Variable> {
    COLOURS
        .iter()
        .map(|c| Variable {
            name: c.name.to_owned(),
            light: c.light,
            dark: c.dark,
        })
        .collect()
}

fn class(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Quiet => "quiet",
        Verdict::Settles => "settles",
        Verdict::Rings => "rings",
        Verdict::Refused => "refused",
    }
}

pub(super) fn svg(study: &CoupledStudy) -> Markup {
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
    html! {
        svg xmlns="http://www.w3.org/2000/svg" role="img"
            aria-label="Where the shaft stays quiet after the hand has stopped"
            viewBox=(format!("0 0 {} {}", all.0, all.1)) width=(all.0) height=(all.1) {
            style { (PreEscaped(palette::picture_style(STYLE, &variables()))) }
            rect width="100%" height="100%" fill=(palette::PAPER.hex()) {}
            text.soft x="8" y="16" { "stiffness of the rendered spring, N·m/rad, against the damping of the cuff, N·m·s/rad" }
            @for (n, lag) in LAGS.iter().enumerate() {
                text.bold x=(place(n).0) y="38" { (lag.name()) }
                text.soft x=(place(n).0) y="52" {
                    "mean lag " (format!("{:.0}", lag.mean_s() * 1e6)) " µs"
                }
            }
            @for (n, (cells, onsets)) in panels.iter().enumerate() {
                (panel(place(n), cells, onsets, n % LAGS.len() == 0))
            }
            (legend(all.1 - LEGEND + 8.0))
        }
    }
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
            text.bold x="8" y=(y0 - 6.0) { "gear’s friction: " (cell.setting.gear.name) }
        }
        @for (column, cells) in columns.enumerate() {
            @for (row, cell) in cells.iter().enumerate() {
                rect class=(class(cell.verdict))
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
        @for preset in &PRESETS {
            @let y = foot - rise(preset.parameters.stiffness_nm_per_rad) * CELL.1;
            path.own d=(format!("M{x0} {y:.1}h{}", panel_width())) { title { (preset.name) } }
        }
        @for (n, onset) in onsets.iter().enumerate() {
            @if within(onset.criteria.colgate_schenkel) {
                path.criterion d=(bar(n, onset.criteria.colgate_schenkel)) { title { "Colgate and Schenkel" } }
            }
            @if within(onset.criteria.linear) {
                path.criterion.linear d=(bar(n, onset.criteria.linear)) { title { "linear, without friction" } }
            }
            @if within(onset.criteria.abbott_okamura) {
                path.criterion.counts d=(bar(n, onset.criteria.abbott_okamura)) { title { "Abbott and Okamura" } }
            }
            @if within(onset.criteria.diolaiti) {
                path.criterion.rubbing d=(bar(n, onset.criteria.diolaiti)) { title { "Diolaiti et al." } }
            }
        }
        rect.frame x=(x0 - 0.5) y=(y0 - 0.5) width=(panel_width()) height=(panel_height()) {}
        @for stiffness in STIFFNESSES.iter().step_by(4) {
            @if is_first {
                text.end x=(x0 - 4.0) y=(foot - rise(*stiffness) * CELL.1 + 4.0) { (stiffness) }
            }
        }
        @for (n, damping) in DAMPINGS.iter().enumerate() {
            text.middle x=(x0 + (n as f64 + 0.5) * CELL.0) y=(foot + 12.0) { (damping) }
        }
    }
}

fn legend(y: f64) -> Markup {
    let entries = [
        ("quiet", "quiet: two counts or less"),
        ("settles", "settles"),
        ("rings", "rings"),
    ];
    html! {
        @for (n, (class, words)) in entries.iter().enumerate() {
            @let x = 8.0 + 190.0 * n as f64;
            rect class=(class) x=(x) y=(y) width="22" height="13" {}
            text x=(x + 28.0) y=(y + 11.0) { (words) }
        }
        path.criterion d=(format!("M8 {}h22", y + 28.0)) {}
        text x="36" y=(y + 32.0) { "b/τ, Colgate and Schenkel" }
        path.criterion.linear d=(format!("M198 {}h22", y + 28.0)) {}
        text x="226" y=(y + 32.0) { "linear, without any friction" }
        path.own d=(format!("M408 {}h22", y + 28.0)) {}
        text x="436" y=(y + 32.0) { "fine 320, coarse 400, bone-on-bone 500" }
        path.criterion.counts d=(format!("M8 {}h22", y + 49.0)) {}
        text x="36" y=(y + 53.0) { "counts, Abbott and Okamura" }
        path.criterion.rubbing d=(format!("M198 {}h22", y + 49.0)) {}
        text x="226" y=(y + 53.0) { "friction left, Diolaiti et al. (where not drawn: beyond the panel)" }
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
        for preset in &PRESETS {
            let name = format!("{} {}", preset.name, preset.parameters.stiffness_nm_per_rad);
            assert!(legend.contains(&name), "{name}");
        }
    }
}
