//! Fast part of a joint's torque as the hand gets it: at each step of the chain
//! from a bare diseased knee to the device with its actuator on the shell.
//!
//! Measured is what the palm feels: its acceleration between 15 and 500 Hz, against that
//! of the same hand on a bare knee with the same joint; and the force on a shell that
//! is held, as a share of T/r. The rough estimate was linear; here the gear's friction, the
//! sampled motor and the joint's events are those of the scene.

mod chain;
mod draws;
pub mod loop_gain;
pub mod perception;
pub mod report;
mod signals;
pub mod tables;
mod words;

pub use chain::Step;
pub use draws::{Draws, SPREAD, WITHIN};

use crate::parallel::{Meter, each};
use crate::watcher::{Cancelled, Watcher};
use crepitus_plant::spectrum::cross::{Cross, Likeness};
use crepitus_scene::Scene;
use crepitus_scene::run::step_count;
use serde::Serialize;
use signals::{SettledSignals, record};

/// The band that is compared, Hz: below it the arm moves, above it one hears.
pub const BAND_HZ: (f64, f64) = (15.0, 500.0);

/// The largest lag of a comparison, s.
const MOST_LAG_S: f64 = 5e-3;

/// Share of a run that is left out at its beginning.
const SETTLES: f64 = 0.3;

/// Plan of a study.
#[derive(Clone, Debug)]
pub struct Plan {
    /// A scene for each speed: one with a hand that grips a shell with an actuator.
    pub scenes: Vec<Scene>,
    /// Draws of everything off at once; 0 for none.
    pub draws: usize,
}

/// Results of a study.
#[derive(Clone, Debug, Serialize)]
pub struct VibrationStudy {
    /// A table for each scene.
    pub speeds: Vec<AtSpeed>,
    /// Margins of the loop from the actuator to the encoder and back.
    pub margins: Vec<loop_gain::Margin>,
}

/// One speed.
#[derive(Clone, Debug, Serialize)]
pub struct AtSpeed {
    /// Title of the scene.
    pub title: String,
    /// Speed that is intended, rad/s.
    pub speed_rad_s: f64,
    /// The steps of the chain.
    pub rows: Vec<Row>,
    /// Spectra at the hand, Hz and m/s² rms in each bin: of the bare knee, of the motor
    /// alone, and with the actuator.
    pub spectrum: Vec<(f64, [f64; 3])>,
    /// Result of the draws, with everything off at once.
    pub draws: Option<Draws>,
}

/// One step of the chain.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// Step of the chain.
    pub step: Step,
    /// Measures, unless the run failed.
    #[serde(flatten)]
    pub measured: Option<Measured>,
    /// Reason why the run failed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
}

/// Measures of a step of the chain.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Measured {
    /// Acceleration of the palm in the band, m/s² rms.
    pub acceleration_m_s2: f64,
    /// Level of the acceleration above the threshold of perception, dB, known to ±10 dB.
    pub level_db: f64,
    /// Likeness to that on a bare knee whose joint shows this very torque.
    pub likeness: Option<Like>,
    /// Likeness to that on a bare knee with the same joint, whose events have their own times,
    /// as what the joint does to the leg is another.
    pub own_likeness: Option<Like>,
    /// Share of T/r that arrives at a shell that is held: of what it gets, that which
    /// has the shape of T; none for a bare knee.
    pub share: Option<f64>,
    /// Measures of the coil: current, A rms, heat, W, and the largest excursion, mm.
    pub coil: Option<Coil>,
}

/// Measures of the coil.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Coil {
    /// A rms.
    pub current_a: f64,
    /// Heat in the copper, W.
    pub power_w: f64,
    /// Largest excursion of the mass, mm.
    pub excursion_mm: f64,
}

/// Likeness of two signals in the band.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Like {
    /// Largest correlation, 1 for the same shape.
    pub correlation: f64,
    /// Lag of the device's signal at that correlation, s.
    pub lag_s: f64,
}

impl From<Likeness> for Like {
    fn from(likeness: Likeness) -> Self {
        let Likeness { correlation, lag_s } = likeness;
        Self { correlation, lag_s }
    }
}

/// Reason why a scene cannot be studied.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum VibrationError {
    /// Something that it needs is missing.
    #[error("the scene has no [effects.{missing}]: {why}")]
    Missing {
        /// Name of the missing effect.
        missing: &'static str,
        /// Reason why it is needed.
        why: &'static str,
    },
    /// The watcher cancelled it.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Runs a plan.
///
/// # Errors
/// [`VibrationError`] if a scene lacks what is compared, or the watcher cancels.
pub fn run(plan: &Plan, watcher: &mut dyn Watcher) -> Result<VibrationStudy, VibrationError> {
    for scene in &plan.scenes {
        check(scene)?;
    }
    let mut jobs = Vec::new();
    for scene in &plan.scenes {
        for step in Step::ALL {
            jobs.push(step.free(scene));
            jobs.extend(step.held(scene));
        }
        jobs.extend(draws::scenes(scene, plan.draws));
    }
    let total: f64 = jobs.iter().map(ticks).sum();
    let meter = Meter::new(total);
    let found = each(&jobs, &meter, watcher, |scene| record(scene, &meter))?;
    let mut found = found.into_iter();
    let mut speeds = Vec::new();
    for scene in &plan.scenes {
        let mut next = || {
            let none = || Err("not run".to_owned());
            found.next().unwrap_or_else(none)
        };
        let runs: Vec<_> = Step::ALL
            .into_iter()
            .map(|step| {
                let free = next();
                let held = step.held(scene).map(|_| next());
                (step, free, held)
            })
            .collect();
        let bare = runs.iter().find(|run| run.0 == Step::BareKnee);
        let bare = bare.and_then(|run| run.1.as_ref().ok());
        let rows: Vec<Row> = runs
            .iter()
            .map(|(step, free, held)| row(*step, free, held.as_ref(), bare))
            .collect();
        let device = runs.iter().find(|run| run.0 == Step::Actuator);
        let device = device.and_then(|run| run.1.as_ref().ok());
        let alone = runs.iter().find(|run| run.0 == Step::MotorAlone);
        let alone = alone.and_then(|run| run.1.as_ref().ok());
        let spectrum = spectra(bare, alone, device);
        let drawn: Vec<_> = (0..plan.draws).map(|_| next()).collect();
        speeds.push(AtSpeed {
            title: scene.title.clone(),
            speed_rad_s: scene.motion.piece(0.0).angle_and_velocity(0.0).1,
            rows,
            spectrum: spectrum.unwrap_or_default(),
            draws: (plan.draws > 0)
                .then(|| draws::judge(&drawn, device))
                .flatten(),
        });
    }
    Ok(VibrationStudy {
        speeds,
        margins: plan
            .scenes
            .first()
            .map_or_else(Vec::new, loop_gain::margins),
    })
}

/// The three spectra, if all three ran.
fn spectra(
    bare: Option<&SettledSignals>,
    alone: Option<&SettledSignals>,
    device: Option<&SettledSignals>,
) -> Option<Vec<(f64, [f64; 3])>> {
    let (bare, alone, device) = (bare?, alone?, device?);
    let lines = |x: &SettledSignals, y: &SettledSignals| {
        let cross = Cross::new(&x.acceleration, &y.acceleration, x.step_s)?;
        Some(cross.lines(BAND_HZ.1))
    };
    let both = lines(bare, device)?.into_iter().zip(lines(alone, alone)?);
    Some(
        both.map(|((hz, bare, device), (_, alone, _))| (hz, [bare, alone, device]))
            .collect(),
    )
}

fn ticks(scene: &Scene) -> f64 {
    use crepitus_model::Real;
    f64::from_whole(step_count(scene))
}

/// Rejects a scene that lacks what is compared.
fn check(scene: &Scene) -> Result<(), VibrationError> {
    for (missing, why) in [
        ("crepitus", "it is the joint's grating that is compared"),
        ("limb", "a bare knee has a leg"),
        ("shell", "the hand holds it"),
        ("reaction-mass", "it shakes the shell"),
        ("vibration-actuator", "it drives the mass"),
        ("hand", "it is what feels (with grip = \"firm\", say)"),
    ] {
        if !scene.has(missing) {
            return Err(VibrationError::Missing { missing, why });
        }
    }
    Ok(())
}

fn row(
    step: Step,
    free: &Result<SettledSignals, String>,
    held: Option<&Result<SettledSignals, String>>,
    bare: Option<&SettledSignals>,
) -> Row {
    let measured = match (free, held) {
        (Ok(free), None) => Ok(measure(free, None, bare)),
        (Ok(free), Some(Ok(held))) => Ok(measure(free, Some(held), bare)),
        (Err(why), _) | (_, Some(Err(why))) => Err(why.clone()),
    };
    let (measured, failure) = match measured {
        Ok(measured) => (Some(measured), None),
        Err(why) => (None, Some(why)),
    };
    Row {
        step,
        measured,
        failure,
    }
}

fn measure(
    free: &SettledSignals,
    held: Option<&SettledSignals>,
    bare: Option<&SettledSignals>,
) -> Measured {
    let (low, high) = BAND_HZ;
    let compared = |x: &[f64], y: &[f64]| Cross::new(x, y, free.step_s);
    let own = compared(&free.acceleration, &free.acceleration);
    let acceleration_m_s2 = own
        .as_ref()
        .map_or(f64::NAN, |c| c.rms(low, high, |_| 1.0).0);
    let above = own.map_or(f64::NAN, |c| {
        c.rms(low, high, |hz| 1.0 / perception::threshold_m_s2(hz))
            .0
    });
    let like = |bare: &[f64]| {
        let cross = compared(bare, &free.acceleration)?;
        Some(cross.likeness(low, high, MOST_LAG_S).into())
    };
    let likeness = like(&free.of_bare_knee);
    let own_likeness = bare.and_then(|bare| like(&bare.acceleration));
    let share = held.and_then(|held| {
        let cross = compared(&held.torque, &held.felt)?;
        let (wanted, got) = cross.rms(low, high, |_| 1.0);
        let like = cross.likeness(low, high, MOST_LAG_S);
        // What has the shape of T: the gear's own chatter is none of it.
        Some(like.correlation * got / wanted)
    });
    Measured {
        acceleration_m_s2,
        level_db: 20.0 * above.log10(),
        likeness,
        own_likeness,
        share,
        coil: free.coil,
    }
}
