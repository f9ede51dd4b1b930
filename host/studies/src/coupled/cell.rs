//! Whether a shaft comes to rest.

use super::setting::{DURATION_S, Setting, TICK_S};
use crate::parallel::Meter;
use crate::watcher::Cancelled;
use crepitus_model::control::encoder::EncoderSettings;
use crepitus_plant::Extremes;
use crepitus_scene::run::{Observer, RunError, columns, run};
use serde::Serialize;

/// Length of a window, s. The last two of a run are compared: by then a hand's
/// own swing about its resting place has decayed to e⁻⁹.
const WINDOW_S: f64 = 0.5;

/// A shaft that moves by no more than this is quiet, counts of the encoder.
const QUIET_COUNTS: f64 = 2.0;

/// A ripple below this share of that in the window before is settling.
const SETTLING: f64 = 0.7;

crepitus_model::named! {
    /// Behaviour of the shaft while the hand rests.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Verdict {
        /// A shaft at rest.
        Quiet => "quiet",
        /// A decaying oscillation.
        Settles => "settles",
        /// A sustained or growing oscillation.
        Rings => "rings",
        /// The device refuses the joint: see
        /// [`most_rad_per_count`](crepitus_model::render::turn_back::most_rad_per_count).
        Refused => "refused",
    }
}

/// A cell of the map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// Setting of the cell.
    pub setting: Setting,
    /// Verdict on the setting.
    pub verdict: Verdict,
    /// Peak-to-peak angle of the shaft in the last half second, rad; NaN if
    /// refused.
    pub ripple_rad: f64,
    /// Peak-to-peak torque of the device then, N·m.
    pub ripple_nm: f64,
}

/// Runs a cell.
///
/// # Errors
/// The error of a failed run; `Ok(None)` if the meter was stopped.
pub(super) fn run_cell(setting: &Setting, meter: &Meter) -> Result<Option<Cell>, String> {
    let refused = Cell {
        setting: *setting,
        verdict: Verdict::Refused,
        ripple_rad: f64::NAN,
        ripple_nm: f64::NAN,
    };
    let Ok(scene) = setting.scene() else {
        meter.add(1);
        return Ok(Some(refused));
    };
    let names = columns(&scene);
    let place = |name| names.iter().position(|column| column.name == name);
    let (Some(angle), Some(torque)) = (place("angle_rad"), place("shown_nm")) else {
        return Err("a run without a device".to_owned());
    };
    let mut observer = RippleObserver {
        meter,
        angle,
        torque,
        before: Extremes::default(),
        last: Extremes::default(),
        torque_nm: Extremes::default(),
    };
    match run(&scene, &mut observer) {
        Ok(_) => {}
        Err(RunError::Observer(Cancelled)) => return Ok(None),
        Err(other) => return Err(other.to_string()),
    }
    meter.add(1);
    let (before, last) = (observer.before.width(), observer.last.width());
    Ok(Some(Cell {
        verdict: verdict(before, last),
        ripple_rad: last,
        ripple_nm: observer.torque_nm.width(),
        ..refused
    }))
}

/// The verdict, from the ripple in the window before and in the last, rad.
fn verdict(before_rad: f64, last_rad: f64) -> Verdict {
    if last_rad <= QUIET_COUNTS * EncoderSettings::default().rad_per_count() {
        Verdict::Quiet
    } else if last_rad < SETTLING * before_rad {
        Verdict::Settles
    } else {
        Verdict::Rings
    }
}

/// Observes the last two windows.
struct RippleObserver<'a> {
    meter: &'a Meter,
    angle: usize,
    torque: usize,
    before: Extremes<f64>,
    last: Extremes<f64>,
    torque_nm: Extremes<f64>,
}

impl Observer for RippleObserver<'_> {
    type Error = Cancelled;

    fn row(&mut self, values: &[f64]) -> Result<(), Cancelled> {
        let (Some(time_s), Some(angle_rad), Some(torque_nm)) = (
            values.first(),
            values.get(self.angle),
            values.get(self.torque),
        ) else {
            return Ok(());
        };
        let left_s = DURATION_S - time_s + TICK_S / 2.0;
        if left_s <= WINDOW_S {
            self.last.add(*angle_rad);
            self.torque_nm.add(*torque_nm);
        } else if left_s <= 2.0 * WINDOW_S {
            self.before.add(*angle_rad);
        }
        Ok(())
    }

    fn progress(&mut self, _: f64) -> Result<(), Cancelled> {
        if self.meter.is_stopped() {
            return Err(Cancelled);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::setting::{GEARS, Lag};
    use super::*;

    fn cell(stiffness_nm_per_rad: f64, damping: f64, gear: usize) -> Cell {
        let setting = Setting {
            stiffness_nm_per_rad,
            damping_nms_per_rad: damping,
            gear: GEARS[gear],
            lag: Lag::Motor(1000.0),
            ..Setting::shipped()
        };
        run_cell(&setting, &Meter::new(1.0)).unwrap().unwrap()
    }

    #[test]
    fn the_windows_decide() {
        assert_eq!(verdict(1.0, 71e-6), Verdict::Quiet);
        assert_eq!(verdict(1.0, 0.69), Verdict::Settles);
        assert_eq!(verdict(1.0, 0.71), Verdict::Rings);
        assert_eq!(verdict(0.0, 1.0), Verdict::Rings);
    }

    #[test]
    fn dry_friction_of_the_gear_keeps_the_paper_s_joint_quiet_and_nothing_else_does() {
        let (with, without) = (cell(400.0, 0.0, 0), cell(400.0, 0.0, 5));
        assert_eq!(with.verdict, Verdict::Quiet);
        assert_eq!(without.verdict, Verdict::Rings);
        assert!(without.ripple_nm > 0.1, "{without:?}");
        // Or the damping of a cuff.
        assert_ne!(cell(400.0, 1.0, 5).verdict, Verdict::Rings);
        // Overcompensation drives the leg.
        let pushed = cell(400.0, 1.0, 3);
        assert_eq!(pushed.verdict, Verdict::Rings, "{pushed:?}");
    }

    #[test]
    fn what_the_device_refuses_is_not_run() {
        let cell = cell(3200.0, 1.0, 0);
        assert_eq!(cell.verdict, Verdict::Refused);
        assert!(cell.ripple_nm.is_nan());
    }
}
