//! Recordings that do not show a brace, and what is said of them.

#![allow(clippy::cast_possible_truncation, reason = "counts are small")]

mod braces;
#[path = "../../../sim/virtual-device/tests/support/mod.rs"]
mod support;

use braces::{Truth, WEIGHED};
use crepitus_identify::brace::{
    Brace, Quantity, Recording, Refusal, Sample, TORQUE_DEVIATION, Weight, identify,
};
use std::sync::LazyLock;

const TRUTH: Truth = Truth::NOMINAL;

fn found(recordings: &[Recording], weight: &Weight) -> Result<Brace, Refusal> {
    identify(recordings, weight, TORQUE_DEVIATION, &mut |_| true)
}

fn refused(recording: Recording) -> Refusal {
    let found = found(&[recording], &TRUTH.given());
    let refusal = found.expect_err("refused");
    println!("{refusal}");
    refusal
}

/// A good recording, to be spoilt; simulated once.
fn good() -> Recording {
    static GOOD: LazyLock<Recording> = LazyLock::new(|| TRUTH.recorded(false));
    GOOD.clone()
}

/// A good one with the motor armed.
fn good_armed() -> Recording {
    static GOOD: LazyLock<Recording> = LazyLock::new(|| TRUTH.recorded(true));
    GOOD.clone()
}

/// A hand lifts the weight again, in a second and without a pause before or after, and lets go.
#[test]
fn several_releases_in_one_recording() {
    let one = good();
    let mut it = one.clone();
    // Without what was held before the release.
    let from = 8_000;
    for _ in 0..2 {
        let last = it.samples[it.samples.len() - 1];
        let (a, b) = (f64::from(last.count), f64::from(one.samples[from].count));
        let lifted = (1..=20_000_u32).map(|n| {
            let share = 0.5 - 0.5 * (std::f64::consts::PI * f64::from(n) / 20_000.0).cos();
            Sample {
                tick: last.tick + u64::from(n),
                count: (a + (b - a) * share) as i32,
                ..last
            }
        });
        let again = (one.samples[from..].iter()).map(|sample| Sample {
            tick: sample.tick - one.samples[from].tick + last.tick + 20_001,
            ..*sample
        });
        let more: Vec<Sample> = lifted.chain(again).collect();
        it.samples.extend(more);
    }
    let begun = std::time::Instant::now();
    let brace = found(&[it], &TRUTH.given()).expect("accepted");
    println!("{:?} for {:?}", begun.elapsed(), brace.swung());
    assert_eq!(brace.swung().0, 3);
    for quantity in [
        Quantity::Friction,
        Quantity::Backlash,
        Quantity::CuffStiffness,
    ] {
        let estimate = brace.value(quantity).expect("visible");
        assert!(
            estimate.holds(TRUTH.value(quantity)),
            "{quantity:?} {estimate:?}"
        );
    }
}

#[test]
fn too_short() {
    let mut it = good();
    it.samples.truncate(20_000);
    assert!(matches!(refused(it), Refusal::Short { .. }));
    let mut it = good();
    it.samples.clear();
    assert!(matches!(refused(it), Refusal::Short { .. }));
}

#[test]
fn ended_in_mid_swing() {
    let mut it = good();
    it.samples.truncate(40_000);
    assert!(matches!(refused(it), Refusal::NotToRest));
}

#[test]
fn a_hand_that_never_reverses() {
    // Lifted slowly by 1 rad within 3 s, and held.
    let mut it = good();
    for (n, sample) in (0_u32..).zip(&mut it.samples) {
        let t = f64::from(n) * it.tick_s;
        let share = ((t - 1.0) / 3.0).clamp(0.0, 1.0);
        let angle = 0.5 - 0.5 * (std::f64::consts::PI * share).cos();
        sample.count = (angle / it.rad_per_count) as i32;
    }
    // Long enough.
    let last = it.samples[it.samples.len() - 1];
    let more = (1..100_000).map(|n| Sample {
        tick: last.tick + n,
        ..last
    });
    it.samples.extend(more);
    assert!(matches!(refused(it), Refusal::NoReversal { .. }));
}

#[test]
fn a_constant_angle() {
    let mut it = good();
    it.samples.iter_mut().for_each(|sample| sample.count = 1234);
    assert!(matches!(refused(it), Refusal::NoMotion { .. }));
}

#[test]
fn an_encoder_whose_counter_saturates() {
    let mut it = good();
    let most = it.samples.iter().map(|s| s.count).max().expect("samples");
    // On the way, not at the turning point.
    for sample in &mut it.samples {
        sample.count = sample.count.min(most / 2);
    }
    assert!(matches!(refused(it), Refusal::Frozen { .. }));
}

#[test]
fn a_belt_that_slips() {
    for counts in [150, -30_000] {
        let mut it = good();
        let half = it.samples.len() / 4;
        it.samples[half..]
            .iter_mut()
            .for_each(|s| s.count += counts);
        assert!(matches!(refused(it), Refusal::Jump { .. }), "{counts}");
    }
    // Slowly, within 10 ms, by 1.2°: no jump, but no pendulum either.
    let mut it = good();
    let half = it.samples.len() / 2;
    for (n, sample) in it.samples[half..].iter_mut().enumerate() {
        sample.count += i32::try_from(3 * n.min(200)).expect("small");
    }
    assert!(matches!(refused(it), Refusal::Misfit { .. }));
}

#[test]
fn a_fifth_of_the_samples_lost() {
    let mut random = fastrand::Rng::with_seed(5);
    let mut it = good();
    it.samples.retain(|_| random.f64() > 0.2);
    assert!(matches!(refused(it), Refusal::Missing { .. }));
    let mut it = good();
    it.samples
        .iter_mut()
        .step_by(5)
        .for_each(|s| s.is_lost = true);
    assert!(matches!(refused(it), Refusal::Missing { .. }));
}

#[test]
fn a_gap_in_the_ticks() {
    let mut it = good();
    it.samples.drain(20_000..20_600);
    assert!(matches!(refused(it), Refusal::Missing { .. }));
    // A restart of the drive.
    let mut it = good();
    it.samples[30_000..]
        .iter_mut()
        .for_each(|s| s.tick -= 30_000);
    assert!(matches!(refused(it), Refusal::NotInOrder { .. }));
    // Few and short ones do no harm.
    let mut random = fastrand::Rng::with_seed(5);
    let mut it = good();
    it.samples.retain(|_| random.f64() > 0.005);
    let brace = found(&[it], &TRUTH.given()).expect("accepted");
    let friction = brace.value(Quantity::Friction).expect("visible");
    assert!(friction.holds(TRUTH.friction_nm));
}

#[test]
fn a_leg_in_the_brace() {
    let it = TRUTH.recorded_with(false, "passive = \"riener-edrich\"", 9);
    let refusal = refused(it);
    assert!(
        matches!(
            refusal,
            Refusal::Misfit { .. } | Refusal::Contradiction { .. } | Refusal::Impossible { .. }
        ),
        "{refusal:?}"
    );
}

#[test]
fn a_wrong_weight() {
    let recordings = [good(), good_armed()];
    let with = |mass: f64, lever: f64| {
        let inertia = TRUTH.inertia_kg_m2() * mass * lever * lever;
        let (mass, lever) = (TRUTH.mass_kg * mass, TRUTH.lever_m * lever);
        Weight::new(mass, lever, Some(inertia), WEIGHED)
    };
    // The motor's torque tells a mass that is off by a quarter …
    for (mass, lever) in [(1.25, 1.0), (1.0, 0.8)] {
        let refusal = found(&recordings, &with(mass, lever)).err();
        println!("{refusal:?}");
        assert!(
            matches!(
                refusal,
                Some(Refusal::Contradiction { .. } | Refusal::Impossible { .. })
            ),
            "{mass} {lever}"
        );
    }
    // … and one of a tenth is said to be possible.
    let brace = found(&recordings, &with(1.12, 1.0)).expect("accepted");
    assert!(
        brace.notes.iter().any(|n| n.contains("weight's moment")),
        "{:?}",
        brace.notes
    );
    // Without the motor a wrong weight may go unnoticed, which is said.
    let is_told = |brace: &Brace| {
        brace
            .notes
            .iter()
            .any(|n| n.contains("nothing here checks"))
    };
    let brace = found(&recordings[..1], &with(1.25, 1.0)).expect("accepted");
    assert!(is_told(&brace), "{:?}", brace.notes);
    let wrong = brace.value(Quantity::Friction).expect("visible");
    assert!(!wrong.holds(TRUTH.friction_nm));
    for lever in [0.75, 1.2] {
        let brace = found(&recordings[..1], &with(1.0, lever));
        assert!(brace.as_ref().map_or(true, is_told), "{lever}");
    }
}

#[test]
fn a_motor_with_reversed_polarity() {
    let mut it = good_armed();
    for sample in &mut it.samples {
        sample.current_a = sample.current_a.map(|a| -a);
    }
    let refusal = refused(it);
    assert!(
        matches!(
            refusal,
            Refusal::Misfit { .. } | Refusal::Contradiction { .. } | Refusal::Impossible { .. }
        ),
        "{refusal:?}"
    );
}

#[test]
fn progress_can_end_it() {
    let ended = identify(&[good()], &TRUTH.given(), TORQUE_DEVIATION, &mut |_| false);
    assert!(matches!(ended, Err(Refusal::Interrupted)));
}
