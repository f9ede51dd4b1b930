//! One case in full.

use crate::compare::{compare, ours};
use crate::corpus::{Case, MOST_EVENTS};
use crate::double_double::Dd;
use crate::watched::{Answer, LIMIT, Watched};
use crepitus_model::Parameters;
use crepitus_model::parameters::Tabled;
use crepitus_plant::Motion;
use std::io;

/// Prints the case that `CREPITUS_CASE` numbers, or one on which the solvers agree.
#[test]
fn a_case_in_full() {
    let number = std::env::var("CREPITUS_CASE").ok();
    let agree = case(
        number
            .as_ref()
            .map_or(17, |number| number.parse().expect("a number")),
    );
    assert!(agree.expect("a child") || number.is_some());
}

/// Prints case `number`; whether the solvers agree.
fn case(number: u64) -> io::Result<bool> {
    let case = Case::new(number);
    let settings = &case.settings;
    println!("case {number}");
    println!(
        "  {} {}, {}",
        settings.convention.name(),
        settings.restart.name(),
        case.kind.name()
    );
    for (spec, value) in Parameters::TABLE.iter().zip(settings.parameters.values()) {
        println!("  {} = {value:e} {}", spec.symbol, spec.unit);
    }
    let p = &settings.parameters;
    println!(
        "  ωn = {:e} rad/s, damping ratio {:e}, Ts/kr = {:e} rad",
        p.natural_rad_s(),
        p.damping_nms_per_rad / (2.0 * p.impedance_nms_per_rad()),
        p.static_torque_nm / p.stiffness_nm_per_rad
    );
    println!("  duration {:e} s", case.duration_s);
    match &case.motion {
        Motion::Sequence(pieces) => {
            for piece in pieces {
                println!("  {piece:?}");
            }
        }
        motion => println!("  {motion:?}"),
    }
    let Some(answer) = Watched::new(&std::env::current_exe()?, LIMIT, number, number + 1).next()
    else {
        return Ok(false);
    };
    let (_, answer) = answer?;
    let history = ours(&case).map_err(|why| println!("this solver: {why}"));
    let ours = history.as_ref().map_or(&[][..], |h| &h.events[..]);
    let theirs = match &answer {
        Answer::Solved(theirs) => {
            println!(
                "reference: {} events (at most {MOST_EVENTS} are kept), sign law {:.1} roundings at {:e} s",
                theirs.events.len(),
                theirs.breach,
                theirs.breach_s
            );
            &theirs.events[..]
        }
        other => {
            println!("reference: {other:?}");
            &[]
        }
    };
    if let Ok(history) = &history {
        println!(
            "this solver: {} events, touches at {:?}",
            ours.len(),
            &history.touches_s[..history.touches_s.len().min(5)]
        );
    }
    for at in 0..ours.len().max(theirs.len()) {
        if let Some(e) = ours.get(at) {
            println!(
                "{at:4} this {:7} {:+} {:22.16e} s  θ {:+.12e}  Ω {:+.6e}  T {:+.9e} -> {:+.9e}  {:?} ±{:.0e} s {}",
                e.kind.name(),
                e.to,
                e.time_s.to_f64(),
                e.theta_rad.to_f64(),
                e.omega_rad_s.to_f64(),
                e.torque_before_nm.map_or(f64::NAN, Dd::to_f64),
                e.torque_after_nm.to_f64(),
                e.cause,
                e.half_width_s,
                e.excess
                    .map_or(String::new(), |x| format!("excess {x:.1e}"))
            );
        }
        if let Some(e) = theirs.get(at) {
            println!(
                "{at:4} ref  {:7} {:+} {:22.16e} s  θ {:+.12e}  Ω {:+.6e}  T {:+.9e} -> {:+.9e}  Δt {:.1e} s",
                e.kind.name(),
                e.to.sign(),
                e.fraction,
                e.theta_rad,
                e.omega_rad_s,
                e.torque_before_nm,
                e.torque_after_nm,
                ours.get(at)
                    .map_or(f64::NAN, |o| e.fraction - o.time_s.to_f64())
            );
        }
    }
    let comparison = compare(&case, &answer);
    println!("{comparison:?}");
    Ok(comparison.verdict == crate::compare::Verdict::Agreed)
}
