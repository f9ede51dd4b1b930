//! `crepitus calibrate`: the steps that a new brace needs before it is used: zero, range, polarity, friction, torque constant.

mod change;
mod connected;
mod finding;
mod friction;
mod hanging;
mod page;
mod person;
mod polarity;
mod prepared;
mod pulled;
mod range;
mod results;
mod step;
mod watched;
mod weight;
mod zero;

use crate::cli::{DeviceArguments, Force, duration};
use crate::failure::{Failure, print, print_json};
use crate::interrupt;
use crate::line::{Line, failure, open, open_in_real_time};
use crate::results::folder;
use clap::{Args, ValueHint};
use crepitus_client::Client;
use crepitus_files::json_path;
use finding::{Finding, Verdict};
use person::{Answer, Person};
use serde_json::json;
use std::path::PathBuf;
use std::time::Duration;
use step::Step;
use weight::WeightArguments;

/// Calibrate a new brace: zero, range, polarity, friction, torque constant by a hanging weight.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus calibrate
  crepitus calibrate --weight-kg 0.6 --lever-m 0.25 --out out/calibration \\
      --apply
  crepitus calibrate --steps torque-constant --weight-kg 0.6 --lever-m 0.25
  crepitus calibrate --device sim --scene weight-on-the-arm \\
      --steps zero,polarity,torque-constant --weight-kg 0.6 --lever-m 0.25 \\
      --yes
  crepitus calibrate --device sim --scene weight-in-the-brace \\
      --steps friction --weight-kg 2.44 --lever-m 0.2477 \\
      --weight-inertia-kg-m2 0.2202 --yes

Clamp the upper half of the brace in a vice, its axis level, nobody in it. Each step says what to do, and goes on by Enter; s skips \
it, Ctrl-C ends the program with the torque off.

The steps friction and torque-constant need a known weight, each its own: friction one that swings (moment 9 to 14 times the friction, 2.5 kg \
at 0.25 m), torque-constant one that the motor lifts to horizontal (0.6 kg at 0.25 m). So run them one after the other, each with its \
--weight-kg and --lever-m. A simulated device has one scene, and nobody who does what a step says: so it needs --yes, and a scene for each step.

Parameters of the experiments are restored after each step, and never saved. Without --apply nothing of the device is changed but its \
zero. Exit code 1: a step is not good; the text says what to do.")]
pub(crate) struct Arguments {
    /// Steps, in this order: zero, range, polarity, friction, torque-constant [default: all; those that need a
    /// weight only with --weight-kg].
    #[arg(long, value_name = "STEP", value_delimiter = ',')]
    steps: Vec<Step>,

    /// Do not wait for anybody: take each step at once.
    #[arg(long)]
    yes: bool,

    /// With --yes: for how long the steps range and friction look at the motion.
    #[arg(long = "for", value_name = "TIME", value_parser = duration, default_value = "10s")]
    for_s: Duration,

    #[command(flatten)]
    weight: WeightArguments,

    /// Folder for report.html, calibration.json and the pictures.
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    out: Option<PathBuf>,

    #[command(flatten)]
    force: Force,

    /// Set what was found on the device, in one commit, and save it; only if no step is bad.
    #[arg(long)]
    apply: bool,

    #[command(flatten)]
    device: DeviceArguments,
}

impl Arguments {
    /// The steps, in their order.
    fn steps(&self) -> Result<Vec<Step>, Failure> {
        let has_weight = self.weight.is_given();
        if let Some(step) = self
            .steps
            .iter()
            .find(|step| step.needs_weight() && !has_weight)
        {
            return Err(Failure::Input(format!(
                "--steps {}: expected the weight that hangs in the brace: --weight-kg KG --lever-m M",
                step.name()
            )));
        }
        let is_asked = |step: &Step| self.steps.is_empty() || self.steps.contains(step);
        Ok(Step::ALL.into_iter().filter(is_asked).collect())
    }
}

/// Takes the steps, prints what each has found, and applies it if asked to.
pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    let steps = arguments.steps()?;
    let weight = arguments.weight.weight()?;
    let person = Person::new(arguments.yes, arguments.for_s)?;
    let out = arguments.out.as_deref();
    let prepare = |out| {
        let claim = arguments.force.claim("calibrate", [""; 0]);
        folder(out, claim, results::NAMES)
    };
    let prepared = out.map(prepare).transpose()?;
    interrupt::listen();
    let line = if arguments.yes {
        open(&arguments.device)?
    } else {
        open_in_real_time(&arguments.device)?
    };
    let mut client = Client::connect(line).map_err(failure)?;
    client.subscribe().map_err(failure)?;
    let mut findings = Vec::new();
    let first = connected::found(&mut client)?;
    let goes_on = first.verdict == Verdict::Good;
    show(&first, as_json)?;
    findings.push(first);
    for step in steps.into_iter().filter(|_| goes_on) {
        let has_bad_zero =
            |finding: &Finding| finding.step == Some(Step::Zero) && finding.verdict == Verdict::Bad;
        let finding = if step.needs_zero() && findings.iter().any(has_bad_zero) {
            Finding::skipped(step, "the zero is bad, and angles count from it")
        } else {
            taken(step, &mut client, &person, weight.as_ref())?
        };
        show(&finding, as_json)?;
        findings.push(finding);
    }
    let changes = change::changes(&findings)?;
    let is_any = |verdict| {
        findings
            .iter()
            .any(|finding: &Finding| finding.verdict == verdict)
    };
    let (is_bad, is_unknown) = (is_any(Verdict::Bad), is_any(Verdict::Unknown));
    let revision = if arguments.apply && !is_bad && !changes.is_empty() {
        Some(applied(&mut client, &changes)?)
    } else {
        None
    };
    client.end_telemetry();
    let summary = results::summary(&findings, &changes, revision);
    if let (Some(out), Some(folder)) = (out, prepared) {
        results::write(out, folder, &findings, &changes, &summary)?;
    }
    if as_json {
        print_json(&json!({ "calibration": summary, "out": out.map(json_path) }))?;
    } else {
        print(&results::text(&findings, &changes))?;
        if let Some(revision) = revision {
            print(&format!("revision {revision} is applied and saved\n"))?;
        } else if arguments.apply && is_bad {
            print("nothing is applied: a step is bad\n")?;
        }
        if let Some(out) = out {
            print(&format!("report: {}\n", out.join(results::PAGE).display()))?;
        }
    }
    if is_bad || is_unknown {
        Err(Failure::Negative)
    } else {
        Ok(())
    }
}

/// One commit of all, saved.
fn applied(client: &mut Client<Line>, changes: &[change::Change]) -> Result<u32, Failure> {
    let changes: Vec<(u8, f64)> = changes
        .iter()
        .map(|change| (change.parameter.id, change.value))
        .collect();
    let revision = client.set(&changes).map_err(failure)?;
    client.save().map_err(failure)?;
    Ok(revision.0)
}

/// Takes a step. An error is reported with the step's name.
fn taken(
    step: Step,
    client: &mut Client<Line>,
    person: &Person,
    weight: Option<&weight::Known>,
) -> Result<Finding, Failure> {
    let skipped = || Finding::skipped(step, "it needs a known weight: --weight-kg KG --lever-m M");
    if step.needs_weight() && weight.is_none() {
        return Ok(skipped());
    }
    if step.needs_zero() && !client.status().map_err(failure)?.zeroed {
        return Ok(Finding::new(step, Verdict::Unknown)
            .remark("the angle has no zero")
            .remedy("take the step zero first"));
    }
    let result = match person.ask(client, step)? {
        Answer::Skip => return Ok(Finding::skipped(step, "left out by hand")),
        Answer::Go => match (step, weight) {
            (Step::Zero, _) => zero::found(client),
            (Step::Range, _) => range::found(client, person),
            (Step::Polarity, _) => polarity::found(client),
            (Step::Friction, Some(weight)) => friction::found(client, person, weight),
            (Step::TorqueConstant, Some(weight)) => hanging::found(client, weight),
            (Step::Friction | Step::TorqueConstant, None) => Ok(skipped()),
        },
    };
    if interrupt::requested() {
        return Err(person::interrupted());
    }
    result.map_err(|error| match error {
        Failure::Work(text) => Failure::Work(format!(
            "step {}: {text}; torque is off, nothing was written",
            step.name()
        )),
        other => other,
    })
}

/// Prints a finding as soon as it is there.
fn show(finding: &Finding, as_json: bool) -> Result<(), Failure> {
    if as_json {
        Ok(())
    } else {
        print(&finding.text())
    }
}

#[cfg(test)]
mod tests;
