use super::*;
use crate::laws::Use;
use crate::laws::costs::{Costs, StepTime};
use crate::machine::Machine;
use serde_json::Value;

/// A row of creep; `None` is a law that cannot do it.
pub(in crate::laws) fn row(law: &'static str, error: Option<f64>) -> Row {
    Row {
        law,
        joint: "coarse",
        task: "creep",
        quantity: "creep",
        unit: "rad",
        of: Use::Rest,
        demanded: 0.0,
        scale: 1.0,
        value: error,
        converged: error,
        refinement: Some(0.0),
        is_settled: true,
        parts: 32,
        model_error: error,
        numerical_error: error.map(|_| 0.0),
        relative_error: error,
        failed: error.is_none().then_some("diverges"),
        converged_failed: None,
    }
}

fn costs(law: &'static str, ns: f64) -> Costs {
    Costs {
        law,
        bytes: 40,
        repeats: 5,
        grating: Some(StepTime {
            ns,
            quartiles_ns: [0.99 * ns, 1.01 * ns],
            spread: 0.02,
        }),
        knee: None,
        controller: None,
    }
}

/// Two laws, of which ours costs more.
pub(in crate::laws) fn study(rows: Vec<Row>) -> LawStudy {
    LawStudy {
        machine: Machine::here(),
        extent: Extent::Quick,
        joints: vec!["coarse"],
        laws: vec![("frozen", "ours"), ("dahl", "Dahl's bristles")],
        rows,
        costs: vec![costs("frozen", 30.0), costs("dahl", 10.0)],
        wall_s: 1.0,
    }
}

#[test]
fn all_of_the_numbers_are_in_the_full_text_and_in_the_summary() {
    let study = study(vec![row("frozen", Some(0.25)), row("dahl", None)]);
    let outcome = LawsOutcome::new(&study);
    let text = outcome.in_full();
    for part in [
        "creep under a load",
        "fails at 20 kHz: diverges",
        "0.25",
        "shaft and ground",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let short = outcome.in_short();
    assert_eq!(short.lines().count(), 4, "{short}");
    let summary: Value = serde_json::to_value(outcome.summary()).expect("JSON");
    assert_eq!(summary["rows"].as_array().map(Vec::len), Some(2));
    assert_eq!(summary["rows"][0]["relative_error"], 0.25);
    assert_eq!(summary["costs"][1]["grating_ns_per_step"], 10.0);
    assert_eq!(summary["answers"][0]["law"], "frozen");
    assert_eq!(summary["tasks"].as_array().map(Vec::len), Some(1));
    assert_eq!(summary["fits"].as_array().map(Vec::len), Some(2));
    let names: Vec<_> = outcome.tables().iter().map(|(name, _)| *name).collect();
    assert_eq!(names, ["leaderboard.csv", "costs.csv"]);
}

#[test]
fn a_page_has_its_figures_and_every_number() {
    let study = study(vec![row("frozen", Some(0.25)), row("dahl", None)]);
    let outcome = LawsOutcome::new(&study);
    let page = outcome.page();
    for part in ["<svg", "How a law is chosen", "Stribeck", "diverges"] {
        assert!(page.contains(part), "{part}");
    }
    assert!(!page.contains("https://"));
    assert!(!outcome.pictures(Paper::Screen).is_empty());
}
