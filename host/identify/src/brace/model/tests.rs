//! The model against closed forms.

use super::*;

const N: Numbers = Numbers {
    friction_nm: 0.5,
    load_loss: 0.3,
    viscous_nms: 0.05,
    rotor_kg_m2: 0.05,
    brace_kg_m2: 0.01,
    gap_rad: 0.0175,
    stiffness_nm: 120.0,
    damping_nms: 1.0,
    moment_nm: 6.0,
    weight_kg_m2: 0.2,
    torque_scale: 1.0,
};

fn begin(angle_rad: f64, omega_rad_s: f64) -> Begin {
    Begin {
        angle_rad,
        omega_rad_s,
        deflection_rad: 0.0,
        deflection_rad_s: 0.0,
    }
}

/// Without friction, gap and compliance a small swing is a sine of √(M/J).
#[test]
fn a_small_swing_without_losses_is_a_sine() {
    let n = Numbers {
        friction_nm: 0.0,
        viscous_nms: 0.0,
        gap_rad: 1e-4,
        stiffness_nm: 2000.0,
        ..N
    };
    // At once lost motion is harmless where the weight drives a rotor with friction; here
    // there is none, and the gap is 1e-4.
    let omega = (6.0_f64 / 0.26).sqrt();
    let angles = swing(&n, 0.0, &begin(0.0, 0.02 * omega), &vec![0.0; 4000]);
    for (i, angle) in angles.iter().enumerate() {
        let t = (i + 1) as f64 * STEP_S;
        assert!(
            (angle - 0.02 * (omega * t).sin()).abs() < 3e-4,
            "{t} {angle}"
        );
    }
}

/// A half swing of a dry pendulum loses 2F/M: here by the energy, M(cos a − cos b) = F(a + b).
#[test]
fn dry_friction_takes_its_share_of_each_half_swing() {
    let n = Numbers {
        viscous_nms: 0.0,
        stiffness_nm: 2000.0,
        gap_rad: 1e-4,
        ..N
    };
    let angles = swing(&n, 0.0, &begin(0.0, 5.0), &vec![0.0; 8000]);
    let turns: Vec<f64> = angles
        .windows(3)
        .filter(|w| (w[1] - w[0]) * (w[2] - w[1]) < 0.0)
        .map(|w| w[1].abs())
        .collect();
    assert!(turns.len() >= 2, "{turns:?}");
    for pair in turns.windows(2) {
        let lost = 6.0 * (pair[1].cos() - pair[0].cos());
        let expected = 0.5 * (pair[0] + pair[1]);
        assert!((lost / expected - 1.0).abs() < 0.02, "{turns:?}");
    }
}

/// The angle is smooth in the numbers: differences of twice the step give the same slope.
#[test]
fn the_angle_is_smooth_in_every_number() {
    let base = [
        0.5, 0.3, 0.05, 0.05, 0.01, 0.0175, 120.0, 1.0, 6.0, 0.2, 1.0,
    ];
    let torques: Vec<f64> = (0..4000)
        .map(|i| {
            if i < 2000 {
                0.0
            } else {
                0.4 * (0.02 * f64::from(i)).sin()
            }
        })
        .collect();
    let angles = |numbers: [f64; 11]| swing(&numbers.into(), 0.1, &begin(0.1, 5.0), &torques);
    for place in 0..11 {
        let slope = |share: f64| {
            let (mut up, mut down) = (base, base);
            up[place] *= 1.0 + share;
            down[place] *= 1.0 - share;
            let (up, down) = (angles(up), angles(down));
            let slopes = up.iter().zip(&down).map(|(u, d)| (u - d) / share);
            slopes.collect::<Vec<_>>()
        };
        let (a, b) = (slope(1e-5), slope(2e-5));
        let norm = |v: &mut dyn Iterator<Item = f64>| v.map(|x| x * x).sum::<f64>().sqrt();
        let differ = norm(&mut a.iter().zip(&b).map(|(a, b)| a - b));
        let whole = norm(&mut a.iter().copied());
        assert!(differ < 0.1 * whole + 1e-9, "{place}: {differ} of {whole}");
    }
}
