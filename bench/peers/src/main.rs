//! # Our solvers against ODE libraries, on the same work in one run
//!
//! `cargo run --release` prints the tables; README.md says what they compare and how.
//!
//! | to find | look in |
//! |---|---|
//! | the work at a constant speed, its closed form, what is delivered | [`work`] |
//! | our solvers | [`ours`] |
//! | the libraries at a constant speed | [`peers`] |
//! | who takes part there, the search for settings, the rounds | [`contest`] |
//! | the ratios there and whether they hold | [`verdict`] |
//! | motions of a hand | [`motion`] |
//! | event-to-event times on them, the libraries there | [`moving`] |
//! | what rows of output cost the reference | [`rows`] |
//! | scores and clocks | [`measure`] |

mod contest;
mod measure;
mod motion;
mod moving;
mod ours;
mod peers;
mod rows;
mod table;
mod verdict;
mod work;

use crepitus_model::Convention;
use serde_json::{Value, json};
use std::process::ExitCode;

const USAGE: &str =
    "usage: crepitus-peers [--json] [--check] [--motion NAME]... [--rounds N] [--quick]

  --json         print the result for machines instead of the tables
  --check        exit 1 if the ratios or our errors are not what is asked for
  --motion NAME  constant, hand-sine or recorded-knee; all three if none is named
  --rounds N     rounds in which everyone takes a turn, at least 9 (default 11)
  --quick        try every other tolerance of the peers on a moving hand";

const CONSTANT: &str = "constant";

struct Options {
    json: bool,
    check: bool,
    quick: bool,
    motions: Vec<String>,
    rounds: usize,
}

impl Options {
    fn parse() -> Option<Self> {
        let mut options = Self {
            json: false,
            check: false,
            quick: false,
            motions: Vec::new(),
            rounds: 11,
        };
        let mut args = std::env::args().skip(1);
        while let Some(arg) = args.next() {
            match arg.as_str() {
                "--json" => options.json = true,
                "--check" => options.check = true,
                "--quick" => options.quick = true,
                "--motion" => options.motions.push(args.next().filter(|name| {
                    [CONSTANT, motion::HAND_SINE, motion::RECORDED_KNEE].contains(&name.as_str())
                })?),
                "--rounds" => options.rounds = args.next()?.parse().ok().filter(|&n| n >= 9)?,
                _ => return None,
            }
        }
        Some(options)
    }

    fn asks_for(&self, name: &str) -> bool {
        self.motions.is_empty() || self.motions.iter().any(|m| m == name)
    }
}

/// One part of the program's result.
struct Part {
    text: String,
    json: Value,
    failures: Vec<String>,
}

fn main() -> ExitCode {
    let Some(options) = Options::parse() else {
        eprintln!("{USAGE}");
        return ExitCode::from(2);
    };
    let mut out = work::Delivery::new();
    let mut hands = Vec::new();
    if options.asks_for(motion::HAND_SINE) {
        hands.push(motion::hand_sine());
    }
    if options.asks_for(motion::RECORDED_KNEE) {
        match motion::recorded_knee() {
            Ok(hand) => hands.push(hand),
            Err(error) => {
                eprintln!("the recorded knee: {error}");
                return ExitCode::from(2);
            }
        }
    }
    let mut parts = Vec::new();
    if options.asks_for(CONSTANT) {
        parts.push((CONSTANT, constant(&options, &mut out)));
    }
    if !hands.is_empty() {
        parts.push(("moving", moving(&hands, &options, &mut out)));
        parts.push(("rows", rows(&hands, &options, &mut out)));
    }
    if options.json {
        let mut all: serde_json::Map<String, Value> = parts
            .iter()
            .map(|(name, part)| ((*name).to_string(), part.json.clone()))
            .collect();
        all.insert("rounds".into(), json!(options.rounds));
        println!("{:#}", Value::Object(all));
    }
    let mut good = true;
    for (_, part) in &parts {
        if !options.json {
            print!("{}", part.text);
        }
        for failure in &part.failures {
            eprintln!("not reached: {failure}");
            good = false;
        }
    }
    ExitCode::from(u8::from(options.check && !good))
}

/// Ten seconds at a constant speed, with and without samples.
fn constant(options: &Options, out: &mut work::Delivery) -> Part {
    let mut contestants = contest::line_up(out);
    contest::hold(&mut contestants, options.rounds, out);
    let ratios = verdict::ratios(&contestants);
    let failures = verdict::failures(&contestants, &ratios);
    let entries: Vec<_> = contestants
        .iter()
        .map(|c| {
            let [samples, samples_in_stick, events] = work::Task::ALL.map(|t| c.result(t));
            json!({
                "who": c.who,
                "samples": samples,
                "samples_in_stick": samples_in_stick,
                "events": events,
            })
        })
        .collect();
    Part {
        text: table::markdown(&contestants, &ratios, options.rounds),
        json: json!({ "contestants": entries, "ratios": ratios, "failures": failures }),
        failures,
    }
}

/// Event to event on moving hands, under both conventions that have peers.
fn moving(hands: &[motion::Hand], options: &Options, out: &mut work::Delivery) -> Part {
    let mut cases = Vec::new();
    for hand in hands {
        for convention in [Convention::Frozen, Convention::Physical] {
            cases.push(moving::Case::new(hand, convention, options.quick, out));
        }
    }
    moving::hold(&mut cases, options.rounds, out);
    let failures: Vec<String> = cases.iter().flat_map(moving::Case::failures).collect();
    let entries: Vec<_> = cases
        .iter()
        .map(|c| {
            let ratios: Vec<_> = c
                .ratios()
                .map(|(peer, ratio)| json!({ "peer": peer.name, "cpu": ratio }))
                .collect();
            json!({
                "case": c.name(),
                "motion": c.hand.source,
                "ours": c.ours,
                "peers": c.peers,
                "ratios": ratios,
            })
        })
        .collect();
    Part {
        text: moving::markdown(&cases, options.rounds),
        json: json!({ "cases": entries, "failures": failures }),
        failures,
    }
}

/// Cost of output rows for the reference on moving hands.
fn rows(hands: &[motion::Hand], options: &Options, out: &mut work::Delivery) -> Part {
    let mut all = Vec::new();
    for hand in hands {
        for convention in [Convention::Frozen, Convention::Physical] {
            all.push(rows::Rows::new(hand, convention));
        }
    }
    rows::hold(&mut all, options.rounds, out);
    let failures: Vec<String> = all.iter().flat_map(rows::Rows::failures).collect();
    Part {
        text: rows::markdown(&all),
        json: json!({ "costs": all, "failures": failures }),
        failures,
    }
}
