use super::*;
use crepitus_scene::preset::joints;

#[test]
fn the_closed_form_of_the_paper_has_637_events_and_each_jumps_at_them() {
    let paper = Work::new(joints()[0].parameters).closed_form_events();
    assert_eq!((paper.len(), paper[0]), (637, 1e-3));
    for joint in joints() {
        let p = &joint.parameters;
        let (kinetic, limit) = (p.kinetic_torque_nm, p.static_torque_nm);
        let work = Work::new(*p);
        for (n, event_s) in work.closed_form_events().into_iter().enumerate() {
            let torque = |time_s| work.closed_form_torque(time_s).unwrap();
            assert_eq!(work.closed_form_torque(event_s), None);
            let (before, after) = (torque(event_s - 2e-6), torque(event_s + 2e-6));
            let (expected_before, expected_after) = if n % 2 == 0 {
                (limit, kinetic)
            } else {
                (kinetic, 2.0 * kinetic - limit)
            };
            assert!((before - expected_before).abs() < 2e-3, "{n}");
            assert!((after - expected_after).abs() < 2e-3, "{n}");
        }
    }
}

#[test]
fn an_excursion_above_the_shaft_speed_is_longer_than_the_safe_step() {
    for joint in joints() {
        let p = &joint.parameters;
        let work = Work::new(*p);
        // v of a free swing from a break: Ω·cos − (Ts − Tk)/√(J·kr)·sin of ωn·t.
        let v = |t: f64| {
            let (sin, cos) = (work.natural * t).sin_cos();
            let drop = (p.static_torque_nm - p.kinetic_torque_nm) / p.impedance_nms_per_rad();
            OMEGA * cos - drop * sin
        };
        assert!(v(work.slip_s + 1e-9) > OMEGA, "{}", joint.name);
        assert!(v(work.slip_s + work.safe_step_s()) > OMEGA);
        assert!(v(work.slip_s + work.safe_step_s() / 0.98) < OMEGA);
    }
}
