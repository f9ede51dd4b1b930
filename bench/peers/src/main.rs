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
//! | ours beside the best peer on everything | [`summary`] |
//! | computer and build | [`machine`] |

mod contest;
mod machine;
mod measure;
mod motion;
mod moving;
mod ours;
mod peers;
mod rows;
mod summary;
mod table;
mod verdict;
mod work;

use crepitus_model::Convention;
use crepitus_scene::preset::{Joint, joints};
use serde_json::{Value, json};
use std::process::ExitCode;

const USAGE: &str =
    "usage: crepitus-peers [--json] [--check] [--joint NAME]... [--motion NAME]... [--rounds N] [--quick]

  --json         print the result for machines instead of the tables
  --check        exit 1 if the ratios or our errors are not what is asked for
  --joint NAME   a preset of crepitus alone: coarse (the paper's), fine or bone-on-bone; all if
                 none is named, with --quick the paper's
  --motion NAME  constant, hand-sine, strokes or recorded-knee; all four if none is named
  --rounds N     rounds in which everyone takes a turn, at least 9 (default 11)
  --quick        try every other tolerance of the peers on a moving hand";

const CONSTANT: &str = "constant";
const MOTIONS: [&str; 4] = [
    CONSTANT,
    motion::HAND_SINE,
    motion::STROKES,
    motion::RECORDED_KNEE,
];

struct Options {
    json: bool,
    check: bool,
    quick: bool,
    joints: Vec<Joint>,
    motions: Vec<String>,
    rounds: usize,
}

impl Options {
    fn parse() -> Option<Self> {
        let mut options = Self {
            json: false,
            check: false,
            quick: false,
            joints: Vec::new(),
            motions: Vec::new(),
            rounds: 11,
        };
        let mut args = std::env::args().skip(1);
        while let Some(arg) = args.next() {
            match arg.as_str() {
                "--json" => options.json = true,
                "--check" => options.check = true,
                "--quick" => options.quick = true,
                "--joint" => {
                    let name = args.next()?;
                    let joint = joints().iter().find(|joint| joint.name == name);
                    options.joints.push(*joint?);
                }
                "--motion" => options.motions.push(
                    args.next()
                        .filter(|name| MOTIONS.contains(&name.as_str()))?,
                ),
                "--rounds" => options.rounds = args.next()?.parse().ok().filter(|&n| n >= 9)?,
                _ => return None,
            }
        }
        if options.joints.is_empty() {
            let most = if options.quick { 1 } else { usize::MAX };
            options.joints = joints().iter().take(most).copied().collect();
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
    lines: Vec<summary::Line>,
    failures: Vec<String>,
}

fn main() -> ExitCode {
    let Some(options) = Options::parse() else {
        eprintln!("{USAGE}");
        return ExitCode::from(2);
    };
    let mut out = work::Delivery::new();
    let hands = match hands(&options) {
        Ok(hands) => hands,
        Err(error) => {
            eprintln!("the recorded knee: {error}");
            return ExitCode::from(2);
        }
    };
    let mut parts = Vec::new();
    if options.asks_for(CONSTANT) {
        parts.push((CONSTANT, constant(&options, &mut out)));
    }
    if !hands.is_empty() {
        parts.push(("moving", moving(&hands, &options, &mut out)));
        parts.push(("rows", rows(&hands, &options, &mut out)));
    }
    let lines: Vec<_> = parts.iter().flat_map(|(_, part)| &part.lines).collect();
    if options.json {
        let mut all: serde_json::Map<String, Value> = parts
            .iter()
            .map(|(name, part)| ((*name).to_string(), part.json.clone()))
            .collect();
        all.insert("rounds".into(), json!(options.rounds));
        all.insert("machine".into(), json!(machine::line()));
        all.insert("summary".into(), json!(lines));
        println!("{:#}", Value::Object(all));
    }
    let mut good = true;
    for (_, part) in &parts {
        if !options.json {
            print!("{}", part.text);
        }
    }
    if !options.json {
        print!("{}", summary::markdown(&lines));
        println!("\n{}", machine::line());
    }
    for (_, part) in &parts {
        for failure in &part.failures {
            eprintln!("not reached: {failure}");
            good = false;
        }
    }
    ExitCode::from(u8::from(options.check && !good))
}

/// Each joint under each hand that is asked for.
fn hands(options: &Options) -> Result<Vec<motion::Hand>, String> {
    let mut hands = Vec::new();
    for &joint in &options.joints {
        if options.asks_for(motion::HAND_SINE) {
            hands.push(motion::hand_sine(joint));
        }
        if options.asks_for(motion::STROKES) {
            hands.push(motion::strokes(joint));
        }
        if options.asks_for(motion::RECORDED_KNEE) {
            hands.push(motion::recorded_knee(joint)?);
        }
    }
    Ok(hands)
}

/// Ten seconds at a constant speed, with and without samples.
fn constant(options: &Options, out: &mut work::Delivery) -> Part {
    let (mut text, mut all) = (String::new(), Vec::new());
    let (mut lines, mut failures) = (Vec::new(), Vec::new());
    for joint in &options.joints {
        let mut contestants = contest::line_up(joint, out);
        contest::hold(joint, &mut contestants, options.rounds, out);
        let ratios = verdict::ratios(&contestants);
        failures.extend(verdict::failures(joint, &contestants, &ratios));
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
        text += &table::markdown(joint, &contestants, &ratios, options.rounds);
        all.push(json!({ "joint": joint.name, "contestants": entries, "ratios": ratios }));
        lines.extend(ratios.iter().map(|ratio| table::line(joint, ratio)));
    }
    Part {
        text,
        json: json!({ "joints": all, "failures": failures }),
        lines,
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
        lines: cases.iter().filter_map(moving::Case::line).collect(),
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
        lines: Vec::new(),
        failures,
    }
}
