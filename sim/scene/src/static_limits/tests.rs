use super::*;
use crepitus_model::render::effects::clasp_knife::ClaspKnifeSettings;
use crepitus_model::render::effects::clonus::ClonusSettings;
use crepitus_model::render::effects::cogwheel::CogwheelSettings;
use crepitus_model::render::effects::lead_pipe::LeadPipeSettings;
use crepitus_model::render::effects::range_limit::RangeLimitSettings;
use crepitus_model::render::effects::{Effects, Timing};
use crepitus_model::render::input_check::{InputCheck, InputLimits};
use crepitus_model::render::position::Sensing;
use crepitus_model::render::{Addition, Check, ShaftEstimate, Shown};
use crepitus_model::{Sample, ShaftStep, Tabled};

const STEP_S: f64 = 5e-5;

const TIMING: Timing = Timing {
    step_s: STEP_S,
    delay_ticks: 1,
    sensing: Sensing::IDEAL,
};

/// Angle, velocity and torque at the ticks of a movement over these angles, deg, at
/// this speed, deg/s.
fn follow(settings: &EffectSettings, degrees: &[f64], deg_s: f64) -> Vec<(f64, f64, f64)> {
    let mut effects: Effects<f64> = settings.laws(&TIMING).unwrap();
    let mut check = InputCheck::new(&InputLimits::device(STEP_S), STEP_S, 0.0);
    effects.rest(&TIMING.sensing.position(degrees[0].to_radians()));
    let mut rows = Vec::new();
    for ends in degrees.windows(2) {
        let (from, to) = (ends[0].to_radians(), ends[1].to_radians());
        let omega_rad_s = deg_s.to_radians().copysign(to - from);
        let ticks = ((to - from) / omega_rad_s / STEP_S).round();
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        for n in 1..=ticks as u32 {
            let angle_rad = from + f64::from(n) * STEP_S * omega_rad_s;
            let sample = Sample::Taken(ShaftStep {
                delta_phi_rad: STEP_S * omega_rad_s,
                omega_start_rad_s: omega_rad_s,
                omega_end_rad_s: omega_rad_s,
            });
            let seen = ShaftEstimate {
                sample,
                omega_rad_s,
                place: TIMING.sensing.position(angle_rad),
                is_driven: true,
            };
            let mut shown = Shown::nothing();
            effects.tick(&seen, &check.check(&sample), &mut shown, &mut ());
            rows.push((angle_rad, omega_rad_s, shown.torque_nm));
        }
    }
    rows
}

/// The torque never leaves the limits, and is on both of them for a part of the
/// movement.
fn assert_between(rows: &[(f64, f64, f64)], limits: impl Fn(f64) -> Limits<f64>) {
    let (mut at_upper, mut at_lower) = (0, 0);
    for (angle_rad, _, nm) in rows {
        let Limits { lower_nm, upper_nm } = limits(*angle_rad);
        assert!(
            (lower_nm - 1e-9..=upper_nm + 1e-9).contains(nm),
            "{nm} at {angle_rad}: {lower_nm} to {upper_nm}"
        );
        at_upper += u32::from(upper_nm > 0.0 && (nm - upper_nm).abs() < 1e-9);
        at_lower += u32::from(lower_nm < 0.0 && (nm - lower_nm).abs() < 1e-9);
    }
    assert!(at_upper > 200 && at_lower > 200, "{at_upper}, {at_lower}");
}

#[test]
fn both_ends_of_the_range_push_inwards() {
    let settings = RangeLimitSettings {
        extension_torque_nm: 3.0,
        ..RangeLimitSettings::defaults()
    };
    let of = EffectSettings {
        range_limit: Some(settings),
        ..EffectSettings::default()
    };
    let rows = follow(&of, &[60.0, 125.0, 5.0, 60.0], 60.0);
    let limits_at = |angle_rad| range_limit::limits_at(&settings, angle_rad);
    assert_between(&rows, limits_at);
    assert_eq!(limits_at(1.0), Limits::both(0.0));
    assert_eq!(limits_at(140_f64.to_radians()).upper_nm, 4.0);
    assert_eq!(limits_at(0.0).lower_nm, -3.0);
}

#[test]
fn closed_forms_of_ends_catches_and_blades() {
    let settings = RangeLimitSettings {
        flexion_limit_deg: 0.0,
        flexion_stiffness_nm_per_rad: 40.0,
        flexion_stiffening_nm_per_rad2: 1000.0,
        flexion_torque_nm: 6.0,
        extension_limit_deg: -10.0,
        ..RangeLimitSettings::defaults()
    };
    for (beyond_rad, nm) in [(-0.01, 0.0), (0.01, 0.5), (0.05, 4.5), (0.1, 6.0)] {
        let upper_nm = range_limit::limits_at(&settings, beyond_rad).upper_nm;
        assert!((upper_nm - nm).abs() < 1e-12, "{upper_nm} for {nm}");
    }
    for (muscles, sign) in [(0, 1.0), (1, -1.0)] {
        let muscle = SpasticitySettings {
            muscles,
            velocity_torque_nms_per_rad: 0.5,
            torque_nm: 2.0,
            ..SpasticitySettings::defaults()
        };
        for (rad_s, nm) in [(3.0, 1.5), (9.0, 2.0), (-3.0, 0.0)] {
            assert_eq!(spasticity::catch_nm(&muscle, sign * rad_s), nm);
        }
        let blade = ClaspKnifeSettings {
            muscles,
            onset_deg: 60.0,
            onset_torque_nm: 1.5,
            slope_nm_per_rad: 2.0,
            ..ClaspKnifeSettings::defaults()
        };
        let onset_rad = 60_f64.to_radians();
        for (beyond_rad, nm) in [(-0.1, 0.0), (0.0, 1.5), (0.25, 2.0)] {
            let found_nm = clasp_knife::building_nm(&blade, onset_rad + sign * beyond_rad);
            assert!((found_nm - sign * nm).abs() < 1e-12, "{found_nm} {nm}");
        }
    }
}

#[test]
fn rigidity_is_a_band_about_its_spring() {
    let settings = LeadPipeSettings {
        elastic_nm_per_rad: 2.0,
        ..LeadPipeSettings::defaults()
    };
    let of = EffectSettings {
        lead_pipe: Some(settings),
        ..EffectSettings::default()
    };
    let rows = follow(&of, &[45.0, 80.0, 20.0, 45.0], 60.0);
    assert_between(&rows, |rad| lead_pipe::limits_at(&settings, rad));
}

#[test]
fn a_cogwheel_is_on_the_limits_of_its_teeth() {
    let settings = CogwheelSettings::defaults();
    let of = EffectSettings {
        cogwheel: Some(settings),
        ..EffectSettings::default()
    };
    let rows = follow(&of, &[45.0, 80.0, 20.0, 45.0], 60.0);
    assert_between(&rows, |rad| cogwheel::limits_at(&settings, rad, true));
    let low = cogwheel::limits_at(&settings, 0.0, false);
    let at_low = rows.iter().filter(|(.., nm)| *nm == low.upper_nm).count();
    assert!(low.upper_nm == 0.8 && at_low > 200, "{at_low}");
}

#[test]
fn a_catch_is_where_it_should_be_and_leaves_what_it_should() {
    for muscles in [0, 1] {
        let settings = SpasticitySettings {
            muscles,
            ..SpasticitySettings::defaults()
        };
        let of = EffectSettings {
            spasticity: Some(settings),
            ..EffectSettings::default()
        };
        let degrees = if muscles == 0 {
            [20.0, 110.0]
        } else {
            [130.0, 40.0]
        };
        let rows = follow(&of, &degrees, 90.0);
        let omega_rad_s = spasticity::sense(&settings) * 90_f64.to_radians();
        let caught_rad = spasticity::threshold_rad(&settings, omega_rad_s);
        let (first, ..) = rows.iter().find(|(.., nm)| *nm != 0.0).unwrap();
        assert!((first - caught_rad).abs() < 2e-4, "{first} {caught_rad}");
        let (end_rad, _, end_nm) = rows.last().unwrap();
        let left_nm = spasticity::left_nm(&settings, caught_rad, omega_rad_s, *end_rad);
        assert!((end_nm - left_nm).abs() < 1e-3, "{end_nm} {left_nm}");
        let catch_nm = spasticity::catch_nm(&settings, omega_rad_s);
        assert!((catch_nm - 1.0524).abs() < 1e-4);
        // Slower than any that is caught.
        assert!(spasticity::slowest_rad_s(&settings) > 30_f64.to_radians());
        let slow = follow(&of, &degrees, 30.0);
        assert!(slow.iter().all(|(.., nm)| *nm == 0.0));
    }
}

#[test]
fn a_reflex_comes_to_its_line_late() {
    let settings = SpasticitySettings {
        form: 1,
        velocity_shift_s: 0.27,
        ..SpasticitySettings::defaults()
    };
    let of = EffectSettings {
        spasticity: Some(settings),
        ..EffectSettings::default()
    };
    let late_s = settings.delay_s + settings.activation_s;
    let rows = follow(&of, &[30.0, 110.0], 60.0);
    let (angle_rad, omega_rad_s, nm) = *rows.last().unwrap();
    let seen_rad = angle_rad - omega_rad_s * late_s;
    let expected_nm = spasticity::reflex_nm(&settings, seen_rad, omega_rad_s);
    assert!((nm - expected_nm).abs() < 1e-3, "{nm} {expected_nm}");
    assert!(nm > 1.0 && !settings.catches());
    assert_eq!(spasticity::slowest_rad_s(&settings), 0.0);
}

/// A reach of a device at its defaults: 0° to 120°.
fn reach() -> Reach {
    Reach::of(&RangeSettings::defaults(), &LimitSettings::defaults())
}

#[test]
fn springs_count_as_far_from_their_neutral_angle_as_the_leg_can_be() {
    let of = |neutral_deg| EffectSettings {
        lead_pipe: Some(LeadPipeSettings {
            torque_nm: 1.2,
            elastic_nm_per_rad: 2.0,
            neutral_deg,
            ..LeadPipeSettings::defaults()
        }),
        ..EffectSettings::default()
    };
    let joint = Parameters::default();
    for (neutral_deg, furthest_deg) in [(45.0, 75.0), (100.0, 100.0), (140.0, 140.0)] {
        let nm = largest_within_nm(&of(neutral_deg), Some(&joint), &reach());
        let expected_nm = 0.4 + 1.2 + 2.0 * f64::to_radians(furthest_deg);
        assert!((nm - expected_nm).abs() < 1e-12, "{nm} {expected_nm}");
    }
    let both = EffectSettings {
        cogwheel: Some(CogwheelSettings {
            elastic_nm_per_rad: 1.0,
            neutral_deg: 0.0,
            ..CogwheelSettings::defaults()
        }),
        ..of(45.0)
    };
    let nm = |effects: &EffectSettings| largest_within_nm(effects, None, &reach());
    let more_nm = nm(&both) - nm(&of(45.0));
    assert!(
        (more_nm - 2.0 - 120_f64.to_radians()).abs() < 1e-12,
        "{more_nm}"
    );
}

/// Catches of both muscles, at the speed at which a device disarms and at slower ones.
#[test]
fn no_catch_exceeds_its_largest_torque_and_the_fastest_comes_close() {
    for (muscles, threshold_deg, degrees) in [(0, 50.0, [0.0, 120.0]), (1, 70.0, [120.0, 0.0])] {
        for release_s in [0.06, 1.0] {
            let settings = SpasticitySettings {
                muscles,
                threshold_deg,
                velocity_torque_nms_per_rad: 0.956,
                residual_share: 0.7,
                stiffness_nm_per_rad: 2.0,
                release_s,
                ..SpasticitySettings::defaults()
            };
            let of = EffectSettings {
                spasticity: Some(settings),
                ..EffectSettings::default()
            };
            let bound_nm = largest_within_nm(&of, None, &reach());
            let highest_nm = |deg_s| {
                let rows = follow(&of, &degrees, deg_s);
                rows.iter().fold(0.0_f64, |most, row| most.max(row.2.abs()))
            };
            // The last tick may end beyond the reach, by less than a tick.
            let highest_allowed_nm = bound_nm + 1e-3;
            for deg_s in [60.0, 150.0, 300.0] {
                assert!(highest_nm(deg_s) <= highest_allowed_nm, "{deg_s} deg/s");
            }
            let fastest_nm = highest_nm(reach().speed_rad_s.to_degrees());
            let close = 0.99 * bound_nm..=highest_allowed_nm;
            assert!(close.contains(&fastest_nm), "{fastest_nm} {bound_nm}");
            assert!(bound_nm > 4.5 + 2.0, "{bound_nm}");
        }
    }
    // A reflex has its largest torque, and no more.
    let reflex = EffectSettings {
        spasticity: Some(SpasticitySettings {
            form: 1,
            stiffness_nm_per_rad: 10.0,
            ..SpasticitySettings::defaults()
        }),
        ..EffectSettings::default()
    };
    assert_eq!(largest_within_nm(&reflex, None, &reach()), 4.5);
}

#[test]
fn a_clasp_knife_builds_along_its_line() {
    for muscles in [0, 1] {
        let settings = ClaspKnifeSettings {
            muscles,
            onset_deg: if muscles == 0 { 30.0 } else { 75.0 },
            release_deg: if muscles == 0 { 75.0 } else { 30.0 },
            ..ClaspKnifeSettings::defaults()
        };
        let of = EffectSettings {
            clasp_knife: Some(settings),
            ..EffectSettings::default()
        };
        let (from, to) = if muscles == 0 {
            (20.0, 110.0)
        } else {
            (85.0, -5.0)
        };
        let rows = follow(&of, &[from, to], 60.0);
        let building_nm = |angle_rad| clasp_knife::building_nm(&settings, angle_rad);
        let most_nm = |(angle_rad, ..): &(f64, f64, f64)| building_nm(*angle_rad);
        let on_it = rows
            .iter()
            .filter(|row| (row.2 - most_nm(row)).abs() < 1e-9);
        assert!(on_it.filter(|row| row.2 != 0.0).count() > 10_000);
        let released_rad = clasp_knife::release_rad(&settings).unwrap();
        assert!((building_nm(released_rad).abs() - 3.156).abs() < 1e-3);
        let (.., end_nm) = rows.last().unwrap();
        let left_nm = clasp_knife::left_nm(&settings, released_rad);
        assert!((end_nm - left_nm).abs() < 1e-6);
    }
}

#[test]
fn clonus_has_its_closed_form() {
    let clonus = ClonusSettings::defaults();
    for (n, ms) in [(0, 216.7), (1, 191.7), (2, 179.2), (3, 172.9)] {
        assert!((1e3 * clonus::interval_s(&clonus, n) - ms).abs() < 0.05);
    }
    assert_eq!(clonus::beat_nm(&clonus), 1.5);
}
