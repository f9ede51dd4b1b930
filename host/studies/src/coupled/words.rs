//! Words of the study: what its verb prints, and the text of its page.

use crate::coupled::{
    CoupledStudy, GEARS, LAGS, Margin, Setting, Verdict, most_share, report, tables,
};
use crate::{Outcome, Picture, Section, StudyText};
use crepitus_pages::plot::Paper;
use crepitus_pages::words::footer;
use serde::{Serialize, Serializer};
use std::fmt::Write;

impl Outcome for CoupledStudy {
    const REST: &'static str = "every line";

    fn summary(&self) -> impl Serialize {
        summary(self)
    }

    fn page(&self) -> String {
        report::html(self, &text(self))
    }

    fn pictures(&self, _: Paper) -> Vec<Picture> {
        report::pictures(self)
    }

    fn tables(&self) -> Vec<(&'static str, String)> {
        let margins = [self.presets.as_slice(), &self.extras].concat();
        vec![
            ("cells.csv", tables::cells(&self.cells).to_csv()),
            ("onsets.csv", tables::onsets(&self.onsets).to_csv()),
            ("margins.csv", tables::margins(&margins).to_csv()),
            ("scene.toml", Setting::shipped().toml()),
        ]
    }

    fn answer(&self) -> String {
        answer(self)
    }

    fn in_short(&self) -> String {
        self.in_full()
    }

    fn in_full(&self) -> String {
        onsets_and_margins(self)
    }

    fn broken(&self) -> Option<String> {
        let shipped = Setting::shipped().gear;
        let ringing = self
            .presets
            .iter()
            .find(|joint| joint.setting.gear == shipped && joint.verdict == Verdict::Rings)?;
        Some(format!(
            "preset {} rings on the device as it is",
            ringing.setting.preset.name
        ))
    }
}

/// Version of `summary.json`.
const SUMMARY_VERSION: u32 = 1;

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

fn text(study: &CoupledStudy) -> StudyText {
    let row = |name: &str, value: String| (name.to_owned(), value);
    let summary = summary(study);
    let cells = &summary.cells;
    StudyText {
        title: "Where the device stays quiet on a leg".to_owned(),
        intro: answer(study)
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
