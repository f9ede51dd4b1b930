//! The model against closed forms.

use super::*;

const N: WeightedBrace = WeightedBrace {
    gear: Gear {
        inertia_kg_m2: 0.05,
        friction_nm: 0.5,
        load_loss: 0.3,
    },
    gap_rad: 0.0175,
    brace_kg_m2: 0.01,
    stiffness_nm: 120.0,
    damping_nms: 1.0,
    moment_nm: 6.0,
    weight_kg_m2: 0.2,
    viscous_nms: 0.05,
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
    let n = WeightedBrace {
        gear: Gear {
            friction_nm: 0.0,
            ..N.gear
        },
        viscous_nms: 0.0,
        gap_rad: 1e-4,
        stiffness_nm: 2000.0,
        ..N
    };
    // At once lost motion is harmless where the weight drives a rotor with friction; here
    // there is none, and the gap is 1e-4.
    let omega = (6.0_f64 / 0.26).sqrt();
    let angles = swing(&n, 0.0, &begin(0.0, 0.02 * omega), &vec![0.0; 4000]);
    for (i, angle) in (1..).zip(&angles) {
        let t = f64::from(i) * STEP_S;
        assert!(
            (angle - 0.02 * (omega * t).sin()).abs() < 3e-4,
            "{t} {angle}"
        );
    }
}

/// A half swing of a dry pendulum loses 2F/M: here by the energy, M(cos a − cos b) = F(a + b).
#[test]
fn dry_friction_takes_its_share_of_each_half_swing() {
    let n = WeightedBrace {
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
    let places: [fn(&mut WeightedBrace) -> &mut f64; 10] = [
        |n| &mut n.gear.inertia_kg_m2,
        |n| &mut n.gear.friction_nm,
        |n| &mut n.gear.load_loss,
        |n| &mut n.gap_rad,
        |n| &mut n.brace_kg_m2,
        |n| &mut n.stiffness_nm,
        |n| &mut n.damping_nms,
        |n| &mut n.moment_nm,
        |n| &mut n.weight_kg_m2,
        |n| &mut n.viscous_nms,
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
    for (i, place) in places.iter().enumerate() {
        let slope = |share: f64| {
            let angles = |factor: f64| {
                let mut n = N;
                *place(&mut n) *= factor;
                swing(&n, 0.1, &begin(0.1, 5.0), &torques)
            };
            let (up, down) = (angles(1.0 + share), angles(1.0 - share));
            let slopes = up.iter().zip(&down).map(|(u, d)| (u - d) / share);
            slopes.collect::<Vec<_>>()
        };
        let (a, b) = (slope(1e-5), slope(2e-5));
        let norm = |v: &mut dyn Iterator<Item = f64>| v.map(|x| x * x).sum::<f64>().sqrt();
        let differ = norm(&mut a.iter().zip(&b).map(|(a, b)| a - b));
        let whole = norm(&mut a.iter().copied());
        assert!(differ < 0.1 * whole + 1e-9, "{i}: {differ} of {whole}");
    }
}
