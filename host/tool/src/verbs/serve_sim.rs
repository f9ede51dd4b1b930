//! `crepitus serve-sim`: a simulated device as a serial port, in real time.

use crate::failure::{Failure, print, print_json};
use crate::interrupt;
use crate::shipped;
use clap::Args;
use crepitus_board::{Start, VirtualDevice};
use crepitus_client::discovery::{ServedName, user_folder};
use crepitus_protocol::TICKS_PER_S;
use crepitus_scene::Overrides;
use crepitus_usb::pty::Pty;
use serde_json::json;
use std::io::ErrorKind;
use std::path::PathBuf;
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Serve a simulated device as a serial port.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus serve-sim
  crepitus serve-sim --scene everything --name bench
  crepitus info --device bench

A simulated device as a serial port that any program can open, in real time, until Ctrl-C. \
`crepitus devices` lists it.")]
pub(crate) struct Arguments {
    /// The scene that sets its leg and parameters.
    #[arg(long, value_name = "SCENE", default_value = "passive-examination")]
    scene: PathBuf,

    /// Its name, for --device.
    #[arg(long, value_name = "NAME", default_value = "sim-1")]
    name: String,
}

/// Ticks between two exchanges with the port.
const EXCHANGE_TICKS: u64 = 20;

/// Simulated time that lags more than this is not caught up.
const MOST_LAG: Duration = Duration::from_millis(200);

/// Serves until Ctrl-C.
pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    let is_plain = |c: char| c.is_alphanumeric() || c == '-' || c == '_';
    let is_reserved = ["", "sim", "emulated", "shared"].contains(&&*arguments.name);
    if is_reserved || !arguments.name.chars().all(is_plain) {
        return Err(Failure::Input(format!(
            "--name {:?}: expected letters, digits, `-` and `_`, and not `sim`, `emulated` or `shared`, \
             which are reserved",
            arguments.name
        )));
    }
    let scene = shipped::scene(&arguments.scene, &Overrides::default())?;
    let mut device = VirtualDevice::of(&scene, &Start::default()).map_err(Failure::input)?;
    let name = ServedName::take(&arguments.name).map_err(|e| match e.kind() {
        ErrorKind::AddrInUse => Failure::Input(format!(
            "--name {:?}: another program serves a device of this name; choose another one",
            arguments.name
        )),
        _ => Failure::at(&user_folder(), "the folder of simulated devices", &e),
    })?;
    let link = name.link();
    let mut pty = Pty::new(Some(link)).map_err(|e| Failure::at(link, "cannot be created", &e))?;
    interrupt::listen();
    if as_json {
        print_json(&json!({ "port": link, "name": arguments.name, "scene": scene.title }))?;
    } else {
        print(&format!(
            "{} is served as {}\ntry `crepitus info --device {}`; Ctrl-C stops it\n",
            scene.title,
            link.display(),
            arguments.name
        ))?;
    }
    let mut clock = Clock::new();
    while !interrupt::requested() {
        for _ in 0..clock.due_ticks() {
            device.tick();
            if device.board().now().is_multiple_of(EXCHANGE_TICKS) {
                // After a restart of comms the cable is still connected.
                if device.host().is_none() && device.board().comms_runs() {
                    let _ = device.plug_in();
                }
                if let Some(host) = device.host() {
                    pty.exchange(host)
                        .map_err(|e| Failure::at(link, "the port failed", &e))?;
                }
            }
        }
        sleep(Duration::from_millis(1));
    }
    Ok(())
}

/// Keeps simulated time up with real time.
struct Clock {
    begun: Instant,
    ticks: u64,
}

impl Clock {
    fn new() -> Self {
        Self {
            begun: Instant::now(),
            ticks: 0,
        }
    }

    /// Ticks that are due.
    fn due_ticks(&mut self) -> u64 {
        let per_tick = Duration::from_secs(1) / TICKS_PER_S;
        let elapsed = self.begun.elapsed().as_nanos();
        let now = u64::try_from(elapsed / per_tick.as_nanos()).unwrap_or(u64::MAX);
        let due = now.saturating_sub(self.ticks);
        self.ticks = now;
        // Time in which the computer slept is not caught up.
        let most = u64::try_from(MOST_LAG.as_nanos() / per_tick.as_nanos()).unwrap_or(u64::MAX);
        due.min(most)
    }
}
