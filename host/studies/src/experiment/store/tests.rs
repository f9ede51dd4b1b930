use super::super::finding::Finding;
use super::super::table::DESCRIBED;
use super::super::trial::{Rating, Response, Row};
use super::*;

const TEXT: &str = "title = 'Can you feel it?'\nconsent = 'consent.txt'\n[threshold]\nquantity = 'torque'\n\
    [threshold.constant]\ndifferences = [0.1]\nrepeats = 2";

struct Study {
    home: tempfile::TempDir,
    store: Store,
}

fn study() -> Study {
    let home = tempfile::tempdir().unwrap();
    fs::write(home.path().join("p.toml"), TEXT).unwrap();
    fs::write(home.path().join("consent.txt"), "I agree.").unwrap();
    let store = Store::create(&home.path().join("study")).unwrap();
    Study { home, store }
}

impl Study {
    fn begin(&self, participant: &str, has_consented: bool) -> Result<Held, StoreError> {
        let protocol = self.home.path().join("p.toml");
        let beginning = Beginning {
            protocol: &protocol,
            participant,
            seed: None,
            has_consented,
            unix_s: 7,
        };
        Ok(self.store.begin(beginning, Known::SHIPPED)?.0)
    }
}

/// Everything below a folder, with its permissions.
#[cfg(unix)]
fn modes(folder: &Path) -> Vec<(PathBuf, u32)> {
    use std::os::unix::fs::PermissionsExt;
    let mut all = vec![(
        folder.to_owned(),
        fs::metadata(folder).unwrap().permissions().mode() & 0o777,
    )];
    for path in entries(folder).unwrap() {
        if path.is_dir() {
            all.extend(modes(&path));
        } else {
            let mode = fs::metadata(&path).unwrap().permissions().mode() & 0o777;
            all.push((path, mode));
        }
    }
    all
}

#[cfg(unix)]
fn is_private(folder: &Path) {
    let all = modes(folder);
    assert!(all.len() > 4, "{all:?}");
    for (path, mode) in all {
        let expected = if path.is_dir() { 0o700 } else { 0o600 };
        assert_eq!(mode, expected, "{}", path.display());
    }
}

#[test]
fn without_consent_no_session_begins_and_its_text_stays() {
    let study = study();
    assert!(matches!(
        study.begin("P01", false),
        Err(StoreError::NoConsent(_))
    ));
    assert_eq!(study.store.participants().unwrap(), [""; 0]);
    let held = study.begin("P01", true).unwrap();
    let hash = held.begun().consent_sha256.clone().unwrap();
    // `printf 'I agree.' | sha256sum`
    assert_eq!(hash, CONSENT_SHA256);
    fs::write(study.home.path().join("consent.txt"), "I agree to more.").unwrap();
    let kept = study
        .store
        .folder()
        .join(CONSENT)
        .join(format!("{hash}.txt"));
    assert_eq!(fs::read_to_string(kept).unwrap(), "I agree.");
    assert!(matches!(
        study.begin("p01", true),
        Err(StoreError::Taken(_))
    ));
    let other = study.begin("P02", true).unwrap();
    assert_ne!(other.begun().consent_sha256, Some(hash));
    #[cfg(unix)]
    is_private(study.store.folder());
}

#[test]
fn pseudonyms_have_a_digit_and_lead_nowhere() {
    for good in ["P01", "7", "group-a-12", "x1"] {
        assert!(check_pseudonym(good).is_ok(), "{good}");
    }
    let long = "1".repeat(25);
    for bad in [
        "", "Anna", "../P1", "P 1", "-1", "P1/..", "com1", "é1", ".1", &long,
    ] {
        assert!(check_pseudonym(bad).is_err(), "{bad}");
    }
}

#[test]
fn a_folder_of_others_is_no_study() {
    let home = tempfile::tempdir().unwrap();
    fs::write(home.path().join("thesis.tex"), "mine").unwrap();
    assert!(matches!(
        Store::create(home.path()),
        Err(StoreError::NoStudy(_))
    ));
    assert!(matches!(
        Store::open(&home.path().join("none")),
        Err(StoreError::NoStudy(_))
    ));
    assert_eq!(entries(home.path()).unwrap().len(), 1);
}

#[test]
fn one_participant_is_exported_and_deleted() {
    let study = study();
    for participant in ["P01", "P02"] {
        let mut held = study.begin(participant, true).unwrap();
        held.answer(Response::Choice(1), 1.0).unwrap();
    }
    let out = study.home.path().join("out");
    study.store.export("P01", &out).unwrap();
    #[cfg(unix)]
    is_private(&out);
    let session = out.join("can-you-feel-it-1");
    let held = Held::read(&session).unwrap();
    assert!(held.begun().participant == "P01" && held.session().rows().len() == 1);
    let consent = held.begun().consent_sha256.clone().unwrap();
    assert!(out.join(CONSENT).join(format!("{consent}.txt")).is_file());
    assert!(matches!(
        study.store.export("P01", &out),
        Err(StoreError::Write { .. })
    ));
    assert!(matches!(
        study.store.export("P03", &out),
        Err(StoreError::NoParticipant(_))
    ));

    assert_eq!(study.store.delete("P01", false).unwrap(), 1);
    assert_eq!(study.store.participants().unwrap(), ["P02"]);
    assert!(matches!(
        study.store.delete("P01", false),
        Err(StoreError::NoParticipant(_))
    ));
    assert_eq!(study.store.sessions().unwrap().len(), 1);
    let left = names_below(study.store.folder());
    assert!(left.iter().all(|name| !name.contains("P01")), "{left:?}");
}

/// A session of a clinician, of which the last line has no end.
fn judged(study: &Study, participant: &str) -> PathBuf {
    let protocol = study.home.path().join("knees.toml");
    let text = "title = 'Knees'\nconsent = 'consent.txt'\n[realism]\npresets = ['coarse', 'fine']\nrepeats = 2";
    fs::write(&protocol, text).unwrap();
    let beginning = Beginning {
        protocol: &protocol,
        participant,
        seed: None,
        has_consented: true,
        unix_s: 7,
    };
    let (mut held, _) = study.store.begin(beginning, Known::SHIPPED).unwrap();
    for (trial, said) in [
        (1.0, "like the knee of Mr. X,\n\"gravel\""),
        (2.0, "smooth"),
    ] {
        held.answer(Response::Description(said.to_owned()), trial)
            .unwrap();
        let rating = Rating {
            realism: vec![3],
            severity: 2,
            finding: Finding::find("crepitus").unwrap(),
        };
        held.answer(Response::Rating(rating), trial).unwrap();
    }
    let trials = held.folder().join(TRIALS);
    let mut table = OpenOptions::new().append(true).open(trials).unwrap();
    table.write_all(b"3,coa").unwrap();
    held.folder().to_owned()
}

#[test]
fn a_description_without_its_rating_is_kept() {
    let study = study();
    let own = judged(&study, "C1");
    let described = |study: &Study| {
        let all = study.store.sessions_of("C1").unwrap();
        all[0].session().described().map(str::to_owned)
    };
    // That of the last trial has its rating.
    assert!(own.join(DESCRIBED).is_file());
    assert_eq!(described(&study), None);
    let mut held = Held::open(&own).unwrap();
    held.answer(Response::Description("stiff,\nthen soft".to_owned()), 3.0)
        .unwrap();
    drop(held);
    assert_eq!(described(&study).as_deref(), Some("stiff, then soft"));
    let mut held = Held::open(&own).unwrap();
    let rating = Rating {
        realism: vec![4],
        severity: 1,
        finding: Finding::find("crepitus").unwrap(),
    };
    let row = held.answer(Response::Rating(rating), 4.0).unwrap();
    assert!(matches!(row, Some(Row::Realism(row)) if row.description == "stiff, then soft"));
    drop(held);
    assert_eq!(described(&study), None);
    #[cfg(unix)]
    is_private(study.store.folder());
    assert_eq!(study.store.delete("C1", false).unwrap(), 1);
}

#[test]
fn a_deposit_is_the_study_without_what_tells_people() {
    let study = study();
    let mut held = study.begin("P01", true).unwrap();
    held.answer(Response::Choice(1), 1.0).unwrap();
    let own = judged(&study, "C1");
    fs::write(own.join("notes.txt"), "Mr. X").unwrap();
    fs::write(study.store.folder().join("C1/phone.txt"), "of C1").unwrap();

    let whole = study.home.path().join("whole");
    assert_eq!(study.store.deposit(&whole, true).unwrap(), 2);
    let rows = |store: &Store| {
        let all = store.sessions().unwrap();
        all.iter()
            .map(|held| held.session().rows().to_vec())
            .collect::<Vec<_>>()
    };
    assert_eq!(rows(&Store::open(&whole).unwrap()), rows(&study.store));

    let for_others = study.home.path().join("for-others");
    assert_eq!(study.store.deposit(&for_others, false).unwrap(), 2);
    #[cfg(unix)]
    is_private(&for_others);
    let names = names_below(&for_others).join("\n");
    assert!(
        !names.contains("notes") && !names.contains("phone"),
        "{names}"
    );
    let deposit = Store::open(&for_others).unwrap();
    let mut expected = rows(&study.store);
    for row in expected.iter_mut().flatten() {
        if let Row::Realism(row) = row {
            row.description = LEFT_OUT.to_owned();
        }
    }
    assert_eq!(rows(&deposit), expected);
    let of = deposit.sessions_of("C1").unwrap();
    let text = fs::read_to_string(of[0].folder().join(TRIALS)).unwrap();
    assert!(!text.contains("Mr. X") && text.ends_with('\n'), "{text}");
    assert_eq!(
        of[0].begun(),
        study.store.sessions_of("C1").unwrap()[0].begun()
    );
    let consent = of[0].begun().consent_sha256.clone().unwrap();
    assert!(
        for_others
            .join(CONSENT)
            .join(format!("{consent}.txt"))
            .is_file()
    );
    // Nothing is replaced, and nothing is left of what failed.
    let before = entries(study.home.path()).unwrap();
    let refused = study.store.deposit(&for_others, true);
    assert!(matches!(refused, Err(StoreError::Write { .. })));
    assert_eq!(entries(study.home.path()).unwrap(), before);
}

/// Names of everything below a folder.
fn names_below(folder: &Path) -> Vec<String> {
    let mut all = Vec::new();
    for path in entries(folder).unwrap() {
        all.push(path.display().to_string());
        if path.is_dir() {
            all.extend(names_below(&path));
        }
    }
    all
}

#[test]
fn files_of_others_are_not_deleted_unless_forced() {
    let study = study();
    let held = study.begin("P01", true).unwrap();
    let own = held.folder().to_owned();
    let refused = study.store.delete("P01", true);
    assert!(matches!(
        refused,
        Err(StoreError::Table(TableError::Locked(_)))
    ));
    drop(held);
    for foreign in [
        own.join("notes.txt"),
        study.store.folder().join("P01/notes.txt"),
    ] {
        fs::write(&foreign, "mine").unwrap();
        let refused = study.store.delete("P01", false);
        assert!(matches!(refused, Err(StoreError::Foreign(file)) if file == foreign));
        assert!(own.join(TRIALS).is_file());
        fs::remove_file(&foreign).unwrap();
    }
    fs::write(own.join("notes.txt"), "mine").unwrap();
    assert_eq!(study.store.delete("P01", true).unwrap(), 1);
}

#[cfg(unix)]
#[test]
fn a_link_is_no_participant() {
    let study = study();
    let elsewhere = study.home.path().join("elsewhere");
    fs::create_dir(&elsewhere).unwrap();
    fs::write(elsewhere.join("mine"), "mine").unwrap();
    std::os::unix::fs::symlink(&elsewhere, study.store.folder().join("P09")).unwrap();
    assert!(matches!(
        study.store.delete("P09", true),
        Err(StoreError::NoParticipant(_))
    ));
    assert!(elsewhere.join("mine").is_file());
}

const CONSENT_SHA256: &str = "826ff0dab649a97ffdd7779a332accafb35cc161012253a19383db19289d6e02";
