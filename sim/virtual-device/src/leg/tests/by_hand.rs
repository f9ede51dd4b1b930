//! A leg that a hand takes from the scene's motion, moves and gives back.

use super::*;
use crepitus_knee::Hand;
use crepitus_knee::hand::MOST_RAD_S;
use crepitus_scene::{preset, shipped};

/// Largest change of the leg's velocity in a tick, rad/s: 50 N·m on the arm alone would be 0.037.
const MOST_CHANGE_RAD_S: f64 = 0.04;

/// Runs ticks; returns the largest change of the leg's velocity in one.
fn largest_change(leg: &mut Leg, count: u32) -> f64 {
    let (mut before, mut most) = (leg.leg(), 0.0_f64);
    for _ in 0..count {
        ticks(leg, 1);
        let now = leg.leg();
        let moved_rad = (now.angle_rad - before.angle_rad).abs();
        let fastest = now.omega_rad_s.abs().max(before.omega_rad_s.abs());
        assert!(moved_rad <= TICK_S * (fastest + MOST_CHANGE_RAD_S));
        most = most.max((now.omega_rad_s - before.omega_rad_s).abs());
        before = now;
    }
    most
}

/// Legs without a gap: what meets at its end jumps by itself.
fn smooth() -> impl Iterator<Item = &'static [&'static str]> {
    let all = MECHANICS.into_iter();
    all.filter(|listed| !listed.contains(&"backlash"))
}

#[test]
fn a_hand_takes_a_moving_leg_without_a_jump_and_moves_it() {
    for listed in smooth() {
        let mut leg = leg(STROKES, listed);
        let hand = leg.hand();
        ticks(&mut leg, 20_000);
        assert_eq!(hand.hand_rad(), None);
        let before = leg.leg();
        assert!(before.omega_rad_s > 0.5, "in the middle of a stroke");
        hand.aim(1.0);
        let most = largest_change(&mut leg, 60_000);
        assert!(most < MOST_CHANGE_RAD_S, "{listed:?}: {most}");
        assert!((hand.hand_rad().expect("it has the leg") - 1.0).abs() < 1e-9);
        // The gear's friction is 0.5 N·m.
        let off_rad = leg.leg().angle_rad - 1.0;
        assert!(off_rad.abs() < 0.02, "{listed:?}: {off_rad}");
        assert_eq!(hand.shaft_rad(), leg.shaft().angle_rad);
        let time_s = 80_000.0 * TICK_S;
        assert!((leg.time_s() - time_s).abs() < 1e-9);
        is_balanced(&leg);
    }
}

#[test]
fn a_hand_takes_a_moving_leg_with_its_speed() {
    let mut leg = leg(STROKES, &[]);
    let hand = leg.hand();
    ticks(&mut leg, 20_000);
    let before = leg.leg();
    hand.aim(before.angle_rad);
    ticks(&mut leg, 1);
    let taken_rad = hand.hand_rad().expect("it has the leg");
    ticks(&mut leg, 1);
    let moved_rad = hand.hand_rad().expect("it has the leg") - taken_rad;
    let share = moved_rad / (TICK_S * before.omega_rad_s);
    assert!((share - 1.0).abs() < 0.1, "{share}");
}

/// 1 V on the winding at rest is 2.7 N·m.
#[test]
fn what_resists_is_seen_as_a_lag() {
    let mut leg = leg(STROKES, &["motor"]);
    let hand = leg.hand();
    hand.aim(0.8);
    ticks(&mut leg, 1);
    leg.set_terminals(Terminals::Driven(-1.0));
    ticks(&mut leg, 140_000);
    let resists_nm = CONSTANT / OHM;
    let lag_rad = 0.8 - leg.leg().angle_rad;
    let known_rad = resists_nm / Hand::default().stiffness_nm_per_rad;
    assert!((lag_rad - known_rad).abs() < 1e-5, "{lag_rad}");
    let pull_nm = Hand::default().torque_nm(lag_rad, 0.0);
    let felt_nm = leg.felt_nm();
    assert!((felt_nm - pull_nm).abs() < 1e-4, "{felt_nm}");
    is_balanced(&leg);
}

#[test]
fn a_leg_that_is_given_back_is_led_to_the_motion_without_a_jump() {
    for listed in [
        &[][..],
        &["drivetrain", "cuff"],
        &["drivetrain", "cuff", "limb", "hand"],
    ] {
        let mut leg = leg(STROKES, listed);
        let hand = leg.hand();
        hand.aim(1.6);
        // On its way, at full speed.
        ticks(&mut leg, 4_000);
        assert!(leg.leg().omega_rad_s > 2.0, "{listed:?}");
        hand.release();
        let most = largest_change(&mut leg, 1);
        assert!(most < MOST_CHANGE_RAD_S, "{listed:?}: {most}");
        assert_eq!(hand.hand_rad(), None);
        let most = largest_change(&mut leg, 120_000);
        assert!(most < MOST_CHANGE_RAD_S, "{listed:?}: {most}");
        // The strokes go on, from 20° to 80°.
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for _ in 0..90_000 {
            ticks(&mut leg, 1);
            low = low.min(leg.leg().angle_rad);
            high = high.max(leg.leg().angle_rad);
        }
        assert!((low.to_degrees() - 20.0).abs() < 5.0, "{low}");
        assert!((high.to_degrees() - 80.0).abs() < 5.0, "{high}");
        is_balanced(&leg);
    }
}

#[test]
fn a_hand_that_takes_the_leg_again_on_its_way_back_has_it() {
    let mut leg = leg(STROKES, &["drivetrain"]);
    let hand = leg.hand();
    hand.aim(1.2);
    ticks(&mut leg, 20_000);
    hand.release();
    ticks(&mut leg, 4_000);
    hand.aim(1.2);
    ticks(&mut leg, 40_000);
    assert!((leg.leg().angle_rad - 1.2).abs() < 0.02);
}

/// Nobody leads it back: it falls.
#[test]
fn a_leg_that_nobody_held_is_let_go_again() {
    let mut leg = leg("kind = \"released\"\nfrom_deg = 30", &["limb"]);
    let hand = leg.hand();
    hand.aim(0.5);
    ticks(&mut leg, 40_000);
    assert!((leg.leg().angle_rad - 0.5).abs() < 0.01);
    hand.release();
    ticks(&mut leg, 2_000);
    assert!(leg.leg().angle_rad > 0.55, "{:?}", leg.leg());
}

#[test]
fn its_energy_is_kept_whatever_bridge_and_hand_do() {
    for listed in MECHANICS {
        let mut leg = leg(STROKES, listed);
        let hand = leg.hand();
        let mut fastest = 0.0_f64;
        for n in 0..40_u32 {
            hand.aim(0.4 + f64::from(n * 7 % 10) / 10.0);
            thrash(&mut leg, 500);
            fastest = fastest.max(leg.leg().omega_rad_s.abs());
        }
        let open = leg.balance().relative_residual();
        println!("{listed:?}: {open:.1e}, up to {fastest:.1} rad/s");
        assert!(open.abs() < 1e-7, "{listed:?}: {open:.1e}");
        assert!(fastest < 3.0 * MOST_RAD_S, "{listed:?}: {fastest}");
    }
}

/// Degrees between which the leg moves in so many ticks.
fn ends_deg(leg: &mut Leg, count: u32) -> [f64; 2] {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for _ in 0..count {
        ticks(leg, 1);
        low = low.min(leg.leg().angle_rad);
        high = high.max(leg.leg().angle_rad);
    }
    [low, high].map(f64::to_degrees)
}

/// Also before the device is armed, and with the knee that it got meanwhile.
#[test]
fn an_examiner_goes_on_from_where_a_hand_has_left_the_leg() {
    let mut leg = Leg::new(&Scene {
        begins_straight: true,
        ..shipped::examination().expect("it ships")
    });
    let hand = leg.hand();
    ticks(&mut leg, 2_000);
    assert!(leg.leg().angle_rad.abs() < 1e-9, "straight until armed");
    hand.aim(1.0);
    ticks(&mut leg, 40_000);
    let held_rad = leg.leg().angle_rad;
    assert!((held_rad - 1.0).abs() < 0.1, "{held_rad}");
    hand.release();
    // It rests for 0.4 s.
    let most = largest_change(&mut leg, 7_900);
    assert!(most < MOST_CHANGE_RAD_S, "{most}");
    assert!((leg.leg().angle_rad - held_rad).abs() < 0.01);
    let [low, high] = ends_deg(&mut leg, 80_000);
    assert!(
        (low - 10.0).abs() < 0.1 && (high - 80.0).abs() < 0.1,
        "{low} to {high}"
    );
    hand.aim(0.5);
    ticks(&mut leg, 20_000);
    let clonus = preset::find("scats-3-clonus").expect("it ships");
    leg.examine(&clonus.effect_settings(), false);
    let [low, high] = ends_deg(&mut leg, 20_000);
    assert!(low > 22.0 && high < 35.0, "held: {low} to {high}");
    hand.release();
    let [_, high] = ends_deg(&mut leg, 60_000);
    assert!((high - 75.0).abs() < 0.1, "{high}");
}

/// Their motion is seen.
#[test]
fn in_a_blind_trial_all_knees_are_moved_alike() {
    let way = |name: &str| {
        let mut leg = Leg::new(&shipped::examination().expect("it ships"));
        leg.hand().set_blind(true);
        ticks(&mut leg, 100);
        let knee = preset::find(name).expect("it ships");
        leg.examine(&knee.effect_settings(), false);
        let next = |_: u32| {
            ticks(&mut leg, 2_000);
            leg.leg().angle_rad
        };
        (0..80).map(next).collect::<Vec<_>>()
    };
    assert_eq!(way("mas-4-lead-pipe"), way("scats-3-clonus"));
}
