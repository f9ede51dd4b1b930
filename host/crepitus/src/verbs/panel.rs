//! `crepitus panel`: the trainer's page.

mod browser;
mod lan;
mod program;

use crate::cli::DeviceArguments;
use crate::failure::{Failure, print, print_json, warn};
use crate::interrupt;
use crate::line::{Line, failure, open_examined};
use crate::output::to_stdout;
use clap::Args;
use crepitus_client::Client;
use crepitus_files::output::temporary_in;
use crepitus_panel::{Experiments, Links, Panel, Settings, Source};
use crepitus_recording::{Damage, Recording};
use lan::Lan;
use program::ThisProgram;
use serde_json::json;
use std::fs;
use std::io::{IsTerminal, stdout};
use std::path::{Path, PathBuf};

/// Open the trainer's panel: a page to choose a knee, see what the hand does, and hold lessons.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus panel                                # the device that is attached
  crepitus panel --device sim                   # without a device
  crepitus panel --or-sim                       # simulated without a brace
  crepitus panel --sessions my-lessons          # lessons are stored there
  crepitus panel --experiments protocols        # thresholds, A or B, realism
  crepitus panel --replay monday.parquet --replay tuesday.parquet
  crepitus panel --lan auto                     # for a class, with TLS

The page is served to this computer alone, under a link with a secret; a second link is for looking on. \
One page has control and may turn the motor on; every page may stop. If the controlling page is closed or \
does not answer for 200 ms, the motor is off. With --lan a third link, as a QR code, is for students who \
answer by phone.

To see it from another computer, `ssh -L 8080:localhost:8080` with `--port 8080` is safest; --lan serves \
it to a network with a certificate that browsers warn about.")]
pub(crate) struct Arguments {
    /// Port [default: any free one].
    #[arg(long, default_value_t = 0, hide_default_value = true)]
    port: u16,

    /// Store sessions and recordings in this folder [default: store nothing].
    #[arg(long, value_name = "FOLDER")]
    sessions: Option<PathBuf>,

    /// Offer the protocols (*.toml) of this folder as experiments; answers go to `study` in it [default: none].
    #[arg(long, value_name = "FOLDER", conflicts_with = "replay")]
    experiments: Option<PathBuf>,

    /// Show recordings instead of a device; twice to compare two.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["device", "sessions"])]
    replay: Vec<PathBuf>,

    /// Take a simulated knee if no device is attached, as a double-click does.
    #[arg(long, conflicts_with_all = ["device", "replay"])]
    or_sim: bool,

    /// Serve it to the network, with TLS, under this address of this computer; auto finds it.
    #[arg(long, value_name = "ADDRESS")]
    lan: Option<Lan>,

    /// Do not open a browser.
    #[arg(long)]
    no_open: bool,

    #[command(flatten)]
    device: DeviceArguments,
}

/// Serves the panel until Ctrl-C.
pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    for file in &arguments.replay {
        Recording::open(file, Damage::Salvage).map_err(Failure::input)?;
    }
    if let Some(folder) = &arguments.sessions {
        probe(folder)?;
    }
    let experiments = arguments.experiments.as_deref().map(Experiments::open);
    let settings = Settings {
        port: arguments.port,
        lan: arguments.lan.map(Lan::address).transpose()?,
        sessions: arguments.sessions.clone(),
        experiments: experiments.transpose().map_err(Failure::input)?,
        recordings: arguments.replay.clone(),
    };
    interrupt::listen();
    if !arguments.replay.is_empty() {
        let panel = Panel::open(settings, &Source::Replay).map_err(Failure::input)?;
        let _opened = announce(&panel, arguments, "recordings, and no device", as_json)?;
        panel.replay(interrupt::requested);
        return Ok(());
    }
    let line = open_examined(&device_of(arguments)?)?;
    let mut client = Client::connect(line).map_err(failure)?;
    let is_simulated = matches!(client.transport_mut(), Line::Simulated(_));
    if is_simulated {
        // The leg is straight until the device is armed, but for one that nobody holds.
        client.zero().map_err(failure)?;
    }
    let name = client.port();
    let shown = match (is_simulated, arguments.or_sim) {
        (true, true) => "a simulated knee: no brace is attached".to_owned(),
        (true, false) => "a simulated knee".to_owned(),
        (false, _) => format!("the brace at {name}"),
    };
    let source = Source::Device {
        name,
        serial: crepitus_client::connection::device_text::serial(&client.handshake().comms),
        hand: client.transport_mut().hand(),
    };
    let panel = Panel::open(settings, &source).map_err(Failure::input)?;
    let _opened = announce(&panel, arguments, &shown, as_json)?;
    panel.keep(client, &ThisProgram).map_err(failure)
}

/// The device that the arguments name: with `--or-sim` a simulated one, if none is attached.
fn device_of(arguments: &Arguments) -> Result<DeviceArguments, Failure> {
    let mut device = arguments.device.clone();
    if arguments.or_sim && Line::attached().map_err(Failure::input)?.is_empty() {
        device.device = Some("sim".to_owned());
    }
    Ok(device)
}

/// Checks that files can be stored in a folder; a lesson would find out too late.
fn probe(folder: &Path) -> Result<(), Failure> {
    fs::create_dir_all(folder)
        .and_then(|()| temporary_in(folder).map(drop))
        .map_err(|e| {
            let text = Failure::at(folder, "--sessions: cannot store anything there", &e);
            Failure::Input(text.into_text() + ": name another folder")
        })
}

/// Prints what the page shows and its links, and opens the first.
fn announce(
    panel: &Panel,
    arguments: &Arguments,
    shown: &str,
    as_json: bool,
) -> Result<Option<browser::Opened>, Failure> {
    let Links {
        teacher,
        viewer,
        student,
        remote,
        student_code,
        certificate,
    } = panel.links();
    if as_json {
        print_json(&json!({
            "shown": shown,
            "teacher": teacher,
            "viewer": viewer,
            "student": student,
            "remote": remote,
            "certificate": certificate,
        }))?;
    } else {
        print(&format!(
            "{shown}\n{teacher}\n  this link controls: keep it to yourself\n{viewer}\n  this one is for \
             looking on, and can stop\nCtrl-C turns the motor off and ends the panel\n"
        ))?;
        if let Some(code) = student_code
            && arguments.replay.is_empty()
        {
            print(&format!("{student}\n  this one is for students' phones\n"))?;
            print_code(code)?;
        }
        if let Some(certificate) = certificate {
            print(&format!(
                "browsers warn about the certificate; compare its SHA-256 fingerprint:\n  {certificate}\n"
            ))?;
        }
    }
    if arguments.no_open || as_json {
        return Ok(None);
    }
    match browser::open(teacher) {
        Ok(opened) => Ok(Some(opened)),
        Err(error) => {
            warn(format!(
                "no browser was opened ({error}): open the first link yourself"
            ));
            Ok(None)
        }
    }
}

/// Prints a QR code whose light modules are blocks: white on black, whatever the colours of the terminal are. Without a
/// terminal no camera sees it.
fn print_code(code: &str) -> Result<(), Failure> {
    if !stdout().is_terminal() {
        return Ok(());
    }
    // Terminals of older versions of Windows show the codes of colours, and are black.
    let (begin, end) = if cfg!(windows) {
        ("", "")
    } else {
        ("\x1b[97;40m", "\x1b[0m")
    };
    let lines = code.lines().map(|line| format!("{begin}{line}{end}\n"));
    to_stdout(&lines.collect::<String>()).map_err(|_| Failure::NoReader)
}
