//! `crepitus stability --coupled`: the Z-width of the device on a leg.

use crate::failure::{Failure, print, print_json};
use crate::pictures::{self, Files, PictureFormat};
use crate::studying::{self, Watch};
use crepitus_scene::output::Folder;
use crepitus_study::coupled::{
    CoupledError, CoupledStudy, GEARS, LAGS, Margin, Setting, Verdict, csv, most_share, run,
};
use crepitus_study_pages::{Section, StudyText, coupled};
use serde::Serialize;
use serde_json::json;
use std::fmt::Write as _;
use std::path::Path;

/// Version of `summary.json`.
const SUMMARY_VERSION: u32 = 1;

/// The map in numbers.
#[derive(Serialize)]
struct Summary {
    #[serde(rename = "summary_version")]
    version: u32,
    crepitus_version: &'static str,
    cells: Counts,
    presets: Vec<Joint>,
    extras: Vec<Joint>,
    wall_s: f64,
}

/// Number of cells by verdict.
#[derive(Default, Serialize)]
struct Counts {
    quiet: usize,
    settles: usize,
    rings: usize,
    refused: usize,
}

/// A joint on a device.
#[derive(Serialize)]
struct Joint {
    preset: &'static str,
    with: &'static str,
    gear_friction: &'static str,
    cuff_damping_nms_per_rad: f64,
    verdict: Verdict,
    /// `null` if none rings up to `most_over_stiffness`.
    onset_over_stiffness: Option<f64>,
    most_over_stiffness: f64,
    /// The largest share of a friction of 0.5 N·m that may be compensated.
    most_share: f64,
}

/// Makes the map, writes the files, says what is left to the presets.
pub(super) fn coupled(
    out: &Path,
    pictures: Option<PictureFormat>,
    as_json: bool,
) -> Result<(), Failure> {
    let folder = Folder::create(out).map_err(|e| Failure::at(out, "cannot be written", &e))?;
    let study = run(&mut Watch::new()).map_err(|error| match error {
        CoupledError::Watcher(_) => Failure::Work("interrupted: nothing was written".to_owned()),
        CoupledError::Run(why) => Failure::Work(format!("the study failed: {why}")),
    })?;
    let summary = summary(&study);
    studying::write(folder, out, files(&study, &summary, pictures)?)?;
    if as_json {
        print_json(&json!({ "out": out, "summary": summary }))?;
    } else {
        print(&format!(
            "{}\nreport: {}\n",
            told(&study),
            out.join("report.html").display()
        ))?;
    }
    judge(&study)
}

/// Fails if a preset rings on the device as it is.
fn judge(study: &CoupledStudy) -> Result<(), Failure> {
    let shipped = Setting::shipped().gear;
    let ringing = study
        .presets
        .iter()
        .find(|joint| joint.setting.gear == shipped && joint.verdict == Verdict::Rings);
    match ringing {
        Some(joint) => Err(Failure::Work(format!(
            "preset {} rings on the device as it is",
            joint.setting.preset.name
        ))),
        None => Ok(()),
    }
}

fn summary(study: &CoupledStudy) -> Summary {
    let mut cells = Counts::default();
    for cell in &study.cells {
        *match cell.verdict {
            Verdict::Quiet => &mut cells.quiet,
            Verdict::Settles => &mut cells.settles,
            Verdict::Rings => &mut cells.rings,
            Verdict::Refused => &mut cells.refused,
        } += 1;
    }
    let joints = |margins: &[Margin]| margins.iter().map(joint).collect();
    Summary {
        version: SUMMARY_VERSION,
        crepitus_version: env!("CARGO_PKG_VERSION"),
        cells,
        presets: joints(&study.presets),
        extras: joints(&study.extras),
        wall_s: study.wall_s,
    }
}

fn joint(margin: &Margin) -> Joint {
    let at = &margin.setting;
    Joint {
        preset: at.preset.name,
        with: at.extra.name,
        gear_friction: at.gear.name,
        cuff_damping_nms_per_rad: at.damping_nms_per_rad,
        verdict: margin.verdict,
        onset_over_stiffness: margin.onset,
        most_over_stiffness: margin.most,
        most_share: most_share(at, FRICTION_NM),
    }
}

/// The gear's friction as the paper has it, N·m.
const FRICTION_NM: f64 = GEARS[0].friction_nm;

/// The lowest stiffness that rings, for each gear and damping at the device's
/// lag, beside the criteria; then what the presets have left.
fn told(study: &CoupledStudy) -> String {
    let mut text = String::from(
        "A hand that stops: the lowest stiffness whose shaft rings, N·m/rad, with the paper's joint\n\n\
         gear's friction                      cuff   measured    linear  Colgate–S.  Diolaiti\n",
    );
    let of_device = |onset: &&_| {
        let onset: &crepitus_study::coupled::Onset = onset;
        onset.setting.lag == LAGS[1]
    };
    for onset in study.onsets.iter().filter(of_device) {
        let measured = onset
            .measured
            .map_or_else(|| format!("> {:.0}", onset.most), |kr| format!("{kr:.0}"));
        let at = &onset.setting;
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "{:34} {:6} {measured:>10} {:>9.0} {:>11.0} {:>9.3e}",
            at.gear.name,
            at.damping_nms_per_rad,
            onset.criteria.linear,
            onset.criteria.colgate_schenkel,
            onset.criteria.diolaiti,
        );
    }
    text.push_str("\nThe presets on the device as it is (cuff 0 and 1 N·m·s/rad)\n\n");
    let shipped = Setting::shipped().gear;
    for margin in study.presets.iter().filter(|m| m.setting.gear == shipped) {
        let left = match margin.onset {
            Some(factor) => format!("rings from {factor:.2} times its stiffness on"),
            None => format!(
                "quiet up to {:.1} times its stiffness, the most the device takes",
                margin.most
            ),
        };
        let _ = writeln!(
            text,
            "{:14} cuff {:3}  {left}; compensation up to {:.1} % of {FRICTION_NM} N·m",
            margin.setting.preset.name,
            margin.setting.damping_nms_per_rad,
            100.0 * most_share(&margin.setting, FRICTION_NM)
        );
    }
    text
}

fn files(
    study: &CoupledStudy,
    summary: &Summary,
    format: Option<PictureFormat>,
) -> Result<Files, Failure> {
    let json = serde_json::to_string_pretty(summary)
        .map_err(|e| Failure::Work(format!("the summary cannot be written: {e}")))?;
    let mut files = vec![
        (
            "report.html".to_owned(),
            coupled::html(study, &words(summary)).into(),
        ),
        ("cells.csv".to_owned(), csv::cells(&study.cells).into()),
        ("onsets.csv".to_owned(), csv::onsets(study).into()),
        ("margins.csv".to_owned(), csv::margins(study).into()),
        ("scene.toml".to_owned(), Setting::shipped().toml().into()),
        ("summary.json".to_owned(), (json + "\n").into()),
    ];
    files.extend(pictures::files(format, || coupled::pictures(study))?);
    Ok(files)
}

fn words(summary: &Summary) -> StudyText {
    let row = |name: &str, value: String| (name.to_owned(), value);
    let cells = &summary.cells;
    StudyText {
        title: "Where the device stays quiet on a leg".to_owned(),
        intro: "A hand moves the leg at 0.5 rad/s, stops, and rests. Does the motor's shaft come to rest, too? Each cell \
                is a run of three seconds with what the drive renders: encoder, joint, guard, limits, current loop. A \
                rendered spring acts late and gives energy away; the damping of the cuff takes it, or the gear's dry \
                friction, which is what the compensation removes."
            .to_owned(),
        tables: vec![Section {
            title: "The map".to_owned(),
            rows: vec![
                row("quiet", cells.quiet.to_string()),
                row("settles", cells.settles.to_string()),
                row("rings", cells.rings.to_string()),
                row("refused", cells.refused.to_string()),
                row("one of its scenes", "scene.toml".to_owned()),
                row("the study took", format!("{:.1} s", summary.wall_s)),
            ],
        }],
        notes: Vec::new(),
        footer: format!(
            "crepitus {} · research and education prototype, not a medical device",
            summary.crepitus_version
        ),
    }
}
