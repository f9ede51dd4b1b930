//! Every access to a shared resource happens at or above its ceiling, whenever
//! the tasks meet.
//!
//! RTIC keeps each shared resource in a static that is named for it; where the
//! statics lie is read from the image's symbols, and which task of which
//! priority shares what from the attributes of its `mod app`. The core's
//! execution priority, with BASEPRI and PRIMASK, is checked at every access of
//! the core, instruction by instruction. Resources that every task shares by
//! `&` are atomics and need no lock.

use crate::host::{Host, examination, image};
use crepitus_emulator::mcu::{RamAccess, Step, Watch};
use crepitus_emulator::{Image, Time};
use crepitus_protocol::State;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// The program whose attributes are read.
const SOURCE: &str = include_str!("../../../../firmware/drive/src/main.rs");

/// Interrupts that tasks are bound to.
const INTERRUPTS: [(&str, u16); 4] = [
    ("TIM3", 29),
    ("TIM4", 30),
    ("TIM7", 55),
    ("DMA2_STREAM6", 69),
];

/// Levels of priority that the chip has.
const LEVELS: u8 = 16;

/// Execution priority of a task's priority.
fn level(priority: u8) -> i32 {
    match priority {
        0 => 256,
        _ => i32::from(LEVELS - priority) << 4,
    }
}

/// A task of the program, as its attribute says.
#[derive(Debug)]
struct Task {
    name: String,
    exception: u16,
    priority: u8,
    shared: Vec<String>,
}

/// The text between `begin` and `end`.
fn between<'a>(text: &'a str, begin: &str, end: &str) -> Option<&'a str> {
    let (_, rest) = text.split_once(begin)?;
    Some(rest.split_once(end)?.0)
}

/// The tasks of the program.
fn tasks() -> Vec<Task> {
    let attributes = SOURCE.split("\n    #[").skip(1).filter_map(|text| {
        let is_idle = text.starts_with("idle(");
        if !is_idle && !text.starts_with("task(") {
            return None;
        }
        let (attribute, function) = text.split_once(")]\n")?;
        let name = between(function, "fn ", "(")?.to_owned();
        let shared = between(attribute, "shared = [", "]").unwrap_or_default();
        let shared = shared.split(',').map(|name| name.trim().to_owned());
        let bound = between(attribute, "binds = ", ",");
        let interrupt = INTERRUPTS.iter().find(|(name, _)| bound == Some(name));
        let priority = between(attribute, "priority = ", ",")
            .map(|text| text.trim().parse().expect("a priority"));
        Some(Task {
            exception: interrupt.map_or(0, |(_, number)| 16 + number),
            priority: priority.unwrap_or(0),
            shared: shared.filter(|name| !name.is_empty()).collect(),
            name,
        })
    });
    attributes.collect()
}

/// A resource that is locked.
#[derive(Debug)]
struct Resource {
    name: String,
    ranges: Vec<Range<u32>>,
    ceiling: u8,
    /// Tasks that share it.
    tasks: BTreeSet<u16>,
}

/// The resources of an image that are locked.
fn resources(image: &Image) -> Vec<Resource> {
    let tasks = tasks();
    let locked: BTreeSet<&String> = tasks
        .iter()
        .flat_map(|task| &task.shared)
        .filter(|name| !name.starts_with('&'))
        .collect();
    let found = locked.into_iter().map(|name| {
        let sharing: Vec<&Task> = tasks
            .iter()
            .filter(|task| task.shared.contains(name))
            .collect();
        // The name's length stands before it and a hash behind it.
        let full = format!("__rtic_internal_shared_resource_{name}");
        let full = format!("{}{full}17h", full.len());
        let symbols = image.symbols().filter(|(symbol, _)| symbol.contains(&full));
        Resource {
            name: name.clone(),
            ranges: symbols
                .map(|(_, at)| at.address..at.address + at.size.max(1))
                .collect(),
            ceiling: sharing.iter().map(|task| task.priority).max().unwrap_or(0),
            tasks: sharing.iter().map(|task| task.exception).collect(),
        }
    });
    found.collect()
}

/// Checks every access to a locked resource.
pub(crate) struct LockCheck {
    resources: Vec<Resource>,
    /// Accesses by resource and exception.
    accesses: BTreeMap<(String, u16), u64>,
    broken: BTreeSet<String>,
    /// Pairs of an exception that was interrupted and the one that interrupted it.
    preemptions: BTreeSet<(u16, u16)>,
    running: Vec<u16>,
}

impl LockCheck {
    fn new(image: &Image) -> Self {
        Self {
            resources: resources(image),
            accesses: BTreeMap::new(),
            broken: BTreeSet::new(),
            preemptions: BTreeSet::new(),
            running: Vec::new(),
        }
    }

    /// The RAM to be observed.
    pub(crate) fn ranges(&self) -> Vec<Range<u32>> {
        let all = self.resources.iter().flat_map(|resource| &resource.ranges);
        all.cloned().collect()
    }

    fn assert_unbroken(&self) {
        let lines: Vec<&str> = self.broken.iter().map(String::as_str).collect();
        assert!(lines.is_empty(), "{}", lines.join("\n"));
    }
}

impl Watch for LockCheck {
    fn step(&mut self, step: &Step) {
        let depth = step.active as usize;
        if depth > self.running.len() {
            self.running.push(step.exception);
        }
        self.running.truncate(depth);
        // From one straight to the next, above the same one.
        if let [.., below, top] = &mut self.running[..] {
            *top = step.exception;
            self.preemptions.insert((*below, *top));
        } else if let [only] = &mut self.running[..] {
            *only = step.exception;
        }
    }

    fn ram_access(&mut self, access: &RamAccess) {
        // With PRIMASK set nothing interrupts: `init`, and the end of the start.
        if access.priority <= 0 {
            return;
        }
        let is_in = |resource: &&Resource| {
            resource
                .ranges
                .iter()
                .any(|range| range.contains(&access.address))
        };
        let Some(resource) = self.resources.iter().find(is_in) else {
            return;
        };
        let (name, exception) = (&resource.name, access.exception);
        *self.accesses.entry((name.clone(), exception)).or_default() += 1;
        if !resource.tasks.contains(&exception) {
            self.broken.insert(format!(
                "`{name}` is accessed by exception {exception}, which does not share it"
            ));
        }
        if access.priority > level(resource.ceiling) {
            self.broken.insert(format!(
                "`{name}`, ceiling {}, is accessed by exception {exception} at execution priority {:#x} without its lock (pc {:#x})",
                resource.ceiling, access.priority, access.pc
            ));
        }
    }
}

#[test]
fn the_resources_of_the_program_are_found_in_its_image() {
    let Some(image) = image() else { return };
    let tasks = tasks();
    assert!(tasks.len() > 1, "{tasks:?}");
    assert!(
        tasks
            .iter()
            .any(|task| task.name == "idle" && task.priority == 0)
    );
    for task in &tasks {
        // With a vector of its own.
        let handler = image.vector(task.exception.max(1));
        assert!(handler.is_some(), "{task:?}");
        assert_eq!(
            task.exception == 0,
            task.name == "idle",
            "{task:?}: add its interrupt to INTERRUPTS"
        );
    }
    let resources = resources(&image);
    assert!(resources.len() > 1, "{resources:?}");
    for resource in &resources {
        assert!(!resource.ranges.is_empty(), "{resource:?} has no symbol");
        assert!(
            resource.tasks.len() > 1,
            "{resource:?} is shared by one task"
        );
    }
}

#[test]
fn every_access_to_a_shared_resource_is_locked() {
    let Some(image) = image() else { return };
    let mut host = Host::locked(&image, &examination(), LockCheck::new(&image));
    host.arm();
    host.run(400);
    let locks = host.locks.take().expect("it is there");
    for ((name, exception), count) in &locks.accesses {
        println!("{name}: {count} accesses by exception {exception}");
    }
    locks.assert_unbroken();
    for resource in &locks.resources {
        for task in &resource.tasks {
            let accesses = locks.accesses.get(&(resource.name.clone(), *task));
            assert!(
                accesses.is_some(),
                "no access of exception {task} to `{}` was seen",
                resource.name
            );
        }
    }
}

#[test]
fn a_core_that_stalls_at_any_phase_breaks_no_lock_and_no_tick() {
    /// Step from phase to phase, a multiple of nothing.
    const STEP_NS: u64 = 730;
    const TICK_NS: u64 = 50_000;
    /// Lengths of stalls, in turn: up to the next task, or over it.
    const STALLS_NS: [u64; 3] = [9_100, 17_300, 27_400];
    let Some(image) = image() else { return };
    let mut host = Host::locked(&image, &examination(), LockCheck::new(&image));
    host.arm();
    host.run(200);
    for phase in (0..TICK_NS).step_by(usize::try_from(STEP_NS).expect("small")) {
        for stall in STALLS_NS {
            let locks = host.locks.as_mut().expect("it is there");
            let mcu = host.board.mcu_mut();
            let begin = mcu.now().units();
            let after = |ns: u64| Time::from_units(begin + ns * 336 / 1_000);
            mcu.watch_until(after(phase), locks);
            mcu.set_hung(true);
            mcu.run_until(after(phase + stall));
            mcu.set_hung(false);
            host.run(3);
            let state = host.board.comms().comms().state();
            assert!(host.board.resets().is_empty(), "{stall} ns at {phase} ns");
            assert_eq!(state, State::Armed, "{stall} ns at {phase} ns");
        }
    }
    let locks = host.locks.take().expect("it is there");
    locks.assert_unbroken();
    println!("preemptions: {:?}", locks.preemptions);
    // Every task above `link` has interrupted one below it.
    for task in tasks().iter().filter(|task| task.priority > 1) {
        let interrupts = locks
            .preemptions
            .iter()
            .any(|(_, above)| *above == task.exception);
        assert!(interrupts, "{} has interrupted none", task.name);
    }
}
