//! `crepitus identify-actuator`: parameters of the vibration actuator from its coil's
//! voltage and current.

mod chart;
mod chirp;
mod evidence;
mod played;
mod recorded;
mod results;
mod table;

use crate::cli::{DeviceArguments, Force};
use crate::failure::{Failure, print, print_json, warn};
use crate::line::{Line, connect, failure};
use crate::results::folder;
use chirp::ChirpArguments;
use clap::Args;
use crepitus_client::Client;
use crepitus_files::json_path;
use crepitus_identify::actuator::identify;
use crepitus_model::parameters::Source;
use crepitus_model::render::effects::vibration_actuator::VibrationActuatorSettings;
use evidence::Masses;
use recorded::Recordings;
use serde_json::json;
use std::path::PathBuf;

/// Identify the vibration actuator: play a chirp, read the coil's current, propose parameters.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus identify-actuator --moving-mass-g 60 --zero --out out/actuator \\
      --apply
  crepitus identify-actuator --added-mass-g 30
  crepitus identify-actuator --device sim --scene actuator-in-a-vice --zero \\
      --moving-mass-g 52
  crepitus identify-actuator --from bench.csv --moving-mass-g 60
  crepitus identify-actuator --from bare.csv --from-added heavier.csv \\
      --added-mass-g 30

Clamp the ring in a vice first, by its outer rim, with the mass free to move: a ring that moves adds a \
resonance of its own, or, lying loose, replaces the mass m by m·M/(m + M), which no current tells.

The coil's impedance R + s·L + (Bl²/m)·s/(s² + 2ζω₀·s + ω₀²) shows resistance, inductance, resonance and \
damping, but of force constant and mass only Bl²/m. So either weigh what moves (coil or magnet, and a third of \
the flexure) and give --moving-mass-g; or play a second chirp with a known mass fastened to it, a third of \
the moving mass or more, and give --added-mass-g: the shift of the resonance tells the mass. With both, each \
checks the other.

The device plays the chirp while it is armed, and the motor goes on as ever: let the joint stand still. The actuator \
has to be on and its own command silent: `crepitus params set vibration-actuator.render=on \
vibration-actuator.gain=0`. The chirp ends with the torque, by any key of `arm`, a stop or a fault, and is limited \
to 0.92 of the supply, to a current that the sensor can tell, and to twice the stroke by the parameters in use.

FILE is CSV with the columns t_s, volts, amperes: evenly spaced, at least 500 rows a second, for a chirp up \
to 500 Hz 1240 (faster ones are averaged), from before the chirp until 0.5 s after its end. Any logarithmic or linear chirp from about 8 to \
500 Hz will do, at an amplitude that keeps the mass off its stops.

Intervals are those of 95 %, from the noise of the current; an error of the current sensor's gain adds to them. \
Exit code 1: the recording is not that of a linear actuator on a vice; the text says why.")]
pub(crate) struct Arguments {
    #[command(flatten)]
    recordings: Recordings,

    #[command(flatten)]
    masses: Masses,

    #[command(flatten)]
    chirp: ChirpArguments,

    /// Folder for impedance.svg and summary.json, and for measured.csv of a chirp that was played,
    /// which --from reads again.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    #[command(flatten)]
    force: Force,

    /// Set the identified parameters on the device, in one commit; `params save` keeps them.
    #[arg(long)]
    apply: bool,

    /// Set the angle's zero before arming: hold the joint straight.
    #[arg(long, conflicts_with = "from")]
    zero: bool,

    #[command(flatten)]
    device: DeviceArguments,
}

/// Identifies, prints, and applies if asked to.
pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    let chirp = arguments.chirp.played()?;
    let masses = arguments.masses.weighed()?;
    let out = arguments.out.as_deref();
    let prepare = |out| {
        let inputs = arguments.recordings.files();
        let claim = arguments.force.claim("identify-actuator", inputs);
        folder(
            out,
            claim,
            results::names(arguments.recordings.files().next().is_none()),
        )
    };
    let prepared = out.map(prepare).transpose()?;
    let files = arguments.recordings.read(masses.added.is_some())?;
    let needs_device = files.is_none() || arguments.apply || arguments.device.device.is_some();
    let mut client = needs_device
        .then(|| connect(&arguments.device))
        .transpose()?;
    let (in_use, source) = match &mut client {
        None => (VibrationActuatorSettings::default(), "default"),
        Some(client) => (in_use(client)?, "in use"),
    };
    let (measured, is_played) = match (files, &mut client) {
        (Some(files), _) => (files, false),
        (None, Some(client)) => {
            let with_added = masses.added.is_some();
            (
                played::measured(client, chirp, arguments.zero, with_added)?,
                true,
            )
        }
        (None, None) => return Err(Failure::input("expected --from FILE or --device DEVICE")),
    };
    let evidence = masses.evidence(measured.with_added.as_ref())?;
    let found = identify(&measured.bare, arguments.chirp.band(), &evidence)
        .and_then(|actuator| actuator.settings(&in_use).map(|_| actuator));
    let files = if is_played { Some(&measured) } else { None };
    let found = match found {
        Ok(found) => found,
        Err(refusal) => {
            if let (Some(out), Some(folder), true) = (out, prepared, is_played) {
                results::write(out, folder, None, files)?;
            }
            return Err(Failure::Work(format!("no parameters: {refusal}")));
        }
    };
    let rows = table::rows(&found, &in_use, masses.moving.is_some());
    let notes = found.notes(&in_use);
    let summary = table::summary(&found, &rows, &notes);
    if let (Some(out), Some(folder)) = (out, prepared) {
        results::write(out, folder, Some((&found, &summary)), files)?;
    }
    let revision = match &mut client {
        Some(client) if arguments.apply => {
            Some(client.set(&table::changes(&rows)?).map_err(failure)?)
        }
        _ => None,
    };
    if as_json {
        let revision = revision.map(|revision| revision.0);
        return print_json(
            &json!({ "identified": summary, "revision": revision, "out": out.map(json_path) }),
        );
    }
    for note in notes {
        warn(note);
    }
    print(&format!(
        "{}\n{}",
        table::text(&rows, source),
        table::facts(&found)
    ))?;
    if let Some(out) = out {
        print(&format!("plot: {}\n", out.join(results::PLOT).display()))?;
    }
    if let Some(revision) = revision {
        print(&format!("revision {revision} is applied\n"))?;
    }
    if is_played {
        print(
            "the gain is still 0, as the chirp needs it: `crepitus params set vibration-actuator.gain=1`\n",
        )?;
    }
    Ok(())
}

/// The actuator that the device believes in.
fn in_use(client: &mut Client<Line>) -> Result<VibrationActuatorSettings, Failure> {
    let (_, values) = client.parameters().map_err(failure)?;
    Ok(values.read())
}
