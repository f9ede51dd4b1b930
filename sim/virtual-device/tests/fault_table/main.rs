//! Every fault of the table that a board without silicon can have, provoked at
//! its physical cause, and held to what the table says.
//!
//! For each: which code is latched, how long the bridge is driven after the
//! cause, that nothing drives it again, that arming is refused until the cause
//! is repaired and the fault cleared, and that the device then works as before.

#[path = "../book/mod.rs"]
mod book;
#[path = "../support/mod.rs"]
mod support;

mod blind;
mod breakage;
mod case;
mod coil;
mod pairs;
mod provocation;
mod trial;

use book::Page;
use case::Moment;
use crepitus_protocol::fault::FAULTS;
use provocation::{Provocation, provocation};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::thread;
use trial::Times;

/// The page of these tables.
const PAGE: Page = Page {
    file: "generated/fault-matrix.md",
    bless: "cargo test -p crepitus-virtual-device --test fault_table -- --test-threads=1",
};

/// A tick that has begun is gone through.
const AT_ONCE_TICKS: u32 = 2;

/// Results of so many tries, on all cores.
fn on_all_cores<T: Send + Sync>(count: usize, try_one: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let next = AtomicUsize::new(0);
    let all: Vec<_> = (0..count).map(|_| OnceLock::new()).collect();
    let work = || {
        loop {
            let place = next.fetch_add(1, Relaxed);
            let Some(result) = all.get(place) else { break };
            assert!(result.set(try_one(place)).is_ok(), "each is tried once");
        }
    };
    thread::scope(|scope| {
        for _ in 0..thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(work);
        }
    });
    let results = all.into_iter().map(OnceLock::into_inner);
    results.map(|result| result.expect("a result")).collect()
}

/// The times of all cases of each fault.
fn all_times() -> Vec<Vec<Times>> {
    on_all_cores(FAULTS.len(), |place| {
        let spec = &FAULTS[place];
        match provocation(spec.fault) {
            Provocation::Cases(cases) => cases.iter().map(|case| trial::run(spec, case)).collect(),
            Provocation::None(_) => Vec::new(),
        }
    })
}

#[test]
fn every_fault_is_noticed_in_time_latched_and_cleared() {
    let mut wrong = Vec::new();
    let mut rows = vec![
        "| fault | cause | noticed by | may take, ticks | floats after | latched after | most N·m |".into(),
        "|---|---|---|---|---|---|---|".into(),
    ];
    for (spec, times) in FAULTS.iter().zip(all_times()) {
        match provocation(spec.fault) {
            Provocation::Cases(cases) => {
                for (case, times) in cases.iter().zip(times) {
                    let may =
                        (spec.within_ticks).map_or("floats already".into(), |t| t.to_string());
                    let row = format!(
                        "| [{0}](../faults.md#{1}-{0}) | {2} | {3} | {may} | {4} | {5} | {6:.1} |",
                        spec.name,
                        spec.fault.code(),
                        case.name,
                        spec.detector.name(),
                        times.floats,
                        times.latched,
                        times.most_nm
                    );
                    println!("{row}");
                    rows.push(row);
                    // Where the table has no time the bridge floats already,
                    // or with the cause.
                    let most = case.lag + u64::from(spec.within_ticks.unwrap_or(AT_ONCE_TICKS));
                    if times.floats > most {
                        wrong.push(format!(
                            "{}, {}: driven for {} ticks, the table says {most}",
                            spec.name, case.name, times.floats
                        ));
                    }
                    // A bridge that floats anyway says nothing of the time.
                    let is_late = spec.within_ticks.is_some() && times.latched > most + 1;
                    if case.moment == Moment::Disarmed && is_late {
                        wrong.push(format!(
                            "{}, {}: latched after {} ticks, the table says {most}",
                            spec.name, case.name, times.latched
                        ));
                    }
                }
            }
            Provocation::None(reason) => rows.push(format!(
                "| [{0}](../faults.md#{1}-{0}) | not here: {reason} | {2} | | | | |",
                spec.name,
                spec.fault.code(),
                spec.detector.name(),
            )),
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    PAGE.hold("single", &rows);
}
