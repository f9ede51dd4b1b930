//! Energy is kept, losses only grow, gaps hold, and nothing runs away.

use crate::random::{Case, case};
use crate::support::cases;
use crepitus_plant::energy_balance::{Account, EnergyBalance};
use proptest::prelude::*;

const TICKS: u32 = 6000;

fn losses(balance: &EnergyBalance) -> impl Iterator<Item = f64> {
    let terms = balance.terms().iter();
    terms
        .filter(|t| t.account == Account::Lost)
        .map(|t| t.joule)
}

/// Runs a case; returns the largest residual on the way, as a share of all
/// energy that there was and that moved.
fn run(case: &Case) -> Result<f64, TestCaseError> {
    let mut rig = case.rig(1.0);
    let half_rad = case.build.gap_rad() / 2.0;
    let mut lost: Vec<f64> = losses(&rig.plant.balance()).collect();
    // Of less than 10 µJ nothing but rounding is left.
    let (mut worst_j, mut most_j) = (0.0_f64, 1e-5_f64);
    for n in 0..TICKS {
        rig.tick(case.asks.torque_nm(n));
        let row = rig.row();
        prop_assert!(row.iter().all(|x| x.is_finite()), "{row:?} at tick {n}");
        prop_assert!(rig.felt_nm.is_finite() && rig.felt_nm.abs() < 1e7);
        if half_rad > 0.0 {
            let gap = rig.get("gap_rad");
            prop_assert!(gap.abs() <= half_rad, "{gap} beyond {half_rad} at tick {n}");
            let between = rig.shaft().angle_rad - rig.leg().angle_rad;
            if !rig.has("brace_torque_nm") {
                prop_assert!((between - gap).abs() < 1e-12);
            }
        }
        if n % 8 == 0 {
            let balance = rig.plant.balance();
            let moved = balance.turnover_j();
            for (then, now) in lost.iter_mut().zip(losses(&balance)) {
                prop_assert!(
                    now >= *then - 1e-15 * moved,
                    "{then} J to {now} J at tick {n}"
                );
                *then = now;
            }
            worst_j = worst_j.max(balance.residual_j().abs());
            most_j = most_j.max(moved);
        }
    }
    Ok(worst_j / most_j)
}

proptest! {
    #![proptest_config(cases(200))]

    #[test]
    fn without_a_leg_energy_is_kept_to_rounding(case in case(false)) {
        let open = run(&case)?;
        prop_assert!(open < 1e-9, "{open:.1e} left over");
    }

    #[test]
    fn with_a_leg_it_is_kept_to_the_bends_of_its_torque(case in case(true)) {
        let open = run(&case)?;
        prop_assert!(open < 1e-7, "{open:.1e} left over");
    }
}
