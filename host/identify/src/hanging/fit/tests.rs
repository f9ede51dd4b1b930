//! The fit on currents that are computed in another way.

use super::*;

const MOMENT: Estimate = Estimate {
    value: 1.5,
    half_width: 0.015,
};

/// Means by bisection of the balance of torques: shares nothing with the fit.
fn simulated(constant: f64, loss: f64, friction: f64, stiffness: f64, arc_deg: i32) -> Vec<Mean> {
    let weight_at = |angle: f64| {
        let (mut low, mut high) = (angle - 0.3, angle + 0.3);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if stiffness * (angle - middle) > MOMENT.value * (middle - 0.1).sin() {
                low = middle;
            } else {
                high = middle;
            }
        }
        low
    };
    let mean = |deg: i32, sense: f64| {
        let angle_rad = f64::from(deg).to_radians() + 0.1;
        let load = MOMENT.value * (weight_at(angle_rad) - 0.1).sin();
        let (mut low, mut high) = (-5.0, 5.0);
        for _ in 0..60 {
            let i: f64 = 0.5 * (low + high);
            let lost = (friction + loss * (constant * i).abs()) * sense;
            if constant * i - lost < load {
                low = i;
            } else {
                high = i;
            }
        }
        Mean {
            angle_rad,
            current_a: low,
            sense,
        }
    };
    let up = (-3..arc_deg).map(|deg| mean(deg, 1.0));
    let down = (2..arc_deg).rev().map(|deg| mean(deg, -1.0));
    up.chain(down).collect()
}

#[test]
fn what_was_put_in_comes_out() {
    for (constant, loss, friction, stiffness) in [
        (3.33, 0.3, 0.5, 120.0),
        (2.5, 0.1, 0.2, 60.0),
        (4.2, 0.4, 0.6, 1e4),
        (3.33, 0.0, 0.1, 300.0),
    ] {
        let found = found(
            &simulated(constant, loss, friction, stiffness, 90),
            MOMENT,
            0.3,
            3.33,
        )
        .unwrap();
        assert!(found.nm_per_a.holds(constant), "{constant} {found:?}");
        assert!(found.load_loss.holds(loss), "{loss} {found:?}");
        assert!(found.friction_nm.holds(friction), "{friction} {found:?}");
        // No narrower than the interval of the weight and the allowances for the model.
        assert!(
            (0.0141..0.03).contains(&found.nm_per_a.share()),
            "{found:?}"
        );
        assert!(
            (0.015..0.1).contains(&found.load_loss.half_width),
            "{found:?}"
        );
        let of_friction = found.friction_nm.half_width / friction;
        assert!((0.0316 * 0.97..0.5).contains(&of_friction), "{found:?}");
    }
}

#[test]
fn a_weight_that_is_given_wrongly_scales_all() {
    let means = simulated(3.33, 0.3, 0.5, 120.0, 90);
    let heavier = Estimate {
        value: 3.0,
        half_width: 0.03,
    };
    let wrong = found(&means, heavier, 0.3, 3.33).unwrap();
    assert!(
        (wrong.nm_per_a.value / 6.66 - 1.0).abs() < 0.03,
        "{wrong:?}"
    );
}

#[test]
fn a_short_arc_has_a_wide_interval() {
    let share = |arc| {
        found(&simulated(3.33, 0.3, 0.5, 120.0, arc), MOMENT, 0.3, 3.33)
            .unwrap()
            .nm_per_a
            .share()
    };
    assert!(share(30) > share(90), "{} {}", share(30), share(90));
}

#[test]
fn what_is_no_weight_is_refused() {
    let weight = simulated(3.33, 0.3, 0.5, 120.0, 90);
    assert!(matches!(
        found(&weight[..20], MOMENT, 0.0, 3.33),
        Err(Refusal::Short { .. })
    ));
    let constant: Vec<_> = weight
        .iter()
        .map(|m| Mean {
            current_a: m.sense * 0.2,
            ..*m
        })
        .collect();
    let refused = found(&constant, MOMENT, 0.1, 3.33);
    assert!(refused.is_err(), "{refused:?}");
    let noisy: Vec<_> = weight
        .iter()
        .zip(0..)
        .map(|(m, n)| Mean {
            current_a: m.current_a + 0.3 * f64::from(n % 7 - 3),
            ..*m
        })
        .collect();
    assert!(found(&noisy, MOMENT, 0.0, 3.33).is_err());
}
