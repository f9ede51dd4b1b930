//! `crepitus identify-actuator`: parameters of the vibration actuator from its coil's
//! voltage and current.

mod evidence;
mod recorded;
mod results;
mod table;

use crate::cli::DeviceArguments;
use crate::failure::{Failure, print, print_json, warn};
use crate::line::{connect, failure};
use clap::Args;
use crepitus_identify::{Band, identify};
use crepitus_model::control::chirp::ChirpSettings;
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
  crepitus identify-actuator --from bench.csv --moving-mass-g 60
  crepitus identify-actuator --from bench.csv --moving-mass-g 60 --out out/actuator
  crepitus identify-actuator --from bare.csv --from-added heavier.csv --added-mass-g 30
  crepitus identify-actuator --from bench.csv --moving-mass-g 60 --device /dev/ttyACM0 --apply

Clamp the ring in a vice first, by its outer rim, with the mass free to move: a ring that moves adds a \
resonance of its own, or, lying loose, replaces the mass m by m·M/(m + M), which no current tells.

The coil's impedance R + s·L + (Bl²/m)·s/(s² + 2ζω₀·s + ω₀²) shows resistance, inductance, resonance and \
damping, but of force constant and mass only Bl²/m. So either weigh what moves (coil or magnet, and a third of \
the flexure) and give --moving-mass-g; or play a second chirp with a known mass fastened to it, a third of \
the moving mass or more, and give --added-mass-g: the shift of the resonance tells the mass. With both, each \
checks the other.

FILE is CSV with the columns t_s, volts, amperes: evenly spaced, at least 500 rows a second (faster ones are \
averaged), from before the chirp until 0.5 s after its end. Any logarithmic or linear chirp from about 8 to \
500 Hz will do, at an amplitude that keeps the mass off its stops.

Intervals are those of 95 %, from the noise of the current; an error of the current sensor's gain adds to them. \
Exit code 1: the recording is not that of a linear actuator on a vice; the text says why.")]
pub(crate) struct Arguments {
    #[command(flatten)]
    recordings: Recordings,

    #[command(flatten)]
    masses: Masses,

    /// First frequency of the chirp, Hz.
    #[arg(long, value_name = "HZ", default_value_t = ChirpSettings::default().from_hz)]
    from_hz: f32,

    /// Last frequency of the chirp, Hz: lower it if the coil has eddy currents.
    #[arg(long, value_name = "HZ", default_value_t = ChirpSettings::default().to_hz)]
    to_hz: f32,

    /// Folder for impedance.svg and summary.json.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    /// Set the identified parameters on the device, in one commit; `params save` keeps them.
    #[arg(long)]
    apply: bool,

    #[command(flatten)]
    device: DeviceArguments,
}

/// Identifies, prints, and applies if asked to.
pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    let chirp = arguments.chirp()?;
    let band = Band::of_chirp(f64::from(chirp.from_hz), f64::from(chirp.to_hz));
    let masses = &arguments.masses;
    let measured = arguments.recordings.read(masses.needs_second())?;
    let evidence = masses.evidence(measured.with_added.as_ref())?;
    let mut client = if arguments.apply || arguments.device.device.is_some() {
        Some(connect(&arguments.device)?)
    } else {
        None
    };
    let (in_use, source) = match &mut client {
        None => (VibrationActuatorSettings::default(), "default"),
        Some(client) => {
            let (_, values) = client.parameters().map_err(failure)?;
            (values.read(), "in use")
        }
    };
    let found = identify(&measured.bare, band, &evidence)
        .and_then(|actuator| actuator.settings(&in_use).map(|_| actuator))
        .map_err(|refusal| Failure::Work(format!("no parameters: {refusal}")))?;
    let rows = table::rows(&found, &in_use, masses.is_weighed());
    let notes = found.notes(&in_use);
    let summary = table::summary(&found, &rows, &notes);
    if let Some(out) = &arguments.out {
        results::write(out, &found, &summary)?;
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
            &json!({ "identified": summary, "revision": revision, "out": arguments.out }),
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
    if let Some(out) = &arguments.out {
        print(&format!("plot: {}\n", out.join(results::PLOT).display()))?;
    }
    match revision {
        Some(revision) => print(&format!("revision {revision} is applied\n")),
        None => Ok(()),
    }
}

impl Arguments {
    fn chirp(&self) -> Result<ChirpSettings, Failure> {
        let chirp = ChirpSettings {
            from_hz: self.from_hz,
            to_hz: self.to_hz,
            ..ChirpSettings::default()
        };
        chirp.check().map_err(Failure::input)?;
        Ok(chirp)
    }
}
