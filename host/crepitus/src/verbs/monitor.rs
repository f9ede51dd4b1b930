//! `crepitus monitor`: the live view on a terminal.

mod keys;
mod screen;
mod view;

use crate::cli::{Arming, DeviceArguments, duration};
use crate::failure::{Failure, print, print_json};
use crate::following::{Follower, follow};
use crate::interrupt;
use crate::line::{Line, failure, failure_with, holder, named, open_to_arm};
use clap::Args;
use clap::builder::PossibleValuesParser;
use crepitus_client::{Begin, Client};
use crepitus_panel::live::{Envelope, NAMED, Pace, Target};
use crepitus_protocol::host::Status;
use crepitus_protocol::telemetry::Block;
use crepitus_protocol::{Revision, TICKS_PER_S};
use crepitus_recording::Samples;
use keys::{Key, Keys};
use screen::Screen;
use serde_json::json;
use std::io::{IsTerminal, stdin, stdout};
use std::time::{Duration, Instant};
use view::{Mark, View};

/// Samples of a bin, 5 ms.
const ROWS_PER_BIN: u32 = TICKS_PER_S / 200;

/// Interval of pictures.
const DRAW_EVERY: Duration = Duration::from_millis(50);

/// Interval of the status.
const STATUS_EVERY: Duration = Duration::from_millis(250);

/// Watch a device on the terminal: angle, speed, torque, states, faults.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus monitor
  crepitus monitor --device sim --zero --arm --target medium
  crepitus monitor --for 60s

Keys: s or Esc stops at once, d disarms, m sets a mark, t chooses the next target speed, r begins or ends \
a score, q quits. The marks are printed at the end.")]
pub(crate) struct Arguments {
    /// Target speed to judge the hand by.
    #[arg(long, value_parser = PossibleValuesParser::new(NAMED.map(|target| target.name)))]
    target: Option<String>,

    /// Duration: 500ms, 30s, 5m [default: until q or Ctrl-C].
    #[arg(long = "for", value_name = "TIME", value_parser = duration)]
    for_s: Option<Duration>,

    #[command(flatten)]
    arming: Arming,

    #[command(flatten)]
    device: DeviceArguments,
}

/// Shows it until a key ends it.
pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    interrupt::listen();
    if !stdin().is_terminal() || !stdout().is_terminal() {
        return Err(Failure::input(
            "monitor needs a terminal for its screen and its keys: `crepitus stream` prints samples instead",
        ));
    }
    let line = open_to_arm(&arguments.device, arguments.arming)?.in_real_time();
    let mut client = Client::connect(line).map_err(failure)?;
    client.subscribe().map_err(failure)?;
    let target = arguments.target.as_deref().and_then(Target::find);
    let mut monitor = Monitor::new(client.port(), arguments.arming, target);
    // Its examiner moves the leg, and is not to be judged.
    monitor.view.is_simulated = matches!(client.transport_mut(), Line::Simulated(_));
    let end = follow(
        &mut client,
        arguments.for_s,
        Arming::default(),
        &mut monitor,
    );
    client.end_telemetry();
    // Restores the terminal before anything is printed.
    let marks = monitor.close();
    end?;
    if as_json {
        let marks = marks
            .iter()
            .map(|mark| json!({ "t_s": mark.time_s, "mark": mark.number }));
        return print_json(&json!({ "marks": marks.collect::<Vec<_>>() }));
    }
    let lines = marks
        .iter()
        .map(|mark| format!("mark {} at {:.2} s\n", mark.number, mark.time_s));
    print(&lines.collect::<String>())
}

/// State of the monitor: what is followed, and shown.
struct Monitor {
    arming: Arming,
    has_begun: bool,
    samples: Samples,
    revision: Option<Revision>,
    envelope: Envelope,
    view: View,
    pace: Option<Pace>,
    screen: Option<Screen>,
    keys: Keys,
    drawn_at: Instant,
    asked_at: Instant,
}

impl Monitor {
    fn new(device: String, arming: Arming, target: Option<Target>) -> Self {
        Self {
            arming,
            has_begun: false,
            samples: Samples::default(),
            revision: None,
            envelope: Envelope::new(ROWS_PER_BIN),
            view: View::new(device),
            pace: target.map(Pace::new),
            screen: None,
            keys: Keys,
            drawn_at: Instant::now(),
            asked_at: Instant::now(),
        }
    }

    fn close(self) -> Vec<Mark> {
        drop(self.screen);
        self.view.marks
    }

    /// Zeroes and arms, so that a failure is printed on a terminal in its normal mode;
    /// then takes the screen.
    fn begin(&mut self, client: &mut Client<Line>) -> Result<(), Failure> {
        self.has_begun = true;
        if self.arming.zero {
            client.zero().map_err(|error| failure_with(client, error))?;
        }
        if self.arming.arm {
            client.arm().map_err(|error| failure_with(client, error))?;
        }
        self.ask(client)?;
        self.screen = Some(Screen::take().map_err(|error| {
            Failure::Work(format!("the terminal cannot be used as a screen: {error}"))
        })?);
        Ok(())
    }

    fn ask(&mut self, client: &mut Client<Line>) -> Result<(), Failure> {
        self.asked_at = Instant::now();
        let status: Status = client.status().map_err(failure)?;
        let other = status.lease.filter(|session| *session != client.session());
        self.view.holder = other.map(|session| {
            holder(client, session).map_or_else(
                || "another program".to_owned(),
                |program| named(&program).trim_end_matches(',').to_owned(),
            )
        });
        self.view.status = Some(status);
        Ok(())
    }

    /// Executes a key's command; returns whether to quit.
    fn execute(&mut self, key: Key, client: &mut Client<Line>) -> Result<bool, Failure> {
        match key {
            Key::Stop => client.stop().map_err(failure)?,
            Key::Disarm => {
                if let Err(error) = client.disarm() {
                    let text = failure_with(client, error).into_text();
                    self.tell(&text);
                }
            }
            Key::Mark => self.view.mark(),
            Key::NextTarget => self.next_target(),
            Key::Score => {
                if let Some(pace) = &mut self.pace {
                    let is_scoring = pace.is_scoring();
                    pace.set_scoring(!is_scoring);
                }
            }
            Key::Quit => return Ok(true),
        }
        self.ask(client)?;
        Ok(false)
    }

    fn next_target(&mut self) {
        let now = self.pace.as_ref().map(Pace::target);
        let place = now.and_then(|now| NAMED.iter().position(|target| *target == now));
        let next = place.map_or(0, |place| place + 1);
        self.pace = NAMED.get(next).copied().map(Pace::new);
    }
}

impl Follower for Monitor {
    fn block(&mut self, client: &mut Client<Line>, block: &Block) -> Result<(), Failure> {
        if self.revision != Some(block.revision) {
            let (_, values) = client.parameters().map_err(failure)?;
            self.samples.set(&values);
            self.revision = Some(block.revision);
        }
        for row in self.samples.rows(block) {
            self.envelope.take(&row);
            row.examined_by(&mut self.view.examination);
            if let Some(pace) = &mut self.pace
                && !self.view.is_simulated
            {
                pace.take(&row);
            }
        }
        Ok(())
    }

    fn resumed(&mut self, _: Begin) -> Result<(), Failure> {
        self.revision = None;
        Ok(())
    }

    fn pause(&mut self, client: &mut Client<Line>) -> Result<bool, Failure> {
        if !self.has_begun {
            self.begin(client)?;
        }
        while let Some(key) = self.keys.next() {
            if self.execute(key, client)? {
                return Ok(true);
            }
        }
        if self.asked_at.elapsed() >= STATUS_EVERY {
            self.ask(client)?;
        }
        if self.drawn_at.elapsed() >= DRAW_EVERY {
            self.drawn_at = Instant::now();
            let (first, bins) = self.envelope.complete();
            self.view.extend(first, self.envelope.bin_s(), bins);
            self.view.counts = client.accounting().map(view::Counts::of);
            if let Some(screen) = &mut self.screen {
                let (view, pace) = (&self.view, self.pace.as_ref());
                screen
                    .draw(|frame| view.draw(frame, pace))
                    .map_err(|error| Failure::Work(format!("the terminal is gone: {error}")))?;
            }
        }
        Ok(false)
    }

    fn tell(&mut self, text: &str) {
        self.view.tell(text);
    }
}
