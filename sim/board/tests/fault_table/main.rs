//! Every fault of the table that a board without silicon can have, provoked at
//! its physical cause, and held to what the table says.
//!
//! For each: which code is latched, how long the bridge is driven after the
//! cause, that nothing drives it again, that arming is refused until the cause
//! is repaired and the fault cleared, and that the device then works as before.

#[path = "../support/mod.rs"]
mod support;

mod blind;
mod breakage;
mod case;
mod provocation;
mod trial;

use case::Moment;
use crepitus_protocol::fault::FAULTS;
use provocation::{Provocation, provocation};
use trial::PUSH_TICKS;

/// A tick that has begun is gone through.
const AT_ONCE_TICKS: u32 = 2;

#[test]
fn every_fault_is_noticed_in_time_latched_and_cleared() {
    let mut wrong = Vec::new();
    println!(
        "{:<23} {:<42} {:>6} {:>7} {:>8} {:>5}",
        "fault", "cause", "table", "floats", "latched", "mA"
    );
    for spec in &FAULTS {
        match provocation(spec.fault) {
            Provocation::Cases(cases) => {
                for case in &cases {
                    let times = trial::run(spec, case);
                    let table = spec.within_ticks.map_or("-".into(), |t| t.to_string());
                    println!(
                        "{:<23} {:<42} {table:>6} {:>7} {:>8} {:>5}",
                        spec.name, case.name, times.floats, times.latched, times.current_ma
                    );
                    // Where the table has no time the bridge floats already,
                    // or with the cause.
                    let most = match case.moment {
                        // The push at arming is what finds it.
                        Moment::Arming => PUSH_TICKS,
                        _ => case.lag + u64::from(spec.within_ticks.unwrap_or(AT_ONCE_TICKS)),
                    };
                    if times.floats > most {
                        wrong.push(format!(
                            "{}, {}: driven for {} ticks, the table says {most}",
                            spec.name, case.name, times.floats
                        ));
                    }
                }
            }
            Provocation::None(reason) => println!("{:<23} not here: {reason}", spec.name),
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
