//! The map, the presets' margins, and each effect by itself.

use super::cell::{Cell, Verdict, run_cell};
use super::criteria::Criteria;
use super::setting::{DAMPINGS, Extra, GEARS, LAGS, STIFFNESSES, Setting};
use crate::parallel::{Meter, each};
use crate::watcher::{Cancelled, Watcher};
use crepitus_model::Real;
use crepitus_scene::preset::joints;
use std::time::Instant;

/// Factors of a preset's own stiffness.
const FACTORS: [f64; 15] = [
    0.25, 0.354, 0.5, 0.707, 1.0, 1.41, 2.0, 2.83, 4.0, 5.66, 8.0, 11.3, 16.0, 22.6, 32.0,
];

/// Dampings for presets and effects, N·m·s/rad: none, and the cuff's default.
const ENDS: [f64; 2] = [0.0, 1.0];

/// The onset of ringing in a column of the map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Onset {
    /// The first cell of the column.
    pub setting: Setting,
    /// The lowest stiffness that rings, N·m/rad.
    pub measured: Option<f64>,
    /// The largest that was run.
    pub most: f64,
    /// Theory.
    pub criteria: Criteria,
}

/// Stability margin of a joint on one device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Margin {
    /// The unchanged joint.
    pub setting: Setting,
    /// Verdict on the joint.
    pub verdict: Verdict,
    /// The lowest stiffness that rings, over its own.
    pub onset: Option<f64>,
    /// The largest of those run that the device accepts.
    pub most: f64,
}

/// Results of the study.
#[derive(Clone, Debug)]
pub struct CoupledStudy {
    /// The map: of each gear, lag and damping every stiffness, in this order.
    pub cells: Vec<Cell>,
    /// Onset of each gear, lag and damping of the map, in its order.
    pub onsets: Vec<Onset>,
    /// Each preset on each gear.
    pub presets: Vec<Margin>,
    /// The paper's joint, with each effect that the map leaves out.
    pub extras: Vec<Margin>,
    /// Duration of the study, s.
    pub wall_s: f64,
}

/// Reason why a study has no result.
#[derive(Debug, thiserror::Error)]
pub enum CoupledError {
    /// The watcher cancelled it.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// A run failed.
    #[error("{0}")]
    Run(String),
}

/// Runs the study.
///
/// # Errors
/// Error of the watcher.
pub fn run(watcher: &mut dyn Watcher) -> Result<CoupledStudy, CoupledError> {
    let begun = Instant::now();
    let map = map();
    let (presets, extras) = (presets(), extras());
    let mut settings: Vec<Setting> = map.clone();
    for joint in presets.iter().chain(&extras) {
        settings.extend(stiffer(joint));
    }
    let count = u64::try_from(settings.len()).unwrap_or(u64::MAX);
    let meter = Meter::new(f64::from_whole(count));
    let ran = each(&settings, &meter, watcher, |setting| {
        run_cell(setting, &meter)
    })?;
    let mut cells = Vec::with_capacity(ran.len());
    for cell in ran {
        cells.extend(cell.map_err(CoupledError::Run)?);
    }
    let joints = cells.split_off(map.len().min(cells.len()));
    let mut margins = joints.chunks(FACTORS.len()).map(margin);
    let presets = margins.by_ref().take(presets.len()).flatten().collect();
    Ok(CoupledStudy {
        onsets: cells.chunks(STIFFNESSES.len()).filter_map(onset).collect(),
        cells,
        presets,
        extras: margins.flatten().collect(),
        wall_s: begun.elapsed().as_secs_f64(),
    })
}

fn map() -> Vec<Setting> {
    let mut settings = Vec::new();
    for gear in GEARS {
        for lag in LAGS {
            for damping_nms_per_rad in DAMPINGS {
                for stiffness_nm_per_rad in STIFFNESSES {
                    settings.push(Setting {
                        stiffness_nm_per_rad,
                        damping_nms_per_rad,
                        lag,
                        gear,
                        ..Setting::shipped()
                    });
                }
            }
        }
    }
    settings
}

fn presets() -> Vec<Setting> {
    let mut settings = Vec::new();
    for preset in joints() {
        for gear in GEARS {
            for damping_nms_per_rad in ENDS {
                settings.push(Setting {
                    preset,
                    stiffness_nm_per_rad: preset.parameters.stiffness_nm_per_rad,
                    damping_nms_per_rad,
                    gear,
                    ..Setting::shipped()
                });
            }
        }
    }
    settings
}

fn extras() -> Vec<Setting> {
    let [_, as_shipped, .., none] = GEARS;
    let mut settings = Vec::new();
    for extra in Extra::ALL {
        for gear in [as_shipped, none] {
            for damping_nms_per_rad in ENDS {
                settings.push(Setting {
                    damping_nms_per_rad,
                    gear,
                    extra,
                    ..Setting::shipped()
                });
            }
        }
    }
    settings
}

/// The joint at each factor of its stiffness.
fn stiffer(joint: &Setting) -> impl Iterator<Item = Setting> {
    let joint = *joint;
    FACTORS.into_iter().map(move |factor| Setting {
        stiffness_nm_per_rad: factor * joint.stiffness_nm_per_rad,
        ..joint
    })
}

/// The lowest stiffness that rings, and the largest that was run.
fn rings(cells: &[Cell]) -> (Option<f64>, f64) {
    let stiffness = |cell: &Cell| cell.setting.stiffness_nm_per_rad;
    let ringing = cells.iter().find(|cell| cell.verdict == Verdict::Rings);
    let run = cells.iter().filter(|c| c.verdict != Verdict::Refused);
    (
        ringing.map(stiffness),
        run.map(stiffness).fold(0.0, f64::max),
    )
}

fn onset(column: &[Cell]) -> Option<Onset> {
    let first = column.first()?;
    let (measured, most) = rings(column);
    Some(Onset {
        setting: first.setting,
        measured,
        most,
        criteria: Criteria::of(&first.setting),
    })
}

fn margin(cells: &[Cell]) -> Option<Margin> {
    let (own, _) = cells.iter().zip(FACTORS).find(|(_, f)| *f == 1.0)?;
    let (measured, most) = rings(cells);
    let stiffness = own.setting.stiffness_nm_per_rad;
    Some(Margin {
        setting: own.setting,
        verdict: own.verdict,
        onset: measured.map(|onset| onset / stiffness),
        most: most / stiffness,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cell(stiffness_nm_per_rad: f64, verdict: Verdict) -> Cell {
        Cell {
            setting: Setting {
                stiffness_nm_per_rad,
                ..Setting::shipped()
            },
            verdict,
            ripple_rad: 0.0,
            ripple_nm: 0.0,
        }
    }

    #[test]
    fn the_lowest_stiffness_that_rings_is_the_onset() {
        use Verdict::{Quiet, Refused, Rings, Settles};
        let column = [
            cell(100.0, Quiet),
            cell(200.0, Settles),
            cell(400.0, Rings),
            cell(800.0, Quiet),
            cell(1600.0, Refused),
        ];
        let onset = onset(&column).unwrap();
        assert_eq!((onset.measured, onset.most), (Some(400.0), 800.0));
        let none = [cell(100.0, Quiet), cell(200.0, Refused)];
        assert_eq!(rings(&none), (None, 100.0));
        let joint: Vec<Cell> = FACTORS
            .map(|f| cell(400.0 * f, if f > 3.0 { Rings } else { Quiet }))
            .into();
        let margin = margin(&joint).unwrap();
        assert_eq!((margin.onset, margin.verdict), (Some(4.0), Quiet));
        assert_eq!(margin.most, 32.0);
    }

    #[test]
    fn each_joint_is_run_at_every_factor() {
        let settings = presets();
        assert_eq!(settings.len(), joints().len() * GEARS.len() * ENDS.len());
        assert_eq!(stiffer(&settings[0]).count(), FACTORS.len());
        assert!(FACTORS.contains(&1.0));
        let scenes: Vec<_> = Extra::ALL
            .map(|extra| {
                Setting {
                    extra,
                    ..Setting::shipped()
                }
                .scene()
            })
            .into();
        assert!(scenes.iter().all(Result::is_ok), "{scenes:?}");
    }
}
