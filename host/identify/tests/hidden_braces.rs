//! Braces that the estimator knows from their recordings only: the drive's own code on the
//! simulated plant, with every number drawn within a factor of 2 of the data sheet, the weight
//! weighed as well as a person can, and the torque constant off by some percent.
//!
//! `cargo test -p crepitus-identify --test hidden_braces -- --nocapture` prints the table, which is
//! that of docs/identification.md.

mod braces;
mod compared;
#[path = "../../../sim/virtual-device/tests/support/mod.rs"]
mod support;

use braces::{Truth, in_table};
use compared::{Compared, PAGE, compared};
use crepitus_identify::brace::{Brace, Quantity, Recording, TORQUE_DEVIATION, identify};

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

/// In the long mode, `CREPITUS_LONG=1`: twenty braces take a minute, and the page has their numbers.
/// Those of `second_simulation` are identified always.
#[test]
fn values_of_hidden_braces_are_within_their_intervals() {
    if std::env::var_os("CREPITUS_LONG").is_none() {
        return;
    }
    let mut random = fastrand::Rng::with_seed(2024);
    let truths: Vec<Truth> = (0..DEVICES).map(|_| Truth::hidden(&mut random)).collect();
    let braces = truths.iter().zip(all(&truths)).enumerate();
    let devices: Vec<Vec<Compared>> = braces
        .map(|(device, (truth, (recording, brace)))| {
            let truth = |quantity| in_table(truth, quantity, &recording);
            compared(&format!("device {device}"), &brace, truth)
        })
        .collect();
    let mut table = vec![
        "| | inside, of those visible | worst error | widest interval |".to_owned(),
        "|---|---|---|---|".to_owned(),
    ];
    let inside = |values: &[Compared]| values.iter().filter(|value| value.holds()).count();
    for quantity in Quantity::ALL {
        let values = devices.iter().flatten().copied();
        let values: Vec<Compared> = values.filter(|value| value.quantity == quantity).collect();
        let worst = |of: fn(&Compared) -> f64| values.iter().map(of).fold(0.0, f64::max);
        table.push(format!(
            "| {} | {} of {} | {:.1} % | ± {:.1} % |",
            quantity.name(),
            inside(&values),
            values.len(),
            worst(|value| value.error_percent().abs()),
            worst(|value| 100.0 * value.estimate.share())
        ));
        let visible = values.len();
        assert!(visible >= 15, "{quantity:?} is visible in {visible}");
    }
    let all: Vec<Compared> = devices.concat();
    let whole = devices
        .iter()
        .filter(|values| inside(values) == values.len());
    let (inside, visible, whole) = (inside(&all), all.len(), whole.count());
    table.push(format!("| all values | {inside} of {visible} | | |"));
    table.push(format!(
        "| devices with all their values inside | {whole} of {DEVICES} | | |"
    ));
    println!("{}", table.join("\n"));
    assert!(whole >= 18, "{whole}");
    assert!(100 * inside >= 95 * visible, "{inside} of {visible}");
    PAGE.hold("hidden braces", &table);
}
