use super::*;
use crate::laws::task::Extent;
use crate::machine::Machine;

fn row(law: &'static str, joint: &'static str, error: Option<f64>) -> Row {
    Row {
        law,
        joint,
        task: "creep",
        quantity: "creep",
        unit: "1",
        of: Use::Rest,
        demanded: 0.0,
        scale: 1.0,
        value: error,
        converged: error,
        refinement: None,
        is_settled: false,
        parts: 16,
        model_error: error,
        numerical_error: error.map(|_| 0.0),
        relative_error: error,
        failed: error.is_none().then_some("cannot"),
        converged_failed: None,
    }
}

fn costs(law: &'static str, ns: f64) -> Costs {
    Costs {
        law,
        bytes: 1,
        repeats: 1,
        grating: Some(super::super::costs::StepTime {
            ns,
            quartiles_ns: [ns; 2],
            spread: 0.0,
        }),
        knee: None,
        controller: None,
    }
}

fn study(rows: Vec<Row>) -> LawStudy {
    LawStudy {
        machine: Machine::here(),
        extent: Extent::Quick,
        joints: vec!["coarse", "fine"],
        laws: vec![("a", ""), ("b", ""), ("c", "")],
        rows,
        costs: vec![costs("a", 30.0), costs("b", 10.0), costs("c", 1.0)],
        wall_s: 0.0,
    }
}

#[test]
fn the_cheapest_of_those_as_good_as_the_best_is_the_answer() {
    let study = study(vec![
        row("a", "coarse", Some(0.1)),
        row("a", "fine", Some(0.1)),
        row("b", "coarse", Some(0.02)),
        row("b", "fine", Some(0.19)),
        row("c", "coarse", Some(0.0)),
        row("c", "fine", None),
    ]);
    let [answer] = &answers(&study)[..] else {
        panic!("one use has rows")
    };
    assert_eq!(answer.law, Some("b"));
    assert_eq!(answer.as_good, ["a", "b"]);
    let last = answer.scores.last().unwrap();
    assert_eq!((last.law, last.score, last.failed), ("c", 0.5, 1));
    let [order] = &orders(&study)[..] else {
        panic!("one quantity")
    };
    assert_eq!(
        order.laws,
        [("a", Some(0.1)), ("b", Some(0.19)), ("c", None)]
    );
}

#[test]
fn a_better_law_is_taken_whatever_it_costs_and_none_if_all_fail() {
    let better = study(vec![
        row("a", "coarse", Some(0.1)),
        row("b", "coarse", Some(0.2)),
        row("c", "coarse", Some(7.0)),
    ]);
    assert_eq!(answers(&better)[0].law, Some("a"));
    assert_eq!(answers(&better)[0].scores[2].score, 1.0);
    let none = study(["a", "b", "c"].map(|law| row(law, "fine", None)).to_vec());
    assert_eq!(answers(&none)[0].law, None);
}
