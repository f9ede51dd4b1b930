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
    imperfections: Imperfections {
        presliding_rad_per_nm: 0.0,
        teeth_rad_per_nm: 0.0,
        stribeck: 0.0,
        by_angle: [0.0; BY_ANGLE],
        range_rad: 1.0,
    },
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

/// With friction F·(1 + a·x) + F·c·P₂(x), x the angle over the range, a half swing from −b to c takes its integral.
#[test]
fn friction_by_angle_takes_its_integral() {
    let imperfections = Imperfections {
        by_angle: [0.2, 0.1, 0.0, 0.0],
        range_rad: 1.1,
        ..N.imperfections
    };
    let n = WeightedBrace {
        viscous_nms: 0.0,
        stiffness_nm: 2000.0,
        gap_rad: 1e-4,
        imperfections,
        ..N
    };
    let angles = swing(&n, 0.0, &begin(0.0, 5.0), &vec![0.0; 8000]);
    let turns: Vec<f64> = angles
        .windows(3)
        .filter(|w| (w[1] - w[0]) * (w[2] - w[1]) < 0.0)
        .map(|w| w[1])
        .collect();
    // ∫ 1 + 0.2x + 0.1(1.5x² − 0.5) dφ, x = φ/1.1.
    let integral = |phi: f64| {
        let x = phi / 1.1;
        1.1 * (x + 0.1 * x * x + 0.05 * (x.powi(3) - x))
    };
    assert!(turns.len() >= 2, "{turns:?}");
    for pair in turns.windows(2) {
        let lost = 6.0 * (pair[1].cos() - pair[0].cos());
        let expected = 0.5 * (integral(pair[0]) - integral(pair[1])).abs();
        assert!((lost / expected - 1.0).abs() < 0.02, "{turns:?}");
    }
}

/// Springs that hardly give way change the swing as little; soft ones much.
#[test]
fn stiff_springs_are_nearly_rigid() {
    let swung = |presliding_rad_per_nm: f64, teeth_rad_per_nm: f64| {
        let imperfections = Imperfections {
            presliding_rad_per_nm,
            teeth_rad_per_nm,
            ..N.imperfections
        };
        swing(
            &WeightedBrace { imperfections, ..N },
            0.0,
            &begin(0.1, 5.0),
            &vec![0.0; 6000],
        )
    };
    let rigid = swung(0.0, 0.0);
    let apart = |other: &[f64]| {
        let pairs = rigid.iter().zip(other);
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    for (stiff, soft) in [((5e-6, 0.0), (5e-4, 0.0)), ((0.0, 2e-5), (0.0, 1e-3))] {
        let [stiff, soft] =
            [stiff, soft].map(|(presliding, teeth)| apart(&swung(presliding, teeth)));
        assert!(stiff < 3e-3 && soft > 3.0 * stiff, "{stiff} {soft}");
    }
}

/// Friction that is greater at rest stops the swing earlier.
#[test]
fn stribeck_friction_stops_it_earlier() {
    let last = |stribeck: f64| {
        let imperfections = Imperfections {
            stribeck,
            ..N.imperfections
        };
        let angles = swing(
            &WeightedBrace { imperfections, ..N },
            0.0,
            &begin(0.1, 5.0),
            &vec![0.0; 12_000],
        );
        let turns = angles
            .windows(3)
            .filter(|w| (w[1] - w[0]) * (w[2] - w[1]) < 0.0);
        turns.map(|w| w[1].abs()).sum::<f64>()
    };
    assert!(last(0.5) < last(0.0) - 0.01, "{} {}", last(0.5), last(0.0));
}
