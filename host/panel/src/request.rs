//! Messages of a page: requests, and the right that each needs; answers to frames; its hand.

use crate::tokens::Role;
use serde::Deserialize;
use serde_json::Value;

/// A message of a page.
#[derive(Debug, Deserialize)]
#[serde(untagged)]
pub(crate) enum Message {
    /// The frame of this number is on the screen.
    Seen {
        /// Number of the frame.
        seen: u32,
    },
    /// The page plays the torque as sound from now on, or no longer.
    Listen {
        /// The page plays it.
        listen: bool,
    },
    /// A request.
    Request {
        /// The reply has it, too.
        id: u32,
        /// Number of the newest frame that the page had when it was made.
        #[serde(default)]
        newest: Option<u32>,
        /// Requested action.
        #[serde(flatten)]
        request: Request,
    },
    /// The angle to which the page's hand moves the leg, °, or that it lets go. Without a reply; of the page in
    /// control alone.
    Hand {
        /// Angle of the knee.
        hand: f64,
        /// Whether the hand holds the leg.
        holds: bool,
    },
}

/// A request.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(tag = "do", rename_all = "kebab-case")]
pub(crate) enum Request {
    /// Torque off at once.
    Stop,
    /// Take control.
    Take,
    /// Give control away.
    Release,
    /// Set the angle's zero.
    Zero,
    /// Turn torque on.
    Arm,
    /// Turn torque off.
    Disarm,
    /// Clear faults.
    ClearFault,
    /// Apply a preset.
    Apply {
        preset: String,
        #[serde(default)]
        add: bool,
    },
    /// Set some parameters, in one commit.
    Set { changes: Vec<(u8, f64)> },
    /// Set all effects of the knee to their defaults.
    Reset,
    /// Save the parameters for the next start.
    Save,
    /// Save the knee as a preset.
    SavePreset(SavePreset),
    /// Judge by a target, or by none.
    Target { target: Option<AimAt> },
    /// Begin or end a score.
    Score { running: bool },
    /// Begin the examination again.
    Examine,
    /// Note something on the time line.
    Note { text: String },
    /// Begin or end a recording.
    Record {
        running: bool,
        #[serde(default)]
        name: String,
    },
    /// Begin a lesson.
    LessonBegin(LessonBegin),
    /// Begin its trial.
    LessonStart,
    /// A student's answer.
    LessonAnswer {
        student: String,
        disorder: String,
        #[serde(default)]
        level: Option<String>,
        confidence: u8,
    },
    /// The next trial.
    LessonNext,
    /// End it; its report is in this language.
    LessonEnd {
        #[serde(default)]
        language: String,
    },
    /// Put it away.
    LessonClose,
    /// The lessons that were interrupted.
    Lessons,
    /// Continue the one in this folder.
    LessonResume { folder: String },
    /// A milder or a worse knee of the same disorder.
    Severity { worse: bool },
    /// Let students join by phone, or no more.
    Class { open: bool },
    /// Take a student's seat from its phone.
    FreeSeat { student: String },
    /// Join the class; with the key of an earlier time under the name of that time.
    Join {
        name: String,
        #[serde(default)]
        key: Option<String>,
    },
    /// The answer of the student who has joined on this page, to this trial.
    Answer {
        trial: usize,
        disorder: String,
        #[serde(default)]
        level: Option<String>,
        confidence: u8,
    },
    /// Report of the lesson, in this language.
    Report {
        #[serde(default)]
        language: String,
    },
    /// The page of the book about a fault.
    Fault { code: u8 },
    /// The recordings that there are.
    Recordings,
    /// Facts of one.
    Open { recording: u32 },
    /// Bins of one.
    Trace {
        recording: u32,
        from_s: f64,
        to_s: f64,
        points: u16,
    },
}

/// A preset to save.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
pub(crate) struct SavePreset {
    /// Name of the file; empty: made of the title.
    #[serde(default)]
    pub(crate) name: String,
    #[serde(default)]
    pub(crate) title: String,
    #[serde(default)]
    pub(crate) feel: String,
    #[serde(default)]
    pub(crate) severity: String,
    #[serde(default)]
    pub(crate) source: String,
    #[serde(default)]
    pub(crate) disorder: Option<String>,
    #[serde(default)]
    pub(crate) replace: bool,
}

/// A target, by name or as numbers.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(untagged)]
pub(crate) enum AimAt {
    /// The name of one.
    Named(String),
    /// A metronome.
    Beat { beats_per_min: f64 },
    /// A band of speeds.
    Band {
        low_deg_per_s: f64,
        #[serde(default)]
        high_deg_per_s: Option<f64>,
    },
}

/// A lesson to begin: one that ships, or the page's own.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub(crate) struct LessonBegin {
    #[serde(default)]
    pub(crate) lesson: Option<String>,
    #[serde(default)]
    pub(crate) plan: Option<Value>,
    pub(crate) students: Vec<String>,
    #[serde(default)]
    pub(crate) seed: Option<u64>,
    #[serde(default)]
    pub(crate) repeats: Option<usize>,
}

/// Pages that may make a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Right {
    /// Every page.
    Anybody,
    /// Every page but a student's.
    Look,
    /// A page with the students' link.
    Student,
    /// A page with the teacher's link, or the remote's.
    Note,
    /// The page that has control; the remote, while a page has it.
    Run,
    /// A page with the teacher's link.
    Teacher,
    /// The page that has control.
    Control,
}

impl Right {
    /// Returns whether a link of this role can have it. Control is checked when a request is executed.
    pub(crate) fn is_of(self, role: Role) -> bool {
        match self {
            Self::Anybody => true,
            Self::Look => role != Role::Student,
            Self::Student => role == Role::Student,
            Self::Note | Self::Run => matches!(role, Role::Teacher | Role::Remote),
            Self::Teacher | Self::Control => role == Role::Teacher,
        }
    }
}

impl Request {
    /// Returns whether it is one to the device.
    pub(crate) fn needs_device(&self) -> bool {
        matches!(
            self,
            Self::Stop
                | Self::Zero
                | Self::Arm
                | Self::Disarm
                | Self::ClearFault
                | Self::Save
                | Self::Apply { .. }
                | Self::Set { .. }
                | Self::Reset
                | Self::Severity { .. }
                | Self::LessonStart
                | Self::LessonResume { .. }
        )
    }

    /// Returns whether it must not be executed late: it can give torque, or change what is felt.
    /// To end torque is never too late, and answers and notes are not lost.
    pub(crate) fn expires(&self) -> bool {
        matches!(
            self,
            Self::Take
                | Self::Zero
                | Self::Arm
                | Self::ClearFault
                | Self::Save
                | Self::Apply { .. }
                | Self::Set { .. }
                | Self::Reset
                | Self::Severity { .. }
                | Self::LessonBegin(_)
                | Self::LessonResume { .. }
                | Self::LessonStart
                | Self::LessonNext
        )
    }

    /// Pages that may make it.
    pub(crate) fn right(&self) -> Right {
        match self {
            Self::Stop => Right::Anybody,
            Self::Fault { .. } => Right::Look,
            Self::Join { .. } | Self::Answer { .. } => Right::Student,
            Self::Note { .. } => Right::Note,
            Self::LessonStart | Self::LessonNext | Self::Severity { .. } => Right::Run,
            Self::Take
            | Self::Release
            | Self::Report { .. }
            | Self::Class { .. }
            | Self::FreeSeat { .. }
            | Self::Lessons
            | Self::Recordings
            | Self::Open { .. }
            | Self::Trace { .. } => Right::Teacher,
            _ => Right::Control,
        }
    }
}

#[cfg(test)]
mod tests {
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
        ];
        for text in ALL {
            let name = text.split('"').nth(3).unwrap();
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
}
