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
    /// A step of a session of an experiment.
    Experiment(ExperimentStep),
    /// The protocols, and the sessions that were interrupted.
    Experiments,
    /// Results of all sessions.
    ExperimentResults,
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

/// A step of a session; trials and intervals are numbered from 1.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(tag = "step", rename_all = "kebab-case")]
pub(crate) enum ExperimentStep {
    /// Begin a session, or continue the participant's last one.
    Begin {
        file: String,
        participant: String,
        /// SHA-256 of the text to which the participant has consented.
        #[serde(default)]
        consented: Option<String>,
    },
    /// Give an interval to the device.
    Feel { trial: usize, interval: usize },
    /// An alternative.
    Choose { trial: usize, answer: u8 },
    /// A description, before the rating.
    Describe { trial: usize, text: String },
    /// The rating of a knee, of the whole and of each feature.
    Rate {
        trial: usize,
        realism: Vec<u8>,
        severity: String,
        finding: String,
    },
    /// Put the session away; it can be continued unless it is over.
    Leave,
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
                | Self::Experiment(
                    ExperimentStep::Begin { .. }
                        | ExperimentStep::Feel { .. }
                        | ExperimentStep::Leave
                )
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
                | Self::Experiment(ExperimentStep::Begin { .. } | ExperimentStep::Feel { .. })
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
            | Self::Experiments
            | Self::ExperimentResults
            | Self::Recordings
            | Self::Open { .. }
            | Self::Trace { .. } => Right::Teacher,
            _ => Right::Control,
        }
    }
}

#[cfg(test)]
mod tests;
