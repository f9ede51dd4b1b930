//! Braces that the estimator knows from their recordings only.

mod braces;
#[path = "../../../sim/board/tests/support/mod.rs"]
mod support;

use braces::{Truth, in_table};
use crepitus_identify::brace::{Quantity, QuantityResult, TORQUE_DEVIATION, identify};

#[test]
fn draft() {
    let mut random = fastrand::Rng::with_seed(
        std::env::var("SEED")
            .ok()
            .and_then(|s| s.parse().ok())
            .unwrap_or(7),
    );
    let (mut inside, mut all, mut devices) = (0, 0, 0);
    let started = std::time::Instant::now();
    let mut fitting = 0.0;
    for n in 0..20 {
        let truth = Truth::hidden(&mut random);
        if let Ok(only) = std::env::var("ONLY") {
            if only.parse::<i32>().unwrap() != n {
                continue;
            }
        }
        let recordings = [truth.recorded(false), truth.recorded(true)];
        let t = std::time::Instant::now();
        let found = identify(&recordings, &truth.given(), TORQUE_DEVIATION, &mut |_| true);
        fitting += t.elapsed().as_secs_f64();
        let brace = match found {
            Ok(brace) => brace,
            Err(refusal) => {
                println!("{n}: {truth:?}\n {refusal}");
                continue;
            }
        };
        let mut good = true;
        print!("{n:2} rms {:.5} {:?} ", brace.rms_rad, brace.swung());
        for shown in &brace.shown {
            let t = in_table(&truth, shown.quantity, &recordings[0]);
            match &shown.result {
                QuantityResult::Seen(e) => {
                    all += 1;
                    inside += u32::from(e.holds(t));
                    good &= e.holds(t);
                    print!(
                        " {}{:.2}%({:.1}σ)",
                        if e.holds(t) { "" } else { "!!" },
                        100.0 * e.share(),
                        1.96 * (e.value - t) / e.half_width
                    );
                }
                QuantityResult::NotVisible { .. } => print!(" -"),
            }
        }
        println!();
        devices += u32::from(good);
    }
    println!(
        "inside {inside} of {all}, devices {devices}; {:?} of which fits {fitting}",
        started.elapsed()
    );
    let _ = Quantity::ALL;
}
