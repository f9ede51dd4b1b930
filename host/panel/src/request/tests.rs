use super::*;

fn request(text: &str) -> Result<Request, String> {
    match serde_json::from_str(text) {
        Ok(Message::Request { request, .. }) => Ok(request),
        Ok(Message::Seen { .. } | Message::Listen { .. } | Message::Hand { .. }) => {
            Err("no request".to_owned())
        }
        Err(error) => Err(error.to_string()),
    }
}

#[test]
fn requests_are_what_pages_send() {
    assert_eq!(request(r#"{"id":1,"do":"stop"}"#), Ok(Request::Stop));
    assert_eq!(
        request(r#"{"id":2,"do":"set","changes":[[1,0.5],[7,2]]}"#),
        Ok(Request::Set {
            changes: vec![(1, 0.5), (7, 2.0)]
        })
    );
    let target = |text: &str| match request(text) {
        Ok(Request::Target { target }) => target,
        other => panic!("{other:?}"),
    };
    assert_eq!(target(r#"{"id":3,"do":"target","target":null}"#), None);
    assert_eq!(
        target(r#"{"id":3,"do":"target","target":"slow"}"#),
        Some(AimAt::Named("slow".to_owned()))
    );
    assert!(matches!(
        target(r#"{"id":3,"do":"target","target":{"beats_per_min":60}}"#),
        Some(AimAt::Beat { .. })
    ));
    assert!(matches!(
        target(r#"{"id":3,"do":"target","target":{"low_deg_per_s":60}}"#),
        Some(AimAt::Band { .. })
    ));
    assert!(matches!(
        serde_json::from_str(r#"{"seen":4}"#),
        Ok(Message::Seen { seen: 4 })
    ));
    assert!(matches!(
        serde_json::from_str(r#"{"hand":-12.5,"holds":true}"#),
        Ok(Message::Hand { hand, holds: true }) if hand == -12.5
    ));
    assert!(matches!(
        serde_json::from_str(r#"{"listen":true}"#),
        Ok(Message::Listen { listen: true })
    ));
}

#[test]
fn what_no_page_sends_is_rejected() {
    for text in [
        "",
        "{}",
        "[]",
        r#"{"id":1}"#,
        r#"{"id":1,"do":"explode"}"#,
        r#"{"id":-1,"do":"stop"}"#,
        r#"{"id":1,"do":"set","changes":[[300,1]]}"#,
        r#"{"seen":-1}"#,
        r#"{"listen":1}"#,
        r#"{"hand":1e999,"holds":true}"#,
        r#"{"hand":NaN,"holds":true}"#,
        r#"{"hand":null,"holds":true}"#,
        r#"{"hand":"1","holds":true}"#,
        r#"{"hand":1}"#,
    ] {
        assert!(request(text).is_err(), "{text}");
    }
}

/// Late, an order to end torque is harmless, and one that can give some is not.
#[test]
fn what_gives_torque_expires_and_what_ends_it_does_not() {
    let expiring = [
        "take",
        "zero",
        "arm",
        "clear-fault",
        "apply",
        "set",
        "reset",
        "save",
        "lesson-begin",
        "lesson-start",
        "lesson-next",
        "lesson-resume",
        "severity",
        "begin",
        "feel",
    ];
    for text in ALL {
        let name = named(text);
        let request = request(&numbered(text)).expect(text);
        assert_eq!(request.expires(), expiring.contains(&name), "{name}");
    }
}

/// Everything that a page can ask for.
const ALL: &[&str] = &[
    r#"{"do":"stop"}"#,
    r#"{"do":"take"}"#,
    r#"{"do":"release"}"#,
    r#"{"do":"zero"}"#,
    r#"{"do":"arm"}"#,
    r#"{"do":"disarm"}"#,
    r#"{"do":"clear-fault"}"#,
    r#"{"do":"apply","preset":"a"}"#,
    r#"{"do":"set","changes":[]}"#,
    r#"{"do":"reset"}"#,
    r#"{"do":"save"}"#,
    r#"{"do":"save-preset","name":"a"}"#,
    r#"{"do":"target","target":null}"#,
    r#"{"do":"score","running":true}"#,
    r#"{"do":"examine"}"#,
    r#"{"do":"note","text":"a"}"#,
    r#"{"do":"record","running":true}"#,
    r#"{"do":"lesson-begin","students":[]}"#,
    r#"{"do":"lesson-start"}"#,
    r#"{"do":"lesson-answer","student":"A","disorder":"clonus","confidence":1}"#,
    r#"{"do":"lesson-next"}"#,
    r#"{"do":"lesson-end"}"#,
    r#"{"do":"lesson-close"}"#,
    r#"{"do":"lessons"}"#,
    r#"{"do":"experiments"}"#,
    r#"{"do":"experiment-results"}"#,
    r#"{"do":"experiment","step":"begin","file":"a.toml","participant":"P01"}"#,
    r#"{"do":"experiment","step":"feel","trial":1,"interval":1}"#,
    r#"{"do":"experiment","step":"choose","trial":1,"answer":1}"#,
    r#"{"do":"experiment","step":"describe","trial":1,"text":"a"}"#,
    r#"{"do":"experiment","step":"rate","trial":1,"realism":[3],"severity":"mild","finding":"clonus"}"#,
    r#"{"do":"experiment","step":"leave"}"#,
    r#"{"do":"lesson-resume","folder":"a"}"#,
    r#"{"do":"severity","worse":true}"#,
    r#"{"do":"class","open":true}"#,
    r#"{"do":"free-seat","student":"A"}"#,
    r#"{"do":"join","name":"A"}"#,
    r#"{"do":"answer","trial":1,"disorder":"clonus","confidence":1}"#,
    r#"{"do":"report"}"#,
    r#"{"do":"fault","code":1}"#,
    r#"{"do":"recordings"}"#,
    r#"{"do":"open","recording":0}"#,
    r#"{"do":"trace","recording":0,"from_s":0,"to_s":1,"points":1}"#,
];

/// Name of a request, or of its step.
fn named(text: &str) -> &str {
    let place = if text.contains("\"step\"") { 7 } else { 3 };
    text.split('"').nth(place).unwrap()
}

/// The text of a request with a number, as a page sends it.
fn numbered(text: &str) -> String {
    text.replacen('{', r#"{"id":1,"#, 1)
}

/// Requests that a role may make at all, whoever has control.
#[test]
fn each_role_has_the_least_rights() {
    let may = |role: Role| -> Vec<&str> {
        let requests = ALL.iter().map(|text| {
            let request = request(&numbered(text));
            (request.expect(text).right(), text)
        });
        requests
            .filter(|(right, _)| right.is_of(role))
            .map(|(_, text)| text.split('"').nth(3).unwrap())
            .collect()
    };
    assert_eq!(may(Role::Student), ["stop", "join", "answer"]);
    assert_eq!(may(Role::Viewer), ["stop", "fault"]);
    let remote = [
        "stop",
        "note",
        "lesson-start",
        "lesson-next",
        "severity",
        "fault",
    ];
    assert_eq!(may(Role::Remote), remote);
    // A teacher has every right but that of a student, who answers for one person alone.
    assert_eq!(may(Role::Teacher).len(), ALL.len() - 2);
}

#[test]
fn stop_is_for_everybody() {
    assert_eq!(Request::Stop.right(), Right::Anybody);
    assert_eq!(Request::Arm.right(), Right::Control);
    assert_eq!(
        Request::Report {
            language: String::new()
        }
        .right(),
        Right::Teacher
    );
}
