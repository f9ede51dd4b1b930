//! Whether a shaft comes to rest.

use super::setting::{DURATION_S, Setting, TICK_S};
use crate::parallel::Meter;
use crepitus_model::control::encoder::EncoderSettings;
use crepitus_scene::run::{Observer, RunError, columns, run};
use crepitus_scene::trace::EventRecord;
use serde::Serialize;

/// Length of a window, s. The last two of a run are looked at: by then a hand's
/// own swing about its resting place has died to e⁻⁹.
const WINDOW_S: f64 = 0.5;

/// A shaft that moves by no more than this is quiet, counts of the encoder.
const QUIET_COUNTS: f64 = 2.0;

/// What moves less than this share of what it moved half a second before is
/// dying out.
const DYING: f64 = 0.7;

/// What a shaft does while the hand rests.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// It stands.
    Quiet,
    /// It moves less and less.
    Settles,
    /// It goes on, or moves more and more.
    Rings,
    /// The device does not take the joint: see
    /// [`most_rad_per_count`](crepitus_model::render::turn_back::most_rad_per_count).
    Refused,
}

impl Verdict {
    /// Name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Quiet => "quiet",
            Self::Settles => "settles",
            Self::Rings => "rings",
            Self::Refused => "refused",
        }
    }
}

/// A cell of the map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// What was run.
    pub setting: Setting,
    /// What came of it.
    pub verdict: Verdict,
    /// From the lowest to the highest angle of the shaft in the last half
    /// second, rad; NaN if refused.
    pub ripple_rad: f64,
    /// The same of the torque that the device shows, N·m.
    pub ripple_nm: f64,
}

/// Runs a cell.
///
/// # Errors
/// What a run says that could not go on; `None` if the meter was stopped.
pub(super) fn run_cell(setting: &Setting, meter: &Meter) -> Result<Option<Cell>, String> {
    let refused = Cell {
        setting: *setting,
        verdict: Verdict::Refused,
        ripple_rad: f64::NAN,
        ripple_nm: f64::NAN,
    };
    let Ok(scene) = setting.scene() else {
        meter.did(1);
        return Ok(Some(refused));
    };
    let names = columns(&scene);
    let place = |name| names.iter().position(|column| column.name == name);
    let (Some(angle), Some(torque)) = (place("angle_rad"), place("shown_nm")) else {
        return Err("a run without a device".to_owned());
    };
    let mut listener = Listener {
        meter,
        angle,
        torque,
        before: Span::default(),
        last: Span::default(),
        torque_nm: Span::default(),
    };
    match run(&scene, &mut listener) {
        Ok(_) => {}
        Err(RunError::Observer(Stopped)) => return Ok(None),
        Err(other) => return Err(other.to_string()),
    }
    meter.did(1);
    let (before, last) = (listener.before.width(), listener.last.width());
    Ok(Some(Cell {
        verdict: verdict(before, last),
        ripple_rad: last,
        ripple_nm: listener.torque_nm.width(),
        ..refused
    }))
}

/// Of what the shaft moved in the last window and in the one before, rad.
fn verdict(before_rad: f64, last_rad: f64) -> Verdict {
    if last_rad <= QUIET_COUNTS * EncoderSettings::default().rad_per_count() {
        Verdict::Quiet
    } else if last_rad < DYING * before_rad {
        Verdict::Settles
    } else {
        Verdict::Rings
    }
}

/// From the lowest to the highest.
#[derive(Clone, Copy, Debug)]
struct Span(f64, f64);

impl Default for Span {
    fn default() -> Self {
        Self(f64::INFINITY, f64::NEG_INFINITY)
    }
}

impl Span {
    fn note(&mut self, x: f64) {
        *self = Self(self.0.min(x), self.1.max(x));
    }

    fn width(&self) -> f64 {
        self.1 - self.0
    }
}

/// Watches the last two windows.
struct Listener<'a> {
    meter: &'a Meter,
    angle: usize,
    torque: usize,
    before: Span,
    last: Span,
    torque_nm: Span,
}

#[derive(Debug, thiserror::Error)]
#[error("stopped")]
struct Stopped;

impl Observer for Listener<'_> {
    type Error = Stopped;

    fn row(&mut self, values: &[f64]) -> Result<(), Stopped> {
        let (Some(time_s), Some(angle_rad), Some(torque_nm)) = (
            values.first(),
            values.get(self.angle),
            values.get(self.torque),
        ) else {
            return Ok(());
        };
        let left_s = DURATION_S - time_s + TICK_S / 2.0;
        if left_s <= WINDOW_S {
            self.last.note(*angle_rad);
            self.torque_nm.note(*torque_nm);
        } else if left_s <= 2.0 * WINDOW_S {
            self.before.note(*angle_rad);
        }
        Ok(())
    }

    fn event(&mut self, _: &EventRecord) -> Result<(), Stopped> {
        Ok(())
    }

    fn progress(&mut self, _: f64) -> Result<(), Stopped> {
        if self.meter.is_stopped() {
            return Err(Stopped);
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
        // More compensation than friction drives the leg about.
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
