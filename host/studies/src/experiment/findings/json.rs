//! Results as JSON.

use super::{Findings, Found};
use crate::experiment::bootstrap::Estimate;
use crate::experiment::choices::Told;
use crate::experiment::realism::Results;
use serde_json::{Value, json};

impl Findings {
    /// Results, each number with its interval, or null where there is none.
    pub fn to_json(&self) -> Value {
        let found = match &self.found {
            Found::Threshold(participants) => participants
                .iter()
                .map(|of| {
                    json!({
                        "participant": of.participant,
                        "counts": of.counts.iter().map(|count| json!({
                            "difference": count.difference,
                            "trials": count.trials,
                            "right": count.right,
                        })).collect::<Vec<_>>(),
                        "reversals": of.reversals,
                    })
                })
                .collect(),
            Found::Abx(participants, all) => json!({
                "participants": participants.iter().map(|(name, told)| {
                    json!({ "participant": name, "told": told_apart(told) })
                }).collect::<Vec<_>>(),
                "all": all.as_ref().map(told_apart),
            }),
            Found::Realism(results) => realism(results),
        };
        json!({
            "title": self.protocol.title,
            "protocol_sha256": self.protocol_sha256,
            "sessions": self.sessions,
            "unfinished": self.unfinished,
            "sha256": self.sha256,
            "found": found,
        })
    }
}

fn told_apart(told: &Told) -> Value {
    json!({
        "trials": told.trials,
        "right": told.right,
        "share": f64::from(told.right) / f64::from(told.trials),
        "low": told.interval[0],
        "high": told.interval[1],
        "p": told.p,
    })
}

fn estimate(estimate: Option<Estimate>) -> Value {
    estimate.map_or(Value::Null, |estimate| {
        json!({
            "value": estimate.value,
            "low": estimate.interval.map(|[low, _]| low),
            "high": estimate.interval.map(|[_, high]| high),
            "units": estimate.units,
        })
    })
}

fn realism(results: &Results) -> Value {
    let knees = results.knees.iter().map(|knee| {
        json!({
            "preset": knee.preset,
            "clinicians": knee.clinicians,
            "ratings": knee.ratings,
            "realism": estimate(knee.realism),
            "right": knee.right,
            "descriptions": knee.descriptions,
        })
    });
    let features = results.features.iter().map(|of| {
        json!({
            "feature": of.feature,
            "mean": estimate(of.mean),
            "agreement": estimate(of.agreement),
            "consistency": estimate(of.consistency),
            "again": estimate(of.again),
        })
    });
    json!({
        "clinicians": results.clinicians,
        "finished": results.finished,
        "ratings": results.ratings,
        "knees": knees.collect::<Vec<_>>(),
        "features": features.collect::<Vec<_>>(),
        "severity_again": estimate(results.severity_again),
        "severity": estimate(results.severity),
        "type": estimate(results.finding),
        "false_alarms": results.false_alarms,
        "missed": results.missed,
    })
}
