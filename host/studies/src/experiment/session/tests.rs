use super::super::finding::Finding;
use super::super::trial::Rating;
use super::*;
use std::collections::BTreeMap;

fn session(text: &str, seed: u64) -> Session {
    Session::new(Protocol::from_toml(text).unwrap(), seed)
}

const CONSTANT: &str = "title = 'T'\n[threshold]\npreset = 'coarse'\n\
    quantity = 'crepitus.static_torque_nm'\nreference = 0.4\n[threshold.constant]\ndifferences = [0.1, 0.2]\n\
    repeats = 5\ncatch_trials = 4";
const STAIRCASE: &str = "title = 'T'\n[threshold]\nquantity = 'torque'\n[threshold.staircase]\n\
    rule = '1-up-2-down'\nstart = 0.5\nsteps = [0.1]\nleast = 0.1\nmost = 1\nreversals = 4\ntrials = 30\n\
    interleaved = 2";
const ABX: &str = "title = 'T'\n[abx]\ntrials = 10\na = { preset = 'coarse' }\n\
    b = { preset = 'coarse', values = { 'crepitus.restart' = 1.0 } }";
const REALISM: &str = "title = 'T'\n[realism]\npresets = ['coarse', 'fine']\nrepeats = 2\nhealthy = 2\n\
    features = ['grating']";

/// Answers every trial, right where `is_right` says so; the rows.
fn answered(session: &mut Session, is_right: impl Fn(usize) -> bool) -> Vec<Row> {
    while let Some(trial) = session.trial() {
        let value = |at: usize| -> f64 {
            let stimulus: &Stimulus = &trial.intervals[at];
            stimulus.values.values().sum()
        };
        let right = if value(0) > value(1) { 1 } else { 2 };
        let answer = if is_right(trial.number) {
            right
        } else {
            3 - right
        };
        session.answer(Response::Choice(answer), 1.5).unwrap();
    }
    session.rows().to_vec()
}

fn thresholds(rows: &[Row]) -> Vec<ThresholdRow> {
    let of = |row: &Row| match row {
        Row::Threshold(row) => row.clone(),
        _ => panic!("a row of a threshold"),
    };
    rows.iter().map(of).collect()
}

#[test]
fn constant_stimuli_are_balanced_and_their_order_repeats() {
    let rows = thresholds(&answered(&mut session(CONSTANT, 7), |_| true));
    let mut counts: BTreeMap<String, [usize; 2]> = BTreeMap::new();
    for row in &rows {
        let places = counts.entry(row.difference.to_string()).or_default();
        places[usize::from(row.comparison_in) - 1] += 1;
        assert!(row.is_right || row.difference == 0.0);
    }
    assert_eq!(counts["0"], [2, 2]);
    for level in ["0.1", "0.2"] {
        let [one, two] = counts[level];
        assert!(
            one + two == 5 && one.abs_diff(two) == 1,
            "{level}: {counts:?}"
        );
    }
    assert_eq!(
        rows,
        thresholds(&answered(&mut session(CONSTANT, 7), |_| true))
    );
    assert_ne!(
        rows,
        thresholds(&answered(&mut session(CONSTANT, 8), |_| true))
    );
}

/// An order that an earlier version made is still that of its seed.
#[test]
fn golden_order_of_constant_stimuli() {
    let rows = thresholds(&answered(&mut session(CONSTANT, 7), |_| true));
    let order: Vec<_> = rows
        .iter()
        .map(|row| (row.difference, row.comparison_in))
        .collect();
    assert_eq!(order, GOLDEN);
}

#[test]
fn staircases_run_interleaved_and_repeat() {
    let is_right = |trial: usize| !trial.is_multiple_of(5);
    let rows = thresholds(&answered(&mut session(STAIRCASE, 1), is_right));
    for staircase in [1, 2] {
        let own = rows.iter().filter(|row| row.staircase == staircase);
        let turns = own.clone().filter(|row| row.has_turned).count();
        assert!(turns == 4 || own.count() == 30, "{turns}");
    }
    let changes = rows
        .windows(2)
        .filter(|pair| pair[0].staircase != pair[1].staircase);
    assert!(changes.count() > 5);
    assert_eq!(
        rows,
        thresholds(&answered(&mut session(STAIRCASE, 1), is_right))
    );
}

#[test]
fn a_comparison_below_the_reference_is_right_in_the_other_interval() {
    let text = CONSTANT.replace("[0.1, 0.2]", "[-0.1, -0.2]");
    let rows = thresholds(&answered(&mut session(&text, 2), |_| true));
    let real = rows.iter().filter(|row| row.difference != 0.0);
    assert!(
        real.clone()
            .all(|row| row.is_right && row.answer != row.comparison_in)
    );
    assert_eq!(real.count(), 10);
}

#[test]
fn x_is_each_condition_equally_often() {
    let mut session = session(ABX, 3);
    let mut xs = Vec::new();
    while let Some(trial) = session.trial() {
        let [a, b, x] = &trial.intervals[..] else {
            panic!("three intervals")
        };
        assert!(a != b && (x == a || x == b));
        xs.push(if x == a { 1 } else { 2 });
        session.answer(Response::Choice(1), 0.0).unwrap();
    }
    assert_eq!(xs.iter().map(|x| usize::from(*x == 1)).sum::<usize>(), 5);
    let told = session.rows().iter().map(|row| match row {
        Row::Abx(row) => row.x,
        _ => panic!("a row of A, B and X"),
    });
    let told: Vec<_> = told.collect();
    assert_eq!(told, xs);
}

#[test]
fn a_knee_is_described_before_it_is_judged() {
    let mut session = session(REALISM, 4);
    let rating = || Rating {
        realism: vec![4, 2],
        severity: 2,
        finding: Finding::Healthy,
    };
    let mut knees = Vec::new();
    while let Some(trial) = session.trial() {
        let rated = session.answer(Response::Rating(rating()), 0.0);
        assert!(matches!(rated, Err(SessionError::Kind(what)) if what.contains("description")));
        let described = Response::Description("=1+1\n grating\t under\u{7} the cap ".to_owned());
        assert_eq!(session.answer(described, 0.0), Ok(None));
        for wrong in [
            Rating {
                realism: vec![4],
                ..rating()
            },
            Rating {
                realism: vec![4, 6],
                ..rating()
            },
            Rating {
                realism: vec![0, 1],
                ..rating()
            },
            Rating {
                severity: 4,
                ..rating()
            },
        ] {
            assert!(session.answer(Response::Rating(wrong), 0.0).is_err());
        }
        let Ok(Some(Row::Realism(row))) = session.answer(Response::Rating(rating()), 0.0) else {
            panic!("a row")
        };
        assert_eq!(row.description, "1+1 grating under the cap");
        assert_eq!(row.knee, trial.intervals[0].preset);
        knees.push((row.knee.clone(), row.presentation));
    }
    let twice = knees.windows(2).any(|pair| pair[0].0 == pair[1].0);
    assert!(!twice, "{knees:?}");
    knees.sort();
    let all = ["coarse", "fine", HEALTHY].map(|knee| [(knee.to_owned(), 1), (knee.to_owned(), 2)]);
    assert_eq!(knees, all.concat());
}

#[test]
fn what_is_no_answer_leaves_the_trial() {
    let mut session = session(CONSTANT, 1);
    let before = session.trial();
    for wrong in [
        Response::Choice(0),
        Response::Choice(3),
        Response::Description("rough".to_owned()),
    ] {
        assert!(session.answer(wrong, 0.0).is_err());
        assert_eq!(session.trial(), before);
    }
    answered(&mut session, |_| true);
    assert_eq!(
        session.answer(Response::Choice(1), 0.0),
        Err(SessionError::Over)
    );
    assert!(session.trial().is_none() && session.is_over());
}

const GOLDEN: [(f64, u8); 14] = [
    (0.2, 1),
    (0.2, 2),
    (0.1, 2),
    (0.1, 1),
    (0.2, 1),
    (0.0, 2),
    (0.0, 2),
    (0.1, 2),
    (0.1, 2),
    (0.0, 1),
    (0.2, 1),
    (0.0, 1),
    (0.2, 2),
    (0.1, 1),
];
