//! `crepitus stability --coupled`: the Z-width of the device on a leg.

use super::Arguments;
use crate::failure::{Failure, print, print_json};
use crate::pictures::Pictures;
use crate::results::{self, Files, REPORT, footer, report_files};
use crate::screen::screen;
use crate::studying::Watch;
use crepitus_files::json_path;
use crepitus_studies::coupled::report;
use crepitus_studies::coupled::{
    CoupledError, CoupledStudy, GEARS, LAGS, Margin, Setting, Verdict, most_share, run, tables,
};
use crepitus_studies::{Section, StudyText};
use serde::{Serialize, Serializer};
use serde_json::json;
use std::fmt::Write as _;
use std::path::Path;

/// Version of `summary.json`.
const SUMMARY_VERSION: u32 = 1;

/// Names of the files beside the report.
const FILES: [&str; 4] = ["cells.csv", "onsets.csv", "margins.csv", "scene.toml"];

/// The map in numbers.
#[derive(Serialize)]
struct Summary {
    #[serde(rename = "summary_version")]
    version: u32,
    crepitus_version: &'static str,
    cells: Counts,
    #[serde(serialize_with = "as_rows")]
    presets: Vec<Margin>,
    #[serde(serialize_with = "as_rows")]
    extras: Vec<Margin>,
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

/// Joints with the names and numbers of `margins.csv`, and what else is known
/// of them.
fn as_rows<S: Serializer>(joints: &[Margin], serializer: S) -> Result<S::Ok, S::Error> {
    tables::margins(joints)
        .column("gear_friction", |joint| joint.setting.gear.name)
        // The largest share of a friction of 0.5 N·m that may be compensated.
        .column("most_share", |joint| {
            most_share(&joint.setting, FRICTION_NM)
        })
        .serialize(serializer)
}

/// Makes the map, writes the files, says what is left to the presets.
pub(super) fn coupled(out: &Path, arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    let claim = arguments.force.claim("stability --coupled", [""; 0]);
    let folder = results::folder(out, claim, [&REPORT[..], &FILES].concat())?;
    let study = run(&mut Watch::new()).map_err(|error| match error {
        CoupledError::Cancelled(_) => Failure::interrupted(),
        CoupledError::Run(why) => Failure::Work(format!("the study failed: {why}")),
    })?;
    let summary = summary(&study);
    results::write(folder, out, files(&study, &summary, &arguments.pictures)?)?;
    if as_json {
        print_json(&json!({ "out": json_path(out), "summary": summary }))?;
    } else {
        let report = out.join("report.html");
        let table = onsets_and_margins(&study);
        print(&if arguments.all.all {
            format!(
                "{}\n\n{table}\nreport: {}\n",
                answer(&study),
                report.display()
            )
        } else {
            let last = format!("report: {}; --all prints every line", report.display());
            screen(&answer(&study), &table, &last)
        })?;
    }
    judge(&study)
}

/// Whether the presets stay quiet on the device as it is, and how near the nearest comes.
fn answer(study: &CoupledStudy) -> String {
    let shipped = Setting::shipped().gear;
    let here: Vec<&Margin> = study
        .presets
        .iter()
        .filter(|joint| joint.setting.gear == shipped)
        .collect();
    let rings = here
        .iter()
        .filter(|joint| joint.verdict == Verdict::Rings)
        .count();
    let quiet = match rings {
        0 => format!(
            "On the device as it is every preset is quiet under a hand that rests ({} of {}).",
            here.len(),
            here.len()
        ),
        n => format!(
            "On the device as it is {n} of {} presets ring under a hand that rests.",
            here.len()
        ),
    };
    let least = here
        .iter()
        .map(|joint| most_share(&joint.setting, FRICTION_NM))
        .fold(f64::INFINITY, f64::min);
    format!(
        "{quiet} Up to {:.1} % of {FRICTION_NM} N·m of gear friction may be compensated with every one of them.",
        100.0 * least
    )
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
    Summary {
        version: SUMMARY_VERSION,
        crepitus_version: env!("CARGO_PKG_VERSION"),
        cells,
        presets: study.presets.clone(),
        extras: study.extras.clone(),
        wall_s: study.wall_s,
    }
}

/// The gear's friction as the paper has it, N·m.
const FRICTION_NM: f64 = GEARS[0].friction_nm;

/// The lowest stiffness that rings, for each gear and damping at the device's
/// lag, beside the criteria; then what the presets have left.
fn onsets_and_margins(study: &CoupledStudy) -> String {
    let of_device: Vec<_> = study
        .onsets
        .iter()
        .filter(|onset| onset.setting.lag == LAGS[1])
        .copied()
        .collect();
    let mut text = format!(
        "A hand that stops: the lowest stiffness whose shaft rings, N·m/rad, with the paper's joint\n\n{}",
        tables::onsets(&of_device).to_text()
    );
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

fn files(study: &CoupledStudy, summary: &Summary, pictures: &Pictures) -> Result<Files, Failure> {
    let page = report::html(study, &words(summary, &answer(study)));
    let pictures = pictures.files(|_| report::pictures(study))?;
    let mut files = report_files(page, summary, pictures)?;
    let margins = [study.presets.as_slice(), &study.extras].concat();
    let contents = [
        tables::cells(&study.cells).to_csv(),
        tables::onsets(&study.onsets).to_csv(),
        tables::margins(&margins).to_csv(),
        Setting::shipped().toml(),
    ];
    let named = FILES.iter().zip(contents);
    files.extend(named.map(|(name, content)| ((*name).to_owned(), content.into())));
    Ok(files)
}

fn words(summary: &Summary, answer: &str) -> StudyText {
    let row = |name: &str, value: String| (name.to_owned(), value);
    let cells = &summary.cells;
    StudyText {
        title: "Where the device stays quiet on a leg".to_owned(),
        intro: answer.to_owned()
            + "\n"
            + "A hand moves the leg at 0.5 rad/s, stops, and rests. Does the motor's shaft come to rest, too? Each cell \
                is a run of three seconds with what the drive renders: encoder, joint, guard, limits, current loop. A \
                rendered spring acts late and gives energy away; the damping of the cuff takes it, or the gear's dry \
                friction, which is what the compensation removes.",
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
        footer: footer(),
    }
}
