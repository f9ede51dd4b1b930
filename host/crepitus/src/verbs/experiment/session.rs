//! `crepitus experiment run`: a session on a terminal.

use super::ask::Lines;
use super::{failure as store_failure, own_knee};
use crate::cli::{Arming, DeviceArguments};
use crate::failure::{Failure, print, print_json};
use crate::following::disarming;
use crate::interrupt;
use crate::line::{Line, failure, failure_with, open_to_arm};
use crate::output::to_stderr;
use crate::own_presets;
use clap::{Args, ValueHint};
use crepitus_client::Client;
use crepitus_scene::preset::{self, Preset};
use crepitus_scene::values::with_named;
use crepitus_studies::experiment::finding::{Finding, HEALTHY};
use crepitus_studies::experiment::protocol::{Design, Known};
use crepitus_studies::experiment::store::{Beginning, Store};
use crepitus_studies::experiment::table::{SEVERITIES, TableError, severity};
use crepitus_studies::experiment::{Held, Rating, Response, Stimulus, Trial};
use serde_json::json;
use std::path::PathBuf;
use std::time::{SystemTime, UNIX_EPOCH};

/// Run a session with a participant.
///
/// Every trial is on the disk before the next one is shown. `q` or Ctrl-C turns torque off and ends; the same
/// command goes on.
#[derive(Debug, Args)]
pub(super) struct Run {
    /// The protocol: see `experiment new`.
    #[arg(value_name = "PROTOCOL", value_hint = ValueHint::FilePath)]
    protocol: PathBuf,

    /// Folder of the study; a new one is made.
    #[arg(long, value_name = "DIR")]
    study: PathBuf,

    /// Pseudonym, with a digit: never a name.
    #[arg(long, value_name = "PSEUDONYM")]
    participant: String,

    /// The participant has consented to the text that the protocol names.
    #[arg(long)]
    consented: bool,

    /// Seed of the order [default: of the protocol's, the pseudonym and the number of the session].
    #[arg(long, value_name = "N")]
    seed: Option<u64>,

    /// Set the angle's zero before: hold the leg straight.
    #[arg(long)]
    zero: bool,

    #[command(flatten)]
    device: DeviceArguments,
}

pub(super) fn run(arguments: &Run, as_json: bool) -> Result<(), Failure> {
    interrupt::listen();
    let store = Store::create(&arguments.study).map_err(store_failure)?;
    let beginning = Beginning {
        protocol: &arguments.protocol,
        participant: &arguments.participant,
        seed: arguments.seed,
        has_consented: arguments.consented,
        unix_s: now().as_secs(),
    };
    let known = Known {
        own_preset: &own_knee,
    };
    let (mut held, goes_on) = store.begin(beginning, known).map_err(store_failure)?;
    let others = held.session().protocol().abx.as_ref();
    if others.is_some_and(|abx| abx.a.device.is_some() || abx.b.device.is_some()) {
        return Err(Failure::Input(
            "a condition names a device: two devices at once need Python, crepitus.experiments"
                .to_owned(),
        ));
    }
    let arming = Arming::armed(arguments.zero);
    let line = open_to_arm(&arguments.device, arming)?.in_real_time();
    let mut client = Client::connect(line).map_err(failure)?;
    if arming.zero {
        client
            .zero()
            .map_err(|error| failure_with(&mut client, error))?;
    }
    if goes_on {
        let answered = held.session().rows().len();
        to_stderr(&format!(
            "this session goes on after {answered} answered trials"
        ));
    }
    let result = disarming(&mut client, |client| trials(client, &mut held));
    result?;
    let (answered, is_over) = (held.session().rows().len(), held.session().is_over());
    if as_json {
        return print_json(&json!({
            "participant": held.begun().participant,
            "session": held.begun().session,
            "answered": answered,
            "over": is_over,
            "folder": crepitus_files::json_path(held.folder()),
        }));
    }
    print(&if is_over {
        format!(
            "\nthe session is over: {answered} trials in {}\n",
            held.folder().display()
        )
    } else {
        format!("\n{answered} trials are stored; the same command goes on\n")
    })
}

/// Every trial that has no answer yet.
fn trials(client: &mut Client<Line>, held: &mut Held) -> Result<(), Failure> {
    let lines = Lines::listen();
    if let Some(question) = held.session().protocol().question.as_deref() {
        to_stderr(question);
    }
    // Torque only when the first knee is there.
    let mut is_armed = false;
    while let Some(trial) = held.trial() {
        to_stderr(&format!("\ntrial {} of at most {}", trial.number, trial.of));
        for (number, stimulus) in (1..).zip(&trial.intervals) {
            present(client, stimulus)?;
            if !is_armed {
                client.arm().map_err(|error| failure_with(client, error))?;
                is_armed = true;
            }
            let what = name(held, number);
            let Some(_) = lines.ask(client, &format!("{what}: feel it, then Enter"))? else {
                return Ok(());
            };
        }
        let answered = if held.session().protocol().realism.is_some() {
            rate(client, &lines, held)?
        } else {
            choose(client, &lines, held, &trial)?
        };
        if !client.is_armed() {
            return Err(Failure::Work(
                "torque was off before the answer: the trial is not stored; clear the fault, then the same command \
                 goes on"
                    .to_owned(),
            ));
        }
        let Some(response) = answered else {
            return Ok(());
        };
        held.answer(response, now().as_secs_f64())
            .map_err(table_failure)?;
    }
    Ok(())
}

/// Name of an interval.
fn name(held: &Held, number: usize) -> String {
    let protocol = held.session().protocol();
    if protocol.realism.is_some() {
        return "the knee".to_owned();
    }
    if protocol.abx.is_some() {
        return ["A", "B", "X"]
            .get(number - 1)
            .copied()
            .unwrap_or_default()
            .to_owned();
    }
    format!("{number}")
}

/// Asks for a choice; where it is allowed, an interval can be felt again.
fn choose(
    client: &mut Client<Line>,
    lines: &Lines,
    held: &Held,
    trial: &Trial,
) -> Result<Option<Response>, Failure> {
    let protocol = held.session().protocol();
    let is_abx = protocol.abx.is_some();
    let threshold = protocol.threshold.as_ref();
    let is_again = is_abx || threshold.is_some_and(|t| t.design == Design::TwoAlternatives);
    let choices = if is_abx { ["A", "B"] } else { ["1", "2"] };
    let again = match (is_again, is_abx) {
        (false, _) => "",
        (true, true) => "; again A, again B, again X: feel it again",
        (true, false) => "; again 1, again 2: feel it again",
    };
    let question = format!("your answer, {} or {}{again}:", choices[0], choices[1]);
    loop {
        let Some(line) = lines.ask(client, &question)? else {
            return Ok(None);
        };
        let line = line.to_uppercase();
        if let Some(place) = choices.iter().position(|choice| *choice == line) {
            let choice = if place == 0 { 1 } else { 2 };
            return Ok(Some(Response::Choice(choice)));
        }
        let wanted = line.strip_prefix("AGAIN ").filter(|_| is_again);
        let found = (1..)
            .zip(&trial.intervals)
            .find(|(number, _)| Some(name(held, *number).as_str()) == wanted);
        if let Some((_, stimulus)) = found {
            present(client, stimulus)?;
        } else {
            to_stderr(&format!("expected {} or {}{again}", choices[0], choices[1]));
        }
    }
}

/// Asks for a description, then for the judgement.
fn rate(
    client: &mut Client<Line>,
    lines: &Lines,
    held: &mut Held,
) -> Result<Option<Response>, Failure> {
    if let Some(description) = held.session().described() {
        to_stderr(&format!("before the interruption you felt: {description}"));
    } else {
        let description = lines.until(
            client,
            "describe in your own words what you feel:",
            |line| (!line.is_empty()).then(|| line.to_owned()),
        )?;
        let Some(description) = description else {
            return Ok(None);
        };
        held.answer(Response::Description(description), now().as_secs_f64())
            .map_err(table_failure)?;
    }
    let features = held
        .session()
        .protocol()
        .realism
        .iter()
        .flat_map(|r| &r.features);
    let mut realism = Vec::new();
    let whole = "the knee as a whole".to_owned();
    for feature in std::iter::once(&whole).chain(features) {
        let question = format!("how real is {feature}, from 1, not at all, to 5, as a patient's:");
        let rated = lines.until(client, &question, |line| {
            line.parse::<u8>()
                .ok()
                .filter(|number| (1..=5).contains(number))
        })?;
        let Some(rated) = rated else { return Ok(None) };
        realism.push(rated);
    }
    let question = format!("severity ({}):", SEVERITIES.join(", "));
    let Some(severity) = lines.until(client, &question, severity)? else {
        return Ok(None);
    };
    let types: Vec<_> = Finding::all().map(Finding::name).collect();
    let question = format!("type ({}):", types.join(", "));
    let Some(finding) = lines.until(client, &question, Finding::find)? else {
        return Ok(None);
    };
    let rating = Rating {
        realism,
        severity,
        finding,
    };
    Ok(Some(Response::Rating(rating)))
}

impl Lines {
    /// Asks until the answer is one.
    fn until<T>(
        &self,
        client: &mut Client<Line>,
        question: &str,
        read: impl Fn(&str) -> Option<T>,
    ) -> Result<Option<T>, Failure> {
        loop {
            let Some(line) = self.ask(client, question)? else {
                return Ok(None);
            };
            if let Some(answer) = read(&line) {
                return Ok(Some(answer));
            }
        }
    }
}

/// Renders a stimulus, in one commit.
fn present(client: &mut Client<Line>, stimulus: &Stimulus) -> Result<(), Failure> {
    let preset = if stimulus.preset == HEALTHY {
        Preset::default()
    } else if let Some(shipped) = preset::find(&stimulus.preset) {
        shipped.clone()
    } else {
        let gone = || Failure::Input(format!("the preset {:?} is gone", stimulus.preset));
        Preset::read(&own_presets::find(&stimulus.preset).ok_or_else(gone)?)?
    };
    let (base, now) = client.parameters().map_err(failure)?;
    let values = stimulus.values.iter();
    let values = with_named(
        &now,
        &preset,
        values.map(|(name, value)| (name.as_str(), *value)),
    );
    let values = values.map_err(Failure::input)?;
    client.commit(base, &values).map_err(failure)?;
    Ok(())
}

fn table_failure(error: TableError) -> Failure {
    match error {
        TableError::Write { file, cause } => Failure::at(&file, "cannot be written", &cause),
        error => Failure::input(error),
    }
}

/// Time since 1970.
fn now() -> std::time::Duration {
    SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .unwrap_or_default()
}
