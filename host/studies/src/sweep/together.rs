//! Rows without a trace; those together whose points differ in the parameters of the joint only.

use crate::sweep::plan::{Plan, finish};
use crate::sweep::pool::{Ended, Stop, Unseen};
use crate::sweep::row::Row;
use crepitus_scene::run::Joined;
use crepitus_scene::{Scene, run};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Runs points without a trace, and gives the row of each as it comes.
///
/// # Errors
/// [`Ended::Stopped`].
pub fn totals(
    plan: &Plan,
    points: impl IntoIterator<Item = u64>,
    stop: &Stop,
    give: &mut dyn FnMut(Row),
) -> Result<(), Ended> {
    let mut together = Together::default();
    for point in points {
        stop.check()?;
        let begun = match plan.begin(point) {
            Ok(begun) => begun,
            Err(row) => {
                give(row);
                continue;
            }
        };
        let Some(begun) = together.add(begun) else {
            continue;
        };
        together.run(stop, give)?;
        if let Some((row, scene)) = together.add(begun) {
            give(alone(row, &scene, stop)?);
        }
    }
    together.run(stop, give)
}

/// A run by itself.
fn alone(row: Row, scene: &Scene, stop: &Stop) -> Result<Row, Ended> {
    finish(row, || run(scene, &mut Unseen(stop)))
}

/// Points to be run together, with their rows.
#[derive(Default)]
struct Together {
    rows: Vec<Row>,
    scenes: Joined,
}

impl Together {
    /// Adds a point, or gives it back if it does not belong to the others.
    fn add(&mut self, (row, scene): (Row, Scene)) -> Option<(Row, Scene)> {
        if let Some(scene) = self.scenes.add(scene) {
            return Some((row, scene));
        }
        self.rows.push(row);
        None
    }

    /// Runs the points, and has none then.
    fn run(&mut self, stop: &Stop, give: &mut dyn FnMut(Row)) -> Result<(), Ended> {
        let Self { rows, scenes } = std::mem::take(self);
        let goes_on = |_| stop.check();
        // One gains nothing; and a defect in one run is not to end the others.
        let summaries = if rows.len() < 2 {
            Vec::new()
        } else {
            catch_unwind(AssertUnwindSafe(|| scenes.run(goes_on))).unwrap_or(Ok(Vec::new()))?
        };
        let mut summaries = summaries.into_iter();
        for (row, scene) in rows.into_iter().zip(scenes.scenes()) {
            give(match summaries.next().flatten() {
                Some(summary) => finish(row, || Ok(summary))?,
                None => alone(row, scene, stop)?,
            });
        }
        Ok(())
    }
}
