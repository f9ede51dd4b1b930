//! `crepitus stream`: samples to stdout, as they come.

use crate::cli::device::{SampleFormat, StreamArguments};
use crate::failure::{Failure, print};
use crate::following::{Follower, follow};
use crate::line::{Line, connect, failure};
use crate::status_line::StatusLine;
use crepitus_client::Client;
use crepitus_protocol::telemetry::Block;
use crepitus_protocol::{Revision, TICKS_PER_S};
use crepitus_recording::{COLUMNS, Samples};

/// Streams.
pub(crate) fn stream(arguments: &StreamArguments, as_json: bool) -> Result<(), Failure> {
    let rate = arguments.rate;
    if !TICKS_PER_S.is_multiple_of(rate) {
        let every = TICKS_PER_S / rate;
        return Err(Failure::Input(format!(
            "--rate {rate}: the drive makes {TICKS_PER_S} samples a second, and every n-th \
             is taken: {} is every {every}th, {} every {}th",
            TICKS_PER_S / every,
            TICKS_PER_S / (every + 1),
            every + 1
        )));
    }
    let format = if as_json {
        SampleFormat::Jsonl
    } else {
        arguments.format
    };
    let mut client = connect(&arguments.device)?;
    client.subscribe().map_err(failure)?;
    let mut printing = Printing {
        samples: Samples::default(),
        revision: None,
        every: u64::from(TICKS_PER_S / rate),
        format,
        text: String::new(),
        status: StatusLine::new(),
    };
    if format == SampleFormat::Csv {
        let header: Vec<_> = COLUMNS.iter().map(|(name, _)| *name).collect();
        print(&(header.join(",") + "\n"))?;
    }
    follow(&mut client, arguments.for_s, arguments.arm, &mut printing)?;
    Ok(())
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
        self.status.aside(|| print(&self.text))?;
        self.text.clear();
        self.status.show(client.accounting());
        Ok(false)
    }
}
