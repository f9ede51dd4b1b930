//! A run as the hand feels it: one torque a tick.

use crate::parallel::Meter;
use crepitus_model::Real;
use crepitus_scene::run::{self, FELT_COLUMN, Observer, columns};
use crepitus_scene::trace::EventRecord;
use crepitus_scene::{RunError, Scene, Summary};

/// Why a run has no result.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(super) enum Ended {
    /// Whoever listens has heard enough.
    #[error("heard enough")]
    Enough,
    /// The study ends.
    #[error("ended early")]
    Stopped,
    /// It failed, and why.
    #[error("{0}")]
    Failed(String),
}

/// Runs a scene. `hear` gets the torque of each tick, N·m, and may have heard
/// enough.
pub(super) fn feel(
    scene: &Scene,
    meter: &Meter,
    hear: impl FnMut(f64) -> bool,
) -> Result<Summary, Ended> {
    let mut scene = scene.clone();
    scene.trace_step_s = scene.step_s();
    let mut ear = Ear {
        place: place(&scene),
        hear,
        rows: 0,
        metered: 0,
        meter,
    };
    let result = run::run(&scene, &mut ear);
    // What is left of a run that ended early is done, too.
    meter.did(run::step_count(&scene).saturating_sub(ear.metered));
    result.map_err(|e| match e {
        RunError::Observer(ended) => ended,
        other => Ended::Failed(other.to_string()),
    })
}

/// Events of a run; none without a joint.
pub(super) fn events(summary: &Summary) -> u64 {
    summary
        .events
        .map_or(0, |e| e.breaks + e.sticks + e.reverses)
}

/// Where in a row the torque at the hand stands; nowhere if there is none.
fn place(scene: &Scene) -> Option<usize> {
    let name = if scene.is_coupled() {
        FELT_COLUMN
    } else {
        "torque_nm"
    };
    columns(scene).iter().position(|c| c.name == name)
}

struct Ear<'m, F> {
    place: Option<usize>,
    hear: F,
    rows: u64,
    /// Ticks that the meter knows of.
    metered: u64,
    meter: &'m Meter,
}

impl<F: FnMut(f64) -> bool> Observer for Ear<'_, F> {
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
                "diverged: at t = {time_s} s the torque at the hand is no number"
            )));
        }
        if (self.hear)(torque_nm) {
            Ok(())
        } else {
            Err(Ended::Enough)
        }
    }

    fn event(&mut self, _: &EventRecord) -> Result<(), Ended> {
        Ok(())
    }

    fn progress(&mut self, _: f64) -> Result<(), Ended> {
        self.meter.did(self.rows - self.metered);
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
