//! `crepitus demo`: the whole chain in one process, from the host's library to
//! the simulated leg.

use super::report;
use crate::cli::{Arming, Force};
use crate::failure::{Failure, print, print_json};
use crate::following::{End, Follower, follow};
use crate::interrupt;
use crate::line::{Line, failure};
use crate::overlay::Overlay;
use crate::pictures::Pictures;
use crate::progress::Progress;
use crate::recorded::{Recorded, extension};
use crate::reported::Reported;
use crate::results::{self, REPORT};
use crate::wav::Wav;
use clap::Args;
use crepitus_client::connection::Simulated;
use crepitus_client::{Begin, Client, RequestKind};
use crepitus_files::json_path;
use crepitus_files::output::Inputs;
use crepitus_pages::recorded::RecordingSummary;
use crepitus_protocol::parameters;
use crepitus_protocol::telemetry::Block;
use crepitus_protocol::{Revision, State};
use crepitus_recording::{Damage, EndCause, Ending, Recording};
use crepitus_scene::shipped;
use crepitus_scene::{Overrides, preset};
use serde_json::json;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Run the whole device, simulated: host, USB, both controllers, leg; record and report it.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus demo
  crepitus demo --out /tmp/demo --json

Only the hardware is simulated: the host's library, a USB stack and a virtual cable, the \
program of the comms controller, the link, the program of the drive, and a simulated leg that an \
examiner bends and straightens. DIR gets the recording, report.html and summary.json.")]
pub(crate) struct Arguments {
    /// Folder for the recording and its report [default: out/demo].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    #[command(flatten)]
    force: Force,

    #[command(flatten)]
    pictures: Pictures,
}

/// The scene of the leg, and the preset of its joint.
const SCENE: &str = "passive-examination";
const PRESET: &str = "coarse";

/// Parameter changes during the run, at these shares of its duration.
const CHANGES: [(f64, &str, f64); 2] = [
    (1.0 / 3.0, "crepitus.kinetic_torque_nm", 0.25),
    (2.0 / 3.0, "crepitus.stiffness_nm_per_rad", 900.0),
];

/// Timeout of disarming.
const DISARM_TIMEOUT: Duration = Duration::from_millis(100);

/// Runs the demo.
pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    let begun = Instant::now();
    let out = arguments
        .out
        .clone()
        .unwrap_or_else(|| PathBuf::from("out/demo"));
    let scene = shipped::scene(Path::new(SCENE), &Overrides::default())?;
    interrupt::listen();
    let name = format!("recording.{}", extension());
    let claim = arguments.force.claim("demo", [""; 0]);
    let folder = results::folder(&out, claim, [&REPORT[..], &[&name]].concat())?;
    let place = out.join(&name);
    let file = folder.path_of(Path::new(&name));
    let duration = Duration::from_secs_f64(scene.duration_s);
    let device = Simulated::of(&scene).map_err(Failure::input)?;
    let narration = Narration { is_silent: as_json };

    narration.step(
        "the device",
        "two controllers and a leg, simulated and connected",
    )?;
    let mut client = Client::connect(Line::Simulated(Box::new(device))).map_err(failure)?;
    let (base, values) = client.parameters().map_err(failure)?;
    let joint = preset::find(PRESET)
        .and_then(preset::Preset::joint)
        .ok_or_else(|| Failure::Work(format!("there is no preset {PRESET}")))?;
    client
        .commit(base, &values.with_crepitus(joint))
        .map_err(failure)?;
    narration.step("parameters", &format!("preset {PRESET} applied"))?;

    let recording = Recorded::begin(&mut client, &file, &scene.title)?;
    let mut examination = Examination {
        recording,
        changes: CHANGES
            .iter()
            .map(|(share, name, value)| (duration.mul_f64(*share), *name, *value))
            .collect(),
        begin: client.now(),
        progress: Progress::new(scene.duration_s),
        made: Vec::new(),
    };
    let end = follow(
        &mut client,
        Some(duration),
        Arming::armed(true),
        &mut examination,
    )?;
    wait_until_disarmed(&mut client)?;
    if end == End::Requested {
        return Err(Failure::interrupted());
    }
    let Examination {
        recording, made, ..
    } = examination;
    recording.finish(Ending::of(EndCause::Time))?;
    narration.step("examination", &examination_text(&client, &made))?;

    let recording = Recording::open(&file, Damage::Refuse).map_err(Failure::input)?;
    let extras = report::Extras {
        pictures: &arguments.pictures,
        overlay: &Overlay::default(),
        wav: &Wav::default(),
        force: arguments.force,
    };
    let reported = report::write_into(folder, &recording, &out, &extras, &Inputs::default())?;
    done(&reported, &out, &place, &client, begun.elapsed(), as_json)
}

/// Waits until the drive reports that it has disarmed.
fn wait_until_disarmed(client: &mut Client<Line>) -> Result<(), Failure> {
    let end = client.now() + DISARM_TIMEOUT;
    while client.status().map_err(failure)?.state != State::Disarmed {
        if client.now() >= end {
            return Err(Failure::Work(
                "the device did not disarm within 100 ms: check it with `crepitus doctor`"
                    .to_owned(),
            ));
        }
    }
    Ok(())
}

/// Prints each step, unless JSON is wanted.
struct Narration {
    is_silent: bool,
}

impl Narration {
    fn step(&self, what: &str, text: &str) -> Result<(), Failure> {
        if self.is_silent {
            return Ok(());
        }
        print(&format!("{what:<12} {text}\n"))
    }
}

/// A recorded examination with parameter changes.
struct Examination {
    recording: Recorded,
    /// Pending changes: time, parameter, value.
    changes: std::collections::VecDeque<(Duration, &'static str, f64)>,
    begin: Duration,
    progress: Progress,
    made: Vec<(&'static str, f64, Revision)>,
}

impl Follower for Examination {
    fn block(&mut self, client: &mut Client<Line>, block: &Block) -> Result<(), Failure> {
        self.recording.block(client, block)
    }

    fn resumed(&mut self, begin: Begin) -> Result<(), Failure> {
        self.recording.resumed(begin)
    }

    fn pause(&mut self, client: &mut Client<Line>) -> Result<bool, Failure> {
        let since = client.now().saturating_sub(self.begin);
        self.progress.reached(since.as_secs_f64());
        if let Some((when, name, value)) = self.changes.front().copied()
            && since >= when
        {
            self.changes.pop_front();
            let (id, _) = parameters::find(name)
                .ok_or_else(|| Failure::Work(format!("there is no parameter {name}")))?;
            let revision = client.set(&[(id, value)]).map_err(failure)?;
            self.made.push((name, value, revision));
        }
        self.recording.pause(client)
    }
}

fn examination_text(client: &Client<Line>, made: &[(&'static str, f64, Revision)]) -> String {
    let mut text = "armed, moved, disarmed".to_owned();
    for (name, value, revision) in made {
        let _ = write!(
            text,
            "\n{:<12} {name} = {value} while armed, revision {revision}",
            ""
        );
    }
    if let Some(trip) = client.round_trips().of(RequestKind::Commit) {
        let _ = write!(
            text,
            "\n{:<12} commits took {:.1} ms of the device's time (median; worst {:.1} ms)",
            "",
            trip.median.as_secs_f64() * 1e3,
            trip.worst.as_secs_f64() * 1e3
        );
    }
    text
}

fn done(
    reported: &Reported<RecordingSummary>,
    out: &Path,
    file: &Path,
    client: &Client<Line>,
    wall: Duration,
    as_json: bool,
) -> Result<(), Failure> {
    let device_s = client.now().as_secs_f64();
    let wall_s = wall.as_secs_f64();
    if as_json {
        return print_json(&json!({
            "out": json_path(out),
            "device_s": device_s,
            "wall_s": wall_s,
            "summary": reported.summary,
        }));
    }
    print(&format!(
        "{}recording: {}\n{device_s:.1} s of device time took {wall_s:.1} s in all\n",
        report::text(reported, out),
        file.display()
    ))
}
