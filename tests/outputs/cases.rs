//! Every verb, and every flag with a path: what is written there, or that nothing is.

use crate::support::crepitus;
use crate::{recording, study};
use std::path::Path;
use std::process::{Output, Stdio};

/// Verb, or flag of one, that writes.
pub(super) struct Case {
    pub(super) verb: &'static str,
    pub(super) arguments: &'static [&'static str],
    /// Option before the place; empty for an argument.
    pub(super) flag: &'static str,
    /// Files that are written.
    pub(super) place: Place,
    /// Takes seconds or minutes once nothing is in the way.
    pub(super) is_slow: bool,
}

pub(super) enum Place {
    /// Names in the folder.
    Folder(&'static [&'static str]),
    /// Name of a single file.
    File(&'static str),
}

const RUN: &[&str] = &["fig6-ideal-cycle", "--set", "duration_s=0.05"];
const RUN_QUIETLY: &[&str] = &["fig6-ideal-cycle", "--set", "duration_s=0.05", "--no-trace"];
pub(super) const DRAWN: &[&str] = &["fig6-ideal-cycle", "--set", "duration_s=0.05", "--pictures"];
pub(super) const HEARD: &[&str] = &["slow-examination", "--set", "duration_s=0.2", "--out", "o"];
const SWEEP: &[&str] = &[
    "low-speed",
    "--vary",
    "duration_s=0.01,0.02",
    "--format",
    "csv",
    "--traces",
];
const SHARD: &[&str] = &[
    "low-speed",
    "--vary",
    "duration_s=0.01,0.02",
    "--shard",
    "1/2",
];
const LAWS: &[&str] = &["--quick", "--law", "frozen", "--task", "creep"];
const WEIGHT: &[&str] = &["none", "--weight-kg", "2.4", "--lever-m", "0.25"];
const REPORT: &[&str] = &["RECORDING"];
const EXPORT: &[&str] = &["RECORDING", "--format", "csv"];
const SAVE: &[&str] = &["save-preset", "mine", "--device", "sim"];

const fn folder(
    verb: &'static str,
    arguments: &'static [&'static str],
    names: &'static [&'static str],
) -> Case {
    Case {
        verb,
        arguments,
        flag: "--out",
        place: Place::Folder(names),
        is_slow: false,
    }
}

const fn slow(
    verb: &'static str,
    arguments: &'static [&'static str],
    names: &'static [&'static str],
) -> Case {
    let mut case = folder(verb, arguments, names);
    case.is_slow = true;
    case
}

const fn file(
    verb: &'static str,
    arguments: &'static [&'static str],
    flag: &'static str,
    name: &'static str,
) -> Case {
    Case {
        verb,
        arguments,
        flag,
        place: Place::File(name),
        is_slow: false,
    }
}

/// Every verb and flag that writes. `RECORDING` and `STUDY` stand for one.
pub(super) const CASES: &[Case] = &[
    folder(
        "run",
        RUN,
        &["events.csv", "report.html", "summary.json", "trace.csv"],
    ),
    folder("run", RUN_QUIETLY, &["events.csv", "summary.json"]),
    folder("run", DRAWN, &["torque.svg"]),
    file("run", HEARD, "--wav", "knee.wav"),
    folder(
        "sweep",
        SWEEP,
        &["sweep.csv", "sweep.json", "parts", "traces"],
    ),
    folder("sweep", SHARD, &["sweep.json", "parts"]),
    folder("report", REPORT, &["report.html", "summary.json"]),
    folder(
        "experiment",
        &["results", "STUDY"],
        &["report.html", "summary.json", "trials-1.csv"],
    ),
    file("experiment", &["new", "abx"], "", "mine.toml"),
    file("report", &["RECORDING", "--out", "o"], "--wav", "knee.wav"),
    file("export", EXPORT, "--out", "out.csv"),
    file("knee", &["--language", "en"], "--out", "knee.html"),
    file(
        "record",
        &["--device", "sim", "--for", "50ms"],
        "",
        "mine.parquet",
    ),
    file("params", SAVE, "PRESETS", "mine.toml"),
    file(
        "params",
        &["backup", "--device", "sim"],
        "",
        "mine-backup.toml",
    ),
    slow(
        "effects",
        &["low-speed", "--pictures"],
        &["effects.csv", "report.html", "summary.json"],
    ),
    slow("demo", &[], &["report.html", "summary.json"]),
    slow(
        "accuracy",
        &["--quick"],
        &["points.csv", "symptoms.csv", "report.html", "summary.json"],
    ),
    slow(
        "stability",
        &[],
        &["cases.csv", "report.html", "summary.json"],
    ),
    slow(
        "stability",
        &["--coupled"],
        &[
            "cells.csv",
            "onsets.csv",
            "margins.csv",
            "scene.toml",
            "report.html",
            "summary.json",
        ],
    ),
    folder(
        "laws",
        LAWS,
        &[
            "leaderboard.csv",
            "costs.csv",
            "report.html",
            "summary.json",
        ],
    ),
    slow("vibration", &[], &["report.html", "summary.json"]),
    slow(
        "identify",
        WEIGHT,
        &["identified.json", "report.html", "residual.svg"],
    ),
    Case {
        is_slow: true,
        ..file("identify", WEIGHT, "--scene-out", "brace.toml")
    },
    slow("fit", &["none"], &["fit.json", "residual.csv", "knee.toml"]),
    Case {
        is_slow: true,
        ..file("fit", &["none"], "--scene-out", "knee.toml")
    },
    slow(
        "identify-actuator",
        &["--device", "none", "--moving-mass-g", "60"],
        &[
            "summary.json",
            "impedance.svg",
            "measured.csv",
            "measured-added.csv",
        ],
    ),
    slow(
        "bring-up",
        &["--device", "none", "--yes"],
        &["bring-up.json", "report.html"],
    ),
    slow(
        "calibrate",
        &["--device", "none", "--yes"],
        &["calibration.json", "report.html", "currents.svg"],
    ),
];

/// Verbs that write no file that is named by a user, except below a folder of the panel's, whose recordings and
/// lessons its own tests look at.
pub(super) const OTHERS: [&str; 16] = [
    "panel",
    "monitor",
    "devices",
    "info",
    "doctor",
    "zero",
    "arm",
    "disarm",
    "stop",
    "clear-fault",
    "stream",
    "serve-sim",
    "scenes",
    "presets",
    "completions",
    "help",
];

/// Options with a path that is read.
pub(super) const READ: [&str; 9] = [
    "--points",
    "--again",
    "--merge",
    "--from",
    "--from-added",
    "--replay",
    "--overlay",
    "--sessions",
    "--experiments",
];

impl Case {
    pub(super) fn names(&self) -> Vec<&'static str> {
        match self.place {
            Place::Folder(names) => names.to_vec(),
            Place::File(name) => vec![name],
        }
    }

    /// Runs the verb; `place` is the folder, `home` the folder of the command.
    pub(super) fn run(&self, home: &Path, place: &Path, more: &[&str]) -> Output {
        let mut command = crepitus();
        command
            .arg(self.verb)
            .current_dir(home)
            .stdin(Stdio::null());
        command.env("CREPITUS_PRESETS", place);
        for argument in self.arguments {
            match *argument {
                "RECORDING" => command.arg(recording()),
                "STUDY" => command.arg(study()),
                argument => command.arg(argument),
            };
        }
        let path = match self.place {
            Place::Folder(_) => place.to_owned(),
            Place::File(name) => place.join(name),
        };
        match self.flag {
            "PRESETS" => {}
            "" => {
                command.arg(path);
            }
            flag => {
                command.arg(flag).arg(path);
            }
        }
        command.args(more).output().expect("the program starts")
    }
}
