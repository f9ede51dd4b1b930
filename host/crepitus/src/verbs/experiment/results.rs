//! `crepitus experiment results`.

use super::{failure, own_knee};
use crate::cli::Force;
use crate::failure::{Failure, print, print_json};
use clap::{Args, ValueHint};
use crepitus_files::output::Folder;
use crepitus_studies::experiment::Findings;
use crepitus_studies::experiment::findings::html;
use crepitus_studies::experiment::protocol::Known;
use crepitus_studies::experiment::store::Store;
use std::fs::OpenOptions;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Show what a study has found so far.
#[derive(Debug, Args)]
pub(super) struct Results {
    /// Folder of the study.
    #[arg(value_name = "STUDY", value_hint = ValueHint::DirPath)]
    study: PathBuf,

    /// Folder for report.html, summary.json, and trials-1.csv, … of each protocol [default: none].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    #[command(flatten)]
    force: Force,
}

/// Results of a study, by protocol.
pub(super) fn of(study: &Path) -> Result<Vec<Findings>, Failure> {
    let sessions = Store::open(study).and_then(|store| store.sessions());
    let known = Known {
        own_preset: &own_knee,
    };
    let all = Findings::all(&sessions.map_err(failure)?, |name| known.find(name));
    let all = all.map_err(Failure::input)?;
    if all.is_empty() {
        let study = study.display();
        return Err(Failure::Input(format!("{study}: no session has begun yet")));
    }
    Ok(all)
}

pub(super) fn run(arguments: &Results, as_json: bool) -> Result<(), Failure> {
    let all = of(&arguments.study)?;
    let json: Vec<_> = all.iter().map(Findings::to_json).collect();
    if let Some(out) = &arguments.out {
        let none: [&Path; 0] = [];
        let tables = (1..)
            .zip(&all)
            .map(|(number, of)| (format!("trials-{number}.csv"), of.table.clone()));
        let summary = serde_json::to_string_pretty(&json).unwrap_or_default() + "\n";
        let files = [
            ("summary.json".to_owned(), summary),
            ("report.html".to_owned(), html(&all)),
        ];
        let files: Vec<_> = files.into_iter().chain(tables).collect();
        let claim = arguments.force.claim("experiment", none);
        let folder = Folder::create(out, claim, files.iter().map(|(name, _)| name))?;
        for (name, text) in &files {
            let written = write(&folder.path_of(Path::new(name)), text);
            written.map_err(|error| Failure::at(&out.join(name), "cannot be written", &error))?;
        }
        folder.commit()?;
    }
    if as_json {
        return print_json(&json);
    }
    let texts: Vec<_> = all.iter().map(Findings::to_text).collect();
    print(&texts.join("\n"))
}

/// Writes a file for this user alone: it has what participants said.
fn write(path: &Path, text: &str) -> io::Result<()> {
    let mut options = OpenOptions::new();
    options.write(true).create_new(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    let mut file = options.open(path)?;
    file.write_all(text.as_bytes())?;
    file.sync_all()
}
