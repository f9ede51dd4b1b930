//! `crepitus serve-sim`: a simulated device as a serial port, in real time.

use crate::failure::{Failure, print, print_json};
use crate::interrupt;
use crate::shipped;
use clap::Args;
use crepitus_board::{Start, VirtualDevice};
use crepitus_client::discovery::simulated_folder;
use crepitus_protocol::TICKS_PER_S;
use crepitus_scene::Overrides;
use crepitus_usb::pty::Pty;
use serde_json::json;
use std::fs;
use std::path::PathBuf;
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Offer a simulated device as a serial port.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus serve-sim
  crepitus serve-sim --scene everything --name bench
  crepitus info --device bench

A simulated device as a serial port that any program can open, in real time, until Ctrl-C. \
`crepitus devices` lists it.")]
pub(crate) struct Arguments {
    /// The scene whose leg and parameters it has.
    #[arg(long, value_name = "SCENE", default_value = "passive-examination")]
    scene: PathBuf,

    /// The name under which it is found.
    #[arg(long, value_name = "NAME", default_value = "sim-1")]
    name: String,
}

/// Ticks between two looks at the port.
const EXCHANGE_TICKS: u64 = 20;

/// Beyond this the simulated time is let fall behind.
const BEHIND: Duration = Duration::from_millis(200);

/// Serves until Ctrl-C.
pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    if arguments.name.is_empty() || arguments.name.contains(['/', '\\']) || arguments.name == "sim"
    {
        return Err(Failure::Input(format!(
            "--name {:?}: a name without slashes, and not `sim`, which is the device of one command",
            arguments.name
        )));
    }
    let scene = shipped::scene(&arguments.scene, &Overrides::default())?;
    let mut device = VirtualDevice::of(&scene, &Start::default()).map_err(Failure::input)?;
    let folder = simulated_folder();
    fs::create_dir_all(&folder).map_err(|e| Failure::at(&folder, "cannot be made", &e))?;
    let link = folder.join(&arguments.name);
    let mut pty = Pty::new(Some(&link)).map_err(|e| Failure::at(&link, "cannot be offered", &e))?;
    interrupt::listen();
    if as_json {
        print_json(&json!({ "port": link, "name": arguments.name, "scene": scene.title }))?;
    } else {
        print(&format!(
            "{} is offered as {}\ntry `crepitus info --device {}`; Ctrl-C ends it\n",
            scene.title,
            link.display(),
            arguments.name
        ))?;
    }
    let mut clock = Clock::new();
    while !interrupt::asked() {
        for _ in 0..clock.due_ticks() {
            device.tick();
            if device.board().now().is_multiple_of(EXCHANGE_TICKS) {
                // Comms has started anew: a cable that is in stays in.
                if device.host().is_none() && device.board().comms_runs() {
                    let _ = device.plug_in();
                }
                if let Some(host) = device.host() {
                    pty.exchange(host)
                        .map_err(|e| Failure::at(&link, "the port failed", &e))?;
                }
            }
        }
        sleep(Duration::from_millis(1));
    }
    Ok(())
}

/// Simulated time after the wall's.
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
        // A machine that was asleep does not make up for it.
        let most = u64::try_from(BEHIND.as_nanos() / per_tick.as_nanos()).unwrap_or(u64::MAX);
        due.min(most)
    }
}
