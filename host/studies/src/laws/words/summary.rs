//! `summary.json`: the whole study, for machines.

use super::fits::{Fit, fits, table};
use super::list::tasks;
use super::{LawsOutcome, RULE};
use crate::laws::LawStudy;
use crate::laws::costs::Costs;
use crate::laws::law_tables::{costs_table, leaderboard_table};
use crate::laws::ranking::{Answer, Order, orders};
use crate::laws::row::Row;
use crate::laws::task::Extent;
use crate::machine::Machine;
use crepitus_pages::table::Table;
use serde::{Serialize, Serializer};
use serde_json::{Value, json};

/// Version of this form.
const SUMMARY_VERSION: u32 = 1;

#[derive(Serialize)]
pub(super) struct Summary<'a> {
    #[serde(rename = "summary_version")]
    version: u32,
    crepitus_version: &'static str,
    machine: &'a Machine,
    extent: Extent,
    /// Rule by which laws are put in order.
    rule: &'static str,
    laws: Vec<Value>,
    joints: &'a [&'static str],
    tasks: Vec<Value>,
    answers: &'a [Answer],
    orders: Vec<Order>,
    fits: Fits,
    /// Rows of `leaderboard.csv`.
    rows: Table<'a, Row>,
    /// Rows of `costs.csv`.
    costs: Table<'a, Costs>,
    wall_s: f64,
}

struct Fits(Vec<Fit>);

impl Serialize for Fits {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        table(&self.0).serialize(serializer)
    }
}

impl<'a> Summary<'a> {
    pub(super) fn new(of: &'a LawsOutcome<'_>) -> Self {
        let study: &LawStudy = of.study;
        let laws = study.laws.iter();
        let names = study.rows.iter().map(|row| row.task);
        let studied: Vec<_> = names.collect();
        let is_studied = |task: &Value| {
            let name = task.get("name").and_then(Value::as_str);
            name.is_some_and(|name| studied.contains(&name))
        };
        Self {
            version: SUMMARY_VERSION,
            crepitus_version: env!("CARGO_PKG_VERSION"),
            machine: &study.machine,
            extent: study.extent,
            rule: RULE,
            laws: laws
                .map(|(name, title)| json!({ "name": name, "title": title }))
                .collect(),
            joints: &study.joints,
            tasks: tasks().into_iter().filter(is_studied).collect(),
            answers: &of.answers,
            orders: orders(study),
            fits: Fits(fits(study)),
            rows: leaderboard_table(&study.rows),
            costs: costs_table(&study.costs),
            wall_s: study.wall_s,
        }
    }
}
