//! Settings that are refused: numbers out of range, and contradictions.

use super::rig::{near, on, timing};
use crepitus_model::SettingsError;
use crepitus_model::parameters::Tabled;
use crepitus_model::render::effects::clasp_knife::{ClaspKnife, ClaspKnifeSettings};
use crepitus_model::render::effects::clonus::{Clonus, ClonusSettings};
use crepitus_model::render::effects::cogwheel::{Cogwheel, CogwheelSettings};
use crepitus_model::render::effects::lead_pipe::{LeadPipe, LeadPipeSettings};
use crepitus_model::render::effects::range_limit::{RangeLimit, RangeLimitSettings};
use crepitus_model::render::effects::spasticity::{Spasticity, SpasticitySettings};
use crepitus_model::render::effects::texture::{Texture, TextureSettings};
use crepitus_model::render::effects::{DeviceEffect, EffectSettings};
use crepitus_model::render::position::Sensing;

/// Each number just outside its range is refused, by the rules of a knee and before a law
/// is made of it; no number is.
fn keeps_its_ranges<const N: usize, E>(with: fn(E::Settings) -> EffectSettings)
where
    E: DeviceEffect<f64>,
    E::Settings: Tabled<N>,
{
    let defaults = E::Settings::defaults();
    assert_eq!(with(defaults).check(None), Ok(()));
    assert!(E::coefficients(&defaults, &timing(Sensing::IDEAL)).is_ok());
    for (place, spec) in E::Settings::TABLE.iter().enumerate() {
        let width = spec.max - spec.min;
        for value in [spec.min - 1e-6 * width, spec.max + 1e-6 * width, f64::NAN] {
            let mut settings = defaults;
            *settings.values_mut()[place] = value;
            let (key, refused) = (spec.key, with(settings).check(None));
            assert!(
                matches!(refused, Err(SettingsError::OutOfRange { .. })),
                "{key} = {value}: {refused:?}"
            );
            let refused = E::coefficients(&settings, &timing(Sensing::IDEAL)).map(|_| ());
            assert!(refused.is_err(), "{key} = {value}");
        }
    }
}

#[test]
fn a_number_outside_its_range_is_refused() {
    keeps_its_ranges::<_, RangeLimit<f64>>(|s| on!(range_limit: s));
    keeps_its_ranges::<_, LeadPipe<f64>>(|s| on!(lead_pipe: s));
    keeps_its_ranges::<_, Cogwheel<f64>>(|s| on!(cogwheel: s));
    keeps_its_ranges::<_, Spasticity<f64>>(|s| on!(spasticity: s));
    keeps_its_ranges::<_, ClaspKnife<f64>>(|s| on!(clasp_knife: s));
    keeps_its_ranges::<_, Clonus<f64>>(|s| on!(clonus: s));
    keeps_its_ranges::<_, Texture<f64>>(|s| on!(texture: s));
}

fn is_refused(settings: EffectSettings) -> bool {
    match settings.check(None) {
        Ok(()) => false,
        Err(SettingsError::Contradiction { .. }) => true,
        Err(other) => panic!("{other}"),
    }
}

#[test]
fn a_blade_falls_beyond_its_onset() {
    for (muscles, onset_deg, release_deg, refused) in [
        (0, 40.0, 40.5, false),
        (0, 40.0, 40.0, true),
        (0, 40.0, 39.5, true),
        (1, 40.0, 39.5, false),
        (1, 40.0, 40.0, true),
        (1, 40.0, 40.5, true),
    ] {
        let settings = on!(clasp_knife: ClaspKnifeSettings {
            muscles,
            onset_deg,
            release_deg,
            ..ClaspKnifeSettings::default()
        });
        assert_eq!(is_refused(settings), refused, "{muscles} {release_deg}");
    }
}

#[test]
fn beats_and_seeds_are_whole_numbers() {
    for (number, refused) in [(0.0, false), (3.0, false), (2.5, true), (0.5, true)] {
        let settings = on!(clonus: ClonusSettings {
            beats: number,
            ..ClonusSettings::default()
        });
        assert_eq!(is_refused(settings), refused, "{number} beats");
        let settings = on!(texture: TextureSettings {
            seed: number,
            ..TextureSettings::default()
        });
        assert_eq!(is_refused(settings), refused, "seed {number}");
    }
}

#[test]
fn ends_of_a_range_are_five_degrees_apart() {
    for (flexion_limit_deg, refused) in [(25.0, false), (24.9, true), (15.0, true)] {
        let settings = on!(range_limit: RangeLimitSettings {
            extension_limit_deg: 20.0,
            flexion_limit_deg,
            ..RangeLimitSettings::default()
        });
        assert_eq!(is_refused(settings), refused, "{flexion_limit_deg}");
    }
}

#[test]
fn a_reflex_that_would_give_energy_at_every_speed_is_refused() {
    // 0.0625 + 0.0125 s are 0.075 s to the bit.
    for (form, velocity_shift_s, refused) in [
        (1, 0.075, false),
        (1, 0.074, true),
        (1, 0.05, true),
        (0, 0.0, false),
    ] {
        let settings = on!(spasticity: SpasticitySettings {
            form,
            velocity_shift_s,
            delay_s: 0.0625,
            activation_s: 0.0125,
            ..SpasticitySettings::default()
        });
        assert_eq!(is_refused(settings), refused, "{form} {velocity_shift_s}");
    }
    // As people write them: the least shift, whose sum is a rounding more.
    for (delay_s, activation_s, velocity_shift_s) in [(0.05, 0.01, 0.06), (0.05, 0.1, 0.15)] {
        let settings = on!(spasticity: SpasticitySettings {
            form: 1,
            velocity_shift_s,
            delay_s,
            activation_s,
            ..SpasticitySettings::default()
        });
        assert!(!is_refused(settings), "{delay_s} + {activation_s}");
    }
}

#[test]
fn asperities_rise_and_are_no_steeper_than_their_spring() {
    let rough = |base_nm, peak_nm, pitch_deg: f64, width_share, stiffness_nm_per_rad| {
        is_refused(on!(texture: TextureSettings {
            base_nm,
            peak_nm,
            pitch_deg,
            width_share,
            stiffness_nm_per_rad,
            ..TextureSettings::default()
        }))
    };
    // 2·0.5 N·m over 0.5·2 deg.
    let steepest = 1.0 / 1_f64.to_radians();
    assert!(!rough(0.25, 0.75, 2.0, 0.5, steepest));
    assert!(rough(0.25, 0.75, 2.0, 0.5, 0.999 * steepest));
    assert!(!rough(0.5, 0.5, 2.0, 0.5, 1.0));
    assert!(rough(0.5, 0.499, 2.0, 0.5, 400.0));
}

#[test]
fn the_spring_beside_a_play_counts_in_its_stiffness_and_slope() {
    let elastic_nm_per_rad = 5.0;
    let (pipe, wheel) = (LeadPipeSettings::default(), CogwheelSettings::default());
    for (settings, torque_nm, presliding_deg) in [
        (
            on!(lead_pipe: LeadPipeSettings {
                elastic_nm_per_rad,
                ..pipe
            }),
            pipe.torque_nm,
            pipe.presliding_deg,
        ),
        (
            on!(cogwheel: CogwheelSettings {
                elastic_nm_per_rad,
                ..wheel
            }),
            wheel.torque_nm,
            wheel.presliding_deg,
        ),
    ] {
        let play = torque_nm / presliding_deg.to_radians();
        near(settings.stiffness_nm_per_rad(None), play + 5.0, 1e-9);
        let half_a_turn_nm = torque_nm + 5.0 * std::f64::consts::PI;
        near(settings.torque_bound_nm(None), half_a_turn_nm, 1e-9);
    }
}
