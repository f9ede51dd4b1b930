//! The whole study: every law × joint × task, each at the device's tick and converged.

use super::contestant::Contestant;
use super::costs::{Costs, costs};
use super::row::{Readings, Row, is_settled};
use super::runner::Runner;
use super::task::{Demand, Extent, Prepared, Reading, Setting, Task};
use super::tasks::TASKS;
use crate::machine::Machine;
use crate::parallel::{Meter, each};
use crate::watcher::{StudyError, Watcher};
use crepitus_ladder::laws::{ENTRIES, Entry};
use crepitus_model::Real;
use crepitus_scene::preset::{Joint, joints};
use crepitus_scene::scene::Precision;
use serde::Serialize;
use std::time::Instant;

/// Plan of a study.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Joints that the laws are fitted to.
    pub joints: Vec<Joint>,
    /// Laws by name; all if there are none.
    pub laws: Vec<String>,
    /// Tasks by name; all if there are none.
    pub tasks: Vec<String>,
    /// Extent.
    pub extent: Extent,
    /// Whether each law is refined until it has converged; if not, there are values at the device's tick
    /// only.
    pub is_refined: bool,
    /// Repeats of each timing; 0 for no times.
    pub repeats: usize,
}

/// Most steps in a tick to which a law is refined.
const MOST_PARTS: u32 = 128;

impl Plan {
    /// Every law and every task on the joints that ship, in a few minutes; on the paper's alone in a few
    /// seconds.
    pub fn of(extent: Extent) -> Self {
        let most = if extent == Extent::Quick {
            1
        } else {
            usize::MAX
        };
        Self {
            joints: joints().iter().take(most).copied().collect(),
            laws: Vec::new(),
            tasks: Vec::new(),
            extent,
            is_refined: true,
            repeats: if extent == Extent::Quick { 5 } else { 9 },
        }
    }

    /// The tasks of the plan.
    pub fn tasks(&self) -> impl Iterator<Item = &'static dyn Task> {
        let named = |name: &str| self.tasks.is_empty() || self.tasks.iter().any(|n| n == name);
        TASKS.iter().copied().filter(move |task| named(task.name()))
    }

    /// The laws of the plan.
    pub fn entries(&self) -> impl Iterator<Item = &'static Entry> {
        let named = |name: &str| self.laws.is_empty() || self.laws.iter().any(|n| n == name);
        ENTRIES.iter().filter(move |entry| named(entry.name))
    }
}

/// Findings.
#[derive(Clone, Debug, Serialize)]
pub struct LawStudy {
    /// Computer and build.
    pub machine: Machine,
    /// Extent.
    pub extent: Extent,
    /// Names of the joints.
    pub joints: Vec<&'static str>,
    /// Names and titles of the laws.
    pub laws: Vec<(&'static str, &'static str)>,
    /// Law × joint × quantity.
    pub rows: Vec<Row>,
    /// Costs of the laws.
    pub costs: Vec<Costs>,
    /// Duration of the study, s.
    pub wall_s: f64,
}

/// Runs a plan on the laws of the ladder, and times them.
///
/// # Errors
/// Error of the watcher, or a joint that is invalid.
pub fn run(plan: &Plan, watcher: &mut dyn Watcher) -> Result<LawStudy, StudyError> {
    /// Share of the work that times take.
    const TIMES: f64 = 0.05;
    let begun = Instant::now();
    let entries: Vec<&dyn Contestant> = plan.entries().map(|e| e as &dyn Contestant).collect();
    let rows = run_with(plan, &entries, &mut Part::new(watcher, 0.0, 1.0 - TIMES))?;
    let laws: Vec<_> = plan.entries().collect();
    let joint = plan.joints.first().map(|joint| joint.parameters);
    let joint = joint.unwrap_or_default();
    let times = &mut Part::new(watcher, 1.0 - TIMES, TIMES);
    Ok(LawStudy {
        machine: Machine::here(),
        extent: plan.extent,
        joints: plan.joints.iter().map(|joint| joint.name).collect(),
        laws: laws.iter().map(|law| (law.name, law.title)).collect(),
        rows,
        costs: costs(&laws, &joint, plan.repeats, times)?,
        wall_s: begun.elapsed().as_secs_f64(),
    })
}

/// Runs the tasks of a plan on any laws; the names in the plan do not count.
///
/// # Errors
/// Error of the watcher, or a joint that is invalid.
pub fn run_with(
    plan: &Plan,
    contestants: &[&dyn Contestant],
    watcher: &mut dyn Watcher,
) -> Result<Vec<Row>, StudyError> {
    let tasks: Vec<&dyn Task> = plan.tasks().collect();
    let settings = plan.joints.iter().enumerate().flat_map(|(place, joint)| {
        let tasks = tasks
            .iter()
            .filter(move |t| place == 0 || !t.is_for_one_joint());
        tasks.map(move |task| {
            let extent = plan.extent;
            (
                *task,
                Setting {
                    joint: *joint,
                    extent,
                },
            )
        })
    });
    let settings: Vec<_> = settings.collect();
    let meter = Meter::new(f64::from_whole(count(settings.len() * contestants.len())));
    let prepared = each(&settings, &meter, watcher, |(task, setting)| {
        task.prepare(setting)
    })?;
    let prepared: Vec<Box<dyn Prepared>> = prepared.into_iter().collect::<Result<_, _>>()?;
    let items: Vec<Item<'_>> = contestants
        .iter()
        .flat_map(|law| {
            let cases = settings.iter().zip(&prepared);
            cases.map(move |((task, setting), prepared)| Item {
                law: *law,
                task: *task,
                joint: setting.joint,
                prepared: &**prepared,
                refined: plan.is_refined.then_some(plan.extent),
            })
        })
        .collect();
    let rows = each(&items, &meter, watcher, |item| {
        let rows = item.rows(&meter);
        meter.add(1);
        rows
    })?;
    Ok(rows.into_iter().flatten().collect())
}

fn count(n: usize) -> u64 {
    u64::try_from(n).unwrap_or(u64::MAX)
}

/// Steps in a tick, and the readings.
type Refinement = (u32, Vec<Reading>);

/// A law on a task of a joint.
struct Item<'a> {
    law: &'a dyn Contestant,
    task: &'a dyn Task,
    joint: Joint,
    prepared: &'a dyn Prepared,
    /// Extent of the study, if laws are refined.
    refined: Option<Extent>,
}

impl Item<'_> {
    fn rows(&self, meter: &Meter) -> Vec<Row> {
        let value = self.readings(meter, Precision::F32, 1);
        let demands = self.prepared.demanded();
        let [before, last] = self.converged(meter, &demands);
        let quantities = self.task.quantities().iter().zip(demands);
        let names = [self.law.name(), self.joint.name, self.task.name()];
        quantities
            .enumerate()
            .map(|(place, (quantity, demand))| {
                let of = |readings: &[Reading]| {
                    let reading = readings.get(place).copied();
                    reading.unwrap_or(Reading::failed("not measured"))
                };
                let readings = Readings {
                    value: of(&value),
                    converged: last.as_ref().map(|(_, readings)| of(readings)),
                    before: before.as_ref().map(|(_, readings)| of(readings)),
                    parts: last.as_ref().map_or(1, |(parts, _)| *parts),
                };
                Row::new(names, quantity, demand, &readings)
            })
            .collect()
    }

    /// The last two refinements. A full study goes on, fourfold, until they agree or a tick has
    /// [`MOST_PARTS`].
    fn converged(&self, meter: &Meter, demands: &[Demand]) -> [Option<Refinement>; 2] {
        let Some(extent) = self.refined else {
            return [None, None];
        };
        let run = |parts| (parts, self.readings(meter, Precision::F64, parts));
        let (mut before, mut last) = (None, None);
        for &parts in self.prepared.refinements() {
            before = last.replace(run(parts));
        }
        while extent > Extent::Quick
            && let (Some((_, coarse)), Some((parts, fine))) = (&before, &last)
            && 4 * parts <= MOST_PARTS
            && !meter.is_stopped()
        {
            let mut pairs = demands.iter().zip(coarse.iter().zip(fine));
            if pairs.all(|(demand, (coarse, fine))| is_settled(demand, fine, coarse)) {
                break;
            }
            let finer = run(4 * parts);
            before = last.replace(finer);
        }
        [before, last]
    }

    /// Readings of one run. A law that diverged anywhere has none: what was read is not its number.
    fn readings(&self, meter: &Meter, precision: Precision, parts: u32) -> Vec<Reading> {
        let is_stopped = || meter.is_stopped();
        let joint = &self.joint.parameters;
        let runner = Runner::new(self.law, joint, precision, parts, &is_stopped);
        let read = self.prepared.measure(&runner);
        let all = |reason| vec![Reading::failed(reason); self.task.quantities().len()];
        match (read, runner.trouble()) {
            (_, Some(trouble)) => all(trouble),
            (Err(_), None) => all("refuses the joint at this step"),
            (Ok(readings), None) => readings,
        }
    }
}

/// A part of the progress of a study.
struct Part<'a> {
    watcher: &'a mut dyn Watcher,
    from: f64,
    share: f64,
}

impl<'a> Part<'a> {
    fn new(watcher: &'a mut dyn Watcher, from: f64, share: f64) -> Self {
        Self {
            watcher,
            from,
            share,
        }
    }
}

impl Watcher for Part<'_> {
    fn progress(&mut self, fraction: f64) -> Result<(), crate::watcher::Cancelled> {
        self.watcher.progress(self.from + self.share * fraction)
    }
}

#[cfg(test)]
mod tests;
