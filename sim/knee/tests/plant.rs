//! Numbers and motions that the page's leg shares with the plant, which needs `std`.

use crepitus_knee::hand::{Hand, HandPath, HandState};
use crepitus_knee::leg::{DAMPING_NMS_PER_RAD, LIMB_KG_M2, Leg, WEIGHT_NM};
use crepitus_knee::{Page, pipeline};
use crepitus_model::control::device_limits::RangeSettings;
use crepitus_model::control::encoder::EncoderSettings;
use crepitus_plant::assembly::{Listed, assemble};
use crepitus_plant::boundary::MotionStep;
use crepitus_plant::chain::{Body, Shaft};
use crepitus_plant::effect::{Context, Effect, Given, Part};
use crepitus_plant::effects::{hand, limb};
use crepitus_plant::encoder::Encoder;
use crepitus_plant::guiding_hand::{GuidingHand, HandNumbers};
use crepitus_protocol::{TICK_S, Values};
use crepitus_scene::Preset;
use crepitus_scene::values::with_preset;

/// Default of an effect's number.
fn number(effect: &Effect, key: &str) -> f64 {
    let spec = effect.parameters.iter().find(|spec| spec.key == key);
    spec.expect("a number of the effect").default
}

/// A limb without the passive moment, which the page leaves out.
fn limb() -> Given {
    let mut given = Given::defaults(&limb::EFFECT);
    given.choices[1] = 1;
    given
}

fn context() -> Context {
    Context {
        tick_s: TICK_S,
        single: true,
        start: Body::default(),
        gravity_rad: Some(limb::gravity_rad(&limb())),
    }
}

fn near(ours: f64, theirs: f64) {
    assert!((ours / theirs - 1.0).abs() < 1e-3, "{ours} {theirs}");
}

#[test]
fn the_leg_is_that_of_the_plant() {
    let Part::Link(make) = limb::EFFECT.part else {
        panic!("a limb is a link");
    };
    let (given, context) = (limb(), context());
    let chain = make(&given, &context, Box::new(Shaft));
    let weight_nm = chain.weight().expect("a limb has weight");
    near(LIMB_KG_M2, chain.inertia_kg_m2());
    near(WEIGHT_NM, weight_nm(0.0));
    near(0.5 * WEIGHT_NM, weight_nm(60_f64.to_radians()));
    near(
        DAMPING_NMS_PER_RAD,
        number(&limb::EFFECT, "damping_nms_per_rad"),
    );
}

#[test]
fn the_arm_is_that_of_the_plant_and_pulls_harder() {
    let lever_m = number(&hand::EFFECT, "lever_m");
    let square = lever_m * lever_m;
    let guiding = Hand::default();
    near(
        guiding.inertia_kg_m2,
        square * number(&hand::EFFECT, "mass_kg"),
    );
    let relaxed = square * number(&hand::EFFECT, "stiffness_n_per_m");
    assert!(guiding.stiffness_nm_per_rad > 2.0 * relaxed);
}

fn body(hand: HandState) -> Body {
    Body {
        angle_rad: hand.angle_rad,
        omega_rad_s: hand.omega_rad_s,
    }
}

/// Quick strokes against a knee that resists: the plant's leg, on the same path.
#[test]
fn the_hand_moves_a_leg_as_it_moves_that_of_the_plant() {
    let law = Hand::default();
    let numbers = HandNumbers {
        inertia_kg_m2: law.inertia_kg_m2,
        stiffness_nm_per_rad: law.stiffness_nm_per_rad,
        damping_nms_per_rad: law.damping_nms_per_rad,
        limit_nm: law.limit_nm,
    };
    let listed = [Listed {
        effect: &limb::EFFECT,
        given: limb(),
    }];
    let mut plant = assemble(&listed, &context(), false).expect("a limb alone");
    plant.hold_by(|chain| Box::new(GuidingHand::new(numbers, Body::default(), chain)));
    let mut path = HandPath::taking(HandState::default());
    let mut leg = Leg::straight(&RangeSettings::default());
    let (mut farthest_rad, mut most_lag_rad) = (0.0_f64, 0.0_f64);
    for (target_rad, resistance_nm) in [(1.6, 0.0), (0.2, 3.0), (1.2, -2.0)] {
        path.aim(target_rad);
        for _ in 0..8_000 {
            let from = body(path.state());
            leg.step(resistance_nm, Some(&mut path));
            let to = body(path.state());
            plant.command(resistance_nm, 0.0);
            plant.advance(&MotionStep {
                length_s: TICK_S,
                from,
                to,
            });
            let off_rad = leg.angle_rad() - plant.leg().angle_rad;
            farthest_rad = farthest_rad.max(off_rad.abs());
            most_lag_rad = most_lag_rad.max((to.angle_rad - leg.angle_rad()).abs());
        }
    }
    assert!(farthest_rad < 2e-3, "{farthest_rad}");
    assert!(most_lag_rad > 0.1, "{most_lag_rad}");
}

/// A leg that is let go, from extension on: the hand's column has the true angle.
#[test]
fn counts_are_those_of_the_plants_encoder() {
    let encoder = Encoder::new(&EncoderSettings::default());
    let mut page = Box::new(Page::new());
    page.begin().expect("the defaults are valid");
    page.hand((-9_f32).to_radians(), true);
    for _ in 0..20 {
        page.advance(1_000);
    }
    page.hand(0.0, false);
    let (mut negative, mut off) = (0, 0);
    for _ in 0..10 {
        page.advance(1_000);
        let columns = page.columns();
        let rows = columns.hand_rad.iter().zip(&columns.angle_rad);
        for (leg_rad, counted_rad) in rows.take(1_000) {
            let count = encoder.count(f64::from(*leg_rad));
            let counted = f64::from(*counted_rad) / encoder.rad_per_count();
            // In f32 an angle close to the edge of a count may be on its other side.
            off += u32::from(counted.round() != f64::from(count));
            negative += u32::from(*leg_rad < 0.0);
        }
    }
    assert!(negative > 1_000 && off < 100, "{negative} {off}");
}

#[test]
fn a_healthy_knee_is_a_device_without_a_preset() {
    let healthy = with_preset(&Values::default(), &Preset::default(), false);
    assert_eq!(pipeline::healthy(), healthy);
}
