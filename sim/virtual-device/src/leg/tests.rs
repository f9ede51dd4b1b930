//! The leg against closed forms, and its faults.

mod by_hand;

use super::*;
use crepitus_plant::effects::motor::bridge::DIODE_V;
use crepitus_scene::Overrides;
use std::path::Path;
use std::time::Instant;

const OHM: f64 = 1.23;
const TAU_S: f64 = 0.34e-3 / OHM;
/// Kt·N with the defaults, N·m/A.
const CONSTANT: f64 = 0.0389 * 86.0;
/// Legs of all kinds.
const MECHANICS: [&[&str]; 7] = [
    &[],
    &["drivetrain"],
    &["drivetrain", "backlash"],
    &["drivetrain", "backlash", "cuff"],
    &["drivetrain", "backlash", "cuff", "hand"],
    &["drivetrain", "cuff", "limb", "hand"],
    &["drivetrain", "backlash", "cuff", "limb", "hand"],
];

/// A scene with this motion and these effects at their defaults.
fn scene(motion: &str, effects: &[&str]) -> Scene {
    let tables: String = effects
        .iter()
        .map(|effect| ["[effects.", effect, "]\n"].concat())
        .collect();
    let text = format!(
        "version = 1\ntitle = \"leg\"\nduration_s = 2.0\n[motion]\n{motion}\n[solver]\n\
         kind = \"exact-events\"\nstep_s = 5e-5\n{tables}"
    );
    Scene::parse(Path::new("leg.toml"), &text, &Overrides::default()).expect("a valid scene")
}

fn leg(motion: &str, effects: &[&str]) -> Leg {
    Leg::new(&scene(motion, effects))
}

fn turning(omega_rad_s: f64) -> Leg {
    leg(
        &format!("kind = \"constant\"\nvelocity_rad_s = {omega_rad_s:?}"),
        &[],
    )
}

fn ticks(leg: &mut Leg, ticks: u32) {
    for _ in 0..ticks {
        leg.first_half();
        leg.second_half();
    }
}

/// A current that changes towards another one under a constant voltage.
fn after(from_a: f64, final_a: f64, seconds: f64) -> f64 {
    final_a + (from_a - final_a) * (-seconds / TAU_S).exp()
}

fn is_balanced(leg: &Leg) {
    let open = leg.balance().relative_residual();
    assert!(open.abs() < 1e-9, "{open:.1e} left over");
}

#[test]
fn it_can_live_in_a_thread() {
    fn is_send<T: Send + 'static>(_: &T) {}
    is_send(&turning(0.0));
}

#[test]
fn a_voltage_begins_when_it_is_set() {
    let mut leg = turning(0.0);
    leg.set_terminals(Terminals::Driven(5.0));
    leg.first_half();
    let half_a = leg.winding_current_a();
    leg.set_terminals(Terminals::Driven(-8.0));
    leg.second_half();
    let known = after(half_a, -8.0 / OHM, TICK_S / 2.0);
    assert!((leg.winding_current_a() - known).abs() < 1e-14);
}

/// One diode is all that a current of one sense meets.
#[test]
fn a_shorted_switch_brakes_one_way_until_the_stop_is_pressed() {
    for (omega, brakes) in [(1.5, true), (-1.5, false)] {
        let mut leg = turning(omega);
        leg.set_shorted_switch(Some(Sense::Negative));
        ticks(&mut leg, 400);
        let known = if brakes {
            -(CONSTANT * omega - DIODE_V) / OHM
        } else {
            0.0
        };
        assert!((leg.winding_current_a() - known).abs() < 1e-9);
        assert!((leg.felt_nm() + CONSTANT * known).abs() < 1e-8);
        is_balanced(&leg);
        // Without the supply alone it goes on.
        leg.set_supply(false);
        ticks(&mut leg, 400);
        assert!((leg.winding_current_a() - known).abs() < 1e-9);
        leg.press_stop(true);
        ticks(&mut leg, 1);
        assert_eq!((leg.winding_current_a(), leg.felt_nm()), (0.0, 0.0));
        is_balanced(&leg);
        leg.press_stop(false);
        leg.set_shorted_switch(None);
        ticks(&mut leg, 400);
        assert_eq!(leg.winding_current_a(), 0.0);
    }
}

#[test]
fn counts_follow_the_shaft_through_the_wrap() {
    let count_rad = scene("kind = \"constant\"\nvelocity_rad_s = 1", &["encoder"])
        .encoder
        .expect("listed")
        .rad_per_count();
    for omega in [1.0_f64, -1.0] {
        let mut leg = turning(omega);
        assert_eq!(leg.count(), 0);
        let first = if omega > 0.0 {
            i32::MAX - 100
        } else {
            i32::MIN + 100
        };
        leg.preset_count(first);
        for _ in 0..2000 {
            ticks(&mut leg, 1);
            let turned = leg.count().wrapping_sub(first);
            let known = leg.shaft().angle_rad / count_rad;
            assert!((f64::from(turned) - known).abs() <= 1.0);
        }
        assert_eq!(leg.count().signum(), -first.signum());
    }
}

#[test]
fn an_encoder_can_be_unplugged_and_rewired() {
    let mut leg = turning(1.0);
    ticks(&mut leg, 500);
    let before = leg.count();
    leg.set_encoder_wiring(EncoderWiring::Unplugged);
    ticks(&mut leg, 500);
    assert_eq!(leg.count(), before);
    leg.set_encoder_wiring(EncoderWiring::Swapped);
    ticks(&mut leg, 500);
    assert!((leg.count()).abs() <= 1, "back where it came from");
    leg.set_encoder_wiring(EncoderWiring::Right);
    ticks(&mut leg, 500);
    assert!((leg.count() - before).abs() <= 1);
}

#[test]
fn a_current_sensor_can_be_wrong() {
    let mut leg = turning(0.0);
    leg.set_terminals(Terminals::Driven(1.0));
    ticks(&mut leg, 400);
    let true_a = leg.winding_current_a();
    for (path, other) in [
        (CurrentPath::Sensor, CurrentPath::Monitor),
        (CurrentPath::Monitor, CurrentPath::Sensor),
    ] {
        for (sensor, shown_a) in [
            (CurrentSensor::Right, true_a),
            (CurrentSensor::Offset(-0.2), true_a - 0.2),
            (CurrentSensor::Gain(0.5), 0.5 * true_a),
            (CurrentSensor::StuckAt(0.05), 0.05),
        ] {
            leg.set_current_sensor(path, sensor);
            assert_eq!(leg.current_a(path), shown_a);
            assert_eq!(leg.current_a(other), true_a);
        }
        leg.set_current_sensor(path, CurrentSensor::Right);
    }
    assert_eq!(leg.winding_current_a(), true_a);
}

#[test]
fn without_a_supply_the_terminals_are_open() {
    let mut leg = turning(1.0);
    leg.set_terminals(Terminals::Driven(12.0));
    ticks(&mut leg, 100);
    leg.set_supply(false);
    ticks(&mut leg, 2);
    leg.set_terminals(Terminals::Driven(-12.0));
    ticks(&mut leg, 1);
    assert_eq!((leg.supply_v(), leg.motor_nm()), (0.0, 0.0));
    // When it comes back the bridge follows the command that it was given meanwhile.
    leg.set_supply(true);
    ticks(&mut leg, 200);
    assert!((leg.winding_current_a() - (-12.0 - CONSTANT) / OHM).abs() < 1e-7);
    is_balanced(&leg);
}

#[test]
fn a_motion_that_ends_rests() {
    let knots = "kind = \"velocity-knots\"\nknots = [{ t_s = 0, omega_rad_s = 0.5 }]";
    let mut leg = leg(knots, &["motor"]);
    ticks(&mut leg, 41_900);
    assert!((leg.shaft().omega_rad_s - 0.5 * 0.05).abs() < 1e-9);
    ticks(&mut leg, 10_000);
    assert_eq!(leg.shaft().omega_rad_s, 0.0);
    assert!((leg.shaft().angle_rad - 1.025).abs() < 1e-12);
    assert!((leg.time_s() - 2.595).abs() < 1e-12);
}

/// Ticks from the first drive to the motion at 20°: 0.1 s, and a stroke of 1.25 s.
const LED_TICKS: u32 = 27_000;

#[test]
fn a_leg_that_begins_straight_is_led_to_the_motion_once_the_motor_is_driven() {
    for effects in [&[][..], &["drivetrain", "cuff"]] {
        let plain = scene(STROKES, effects);
        let mut led = Leg::new(&Scene {
            begins_straight: true,
            ..plain.clone()
        });
        ticks(&mut led, 5_000);
        assert!(led.shaft().angle_rad.abs() < 1e-12 && led.count() == 0);
        // As arming pushes, and again without a drive.
        led.set_terminals(Terminals::Driven(0.1));
        ticks(&mut led, 320);
        led.set_terminals(Terminals::Open);
        ticks(&mut led, 3_000);
        assert!(led.leg().angle_rad.abs() < 1e-12);
        led.set_terminals(Terminals::Driven(0.0));
        let mut before_rad = led.leg().angle_rad;
        for n in 0..LED_TICKS {
            // What was begun goes on without a drive, too.
            if n == 3_000 {
                led.set_terminals(Terminals::Open);
            }
            ticks(&mut led, 1);
            let speed_rad_s = (led.leg().angle_rad - before_rad) / TICK_S;
            assert!(
                (-1e-6..30_f64.to_radians() + 1e-6).contains(&speed_rad_s),
                "tick {n}: {speed_rad_s}"
            );
            before_rad = led.leg().angle_rad;
        }
        assert!((before_rad - 20_f64.to_radians()).abs() < 1e-12);
        assert!(led.leg().omega_rad_s.abs() < 1e-12);
        // From here on the scene's motion, to the end of its first stroke.
        let mut plain = Leg::new(&plain);
        for _ in 0..40_000 {
            ticks(&mut led, 1);
            ticks(&mut plain, 1);
            let off_rad = led.leg().angle_rad - plain.leg().angle_rad;
            assert!(off_rad.abs() < 1e-12, "{off_rad}");
        }
        is_balanced(&led);
        let time_s = f64::from(5_000 + 320 + 3_000 + LED_TICKS + 40_000) * TICK_S;
        assert!((led.time_s() - time_s).abs() < 1e-9);
    }
}

#[test]
fn a_leg_that_begins_straight_and_in_motion_has_a_run_up() {
    let motion = "kind = \"constant\"\nfrom_deg = 20\nvelocity_rad_s = 1.5";
    let mut led = Leg::new(&Scene {
        begins_straight: true,
        ..scene(motion, &["drivetrain"])
    });
    led.set_terminals(Terminals::Driven(0.0));
    ticks(&mut led, 2_000);
    let (mut before_rad_s, mut reached) = (0.0, None);
    for n in 0..60_000 {
        ticks(&mut led, 1);
        let Body {
            angle_rad,
            omega_rad_s,
        } = led.shaft();
        // 15 rad/s² at most, where it begins to run.
        assert!(
            (omega_rad_s - before_rad_s).abs() < 16.0 * TICK_S,
            "tick {n}"
        );
        before_rad_s = omega_rad_s;
        if reached.is_none() && (omega_rad_s - 1.5).abs() < 1e-9 {
            reached = Some(angle_rad.to_degrees());
        }
    }
    let reached = reached.expect("its velocity");
    assert!((reached - 20.0).abs() < 0.01, "{reached}");
    assert!((led.shaft().omega_rad_s - 1.5).abs() < 1e-12);
    is_balanced(&led);
}

/// A motion from 0° is there already, and nobody leads a leg that is let go of.
#[test]
fn nothing_leads_where_there_is_no_way_or_nobody() {
    let motions = [
        ("kind = \"constant\"\nvelocity_rad_s = 0.5", &["motor"][..]),
        (
            "kind = \"released\"\nfrom_deg = 30",
            &["drivetrain", "limb"][..],
        ),
    ];
    for (motion, effects) in motions {
        let plain = scene(motion, effects);
        let mut straight = Leg::new(&Scene {
            begins_straight: true,
            ..plain.clone()
        });
        let mut plain = Leg::new(&plain);
        ticks(&mut straight, 10_000);
        ticks(&mut plain, 10_000);
        assert_eq!(straight.shaft(), plain.shaft());
        assert!(plain.shaft().omega_rad_s != 0.0);
    }
}

const STROKES: &str =
    "kind = \"strokes\"\nfrom_deg = 20\nto_deg = 80\npeak_speed_deg_s = 60\npause_s = 0.3";

/// A bridge that is switched without any sense, on all that a leg can have.
fn thrash(leg: &mut Leg, ticks: u32) {
    for n in 0..ticks {
        let volt = f64::from(n * 7919 % 61) - 30.0;
        leg.set_terminals(match n / 50 % 4 {
            0 => Terminals::Open,
            1 => Terminals::Driven(volt),
            2 => Terminals::Driven(0.3 * volt),
            _ => Terminals::Driven(4.0),
        });
        leg.first_half();
        if n % 97 == 0 {
            leg.set_terminals(Terminals::Open);
        }
        leg.second_half();
    }
}

#[test]
fn energy_is_kept_whatever_the_bridge_does() {
    for listed in MECHANICS {
        let mut leg = leg(STROKES, listed);
        thrash(&mut leg, 20_000);
        println!("{listed:?}: {:.1e}", leg.balance().relative_residual());
        is_balanced(&leg);
    }
}

#[test]
fn effects_of_the_device_leave_nothing_behind() {
    let mechanics = ["motor", "drivetrain", "cuff"];
    let device = [
        "crepitus",
        "encoder",
        "friction-compensation",
        "bone-shaping",
    ];
    let all: Vec<_> = device.into_iter().chain(mechanics).collect();
    let (mut bare, mut full) = (leg(STROKES, &mechanics), leg(STROKES, &all));
    for _ in 0..10 {
        thrash(&mut bare, 200);
        thrash(&mut full, 200);
        assert_eq!(bare.shaft(), full.shaft());
        assert_eq!(bare.winding_current_a(), full.winding_current_a());
    }
    assert_eq!(bare.balance(), full.balance());
}

/// Fast enough to be served in real time by any machine.
#[test]
fn it_is_faster_than_real_time() {
    for listed in MECHANICS {
        let mut leg = leg(STROKES, listed);
        let begun = Instant::now();
        thrash(&mut leg, 20_000);
        let ratio = leg.time_s() / begun.elapsed().as_secs_f64();
        println!("{listed:?}: {ratio:.0} times real time");
        assert!(ratio > 2.0, "{listed:?}: {ratio}");
    }
}
