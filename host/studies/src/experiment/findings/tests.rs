use super::super::finding::Finding;
use super::super::protocol::Known;
use super::super::store::{Beginning, Store};
use super::super::trial::{Rating, Response};
use super::*;
use std::fs;

/// A study with sessions of these participants, who answer every trial with `answer`.
fn study(protocol: &str, participants: &[&str], answer: fn(usize) -> Vec<Response>) -> Vec<Held> {
    let home = tempfile::tempdir().unwrap();
    let file = home.path().join("p.toml");
    fs::write(&file, protocol).unwrap();
    let store = Store::create(&home.path().join("study")).unwrap();
    for participant in participants {
        let beginning = Beginning {
            protocol: &file,
            participant,
            seed: None,
            has_consented: false,
            unix_s: 7,
        };
        let (mut held, _) = store.begin(beginning, Known::SHIPPED).unwrap();
        while let Some(trial) = held.trial() {
            for response in answer(trial.number) {
                held.answer(response, 1.0).unwrap();
            }
        }
    }
    store.sessions().unwrap()
}

fn all(sessions: &[Held]) -> Vec<Findings> {
    Findings::all(sessions, |name| Known::SHIPPED.find(name)).unwrap()
}

fn rating(number: usize) -> Vec<Response> {
    let rating = Rating {
        realism: vec![if number.is_multiple_of(2) { 4 } else { 3 }, 2],
        severity: 1,
        finding: Finding::find("crepitus").unwrap(),
    };
    vec![
        Response::Description("grating <here>".to_owned()),
        Response::Rating(rating),
    ]
}

const REALISM: &str = "title = 'Knees of spring'\n[realism]\npresets = ['coarse', 'mas-2-catch']\nhealthy = 2\n\
    features = ['grating']";

#[test]
fn a_realism_session_fills_the_evidence_of_presets() {
    let all = all(&study(REALISM, &["C1", "C2"], rating));
    let findings = all.first().unwrap();
    let judgements = findings.judgements("2026-11-30");
    let names: Vec<_> = judgements.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["coarse", "mas-2-catch"]);
    let coarse = &judgements[0].1;
    assert_eq!((coarse.clinicians, coarse.ratings), (2, 4));
    assert_eq!(coarse.sha256, hash_of(findings.table.as_bytes()));
    assert!(
        coarse.statistic.starts_with("realism 3."),
        "{}",
        coarse.statistic
    );
    assert!(coarse.statistic.ends_with("type right 4 of 4"));
    assert!(coarse.statistic.chars().count() <= 120);
    let parsed = format!("[effects.texture]\n{}", coarse.to_toml());
    let preset = crepitus_scene::Preset::parse(std::path::Path::new("m.toml"), &parsed).unwrap();
    assert_eq!(preset.judged, std::slice::from_ref(coarse));
    assert_eq!(findings.table.lines().count(), 1 + 12);
    assert!(
        findings
            .table
            .starts_with("participant,session,trial,knee,")
    );
}

#[test]
fn text_and_page_have_every_result() {
    let all = all(&study(REALISM, &["C1", "C2"], rating));
    let findings = all.first().unwrap();
    let text = findings.to_text();
    for part in [
        "Knees of spring",
        "2 sessions",
        "ICC(3,1)",
        "coarse",
        "grating <here>",
        "4 of 4",
        &findings.sha256,
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let page = html(&all);
    assert!(page.contains("grating &lt;here&gt;") && !page.contains("<here>"));
    let json = findings.to_json();
    assert_eq!(json["found"]["false_alarms"], serde_json::json!([4, 4]));
    assert_eq!(json["found"]["features"][1]["feature"], "grating");
}

#[test]
fn choices_are_counted_by_participant() {
    let protocol = "title = 'T'\n[threshold]\nquantity = 'torque'\n[threshold.constant]\ndifferences = [0.1]\nrepeats = 6\n\
        catch_trials = 2";
    let sessions = study(protocol, &["P1", "P2"], |_| vec![Response::Choice(1)]);
    let findings = all(&sessions);
    let Found::Threshold(participants) = &findings[0].found else {
        panic!("a threshold")
    };
    for of in participants {
        let counts: Vec<_> = of
            .counts
            .iter()
            .map(|c| (c.difference, c.trials, c.right))
            .collect();
        // Who always says the first is right in half of the trials.
        assert_eq!(counts, [(0.0, 2, 2), (0.1, 6, 3)]);
    }
    assert!(findings[0].to_text().contains("fit_threshold"));
    let protocol = "title = 'T'\n[abx]\ntrials = 10\na = {}\nb = { preset = 'fine' }";
    let findings = all(&study(protocol, &["P1", "P2"], |_| {
        vec![Response::Choice(2)]
    }));
    let Found::Abx(each, Some(all)) = &findings[0].found else {
        panic!("A, B and X")
    };
    assert_eq!((each.len(), all.trials, all.right), (2, 20, 10));
    assert_eq!(findings[0].to_json()["found"]["all"]["share"], 0.5);
}

#[test]
fn each_protocol_has_its_results() {
    let mut sessions = study(REALISM, &["C1"], rating);
    sessions.extend(study(
        &REALISM.replace("spring", "autumn"),
        &["C1", "C2"],
        rating,
    ));
    let all = all(&sessions);
    let found: Vec<_> = all
        .iter()
        .map(|f| (f.protocol.title.as_str(), f.sessions))
        .collect();
    assert_eq!(found, [("Knees of spring", 1), ("Knees of autumn", 2)]);
}
