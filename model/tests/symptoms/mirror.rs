//! A joint and its mirror image.

use super::random::*;
use super::rig::*;
use super::support;
use crepitus_model::render::Addition;
use crepitus_model::render::effects::EffectSettings;
use crepitus_model::render::effects::clonus::ClonusSettings;
use crepitus_model::render::effects::cogwheel::CogwheelSettings;
use crepitus_model::render::effects::lead_pipe::LeadPipeSettings;
use crepitus_model::render::effects::range_limit::RangeLimitSettings;
use crepitus_model::render::effects::spasticity::SpasticitySettings;
use crepitus_model::render::position::Sensing;
use crepitus_model::{Real, Sample};
use proptest::prelude::*;

/// A symptom whose mirror image about 0 deg has settings of its own, and that image.
fn mirrored(which: usize, x: &[f64]) -> [EffectSettings; 2] {
    let mut both = [EffectSettings::default(); 2];
    let [own, image] = &mut both;
    match which {
        0 => {
            let wall = RangeLimitSettings {
                extension_limit_deg: -1.0 - 9.0 * x[4],
                flexion_limit_deg: 4.0 + 30.0 * x[5].min(0.2),
                ..symptom(0, x).range_limit.unwrap()
            };
            own.range_limit = Some(wall);
            image.range_limit = Some(RangeLimitSettings {
                extension_limit_deg: -wall.flexion_limit_deg,
                flexion_limit_deg: -wall.extension_limit_deg,
                ..wall
            });
        }
        1 | 2 => {
            let muscle = SpasticitySettings {
                form: u8::from(which == 2),
                muscles: 0,
                threshold_deg: 60.0 * x[1] - 30.0,
                ..symptom(3, x).spasticity.unwrap()
            };
            own.spasticity = Some(muscle);
            image.spasticity = Some(SpasticitySettings {
                muscles: 1,
                threshold_deg: -muscle.threshold_deg,
                ..muscle
            });
        }
        3 => {
            let clonus = ClonusSettings {
                hold_deg: 0.0,
                start_velocity_deg_s: 20.0 + 100.0 * x[1],
                ..ClonusSettings::default()
            };
            own.clonus = Some(clonus);
            image.clonus = Some(ClonusSettings {
                muscles: 1,
                ..clonus
            });
        }
        4 => {
            own.lead_pipe = Some(LeadPipeSettings {
                elastic_nm_per_rad: 10.0 * x[2],
                neutral_deg: 0.0,
                ..symptom(1, x).lead_pipe.unwrap()
            });
            *image = *own;
        }
        _ => {
            own.cogwheel = Some(CogwheelSettings {
                mode: 0,
                elastic_nm_per_rad: 10.0 * x[5],
                neutral_deg: 0.0,
                ..symptom(2, x).cogwheel.unwrap()
            });
            *image = *own;
        }
    }
    both
}

/// Follows a hand and its mirror image, with samples that are lost in every `gap.1` ticks of
/// each `gap.0`, and these settings instead from the middle on: the torques are each
/// other's to the bit.
fn mirrors<F: Real>(
    both: &[EffectSettings; 2],
    later: &[EffectSettings; 2],
    angles: &[f64],
    gap: (usize, usize),
) -> Result<(), TestCaseError> {
    let [mut one, mut two] =
        both.map(|settings| Rig::<F>::new(settings, Sensing::IDEAL, angles[0]));
    two.effects.rest(&Sensing::IDEAL.position(-angles[0]));
    let (mut omega, mut seen) = (0.0, angles[0]);
    for (n, pair) in angles.windows(2).enumerate() {
        let middle = angles.len() / 2;
        // The torque of a commit is shown before the next sample, too.
        let is_lost = n % gap.0 < gap.1 || gap.1 > 0 && (middle..middle + 3).contains(&n);
        if n == middle {
            one.commit(later[0]);
            two.commit(later[1]);
        }
        let end = (pair[1] - pair[0]) / TICK_S;
        let (nm, image_nm) = if is_lost {
            let place = |rad| Sensing::IDEAL.position(rad);
            (
                one.tick(Sample::Lost, place(seen)),
                two.tick(Sample::Lost, place(-seen)),
            )
        } else {
            let moved = pair[1] - seen;
            let both = (
                one.step((seen, omega), (pair[1], end), moved),
                two.step((-seen, -omega), (-pair[1], -end), -moved),
            );
            seen = pair[1];
            both
        };
        prop_assert_eq!(nm, -image_nm, "{} {}", F::NAME, n);
        omega = end;
    }
    Ok(())
}

proptest! {
    #![proptest_config(support::cases(300))]

    #[test]
    fn a_mirrored_joint_shows_the_mirrored_torque_to_the_bit(
        which in 0..6_usize,
        x in prop::collection::vec(0.0..1.0_f64, 6),
        y in prop::collection::vec(0.0..1.0_f64, 6),
        points in points(),
        gap in (200..2000_usize, prop::sample::select(vec![0, 3, 150])),
    ) {
        let (both, later) = (mirrored(which, &x), mirrored(which, &y));
        let middle = 60_f64.to_radians();
        let angles: Vec<_> = hand(&points).iter().map(|rad| rad - middle).collect();
        mirrors::<f64>(&both, &later, &angles, gap)?;
        mirrors::<f32>(&both, &later, &angles, gap)?;
    }
}
