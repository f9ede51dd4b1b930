//! The files that a run, a study or a recording's report leaves.

use crate::failure::{Failure, warn};
use crate::recorded::beside;
use crepitus_files::input;
use crepitus_files::output::{Claim, Folder, OwnedFolder};
use crepitus_pages::plot::{Figure, pictures};
use crepitus_scene::Scene;
use serde::Serialize;
use serde_json::Value;
use std::ffi::{OsStr, OsString};
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Names and contents of files.
pub(crate) type Files = Vec<(String, Vec<u8>)>;

/// Names of the files of [`report_files`].
pub(crate) const REPORT: [&str; 2] = ["report.html", "summary.json"];

/// The folder of the results, not yet in place, which gets files of these names at least. Called before the
/// work, so that what is in the way, or a folder without write permission, ends it early.
pub(crate) fn folder<N: AsRef<str>>(
    out: &Path,
    claim: Claim,
    names: impl IntoIterator<Item = N>,
) -> Result<Folder, Failure> {
    Ok(Folder::create(out, claim, names)?)
}

/// The files that a verb reads: the scene that was named, the files of scenes, and a curve.
pub(crate) fn inputs<'s>(
    named: &Path,
    scenes: impl IntoIterator<Item = &'s Scene>,
    overlay: Option<&Path>,
) -> Vec<PathBuf> {
    let of_scene = |scene: &Scene| {
        let data = scene.data.as_ref().map(|data| data.file.clone());
        [Some(scene.file.clone()), data]
    };
    let of_scenes = scenes.into_iter().flat_map(of_scene).flatten();
    let others = [Some(named), overlay].into_iter().flatten();
    others.map(Path::to_owned).chain(of_scenes).collect()
}

/// The folder in `out` that is named after a scene's file.
pub(crate) fn named_after(scene: &Path, before: &str, after: &str) -> Result<PathBuf, Failure> {
    let stem = scene.file_stem().unwrap_or_default();
    if [".", ".."].map(OsStr::new).contains(&stem) {
        return Err(Failure::Input(format!(
            "{}: no folder can have that name: name one with --out",
            scene.display()
        )));
    }
    let mut name = OsString::from(before);
    name.push(stem);
    name.push(after);
    Ok(Path::new("out").join(name))
}

/// Longest summary that is read, bytes.
const SUMMARY_BYTES: u64 = 64_000_000;

/// The summary that a folder has; null if there is none.
fn summary_in(folder: &Path) -> Value {
    let text =
        input::read_to_string(&folder.join("summary.json"), SUMMARY_BYTES).unwrap_or_default();
    serde_json::from_str(&text).unwrap_or_default()
}

/// `report.html` and `summary.json`, and the pictures.
pub(crate) fn report_files(
    page: String,
    summary: &impl Serialize,
    pictures: Files,
) -> Result<Files, Failure> {
    let mut files = vec![
        ("report.html".to_owned(), page.into()),
        summary_file(summary)?,
    ];
    files.extend(pictures);
    Ok(files)
}

/// `summary.json`.
pub(crate) fn summary_file(summary: &impl Serialize) -> Result<(String, Vec<u8>), Failure> {
    json_file("summary.json", summary)
}

/// A JSON file of this name.
pub(crate) fn json_file(name: &str, value: &impl Serialize) -> Result<(String, Vec<u8>), Failure> {
    let text = serde_json::to_string_pretty(value)
        .map_err(|e| Failure::Work(format!("{name} cannot be written: {e}")))?;
    Ok((name.to_owned(), (text + "\n").into()))
}

/// The charts of figures as SVG files.
pub(crate) fn svg_files<'f>(figures: impl IntoIterator<Item = &'f Figure>) -> Files {
    let files = pictures(figures).into_iter();
    files
        .map(|picture| (format!("{}.svg", picture.name), picture.svg.into()))
        .collect()
}

/// Identity of a run: runs with the same identity give the same numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Identity<'a> {
    as_run: &'a str,
    data_sha256: Option<&'a str>,
}

impl<'a> Identity<'a> {
    pub(crate) fn of(scene: &'a Scene) -> Self {
        Self {
            as_run: &scene.as_run,
            data_sha256: scene.data.as_ref().map(|data| data.sha256.as_str()),
        }
    }

    /// This folder, or the first of `folder-2`, `folder-3`, … that holds no other run.
    pub(crate) fn free_folder(self, wanted: &Path) -> Result<PathBuf, Failure> {
        /// More than anybody keeps.
        const MOST: u32 = 10_000;
        if !self.is_another_in(wanted) {
            return Ok(wanted.to_owned());
        }
        // The number follows the name, not the slash that a shell completes.
        let named: PathBuf = wanted.components().collect();
        if named.file_name().is_none() {
            return Err(Failure::Input(format!(
                "{} holds another run, and this path has no name to add a number to: name another folder with \
                 --out, or replace that run with --force",
                wanted.display()
            )));
        }
        (2..=MOST)
            .map(|number| beside(&named, &format!("-{number}")))
            .find(|folder| !self.is_another_in(folder))
            .ok_or_else(|| {
                Failure::Input(format!(
                    "{} and {MOST} more hold other runs: name another folder with --out",
                    wanted.display()
                ))
            })
    }

    /// Returns whether a folder holds another run.
    pub(crate) fn is_another_in(self, folder: &Path) -> bool {
        if !folder.join("summary.json").exists() {
            return false;
        }
        let summary = summary_in(folder);
        let is_this = summary["scene_as_run"].as_str() == Some(self.as_run)
            && summary["data"]["sha256"].as_str() == self.data_sha256
            && summary["crepitus_version"].as_str() == Some(env!("CARGO_PKG_VERSION"))
            && summary["crepitus_commit"].as_str() == option_env!("CREPITUS_COMMIT");
        !is_this
    }

    /// Writes the files of the run, and moves their folder to `out`, or to the first beside it
    /// that is free if another program has put its run there meanwhile. Returns where they are.
    pub(crate) fn write(
        self,
        mut folder: Folder,
        (wanted, out): (&Path, &Path),
        files: Files,
    ) -> Result<PathBuf, Failure> {
        fill(&folder, out, files)?;
        let mut place = out.to_owned();
        while !folder.commit_new()? {
            if !self.is_another_in(&place) {
                folder.commit()?;
                break;
            }
            place = self.free_folder(wanted)?;
            folder.aim_at(&place);
        }
        Ok(place)
    }
}

/// Removes what an earlier run in the folder has left and this one does not
/// replace; what is not the run's stays, and is named.
pub(crate) fn remove_others(folder: &Path, claim: Claim) -> Result<(), Failure> {
    let mut owned = OwnedFolder::open(folder, claim)?;
    for name in ["trace.csv", "report.html"] {
        if !owned.remove(name)? {
            warn(format!("{}: not of this run: {name}", folder.display()));
        }
    }
    Ok(owned.compact()?)
}

/// Warns of pictures in the folder that are not of these files: earlier results', or somebody's own.
fn warn_of_other_pictures(folder: &Path, names: &[String]) {
    let is_picture = |name: &String| [".svg", ".pdf"].iter().any(|end| name.ends_with(end));
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let all = entries.filter_map(|entry| entry.file_name().into_string().ok());
    let mut others: Vec<_> = all
        .filter(|name| is_picture(name) && !names.contains(name))
        .collect();
    others.sort();
    if !others.is_empty() {
        let (folder, others) = (folder.display(), others.join(", "));
        warn(format!("{folder}: not of these results: {others}"));
    }
}

/// Writes files into a folder.
fn fill(folder: &Folder, out: &Path, files: Files) -> Result<(), Failure> {
    for (name, content) in files {
        folder
            .file(&name)
            .and_then(|mut file| {
                file.write_all(&content)?;
                folder.finish(file)
            })
            .map_err(|e| Failure::at(out, "writing the results", &e))?;
    }
    Ok(())
}

/// Writes files into a folder, and moves it into place.
pub(crate) fn write(folder: Folder, out: &Path, files: Files) -> Result<(), Failure> {
    let names: Vec<_> = files.iter().map(|(name, _)| name.clone()).collect();
    fill(&folder, out, files)?;
    folder.commit()?;
    warn_of_other_pictures(out, &names);
    Ok(())
}
