//! The report of a recording: what DESIGN asks of a run, from the samples of a
//! device.
//!
//! A device says torque, phase and count of every tick. The object's angle is
//! reconstructed from them with the parameters in force; speed is the drive's
//! own estimate.

mod joint;
mod tables;
mod tally;

use crate::failure::Failure;
use crate::interrupt;
use crate::pictures::{self, PictureFormat};
use crate::progress::Progress;
use crepitus_protocol::{Revision, TICK_S};
use crepitus_recording::{ArmingPushes, Recording, Row, Sidecar};
use crepitus_report::{Collector, Mark, Setup, Text, TorqueLevels};
use crepitus_scene::output::Folder;
use crepitus_scene::trace::{Column, ColumnKind};
use joint::Joint;
use std::io::Write;
use std::path::Path;
pub(crate) use tally::RecordedSummary;
use tally::Tally;

/// The columns that the report draws.
const COLUMNS: [Column; 8] = {
    const fn number(name: &'static str) -> Column {
        Column {
            name,
            kind: ColumnKind::Number,
        }
    }
    [
        number("t_s"),
        number("angle_rad"),
        number("omega_rad_s"),
        Column {
            name: "phase",
            kind: ColumnKind::Phase,
        },
        number("theta_rad"),
        number("theta_dot_rad_s"),
        number("torque_nm"),
        number("motor_torque_nm"),
    ]
};

/// Rows between two looks at the clock.
const PROGRESS_ROWS: u64 = 1 << 14;

/// Writes `report.html` and `summary.json` of a recording into `out`.
pub(crate) fn report(
    recording: &Recording,
    out: &Path,
    pictures: Option<PictureFormat>,
) -> Result<RecordedSummary, Failure> {
    let sidecar = recording.sidecar();
    let failed = |doing: &str, e: &std::io::Error| Failure::at(out, doing, e);
    let folder = Folder::create(out).map_err(|e| failed("cannot be written", &e))?;
    let expected = sidecar.telemetry.received;
    let setup = Setup {
        columns: &COLUMNS,
        rows_expected: expected,
        row_step_s: TICK_S,
        levels: levels(sidecar),
    };
    let mut collector = Collector::new(&setup);
    for (at, name) in sidecar.changes() {
        collector.mark(Mark { at, name });
    }
    let mut pushes = ArmingPushes::default();
    let mut tally = Tally::default();
    let mut joint = Joint::default();
    let mut progress = Progress::of_reading();
    for (n, row) in (0_u64..).zip(recording.rows().map_err(Failure::input)?) {
        let row = row.map_err(Failure::input)?;
        let object = joint.follow(&row, sidecar);
        let values = [
            row.time_s,
            row.angle_rad,
            f64::from(row.omega_rad_s),
            f64::from(row.flags.phase_sign()),
            object.theta_rad,
            object.theta_dot_rad_s,
            f64::from(row.model_torque_nm),
            motor_torque_nm(&row, sidecar),
        ];
        collector.row(&values);
        if let Some(event) = joint.event(&row, &object) {
            collector.event(&event);
        }
        if let Some((from_s, to_s)) = pushes.row(&row) {
            collector.arming_push(from_s, to_s);
        }
        tally.row(&row);
        if n.is_multiple_of(PROGRESS_ROWS) {
            #[expect(clippy::cast_precision_loss, reason = "a share")]
            progress.reached(n as f64 / expected.max(1) as f64);
            if interrupt::asked() {
                return Err(Failure::Work("interrupted: nothing was written".to_owned()));
            }
        }
    }
    let summary = tally.finish(sidecar);
    let text = Text {
        title: sidecar.title.clone(),
        description: None,
        warnings: summary.warnings.clone(),
        sections: tables::sections(&summary, sidecar),
        footer: format!(
            "crepitus {} · research and education prototype, not a medical device",
            env!("CARGO_PKG_VERSION")
        ),
    };
    let figures = collector.finish();
    let json = serde_json::to_string_pretty(&summary)
        .map_err(|e| Failure::Work(format!("the summary cannot be written: {e}")))?;
    let mut texts = vec![
        (
            "report.html".to_owned(),
            crepitus_report::html(&text, &figures).into(),
        ),
        ("summary.json".to_owned(), (json + "\n").into()),
    ];
    texts.extend(pictures::files(pictures, || {
        crepitus_report::pictures(&figures)
    })?);
    for (name, content) in texts {
        folder
            .file(&name)
            .and_then(|mut file| {
                file.write_all(&content)?;
                Folder::finish(file)
            })
            .map_err(|e| failed("writing the report", &e))?;
    }
    folder
        .commit()
        .map_err(|e| failed("moving the report into place", &e))?;
    Ok(summary)
}

/// The torque of the motor at the joint, from its current, N·m.
fn motor_torque_nm(row: &Row, sidecar: &Sidecar) -> f64 {
    let number = |name| sidecar.number(Revision(row.revision), name);
    let constant = number("motor.torque_constant_nm_per_a")
        .zip(number("encoder.gear_ratio"))
        .map(|(constant, gear)| constant * gear);
    row.current_a
        .zip(constant)
        .map_or(f64::NAN, |(amperes, constant)| {
            -f64::from(amperes) * constant
        })
}

/// The levels of the torque, if they were the same all the time.
fn levels(sidecar: &Sidecar) -> Option<TorqueLevels> {
    let mut sets = sidecar.parameters.iter().map(|set| {
        let number = |name| sidecar.number(Revision(set.revision), name);
        let kinetic = number("crepitus.kinetic_torque_nm")?;
        let static_nm = number("crepitus.static_torque_nm")?;
        let elastic = TorqueLevels::elastic(kinetic, static_nm);
        let from_kinetic =
            set.values.get("crepitus.restart").and_then(|v| v.as_str()) == Some("from-kinetic");
        Some(TorqueLevels {
            restart_nm: if from_kinetic {
                kinetic
            } else {
                elastic.restart_nm
            },
            ..elastic
        })
    });
    let first = sets.next()??;
    sets.all(|other| other == Some(first)).then_some(first)
}
