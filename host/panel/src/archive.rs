//! Recordings, for looking at: a thread of its own, so that reading one delays nothing.
//!
//! Of an open recording it keeps bins of each millisecond with samples, 56 bytes each. A trace of a longer
//! time is joined from these; of a shorter one the samples themselves are read again.

mod lessons;
mod opened;

use crate::frame::{Header, Kind, Masks, frame};
use axum::body::Bytes;
use crepitus_recording::{Damage, Recording};
use lessons::Sessions;
use opened::Opened;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::sync::mpsc::Receiver;
use std::time::UNIX_EPOCH;
use tokio::sync::oneshot;

/// Recordings that are open at once.
const MOST_OPEN: usize = 2;

/// Recordings of a list.
const MOST_LISTED: usize = 500;

/// A question about recordings.
pub(crate) struct Question {
    pub(crate) what: Asked,
    pub(crate) reply: oneshot::Sender<Result<ArchiveAnswer, String>>,
}

/// Content of a question.
pub(crate) enum Asked {
    /// List of the recordings.
    List,
    /// List of the lessons that can be continued.
    Lessons,
    /// Facts of one.
    Open { recording: u32 },
    /// Bins of one; `id` is the request's.
    Trace {
        id: u32,
        recording: u32,
        from_s: f64,
        to_s: f64,
        points: u16,
    },
}

/// Answer to a question.
pub(crate) enum ArchiveAnswer {
    Facts(Value),
    Trace(Bytes),
}

/// Reads recordings.
pub(crate) struct Archive {
    /// Recordings of the command line.
    given: Vec<PathBuf>,
    /// Folder of the sessions.
    sessions: Option<PathBuf>,
    /// Files that were listed; the place of one is its number.
    listed: Vec<PathBuf>,
    /// The one used last is the last.
    open: Vec<(u32, Opened)>,
}

impl Archive {
    pub(crate) fn new(given: Vec<PathBuf>, sessions: Option<PathBuf>) -> Self {
        Self {
            listed: given.clone(),
            given,
            sessions,
            open: Vec::new(),
        }
    }

    /// Answers until nobody can ask any more.
    pub(crate) fn run(mut self, inbox: &Receiver<Question>) {
        while let Ok(Question { what, reply }) = inbox.recv() {
            let found = self.answer(&what);
            // The page may be gone.
            let _ = reply.send(found);
        }
    }

    fn answer(&mut self, what: &Asked) -> Result<ArchiveAnswer, String> {
        match *what {
            Asked::List => Ok(ArchiveAnswer::Facts(self.list())),
            Asked::Open { recording } => {
                // Again, if it has grown since.
                self.open.retain(|(number, _)| *number != recording);
                let mut facts = self.opened(recording)?.facts();
                facts["id"] = json!(recording);
                facts["name"] = json!(self.listed.get(place(recording)).map(|p| self.name_of(p)));
                if let Some(path) = self.listed.get(place(recording)) {
                    facts["lesson"] = Sessions::default().trial(path);
                }
                Ok(ArchiveAnswer::Facts(facts))
            }
            Asked::Trace {
                id,
                recording,
                from_s,
                to_s,
                points,
            } => {
                let trace = self.opened(recording)?.trace(from_s, to_s, points)?;
                let header = Header {
                    kind: Kind::Trace,
                    number: id,
                    unix_ms: 0.0,
                    begin_s: trace.begin_s,
                    bin_s: trace.bin_s,
                    missing: 0,
                    masks: Masks::default(),
                };
                Ok(ArchiveAnswer::Trace(frame(&header, &trace.bins)))
            }
            Asked::Lessons => {
                let lessons = lessons::unfinished(self.sessions.as_deref());
                Ok(ArchiveAnswer::Facts(lessons))
            }
        }
    }

    /// Those given, and those of the sessions' folder, the newest first.
    fn list(&mut self) -> Value {
        let mut found = Vec::new();
        if let Some(folder) = &self.sessions {
            collect(folder, 2, &mut found);
        }
        found.sort_by_key(|(_, modified_s)| std::cmp::Reverse(*modified_s));
        let given = self
            .given
            .iter()
            .map(|path| (path.clone(), modified_s(path)));
        let files: Vec<_> = given.chain(found).take(MOST_LISTED).collect();
        let mut sessions = Sessions::default();
        let list = files.iter().map(|(path, modified_s)| {
            let number = self.number_of(path);
            let size = std::fs::metadata(path).map_or(0, |m| m.len());
            json!({
                "id": number,
                "name": self.name_of(path),
                "size": size,
                "when": modified_s,
                "lesson": sessions.trial(path),
            })
        });
        // Numbers stay what they are: pages have them.
        let list: Vec<_> = list.collect();
        json!({ "files": list })
    }

    /// The number of a file; a new one if it was not listed before.
    fn number_of(&mut self, path: &Path) -> usize {
        if let Some(place) = self.listed.iter().position(|known| known == path) {
            return place;
        }
        self.listed.push(path.to_owned());
        self.listed.len() - 1
    }

    /// Path of a file within the folder of sessions, or the whole path.
    fn name_of(&self, path: &Path) -> String {
        let short = (self.sessions.as_ref()).and_then(|folder| path.strip_prefix(folder).ok());
        short.unwrap_or(path).display().to_string()
    }

    fn opened(&mut self, number: u32) -> Result<&mut Opened, String> {
        let found = self.open.iter().position(|(open, _)| *open == number);
        let opened = if let Some(place) = found {
            self.open.remove(place).1
        } else {
            let path = self.listed.get(place(number));
            let path = path.ok_or("there is no such recording: reload the list")?;
            if lessons::is_hidden(path, self.sessions.as_deref()) {
                return Err(
                    "this recording is of a blind lesson that has not ended: continue the \
                     lesson, and end it first"
                        .to_owned(),
                );
            }
            let recording = Recording::open(path, Damage::Salvage).map_err(|e| e.to_string())?;
            Opened::new(recording)?
        };
        if self.open.len() >= MOST_OPEN {
            self.open.remove(0);
        }
        self.open.push((number, opened));
        let (_, opened) = self.open.last_mut().ok_or("no recording is open")?;
        Ok(opened)
    }
}

fn place(number: u32) -> usize {
    usize::try_from(number).unwrap_or(usize::MAX)
}

/// Recordings in a folder, and so deep below it.
fn collect(folder: &Path, depth: u32, found: &mut Vec<(PathBuf, u64)>) {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return;
    };
    for path in entries.filter_map(|entry| Some(entry.ok()?.path())) {
        let is_one = (path.extension()).is_some_and(|e| e == "parquet" || e == "crepitus");
        let is_hidden = path
            .file_name()
            .is_some_and(|n| n.to_string_lossy().starts_with('.'));
        if is_hidden {
            continue;
        }
        if path.is_dir() && depth > 0 {
            collect(&path, depth - 1, found);
        } else if is_one {
            let modified_s = modified_s(&path);
            found.push((path, modified_s));
        }
    }
}

/// Seconds since 1970; 0 if it is not known.
fn modified_s(path: &Path) -> u64 {
    let modified = std::fs::metadata(path).and_then(|m| m.modified()).ok();
    let since = modified.and_then(|time| time.duration_since(UNIX_EPOCH).ok());
    since.map_or(0, |since| since.as_secs())
}
