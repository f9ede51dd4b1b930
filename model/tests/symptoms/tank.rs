//! One tank pays for what gives energy, and for nothing else.

use super::rig::*;
use crepitus_model::render::Limit;
use crepitus_model::render::effects::EffectSettings;
use crepitus_model::render::effects::clasp_knife::ClaspKnifeSettings;
use crepitus_model::render::effects::cogwheel::CogwheelSettings;
use crepitus_model::render::effects::lead_pipe::LeadPipeSettings;
use crepitus_model::render::effects::range_limit::RangeLimitSettings;
use crepitus_model::render::effects::spasticity::SpasticitySettings;
use crepitus_model::render::effects::texture::TextureSettings;

/// A hand shakes the leg in time with a reflex, which empties the tank.
fn shaken(time_s: f64) -> (f64, f64) {
    let phase = 25.0 * time_s;
    (1.05 + 0.3 * phase.sin(), 7.5 * phase.cos())
}

#[test]
fn what_gives_no_energy_neither_fills_the_tank_nor_is_paid_from_it() {
    let reflex = Some(SpasticitySettings {
        form: 1,
        threshold_deg: 60.0,
        velocity_shift_s: 0.27,
        gain_nm_per_rad: 15.0,
        ..SpasticitySettings::default()
    });
    let none = EffectSettings::default;
    for passive in [
        on!(lead_pipe: LeadPipeSettings::default()),
        on!(cogwheel: CogwheelSettings::default()),
        on!(texture: TextureSettings::default()),
        on!(clasp_knife: ClaspKnifeSettings::default()),
        on!(range_limit: RangeLimitSettings {
            flexion_limit_deg: 60.0,
            ..RangeLimitSettings::default()
        }),
    ] {
        let settings = [
            EffectSettings {
                spasticity: reflex,
                ..none()
            },
            passive,
            EffectSettings {
                spasticity: reflex,
                ..passive
            },
        ];
        let [reflex, beside, both] =
            settings.map(|settings| only::<f64>(settings, 1.05_f64.to_degrees()).run(0.3, shaken));
        let mut most_nm = 0.0_f64;
        for ((reflex, beside), both) in reflex.rows.iter().zip(&beside.rows).zip(&both.rows) {
            near(both.2, reflex.2 + beside.2, 1e-9);
            most_nm = most_nm.max(beside.2.abs());
        }
        assert!(most_nm > 0.2, "{most_nm}");
    }
}

#[test]
fn the_tank_is_named_where_it_holds_back_and_a_reason_of_the_joint_stands() {
    let settings = EffectSettings {
        spasticity: Some(SpasticitySettings {
            form: 1,
            threshold_deg: 60.0,
            velocity_shift_s: 0.27,
            gain_nm_per_rad: 15.0,
            ..SpasticitySettings::default()
        }),
        lead_pipe: Some(LeadPipeSettings::default()),
        ..EffectSettings::default()
    };
    for before in [Limit::None, Limit::TurnedBack] {
        let mut rig = only::<f32>(settings, 1.05_f64.to_degrees());
        let (mut ticks, mut most) = (0, 0.0_f64);
        for n in 0..8_000 {
            let from_s = f64::from(n) * TICK_S;
            let (from, to) = (shaken(from_s), shaken(from_s + TICK_S));
            rig.limit = before;
            rig.step(from, to, to.0 - from.0);
            let is_held_back = rig.held_back > 0.0;
            let expected = match before {
                Limit::None if is_held_back => Limit::Tank,
                other => other,
            };
            assert_eq!(rig.limit, expected, "tick {n}");
            assert!((0.0..=1.0).contains(&rig.held_back));
            ticks += i32::from(is_held_back);
            most = most.max(rig.held_back);
        }
        assert!(ticks > 200 && most > 0.5, "{ticks} {most}");
    }
}
