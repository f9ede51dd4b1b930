//! Examinations that tell nothing, each refused with its reason.

// Counts become numbers; none comes near 2^53.
#![allow(clippy::cast_precision_loss)]

use crepitus_identify::knee::{Examination, Refusal, Symptom, fit};

const STEP_S: f64 = 4e-3;

/// A limb whose angle is a sine about 45° of this amplitude, deg, and frequency, Hz.
fn swung(amplitude_deg: f64, hz: f64, for_s: f64) -> Examination {
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a count"
    )]
    let count = (for_s / STEP_S) as usize;
    let time_s: Vec<f64> = (0..count).map(|i| i as f64 * STEP_S).collect();
    let turn = std::f64::consts::TAU * hz;
    let angle = |t: &f64| (45.0 - amplitude_deg * (turn * t).cos()).to_radians();
    let angle_rad: Vec<f64> = time_s.iter().map(angle).collect();
    let mut random = fastrand::Rng::with_seed(2);
    let torque = angle_rad
        .iter()
        .map(|angle| 6.0 * angle.cos() + 0.05 * (random.f64() - 0.5));
    Examination {
        torque_nm: torque.collect(),
        time_s,
        angle_rad,
        released_kg_m2: None,
    }
}

fn refused(it: &Examination) -> Refusal {
    fit(it, &mut |_| true).expect_err("a refusal")
}

#[test]
fn what_tells_nothing_is_refused() {
    let good = swung(35.0, 0.3, 20.0);
    let found = fit(&good, &mut |_| true).expect("a fit");
    assert_eq!(found.best.symptom, Symptom::Healthy);
    // 66 °/s at most: too slow for two of them.
    let untold: Vec<Symptom> = found.untold.iter().map(|(symptom, _)| *symptom).collect();
    assert_eq!(untold, [Symptom::Catch, Symptom::Reflex, Symptom::Clonus]);
    let short = Examination {
        time_s: good.time_s[..90].to_vec(),
        ..good.clone()
    };
    assert_eq!(refused(&short), Refusal::Short { samples: 90 });
    let mut back = good.clone();
    back.time_s[300] = 0.1;
    assert_eq!(refused(&back), Refusal::NotInOrder);
    let mut infinite = good.clone();
    infinite.torque_nm[300] = f64::NAN;
    assert_eq!(refused(&infinite), Refusal::NotInOrder);
    let mut gap = good.clone();
    gap.time_s[2000..].iter_mut().for_each(|t| *t += 0.5);
    assert!(
        matches!(refused(&gap), Refusal::Gap { longest_s } if (longest_s - 0.504).abs() < 1e-9)
    );
    let stretched = |by: f64| Examination {
        time_s: good.time_s.iter().map(|t| by * t).collect(),
        ..good.clone()
    };
    // Milliseconds that are taken for seconds, and a night's recording.
    assert!(matches!(refused(&stretched(1e3)), Refusal::Slow { hz } if (hz - 0.25).abs() < 1e-9));
    assert_eq!(refused(&stretched(1e-4)), Refusal::Short { samples: 0 });
    let long = swung(35.0, 0.3, 601.0);
    assert!(matches!(refused(&long), Refusal::Long { lasts_s, .. } if lasts_s > 600.0));
    assert!(matches!(
        refused(&swung(35.0, 0.1, 20.0)),
        Refusal::FewStrokes { strokes: 4, .. }
    ));
    assert!(
        matches!(refused(&swung(10.0, 0.3, 20.0)), Refusal::Narrow { range_deg, .. } if range_deg < 21.0)
    );
    let mut random = fastrand::Rng::with_seed(1);
    let noise = Examination {
        torque_nm: good.time_s.iter().map(|_| random.f64()).collect(),
        ..good.clone()
    };
    assert!(matches!(refused(&noise), Refusal::Noise { .. }));
    assert_eq!(fit(&good, &mut |_| false), Err(Refusal::Interrupted));
}
