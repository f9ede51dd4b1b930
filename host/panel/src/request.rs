//! Messages of a page: requests, and the right that each needs; answers to frames; its hand.

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
        /// It plays it.
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
    /// A page with the teacher's link.
    Teacher,
    /// The page that has control.
    Control,
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
                | Self::LessonStart
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
                | Self::LessonBegin(_)
                | Self::LessonStart
                | Self::LessonNext
        )
    }

    /// Pages that may make it.
    pub(crate) fn right(&self) -> Right {
        match self {
            Self::Stop | Self::Fault { .. } => Right::Anybody,
            Self::Take
            | Self::Release
            | Self::Note { .. }
            | Self::Report { .. }
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
        for request in [
            Request::Arm,
            Request::Take,
            Request::Reset,
            Request::LessonStart,
        ] {
            assert!(request.expires(), "{request:?}");
        }
        for request in [Request::Stop, Request::Disarm, Request::Release] {
            assert!(!request.expires(), "{request:?}");
        }
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
