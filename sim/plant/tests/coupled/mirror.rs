//! Mirror symmetry of a plant without a leg, whose weight knows up from down: a mirrored plant does the
//! same to the last bit.

use crate::random::case;
use crate::support::cases;
use proptest::prelude::*;

proptest! {
    #![proptest_config(cases(200))]

    #[test]
    fn a_mirrored_run_is_the_mirror_of_the_run(case in case(false)) {
        let (mut rig, mut image) = (case.rig(1.0), case.rig(-1.0));
        for n in 0..4000_u32 {
            let torque = case.asks.torque_nm(n);
            rig.tick(torque);
            image.tick(-torque);
            prop_assert_eq!(rig.felt_nm, -image.felt_nm, "tick {}", n);
            let pairs = rig.row().into_iter().zip(image.row());
            for (i, (a, b)) in pairs.enumerate() {
                prop_assert_eq!(a, -b, "column {} at tick {}", i, n);
            }
            let (a, b) = (rig.shaft(), image.shaft());
            prop_assert_eq!((a.angle_rad, a.omega_rad_s), (-b.angle_rad, -b.omega_rad_s));
        }
        prop_assert_eq!(rig.plant.balance(), image.plant.balance());
    }
}
