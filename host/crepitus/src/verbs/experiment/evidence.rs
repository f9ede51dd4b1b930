//! `crepitus experiment evidence`.

use super::results;
use crate::failure::{Failure, print, print_json};
use crepitus_files::output::{Inputs, NewFile};
use crepitus_panel::lesson::Started;
use crepitus_scene::preset::{self, Judgement};
use serde_json::json;
use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

/// Notes what was found of each preset, in place of what an earlier evaluation of the study found.
pub(super) fn run(study: &Path, as_json: bool) -> Result<(), Failure> {
    let date = today();
    let all = results::of(study)?;
    let judgements: Vec<_> = all
        .iter()
        .flat_map(|findings| findings.judgements(&date))
        .collect();
    if judgements.is_empty() {
        let study = study.display();
        return Err(Failure::Input(format!(
            "{study}: no knee was rated yet in a [realism] session"
        )));
    }
    let mut written = Vec::new();
    let mut own = String::new();
    for (name, judgement) in &judgements {
        if preset::find(name).is_none() {
            // Writing to a String cannot fail.
            let _ = write!(own, "\n# {name}\n{}", judgement.to_toml());
            continue;
        }
        let file = Judgement::file(name).ok_or_else(|| {
            Failure::Input("there is no home folder: set CREPITUS_PRESETS to a folder".to_owned())
        })?;
        let mut kept = if file.is_file() {
            Judgement::read(&file)?
        } else {
            Vec::new()
        };
        kept.retain(|other| other.study != judgement.study);
        kept.push(judgement.clone());
        let text: Vec<_> = kept.iter().map(Judgement::to_toml).collect();
        write(&file, &text.join("\n"))?;
        written.push(file);
    }
    if as_json {
        return print_json(&json!({
            "written": written.iter().map(|file| crepitus_files::json_path(file)).collect::<Vec<_>>(),
            "own": own,
        }));
    }
    for (name, judgement) in &judgements {
        print(&format!("{name}: {}\n", judgement.to_text()))?;
    }
    if !own.is_empty() {
        print(&format!(
            "\nadd these to the files of your own presets:\n{own}"
        ))?;
    }
    Ok(())
}

fn write(path: &Path, text: &str) -> Result<(), Failure> {
    let failed = |error| Failure::at(path, "cannot be written", &error);
    fs::create_dir_all(crepitus_files::output::folder_of(path)).map_err(failed)?;
    // It was read as a file of judgements.
    let file = NewFile::create(path, true, &Inputs::default())?;
    file.as_file().write_all(text.as_bytes()).map_err(failed)?;
    file.persist()?;
    Ok(())
}

/// The day, UTC.
fn today() -> String {
    let unix_s = SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .map_or(0, |time| time.as_secs());
    let text = Started::from_unix(unix_s).map_or_else(String::new, |started| started.to_string());
    text.split(' ').next().unwrap_or_default().to_owned()
}
