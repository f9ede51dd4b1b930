//! `crepitus stream`: samples to stdout as they arrive.

use crate::cli::{Arming, DeviceArguments, duration};
use crate::failure::{Failure, print};
use crate::following::{Follower, follow};
use crate::interrupt;
use crate::line::{Line, connect_to_arm, failure};
use crate::status_line::StatusLine;
use clap::{Args, ValueEnum};
use crepitus_client::Client;
use crepitus_protocol::telemetry::Block;
use crepitus_protocol::{Revision, TICKS_PER_S};
use crepitus_recording::{COLUMNS, Samples};
use std::time::Duration;

/// Output format of samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum SampleFormat {
    /// A header, and one line per sample.
    Csv,
    /// One JSON object per line.
    Jsonl,
}

/// Print a device's samples as they arrive.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus stream --rate 100
  crepitus stream --device sim --for 2s --rate 20000 --arm --zero \\
      > samples.csv
  crepitus stream --format jsonl --rate 10 | head

On a terminal a status line is shown on stderr. A rate below the drive's 20000 Hz takes every n-th \
sample, without a filter.")]
pub(crate) struct Arguments {
    /// Samples a second: 20000 divided by a whole number.
    #[arg(long, value_name = "HZ", default_value_t = 100, value_parser = rate)]
    rate: u32,

    /// Output format; --json means jsonl.
    #[arg(long, default_value = "csv")]
    format: SampleFormat,

    /// Duration: 500ms, 30s, 5m [default: until Ctrl-C].
    #[arg(long = "for", value_name = "TIME", value_parser = duration)]
    for_s: Option<Duration>,

    #[command(flatten)]
    arming: Arming,

    #[command(flatten)]
    device: DeviceArguments,
}

/// Streams.
/// Parses a rate.
fn rate(text: &str) -> Result<u32, String> {
    let rate = text
        .parse()
        .ok()
        .filter(|rate| (1..=TICKS_PER_S).contains(rate));
    rate.ok_or_else(|| format!("expected a whole number from 1 to {TICKS_PER_S}"))
}

pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    interrupt::listen();
    let rate = arguments.rate;
    if !TICKS_PER_S.is_multiple_of(rate) {
        let fits = |rate: &u32| TICKS_PER_S.is_multiple_of(*rate);
        let below = (1..rate).rev().find(fits).unwrap_or(1);
        let above = (rate..=TICKS_PER_S).find(fits).unwrap_or(TICKS_PER_S);
        return Err(Failure::Input(format!(
            "--rate {rate}: expected {TICKS_PER_S} divided by a whole number, for example {below} or {above}"
        )));
    }
    let format = if as_json {
        SampleFormat::Jsonl
    } else {
        arguments.format
    };
    let mut client = connect_to_arm(&arguments.device, arguments.arming)?;
    client.subscribe().map_err(failure)?;
    let mut printing = Printing {
        samples: Samples::default(),
        revision: None,
        every: u64::from(TICKS_PER_S / rate),
        format,
        text: String::new(),
        status: StatusLine::beside_lines(),
    };
    if format == SampleFormat::Csv {
        let header: Vec<_> = COLUMNS.iter().map(|column| column.name).collect();
        print(&(header.join(",") + "\n"))?;
    }
    let end = follow(
        &mut client,
        arguments.for_s,
        arguments.arming,
        &mut printing,
    );
    client.end_telemetry();
    end.map(|_| ())
}

struct Printing {
    samples: Samples,
    revision: Option<Revision>,
    every: u64,
    format: SampleFormat,
    text: String,
    status: StatusLine,
}

impl Follower for Printing {
    fn block(&mut self, client: &mut Client<Line>, block: &Block) -> Result<(), Failure> {
        if self.revision != Some(block.revision) {
            let (revision, values) = client.parameters().map_err(failure)?;
            self.samples.set(&values);
            self.revision = Some(revision);
        }
        for row in self.samples.rows(block) {
            if !row.tick.is_multiple_of(self.every) {
                continue;
            }
            match self.format {
                SampleFormat::Csv => row.append_to(&mut self.text),
                SampleFormat::Jsonl => {
                    self.text.push_str(&row.to_json().to_string());
                    self.text.push('\n');
                }
            }
        }
        self.status.block(block);
        Ok(())
    }

    fn pause(&mut self, client: &mut Client<Line>) -> Result<bool, Failure> {
        print(&self.text)?;
        self.text.clear();
        self.status.show(client.accounting());
        Ok(false)
    }
}
