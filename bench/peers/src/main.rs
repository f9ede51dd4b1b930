//! # Our solvers against ODE libraries, on the same work in one run
//!
//! `cargo run --release` prints the table; README.md says what it compares and how.
//!
//! | to find | look in |
//! |---|---|
//! | the work, its closed form, what is delivered | [`work`] |
//! | our solvers | [`ours`] |
//! | the libraries | [`peers`] |
//! | who takes part, the search for settings, the rounds | [`contest`] |
//! | scores and clocks | [`measure`] |
//! | the ratios and whether they hold | [`verdict`] |

mod contest;
mod measure;
mod ours;
mod peers;
mod table;
mod verdict;
mod work;

use std::process::ExitCode;

const USAGE: &str = "usage: crepitus-peers [--json] [--check] [--rounds N]

  --json      print the result for machines instead of the table
  --check     exit 1 if the ratios or our errors are not what is asked for
  --rounds N  rounds in which everyone takes a turn, at least 9 (default 11)";

struct Options {
    json: bool,
    check: bool,
    rounds: usize,
}

fn options() -> Option<Options> {
    let mut options = Options {
        json: false,
        check: false,
        rounds: 11,
    };
    let mut args = std::env::args().skip(1);
    while let Some(arg) = args.next() {
        match arg.as_str() {
            "--json" => options.json = true,
            "--check" => options.check = true,
            "--rounds" => options.rounds = args.next()?.parse().ok().filter(|&n| n >= 9)?,
            _ => return None,
        }
    }
    Some(options)
}

fn main() -> ExitCode {
    let Some(options) = options() else {
        eprintln!("{USAGE}");
        return ExitCode::from(2);
    };
    let mut out = work::Delivery::new();
    let mut contestants = contest::line_up(&mut out);
    contest::hold(&mut contestants, options.rounds, &mut out);
    let ratios = verdict::ratios(&contestants);
    let failures = verdict::failures(&contestants, &ratios);
    if options.json {
        let entries: Vec<_> = contestants
            .iter()
            .map(|c| {
                let tasks = work::Task::ALL.map(|t| c.result(t));
                let [samples, samples_in_stick, events] = tasks;
                serde_json::json!({
                    "who": c.who,
                    "samples": samples,
                    "samples_in_stick": samples_in_stick,
                    "events": events,
                })
            })
            .collect();
        println!(
            "{:#}",
            serde_json::json!({
                "rounds": options.rounds,
                "contestants": entries,
                "ratios": ratios,
                "failures": failures,
            })
        );
    } else {
        print!("{}", table::markdown(&contestants, &ratios, options.rounds));
    }
    for failure in &failures {
        eprintln!("not reached: {failure}");
    }
    ExitCode::from(u8::from(options.check && !failures.is_empty()))
}
