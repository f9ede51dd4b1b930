use super::super::protocol::Known;
use super::super::store::{Beginning, Store};
use super::*;
use std::fs;

const PROTOCOL_TEXT: &str = "title = 'Torque'\nseed = 3\n[threshold]\nquantity = 'torque'\nreference = 0.5\n\
    [threshold.staircase]\nrule = '1-up-2-down'\nstart = 0.4\nsteps = [0.1]\nleast = 0.1\nmost = 1\n\
    reversals = 6\ntrials = 40\ninterleaved = 2";

struct Study {
    home: tempfile::TempDir,
    store: Store,
}

fn study() -> Study {
    let home = tempfile::tempdir().unwrap();
    fs::write(home.path().join("torque.toml"), PROTOCOL_TEXT).unwrap();
    let store = Store::create(&home.path().join("study")).unwrap();
    Study { home, store }
}

impl Study {
    fn begin(&self, participant: &str) -> (Held, bool) {
        let protocol = self.home.path().join("torque.toml");
        let beginning = Beginning {
            protocol: &protocol,
            participant,
            seed: None,
            has_consented: false,
            unix_s: 7,
        };
        self.store.begin(beginning, Known::SHIPPED).unwrap()
    }
}

/// Answers so many trials, by their number alone; returns the trials.
fn answer(held: &mut Held, count: usize) -> Vec<Trial> {
    let mut trials = Vec::new();
    for _ in 0..count {
        let Some(trial) = held.trial() else { break };
        let choice = if trial.number % 3 == 0 { 1 } else { 2 };
        held.answer(Response::Choice(choice), 12.345_678).unwrap();
        trials.push(trial);
    }
    trials
}

/// Whenever the program is killed, also within a line, the session goes on with the trials that it would have had.
#[test]
fn a_killed_session_goes_on_with_the_same_order() {
    let whole = study();
    let (mut held, _) = whole.begin("P01");
    let all = answer(&mut held, 100);
    let table = fs::read_to_string(held.folder().join(TRIALS)).unwrap();
    assert!(held.session().is_over() && all.len() > 12);
    for cut in (0..table.len()).step_by(37).chain([table.len() - 1]) {
        let killed = study();
        let (held, _) = killed.begin("P01");
        let file = held.folder().join(TRIALS);
        let header = table.find('\n').unwrap() + 1;
        let kept = &table[..cut.max(header)];
        fs::write(&file, kept).unwrap();
        drop(held);
        let (mut held, is_taken_up) = killed.begin("P01");
        assert!(is_taken_up);
        let lines = kept.matches('\n').count() - 1;
        assert_eq!(held.session().rows().len(), lines);
        let rest = answer(&mut held, 100);
        assert_eq!(rest, all[lines..], "cut at {cut}");
        assert_eq!(fs::read_to_string(file).unwrap(), table);
    }
}

#[test]
fn a_session_that_is_over_is_followed_by_another_one() {
    let study = study();
    let (mut held, _) = study.begin("P01");
    let first = answer(&mut held, 100);
    drop(held);
    let (mut held, is_taken_up) = study.begin("P01");
    assert!(!is_taken_up && held.begun().session == 2);
    assert_ne!(answer(&mut held, 100), first);
    let sessions = study.store.sessions().unwrap();
    assert_eq!(sessions.len(), 2);
    assert!(sessions.iter().all(|held| held.session().is_over()));
}

#[test]
fn one_program_has_a_session() {
    let study = study();
    let (held, _) = study.begin("P01");
    assert!(matches!(
        Held::open(held.folder()),
        Err(TableError::Locked(_))
    ));
    let folder = held.folder().to_owned();
    // To look at, it needs no lock, and takes no answer.
    let mut looked_at = Held::read(&folder).unwrap();
    assert!(looked_at.answer(Response::Choice(1), 0.0).is_err());
    assert_eq!(looked_at.session().rows().len(), 0);
    drop(held);
    assert!(Held::open(&folder).is_ok());
}

#[test]
fn what_was_changed_is_an_error() {
    for (name, from, to) in [
        (TRIALS, "\n3,", "\n4,"),
        (TRIALS, "true", "false"),
        (TRIALS, ",0.4,", ",0.3,"),
        (TRIALS, "12.346", "soon"),
        (TRIALS, "difference", "level"),
        (PROTOCOL, "40", "41"),
        (SESSION, "\"format\": 1", "\"format\": 2"),
        (SESSION, "\"seed\": ", "\"seed\": 1"),
        (SESSION, "\"tool\"", "\"tols\""),
    ] {
        let study = study();
        let (mut held, _) = study.begin("P01");
        answer(&mut held, 12);
        let folder = held.folder().to_owned();
        drop(held);
        let file = folder.join(name);
        let text = fs::read_to_string(&file).unwrap();
        assert!(text.contains(from), "{text}");
        fs::write(&file, text.replacen(from, to, 1)).unwrap();
        let error = Held::read(&folder).expect_err(from).to_string();
        assert!(
            error.contains(name) || error.contains("trials.csv"),
            "{error}"
        );
    }
}

/// A table of judgements is read back, whatever is said in it.
#[test]
fn descriptions_are_kept() {
    let home = tempfile::tempdir().unwrap();
    let protocol = home.path().join("p.toml");
    fs::write(
        &protocol,
        "title = 'R'\n[realism]\npresets = ['coarse']\nfeatures = ['grating, slow']",
    )
    .unwrap();
    let store = Store::create(&home.path().join("study")).unwrap();
    let begin = || {
        let beginning = Beginning {
            protocol: &protocol,
            participant: "C1",
            seed: Some(1),
            has_consented: false,
            unix_s: 7,
        };
        store.begin(beginning, Known::SHIPPED).unwrap().0
    };
    let said = "grates, \"like sand\"\nand; catches, ü";
    let mut held = begin();
    held.answer(Response::Description(said.to_owned()), 1.0)
        .unwrap();
    let rating = Rating {
        realism: vec![5, 1],
        severity: 1,
        finding: Finding::find("crepitus").unwrap(),
    };
    let row = held.answer(Response::Rating(rating), 1.0).unwrap();
    drop(held);
    let again = begin();
    assert_eq!(again.session().rows().first(), row.as_ref());
    let Some(Row::Realism(row)) = row else {
        panic!("a row")
    };
    assert_eq!(row.description, "grates, \"like sand\" and; catches, ü");
}
