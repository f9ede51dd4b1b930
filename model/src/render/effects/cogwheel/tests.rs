//! Teeth in time and in space, counted exactly, and the noise at an edge.

use super::*;
use crate::joint::ShaftStep;
use crate::render::input_check::Checked;
use crate::render::position::Sensing;
use std::vec::Vec;

#[test]
fn an_angle_between_two_counts_is_a_part_of_a_tooth() {
    let settings = CogwheelSettings {
        mode: 1,
        pitch_deg: 7.0,
        ..CogwheelSettings::default()
    };
    // So coarse that what lies between two counts is most of a tooth.
    let sensing = Sensing {
        rad_per_count: 0.1,
        ..Sensing::IDEAL
    };
    let timing = Timing {
        step_s: 5e-5,
        delay_ticks: 0,
        sensing,
    };
    let with: CogwheelCoefficients<f64> = Cogwheel::coefficients(&settings, &timing).unwrap();
    let Clock::Space(per_count, per_rest) = with.clock else {
        panic!("a clock in space");
    };
    for angle_rad in [0.0, 0.03, 0.1, 0.15, 2.09, -0.03, -1.77] {
        let found = angle::<f64>(&sensing.position(angle_rad), per_count, per_rest);
        let teeth = angle_rad / settings.pitch_deg.to_radians();
        let expected = teeth - libm::floor(teeth);
        #[expect(clippy::cast_precision_loss, reason = "far less than is asked for")]
        let off = found as f64 / TOOTH - expected;
        assert!(off.abs() < 1e-8, "{angle_rad} rad: {off} of a tooth");
    }
}

/// Sixteen counts a tooth, of which the first eight are high; and 2048 ticks a tooth.
fn coarse(mode: u8, flicker_counts: f64) -> (Cogwheel<f64>, Timing) {
    let settings = CogwheelSettings {
        mode,
        pitch_deg: 8.0,
        duty: 0.5,
        frequency_hz: 8.0,
        ..CogwheelSettings::default()
    };
    let rad_per_count = 8_f64.to_radians() / 16.0;
    let timing = Timing {
        step_s: 1.0 / 16_384.0,
        delay_ticks: 0,
        sensing: Sensing {
            rad_per_count,
            flicker_rad: flicker_counts * rad_per_count,
            velocity_lag_s: 0.0,
        },
    };
    let coefficients = <Cogwheel<f64> as Law>::coefficients(&settings, &timing).unwrap();
    (<Cogwheel<f64> as Law>::new(coefficients), timing)
}

/// Goes on by a number of counts in a tick, to this one; what happened, and when.
fn go(law: &mut Cogwheel<f64>, timing: &Timing, to: i32, counts: i32) -> Vec<(Word, f64)> {
    let delta_phi_rad = f64::from(counts) * timing.sensing.rad_per_count;
    let omega_rad_s = delta_phi_rad / timing.step_s;
    let shaft = ShaftStep {
        delta_phi_rad,
        omega_start_rad_s: omega_rad_s,
        omega_end_rad_s: omega_rad_s,
    };
    let scale = timing.scale().unwrap();
    let travel = Travel::of(&Checked::Step(shaft), &Position::at(to), &scale).unwrap();
    let mut told = Vec::new();
    law.follow(&travel, &mut |change: Change<f64>| {
        if !change.word.is_of_play() {
            told.push((change.word, change.fraction));
        }
    });
    told
}

#[test]
fn a_tooth_ends_with_its_share_of_the_period() {
    let (mut law, timing) = coarse(0, 0.0);
    law.rest(&Position::at(0));
    for tick in 1..1_024 {
        // Along, so that the tooth is felt.
        assert!(go(&mut law, &timing, tick, 1).is_empty(), "{tick}");
        assert_eq!(law.phase(), 1);
    }
    assert_eq!(go(&mut law, &timing, 1_024, 1), [(Word::Give, 1.0)]);
    assert_eq!(law.phase(), 0);
    for tick in 1_025..2_048 {
        assert!(go(&mut law, &timing, tick, 1).is_empty(), "{tick}");
    }
    assert_eq!(go(&mut law, &timing, 2_048, 1), [(Word::Catch, 1.0)]);
}

#[test]
fn a_tooth_is_high_up_to_its_end_and_not_at_it() {
    for (count, is_high) in [(0, true), (7, true), (8, false), (15, false), (16, true)] {
        let (mut law, _) = coarse(1, 0.0);
        law.rest(&Position::at(count));
        assert_eq!(law.phase(), u16::from(is_high), "{count}");
    }
    let (mut law, timing) = coarse(1, 0.0);
    law.rest(&Position::at(6));
    // At its end it may turn back, or stay.
    for (count, counts) in [(7, 1), (8, 1), (8, 0), (7, -1), (8, 1)] {
        assert!(go(&mut law, &timing, count, counts).is_empty(), "{count}");
    }
    assert_eq!(go(&mut law, &timing, 9, 1), [(Word::Give, 0.0)]);
    // Two counts on, an edge in their middle.
    assert!(go(&mut law, &timing, 15, 7).is_empty());
    assert_eq!(go(&mut law, &timing, 17, 2), [(Word::Catch, 0.5)]);
}

/// The noise is of two counts: a joint that is one beyond an edge may be before it.
#[test]
fn an_edge_is_passed_where_noise_cannot_lead_back() {
    let (mut law, timing) = coarse(1, 2.0);
    law.rest(&Position::at(7));
    for count in [8, 9] {
        assert!(go(&mut law, &timing, count, 1).is_empty());
        assert_eq!(law.phase(), 1, "{count}");
    }
    let told = go(&mut law, &timing, 10, 1);
    assert_eq!(
        told.iter().map(|told| told.0).collect::<Vec<_>>(),
        [Word::Give]
    );
    assert_eq!(law.phase(), 0);
}
