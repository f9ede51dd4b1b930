use super::super::protocol::Protocol;
use super::super::trial::{Rating, Response};
use super::*;

const PROTOCOL: &str = "title = 'R'\n[realism]\npresets = ['coarse', 'mas-2-catch', 'fine']\nrepeats = 2\n\
    healthy = 2\nfeatures = ['resistance']";

fn truth(name: &str) -> Knee {
    crepitus_scene::preset::find(name).map_or_else(Knee::healthy, Knee::from)
}

/// A session whose ratings follow from the knee and the presentation.
fn session(
    seed: u64,
    trials: usize,
    rate: impl Fn(&str, usize) -> (u8, u8, &'static str),
) -> Session {
    let mut session = Session::new(Protocol::from_toml(PROTOCOL).unwrap(), seed);
    let mut seen: BTreeMap<String, usize> = BTreeMap::new();
    for _ in 0..trials {
        let Some(trial) = session.trial() else { break };
        let knee = trial.intervals[0].preset.clone();
        let presentation = seen.entry(knee.clone()).or_default();
        *presentation += 1;
        let (realism, severity, finding) = rate(&knee, *presentation);
        session
            .answer(Response::Description(format!("like {knee}")), 0.0)
            .unwrap();
        let rating = Rating {
            realism: vec![realism, 6 - realism],
            severity,
            finding: Finding::find(finding).unwrap(),
        };
        session.answer(Response::Rating(rating), 0.0).unwrap();
    }
    session
}

fn results(sessions: &[(&str, Session)]) -> Results {
    let clinicians = Clinician::all(sessions.iter().map(|(name, session)| (*name, session)));
    Results::of(&clinicians, &["resistance".to_owned()], truth)
}

fn perfect(knee: &str, _: usize) -> (u8, u8, &'static str) {
    match knee {
        "coarse" => (5, 2, "crepitus"),
        "mas-2-catch" => (3, 2, "spasticity"),
        "fine" => (2, 1, "crepitus"),
        _ => (4, 0, "healthy"),
    }
}

#[test]
fn clinicians_who_agree_are_consistent() {
    let of = results(&[
        ("C1", session(1, 99, perfect)),
        ("C2", session(2, 99, perfect)),
    ]);
    assert_eq!((of.clinicians, of.finished, of.ratings), (2, 2, 16));
    let value = |estimate: &Option<Estimate>| estimate.as_ref().unwrap().value;
    for feature in &of.features {
        assert_eq!(value(&feature.agreement), 1.0, "{feature:?}");
        assert_eq!(value(&feature.consistency), 1.0);
        assert_eq!(value(&feature.again), 1.0);
    }
    assert_eq!(of.features[1].feature, "resistance");
    assert_eq!(value(&of.features[0].mean), 3.5);
    assert_eq!((value(&of.severity), value(&of.severity_again)), (1.0, 1.0));
    assert_eq!(value(&of.finding), 1.0);
    assert_eq!((of.false_alarms, of.missed), ([0, 4], [0, 12]));
    let names: Vec<_> = of.knees.iter().map(|knee| knee.preset.as_str()).collect();
    assert_eq!(names, ["coarse", "fine", "mas-2-catch", HEALTHY]);
    let coarse = &of.knees[0];
    assert_eq!((coarse.clinicians, coarse.ratings, coarse.right), (2, 4, 4));
    assert_eq!(value(&coarse.realism), 5.0);
    assert_eq!(coarse.realism.unwrap().units, 2);
    assert_eq!(coarse.descriptions, ["like coarse"; 4]);
}

#[test]
fn a_clinician_who_answers_the_same_always_agrees_with_nothing() {
    let of = results(&[
        ("C1", session(1, 99, |_, _| (3, 1, "healthy"))),
        ("C2", session(2, 99, perfect)),
    ]);
    let half = of.severity.unwrap().value;
    assert!(half > 0.2 && half < 0.8, "{half}");
    assert_eq!(of.missed, [6, 12]);
    let alone = results(&[("C1", session(1, 99, |_, _| (3, 1, "healthy")))]);
    assert_eq!(alone.features[0].agreement, None);
    assert_eq!(alone.severity.unwrap().value, 0.0);
}

#[test]
fn who_has_not_finished_is_left_out_of_the_table_of_clinicians() {
    let of = results(&[
        ("C1", session(1, 99, perfect)),
        ("C2", session(2, 99, perfect)),
        ("C3", session(3, 3, |_, _| (1, 3, "clonus"))),
    ]);
    assert_eq!((of.clinicians, of.finished, of.ratings), (3, 2, 19));
    assert_eq!(of.features[0].agreement.unwrap().value, 1.0);
    assert!(of.finding.unwrap().value < 1.0);
}
