//! The torque at the hand in a run, one value a tick.

use crate::parallel::Meter;
use crepitus_model::Real;
use crepitus_scene::run::{self, FELT_COLUMN, Observer, columns};
use crepitus_scene::trace::SymptomEvent;
use crepitus_scene::{RunError, Scene, Summary};

/// Reason why a run has no result.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(super) enum Ended {
    /// `on_torque` ended the run.
    #[error("stopped early")]
    StoppedEarly,
    /// The study was cancelled.
    #[error("ended early")]
    Stopped,
    /// The run failed; the reason.
    #[error("{0}")]
    Failed(String),
}

/// A completed run.
#[derive(Debug)]
pub(super) struct Felt {
    /// Summary of the run.
    pub(super) summary: Summary,
    /// Events of the joint, and those of symptoms without the play under them.
    pub(super) events: u64,
}

/// The scene's torque at the hand and its events.
pub(super) struct WholeRun {
    pub(super) signal: Vec<f64>,
    pub(super) events: u64,
}

/// Runs a scene. `on_torque` gets the torque of each tick, N·m, and returns
/// whether to continue.
pub(super) fn hand_torque(
    scene: &Scene,
    meter: &Meter,
    on_torque: impl FnMut(f64) -> bool,
) -> Result<Felt, Ended> {
    let mut scene = scene.clone();
    scene.trace_step_s = scene.step_s();
    let mut observer = HandTorqueObserver {
        place: place(&scene),
        on_torque,
        rows: 0,
        symptom_events: 0,
        metered: 0,
        meter,
    };
    let result = run::run(&scene, &mut observer);
    // The rest of a run that ended early is done, too.
    meter.add(run::step_count(&scene).saturating_sub(observer.metered));
    let summary = result.map_err(|e| match e {
        RunError::Observer(ended) => ended,
        other => Ended::Failed(other.to_string()),
    })?;
    let of_joint = summary.events;
    let of_joint = of_joint.map_or(0, |e| e.breaks + e.sticks + e.reverses);
    Ok(Felt {
        summary,
        events: of_joint + observer.symptom_events,
    })
}

/// Index of the torque at the hand in a row, if there is one.
fn place(scene: &Scene) -> Option<usize> {
    let name = if scene.is_coupled() {
        FELT_COLUMN
    } else {
        "torque_nm"
    };
    columns(scene).iter().position(|c| c.name == name)
}

struct HandTorqueObserver<'m, F> {
    place: Option<usize>,
    on_torque: F,
    rows: u64,
    symptom_events: u64,
    /// Ticks already added to the meter.
    metered: u64,
    meter: &'m Meter,
}

impl<F: FnMut(f64) -> bool> Observer for HandTorqueObserver<'_, F> {
    type Error = Ended;

    fn row(&mut self, values: &[f64]) -> Result<(), Ended> {
        self.rows += 1;
        if self.rows == 1 {
            return Ok(());
        }
        let torque_nm = self
            .place
            .and_then(|place| values.get(place))
            .copied()
            .unwrap_or(0.0);
        if !torque_nm.is_finite() {
            let time_s = values.first().copied().unwrap_or(f64::NAN);
            return Err(Ended::Failed(format!(
                "diverged: at t = {time_s} s the torque at the hand is not finite"
            )));
        }
        if (self.on_torque)(torque_nm) {
            Ok(())
        } else {
            Err(Ended::StoppedEarly)
        }
    }

    fn symptom(&mut self, event: &SymptomEvent) -> Result<(), Ended> {
        self.symptom_events += u64::from(!event.word.is_of_play());
        Ok(())
    }

    fn progress(&mut self, _: f64) -> Result<(), Ended> {
        self.meter.add(self.rows - self.metered);
        self.metered = self.rows;
        if self.meter.is_stopped() {
            return Err(Ended::Stopped);
        }
        Ok(())
    }
}

/// Ticks of a scene as a number.
pub(super) fn ticks(scene: &Scene) -> f64 {
    f64::from_whole(run::step_count(scene))
}
