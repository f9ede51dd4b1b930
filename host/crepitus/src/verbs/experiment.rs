//! `crepitus experiment`: thresholds, A or B, and realism, with participants.

mod ask;
mod evidence;
mod results;
mod session;

use crate::cli::Force;
use crate::failure::{Failure, print, print_json};
use crate::own_presets;
use clap::{Args, Subcommand, ValueEnum, ValueHint};
use crepitus_files::output::{Inputs, NewFile};
use crepitus_scene::Preset;
use crepitus_studies::experiment::finding::Knee;
use crepitus_studies::experiment::store::Store;
use crepitus_studies::experiment::{StoreError, protocol};
use serde_json::json;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Run an experiment with participants: thresholds, A or B, realism.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus experiment new threshold torque.toml
  crepitus experiment run torque.toml --study study --participant P01 --zero
  crepitus experiment results study
  crepitus experiment evidence study
  crepitus experiment export study P01 --out of-P01
  crepitus experiment delete study P01

Whoever runs it is as blind as the participant. A session that was interrupted goes on, with the trials \
that would have come, by the same command. Answers are in the folder of the study alone, by pseudonym, \
readable by this user only; nothing there is replaced, and `delete` leaves files that no session has written \
unless --force is given.")]
pub(crate) struct Arguments {
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, Subcommand)]
enum Action {
    /// Write a protocol to begin with.
    New {
        /// Kind of the protocol.
        kind: Kind,
        /// The new file.
        #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
        file: PathBuf,
        #[command(flatten)]
        force: Force,
    },
    Run(session::Run),
    Results(results::Results),
    /// Note what a realism session found as evidence of its presets.
    ///
    /// Wherever a preset is shown, number of clinicians, day, realism with its interval and the hash of all
    /// ratings are beside it. Those of presets that ship are kept in `judged`, a folder among your own presets.
    Evidence {
        /// Folder of the study.
        #[arg(value_name = "STUDY", value_hint = ValueHint::DirPath)]
        study: PathBuf,
    },
    /// Copy everything of a participant to a new folder.
    Export {
        /// Folder of the study.
        #[arg(value_name = "STUDY", value_hint = ValueHint::DirPath)]
        study: PathBuf,
        /// Pseudonym.
        participant: String,
        /// The new folder.
        #[arg(long, value_name = "DIR")]
        out: PathBuf,
    },
    /// Remove everything of a participant.
    Delete {
        /// Folder of the study.
        #[arg(value_name = "STUDY", value_hint = ValueHint::DirPath)]
        study: PathBuf,
        /// Pseudonym.
        participant: String,
        /// Remove files, too, that no session has written.
        #[arg(long)]
        force: bool,
    },
}

/// Protocols to begin with.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Kind {
    /// A threshold, by staircases.
    Threshold,
    /// A threshold, by constant stimuli.
    Constant,
    /// Whether A and B are told apart.
    Abx,
    /// Clinicians' judgement of knees.
    Realism,
}

impl Kind {
    const fn text(self) -> &'static str {
        match self {
            Self::Threshold => protocol::EXAMPLES[0],
            Self::Constant => protocol::EXAMPLES[1],
            Self::Abx => protocol::EXAMPLES[2],
            Self::Realism => protocol::EXAMPLES[3],
        }
    }
}

pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    match &arguments.action {
        Action::New { kind, file, force } => new(*kind, file, *force),
        Action::Run(arguments) => session::run(arguments, as_json),
        Action::Results(arguments) => results::run(arguments, as_json),
        Action::Evidence { study } => evidence::run(study, as_json),
        Action::Export {
            study,
            participant,
            out,
        } => {
            let store = Store::open(study).map_err(failure)?;
            store.export(participant, out).map_err(failure)?;
            done(&format!("{participant} is in {}", out.display()), as_json)
        }
        Action::Delete {
            study,
            participant,
            force,
        } => {
            let store = Store::open(study).map_err(failure)?;
            let count = store.delete(participant, *force).map_err(failure)?;
            done(
                &format!("{participant} is deleted: {count} sessions"),
                as_json,
            )
        }
    }
}

fn new(kind: Kind, path: &Path, force: Force) -> Result<(), Failure> {
    let file = NewFile::create(path, force.force, &Inputs::default())?;
    let written = file.as_file().write_all(kind.text().as_bytes());
    written.map_err(|error| Failure::at(path, "cannot be written", &error))?;
    file.persist()?;
    Ok(())
}

fn done(what: &str, as_json: bool) -> Result<(), Failure> {
    if as_json {
        return print_json(&json!({ "done": what }));
    }
    print(&format!("{what}\n"))
}

/// A knee of the user's own presets.
fn own_knee(name: &str) -> Option<Knee> {
    let file = own_presets::find(name)?;
    Preset::read(&file).ok().as_ref().map(Knee::from)
}

/// A disk that is full is no mistake of the user's.
fn failure(error: StoreError) -> Failure {
    match error {
        StoreError::Write { path, cause } => Failure::at(&path, "cannot be written", &cause),
        error => Failure::input(error),
    }
}
