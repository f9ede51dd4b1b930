//! Cycles of the tasks of a tick by function and by module, with a symptom or the vibration actuator and
//! without, and while a commit arrives: where they go is seen before they are saved.
//!
//! `CREPITUS_LONG=1 cargo test -p crepitus-emulator --test drive_image -- --nocapture profile`: nothing is
//! judged here, so it is left out without.

use crate::actuator;
use crate::budget::begin_commit;
use crate::host::{Flash, is_long};
use crate::symptoms::{CASES, Case, PERIOD_TICKS, SYMPTOMS, armed, commit, values_of};
use crate::tasks::{COMMAND, LINK, RENDER, SAMPLE};
use crepitus_emulator::Time;
use crepitus_emulator::firmware::{Program, path};
use crepitus_emulator::mcu::{Step, Watch};
use crepitus_tools::image::lines::Lines;
use std::collections::BTreeMap;

/// Functions that are listed.
const LISTED: usize = 18;

/// Cycles by the address of an instruction.
type Addresses = BTreeMap<u32, u64>;

const TASKS: [(&str, u16); 4] = [
    ("sample_encoder", SAMPLE),
    ("command_motor", COMMAND),
    ("render_torque", RENDER),
    ("link", LINK),
];

/// The cycles of a task, run by run.
struct Profile {
    exception: u16,
    runs: Vec<Addresses>,
    last: Option<Time>,
    all: Addresses,
}

impl Watch for Profile {
    fn step(&mut self, step: &Step) {
        if step.exception != self.exception {
            return;
        }
        let is_next = |last| step.at - last > Time::from_us(25);
        if self.last.is_none_or(is_next) {
            self.runs.push(Addresses::new());
        }
        self.last = Some(step.at);
        let cycles = u64::from(step.cycles);
        if let Some(run) = self.runs.last_mut() {
            *run.entry(step.pc).or_default() += cycles;
        }
        *self.all.entry(step.pc).or_default() += cycles;
    }
}

fn sum(addresses: &Addresses) -> u64 {
    addresses.values().sum()
}

impl Profile {
    fn of(exception: u16) -> Self {
        Self {
            exception,
            runs: Vec::new(),
            last: None,
            all: Addresses::new(),
        }
    }

    fn worst(&self) -> &Addresses {
        let worst = self.runs.iter().max_by_key(|addresses| sum(addresses));
        worst.expect("a run")
    }

    /// Prints cycles of the worst tick and of the mean one, by innermost function and by module.
    fn print(&self, name: &str, lines: &Lines) {
        println!(
            "\n{name}: worst {}, mean {}",
            sum(self.worst()),
            sum(&self.all) / self.runs.len() as u64
        );
        let innermost = |functions: &[&str]| functions.last().map(|f| (*f).to_owned());
        self.print_by("function", lines, LISTED, innermost);
        let of_ours = |functions: &[&str]| functions.iter().rev().find_map(|f| module(f));
        self.print_by("module", lines, usize::MAX, of_ours);
    }

    /// Prints a table by what `key` makes of the functions of an instruction, the innermost last.
    fn print_by(
        &self,
        title: &str,
        lines: &Lines,
        most: usize,
        key: impl Fn(&[&str]) -> Option<String>,
    ) {
        let mut table: BTreeMap<String, (u64, u64)> = BTreeMap::new();
        let mut add = |addresses: &Addresses, is_worst: bool| {
            for (address, cycles) in addresses {
                let frames = lines.frames(*address);
                let functions: Vec<&str> = frames.iter().map(|f| f.function.as_str()).collect();
                let key = key(&functions).unwrap_or_else(|| "?".to_owned());
                let (worst, mean) = table.entry(key).or_default();
                *if is_worst { worst } else { mean } += cycles;
            }
        };
        add(self.worst(), true);
        add(&self.all, false);
        let mut table: Vec<(String, (u64, u64))> = table.into_iter().collect();
        table.sort_by_key(|(_, (worst, _))| std::cmp::Reverse(*worst));
        println!("{:>6} {:>6} {title}", "worst", "mean");
        for (key, (worst, all)) in table.iter().take(most) {
            println!("{worst:>6} {:>6} {key}", all / self.runs.len() as u64);
        }
    }
}

/// The module of a function of the project, to the depth of `crepitus_device::drive::motor`.
/// `None` for arithmetic and the core's library, whose cycles count for their caller.
fn module(function: &str) -> Option<String> {
    let path = function.trim_start_matches('<');
    let ours = ["crepitus_", "drive::", "board::"];
    let is_ours = ours.iter().any(|crate_name| path.starts_with(crate_name));
    if !is_ours || path.starts_with("crepitus_model::real::") {
        return None;
    }
    let is_module = |name: &&str| name.starts_with(char::is_lowercase);
    let names: Vec<&str> = path.split("::").take(4).take_while(is_module).collect();
    Some(names.join("::"))
}

#[test]
fn where_the_cycles_of_render_torque_go() {
    if !is_long() {
        return;
    }
    let Some(mut host) = armed(&[], Flash::ZeroWaitStates) else {
        return;
    };
    let lines = Lines::of(&path(Program::Drive).expect("an image"));
    let all = CASES.iter().map(|case| (case.name, vec![case]));
    let every: Vec<&Case> = CASES.iter().take(SYMPTOMS).collect();
    let all = all.chain([("all", every)]);
    for (name, cases) in std::iter::once(("no symptom", Vec::new())).chain(all) {
        commit(&mut host, values_of(&cases));
        let mut profile = Profile::of(RENDER);
        host.watch(PERIOD_TICKS, &mut profile);
        profile.print(name, &lines);
        assert!(profile.runs.len() as u64 >= PERIOD_TICKS - 1, "{name}");
    }
}

#[test]
fn where_the_cycles_go_without_the_actuator_and_with_it() {
    if !is_long() {
        return;
    }
    let Some(mut host) = actuator::armed(&[], Flash::ZeroWaitStates) else {
        return;
    };
    let lines = Lines::of(&path(Program::Drive).expect("an image"));
    for (name, values) in [("without", actuator::off()), ("with", actuator::on())] {
        commit(&mut host, values);
        for (task, exception) in [("render_torque", RENDER), ("command_motor", COMMAND)] {
            let mut profile = Profile::of(exception);
            host.watch(PERIOD_TICKS, &mut profile);
            profile.print(&format!("{task} {name} the actuator"), &lines);
        }
    }
}

#[test]
fn where_the_cycles_of_a_commit_go() {
    if !is_long() {
        return;
    }
    let Some(mut host) = armed(&[], Flash::ZeroWaitStates) else {
        return;
    };
    let lines = Lines::of(&path(Program::Drive).expect("an image"));
    for (name, exception) in TASKS {
        let mut profile = Profile::of(exception);
        begin_commit(&mut host, 0.02);
        host.watch(PERIOD_TICKS, &mut profile);
        profile.print(&format!("{name} while a commit arrives"), &lines);
    }
}
