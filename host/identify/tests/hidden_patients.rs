//! Patients that the fit knows from angle and torque alone, half of them of a model and with a noise that it does
//! not know.
//!
//! `CREPITUS_LONG=1 cargo test -p crepitus-identify --test hidden_patients -- --nocapture` fits forty; without the
//! variable it is five.

// Counts become numbers; none comes near 2^53.
#![allow(clippy::cast_precision_loss)]

#[path = "../../../sim/virtual-device/tests/book/mod.rs"]
mod book;
mod patients;

use book::Page;
use crepitus_identify::knee::{KneeFit, Refusal, Symptom, fit};
use patients::{Patient, modelled, other};

/// The page of the results.
const PAGE: Page = Page {
    file: "fit.md",
    bless: "CREPITUS_LONG=1 cargo test -p crepitus-identify --test hidden_patients",
};

/// Types in the order of the patients: each of the model, then of the other one.
const TYPES: [Symptom; 8] = [
    Symptom::LeadPipe,
    Symptom::Catch,
    Symptom::Reflex,
    Symptom::ClaspKnife,
    Symptom::Clonus,
    Symptom::RangeLimit,
    Symptom::Cogwheel,
    Symptom::Healthy,
];

fn patient(number: usize) -> Patient {
    let mut random = fastrand::Rng::with_seed(590 + number as u64);
    let symptom = TYPES[number % TYPES.len()];
    if (number / TYPES.len()).is_multiple_of(2) {
        other::patient(symptom, &mut random)
    } else {
        modelled(symptom, &mut random)
    }
}

#[derive(Default)]
struct Counts {
    patients: usize,
    right: usize,
    refused: usize,
    inside: usize,
    told: usize,
}

/// Compares a fit with its patient.
fn count(number: usize, patient: &Patient, found: &Result<KneeFit, Refusal>, counts: &mut Counts) {
    let name = patient.symptom.name();
    counts.patients += 1;
    let found = match found {
        Ok(found) => found,
        Err(refusal) => {
            println!("{number}: {name}: {refusal}");
            counts.refused += 1;
            return;
        }
    };
    let (best, second) = (&found.best, &found.second);
    let is_right = best.symptom.effect() == patient.symptom.effect();
    println!(
        "{number}: {name}: {}{} {:.4} N·m, then {} {:.4}",
        if is_right { "" } else { "WRONG, " },
        best.symptom.name(),
        best.left_out_nm,
        second.symptom.name(),
        second.left_out_nm
    );
    counts.right += usize::from(is_right);
    if best.symptom != patient.symptom {
        return;
    }
    for (key, truth) in &patient.truth {
        let Some(value) = best.value(key).filter(|value| value.is_told) else {
            println!("    {key} {truth:.3}: not told");
            continue;
        };
        let (number, half_width) = value.estimate.rounded();
        let holds = value.estimate.holds(*truth);
        println!(
            "    {key} {truth:.3}: {number} ± {half_width}{}",
            if holds { "" } else { " OUTSIDE" }
        );
        counts.told += 1;
        counts.inside += usize::from(holds);
    }
}

#[test]
fn types_are_told_and_intervals_hold() {
    let is_long = std::env::var_os("CREPITUS_LONG").is_some();
    // Without: two of another model, three of the fit's own.
    let numbers = if is_long {
        (0..40).collect()
    } else {
        vec![0, 1, 11, 12, 15]
    };
    let mut counts = [Counts::default(), Counts::default()];
    for number in numbers.iter().copied() {
        let patient = patient(number);
        let found = fit(&patient.examination, &mut |_| true);
        count(
            number,
            &patient,
            &found,
            &mut counts[(number / TYPES.len()) % 2],
        );
    }
    let mut table = vec![
        "| patients | type right | refused | values inside, of those told |".to_owned(),
        "|---|---|---|---|".to_owned(),
    ];
    for (counts, name) in counts.iter().zip(["of another model", "of the fit's own"]) {
        table.push(format!(
            "| {} {name} | {} | {} | {} of {} |",
            counts.patients, counts.right, counts.refused, counts.inside, counts.told
        ));
    }
    println!("{}", table.join("\n"));
    let sum = |of: fn(&Counts) -> usize| counts.iter().map(of).sum::<usize>();
    let (right, inside, told) = (sum(|c| c.right), sum(|c| c.inside), sum(|c| c.told));
    let patients = numbers.len();
    assert!(10 * right >= 9 * patients, "{right} of {patients}");
    // Two standard deviations below 95 % of so many.
    let least = 0.95 * told as f64 - 2.0 * (0.95 * 0.05 * told as f64).sqrt();
    assert!(inside as f64 >= least, "{inside} of {told}");
    if is_long {
        PAGE.hold("hidden patients", &table);
    }
}
