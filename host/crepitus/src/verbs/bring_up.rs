//! `crepitus bring-up`: the rows of the hardware page, one after the other, with the device attached.

mod bench;
mod checks;
mod outcome;
mod person;
mod results;
mod rows;

use crate::cli::{DeviceArguments, Force};
use crate::failure::{Failure, print, print_json, warn};
use crate::interrupt;
use crate::line::{Line, failure, open_in_real_time};
use crate::results::folder;
use bench::Builder;
use checks::Rest;
use clap::{Args, ValueHint};
use crepitus_client::Client;
use crepitus_client::connection::device_text;
use crepitus_files::json_path;
use crepitus_protocol::Values;
use crepitus_protocol::parameters::PARAMETERS;
use outcome::{Outcome, Verdict};
use person::{Answer, Person};
use rows::{Check, ROWS, Row};
use serde_json::json;
use std::path::PathBuf;

/// Bring up a new device, row by row.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus bring-up --out out/bring-up
  crepitus bring-up --rows encoder,lines,offset
  crepitus bring-up --from polarity
  crepitus bring-up --device sim --yes
  crepitus bring-up --device sim --yes --wiring-fault motor-swapped

Each row says what to do and what to see, and goes on by Enter; n says that it is not so, s skips it, Ctrl-C ends the program with \
the torque off. What the device can measure is measured; some rows ask for an action while it is armed, and wait 20 s for what has to \
follow. Effects are off meanwhile and put back at the end; the angle's zero is set anew.

With --yes nobody is asked: rows that a person has to see are listed, the others are taken at once. A simulated device has a builder \
who does what the rows say, and on request one fault of its wiring.

Exit code 1: a row is not as expected; the text says what to do.")]
pub(crate) struct Arguments {
    /// Rows by name [default: all].
    #[arg(
        long,
        value_name = "ROW",
        value_delimiter = ',',
        conflicts_with = "from"
    )]
    rows: Vec<String>,

    /// First row, by name.
    #[arg(long, value_name = "ROW")]
    from: Option<String>,

    /// Do not wait for anybody: take each row at once.
    #[arg(long)]
    yes: bool,

    /// With --device sim: plant this fault of the wiring.
    #[arg(long, value_name = "FAULT")]
    wiring_fault: Option<bench::Fault>,

    /// Folder for report.html and bring-up.json.
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    out: Option<PathBuf>,

    #[command(flatten)]
    force: Force,

    #[command(flatten)]
    device: DeviceArguments,
}

/// Name of the simulated device.
const SIMULATED: &str = "sim";

fn find(name: &str) -> Result<usize, Failure> {
    let place = ROWS
        .iter()
        .position(|row| [row.name, row.number].contains(&name));
    place.ok_or_else(|| {
        let names: Vec<_> = ROWS.iter().map(|row| row.name).collect();
        Failure::Input(format!(
            "no row is called `{name}`: expected one of {}",
            names.join(", ")
        ))
    })
}

impl Arguments {
    /// The rows, in their order.
    fn rows(&self) -> Result<Vec<&'static Row>, Failure> {
        let from = self.from.as_deref().map_or(Ok(0), find)?;
        let named = self.rows.iter().map(|name| find(name));
        let named: Vec<usize> = named.collect::<Result<_, _>>()?;
        let rows = ROWS.iter().enumerate();
        let is_asked = |place: usize| place >= from && (named.is_empty() || named.contains(&place));
        Ok(rows
            .filter(|(place, _)| is_asked(*place))
            .map(|(_, row)| row)
            .collect())
    }

    /// Line and builder of the simulated device, if that is asked for.
    fn simulated(&self) -> Result<Option<(Line, Builder)>, Failure> {
        if self.device.device.as_deref() == Some(SIMULATED) {
            if self.device.scene.is_some() {
                return Err(Failure::input(
                    "--scene: the simulated board of a bring-up has its own: leave it out",
                ));
            }
            let (device, builder) = bench::bench(self.wiring_fault)?;
            return Ok(Some((Line::Simulated(Box::new(device)), builder)));
        }
        if self.wiring_fault.is_some() {
            return Err(Failure::input(
                "--wiring-fault: only a simulated board has one: give --device sim, or leave it out",
            ));
        }
        Ok(None)
    }
}

/// The connection, opened when a row needs it first: before, there may be no device.
struct Session<'a> {
    device: &'a DeviceArguments,
    simulated: Option<Line>,
    client: Option<Client<Line>>,
    /// Parameters from before, with the effects.
    before: Option<Values>,
    /// Current at rest.
    rest: Rest,
}

impl Session<'_> {
    /// The connection, opened again if it was lost.
    fn client(&mut self) -> Result<&mut Client<Line>, Failure> {
        let known = self.client.take().filter(Client::is_connected);
        let client = if let Some(client) = known {
            client
        } else {
            let line = match self.simulated.take() {
                Some(line) => line,
                None => open_in_real_time(self.device)?,
            };
            Client::connect(line).map_err(failure)?
        };
        let client = self.client.insert(client);
        // The drive may be connected rows later.
        if self.before.is_none() && client.status().map_err(failure)?.drive_present {
            // One that is silent is a row's to tell.
            self.before = without_effects(client).ok();
        }
        Ok(client)
    }

    /// Puts the effects back.
    fn put_back(&mut self) -> Result<(), Failure> {
        if let (Some(client), Some(before)) = (&mut self.client, &self.before)
            && client.is_connected()
        {
            let (revision, _) = client.parameters().map_err(failure)?;
            client.commit(revision, before).map_err(failure)?;
        }
        Ok(())
    }
}

/// Switches all effects off; returns the values of before.
fn without_effects(client: &mut Client<Line>) -> Result<Values, Failure> {
    let (_, before) = client.parameters().map_err(failure)?;
    let renders = PARAMETERS
        .iter()
        .filter(|parameter| parameter.key() == "render");
    let off: Vec<_> = renders.map(|parameter| (parameter.id, 0.0)).collect();
    client.set(&off).map_err(failure)?;
    Ok(before)
}

/// Leads through the rows, prints each outcome, and writes the record.
pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    let rows = arguments.rows()?;
    let out = arguments.out.as_deref();
    let prepare = |out| {
        let claim = arguments.force.claim("bring-up", [""; 0]);
        folder(out, claim, results::NAMES)
    };
    let prepared = out.map(prepare).transpose()?;
    interrupt::listen();
    let (line, builder) = arguments.simulated()?.unzip();
    let person = Person::new(arguments.yes, builder)?;
    let mut session = Session {
        device: &arguments.device,
        simulated: line,
        client: None,
        before: None,
        rest: Rest::default(),
    };
    let taken = rows.into_iter().try_fold(Vec::new(), |mut outcomes, row| {
        let outcome = taken(&mut session, &person, row)?;
        if !as_json {
            print(&outcome.text())?;
        }
        outcomes.push(outcome);
        Ok::<_, Failure>(outcomes)
    });
    if session.put_back().is_err() {
        warn(
            "the effects stay off until the device is switched off and on: what was saved is not changed",
        );
    }
    let outcomes = taken?;
    let comms = session
        .client
        .as_ref()
        .map(|client| client.handshake().comms);
    let device = comms
        .as_ref()
        .map(device_text::identity)
        .unwrap_or_default();
    let summary = results::summary(&device, &outcomes);
    if let (Some(out), Some(folder)) = (out, prepared) {
        results::write(out, folder, &outcomes, &summary)?;
    }
    if as_json {
        print_json(&json!({ "bring_up": summary, "out": out.map(json_path) }))?;
    } else {
        print(&results::last(&outcomes))?;
        if let Some(out) = out {
            print(&format!("report: {}\n", out.join(results::PAGE).display()))?;
        }
    }
    if outcomes.iter().any(Outcome::is_wrong) {
        Err(Failure::Negative)
    } else {
        Ok(())
    }
}

/// Takes a row.
fn taken(
    session: &mut Session<'_>,
    person: &Person,
    row: &'static Row,
) -> Result<Outcome, Failure> {
    let answer = person.ask(session.client.as_mut(), row)?;
    let outcome = match (answer, row.check) {
        (Answer::Skip, _) => Outcome::new(row, Verdict::Skipped, "", ""),
        (Answer::No, _) => Outcome::bad(row, "not as expected", "repair it before the next row"),
        (Answer::Yes, Check::ByHand) if person.sees() => Outcome::good(row, "seen"),
        (Answer::Yes, Check::ByHand) => Outcome::new(row, Verdict::ByHand, "", ""),
        (Answer::Yes, _) => measured(session, person, row)?,
    };
    person.end();
    Ok(outcome)
}

/// Measures a row. Where the device does not answer as it should, the row could not tell.
fn measured(
    session: &mut Session<'_>,
    person: &Person,
    row: &'static Row,
) -> Result<Outcome, Failure> {
    let mut rest = session.rest;
    let measured = session
        .client()
        .and_then(|client| checks::measured(client, person, row, &mut rest));
    session.rest = rest;
    match measured {
        Err(Failure::Work(text)) if !interrupt::requested() => {
            let remedy = "repair that first; `crepitus doctor` says more";
            Ok(Outcome::new(row, Verdict::Unknown, text, remedy))
        }
        result => result,
    }
}
