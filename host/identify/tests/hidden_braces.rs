//! Braces that the estimator knows from their recordings only: the drive's own code on the
//! simulated plant, with every number drawn within a factor of 2 of the data sheet, the weight
//! weighed as well as a person can, and the torque constant off by some percent.
//!
//! `cargo test -p crepitus-identify --test hidden_braces -- --nocapture` prints the table.

mod braces;
#[path = "../../../sim/board/tests/support/mod.rs"]
mod support;

use braces::{Truth, in_table};
use crepitus_identify::brace::{
    Brace, Quantity, QuantityResult, Recording, TORQUE_DEVIATION, identify,
};

const DEVICES: usize = 20;

/// Records a device and identifies it from that alone.
fn identified(truth: &Truth) -> (Recording, Brace) {
    let [disarmed, armed] = [false, true].map(|is_armed| truth.recorded(is_armed));
    let recordings = [disarmed, armed];
    let found = identify(&recordings, &truth.given(), TORQUE_DEVIATION, &mut |_| true);
    let brace = found.unwrap_or_else(|refusal| panic!("{truth:?}: {refusal}"));
    let [disarmed, _] = recordings;
    (disarmed, brace)
}

/// All of them, in two threads.
fn all(truths: &[Truth]) -> Vec<(Recording, Brace)> {
    std::thread::scope(|scope| {
        let halves = truths.chunks(truths.len().div_ceil(2));
        let threads: Vec<_> = halves
            .map(|half| scope.spawn(|| half.iter().map(identified).collect::<Vec<_>>()))
            .collect();
        let found = threads
            .into_iter()
            .map(|thread| thread.join().expect("all identified"));
        found.flatten().collect()
    })
}

#[test]
fn values_of_hidden_braces_are_within_their_intervals() {
    let mut random = fastrand::Rng::with_seed(2024);
    let mut inside = [0_usize; Quantity::ALL.len()];
    let mut visible = [0_usize; Quantity::ALL.len()];
    // The greatest error and half width, as shares.
    let mut worst = [(0.0_f64, 0.0_f64); Quantity::ALL.len()];
    let mut whole_devices = 0;
    let truths: Vec<Truth> = (0..DEVICES).map(|_| Truth::hidden(&mut random)).collect();
    for (device, (truth, (recording, brace))) in truths.iter().zip(all(&truths)).enumerate() {
        println!(
            "device {device}: {:.4}° rms left",
            brace.rms_rad.to_degrees()
        );
        let mut is_whole = true;
        for (n, shown) in brace.shown.iter().enumerate() {
            let expected = in_table(truth, shown.quantity, &recording);
            let QuantityResult::Seen(estimate) = &shown.result else {
                println!(
                    "  {:24} {expected:10.5}  not visible",
                    shown.quantity.name()
                );
                continue;
            };
            let holds = estimate.holds(expected);
            println!(
                "  {:24} {expected:10.5}  {:10.5} ± {:8.5} {}",
                shown.quantity.name(),
                estimate.value,
                estimate.half_width,
                if holds { "inside" } else { "OUTSIDE" }
            );
            is_whole &= holds;
            visible[n] += 1;
            inside[n] += usize::from(holds);
            let error = (estimate.value / expected - 1.0).abs();
            worst[n] = (worst[n].0.max(error), worst[n].1.max(estimate.share()));
        }
        whole_devices += usize::from(is_whole);
    }
    for (n, quantity) in Quantity::ALL.iter().enumerate() {
        println!(
            "{:24} inside {} of {} visible; worst error {:.1} %, widest ± {:.1} %",
            quantity.name(),
            inside[n],
            visible[n],
            100.0 * worst[n].0,
            100.0 * worst[n].1
        );
        assert!(
            visible[n] >= 15,
            "{quantity:?} is visible in {}",
            visible[n]
        );
    }
    let (inside, visible) = (inside.iter().sum::<usize>(), visible.iter().sum::<usize>());
    println!(
        "{inside} of {visible} values inside; {whole_devices} of {DEVICES} devices with all inside"
    );
    assert!(whole_devices >= 18, "{whole_devices}");
    assert!(100 * inside >= 95 * visible, "{inside} of {visible}");
}
