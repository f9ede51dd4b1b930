//! Tests of the actuator on the shell: what the hand gets of it.

use crepitus_plant::plant::Coil;
use crepitus_scene::{Overrides, Scene, Walk};
use crepitus_studies::vibration::{AtSpeed, Measured, Plan, Step, VibrationError, run};
use crepitus_studies::{Cancelled, Watcher};
use std::path::Path;

struct Patient;

impl Watcher for Patient {
    fn progress(&mut self, _: f64) -> Result<(), Cancelled> {
        Ok(())
    }
}

/// The shipped scene at a speed over 1.4 rad, but 4 s at most, as `crepitus vibration` runs it.
fn scene(speed: f64, set: &[(&str, &str)]) -> Scene {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/fig8-6-actuator.toml");
    let own = [
        ("motion.velocity_rad_s", format!("{speed:?}")),
        ("motion.from_deg", "20.0".to_owned()),
        ("duration_s", format!("{:?}", (1.4 / speed).min(4.0))),
    ];
    let own = own.into_iter().map(|(key, value)| (key.to_owned(), value));
    let set = set
        .iter()
        .map(|(key, value)| ((*key).to_owned(), (*value).to_owned()));
    let overrides = Overrides {
        set: own.chain(set).collect(),
        ..Overrides::default()
    };
    Scene::read(&file, &overrides).expect("it is allowed")
}

fn at(speed: f64, set: &[(&str, &str)], draws: usize) -> AtSpeed {
    let plan = Plan {
        scenes: vec![scene(speed, set)],
        draws,
    };
    let mut study = run(&plan, &mut Patient).expect("it has all that is needed");
    study.speeds.remove(0)
}

fn of(speed: &AtSpeed, step: Step) -> Measured {
    let row = speed
        .rows
        .iter()
        .find(|row| row.step == step)
        .expect("a row");
    row.measured.unwrap_or_else(|| panic!("{:?}", row.failure))
}

#[test]
fn the_actuator_brings_what_the_motor_alone_does_not() {
    for (speed, share, correlation, more_db) in [
        (0.1, 0.85, 0.55, 15.0),
        (0.5, 0.9, 0.9, 35.0),
        (1.0, 0.9, 0.9, 35.0),
    ] {
        let found = at(speed, &[], 0);
        // The book's row of levels, in the order of the steps.
        let levels =
            Step::ALL.map(|step| format!("{:+.0}", of(&found, step).level_db).replace('-', "−"));
        let row = format!("| | level, dB | {} |", levels.join(" | "));
        assert!(
            include_str!("../../../docs/vibration.md").contains(&row),
            "{row}"
        );
        let actuator = of(&found, Step::Actuator);
        let alone = of(&found, Step::MotorAlone);
        assert!(actuator.share.unwrap() >= share, "{speed}: {actuator:?}");
        assert!(alone.share.unwrap().abs() < 1e-2, "{speed}: {alone:?}");
        assert!(
            actuator.level_db > alone.level_db + more_db,
            "{speed}: {alone:?}"
        );
        let like = actuator.likeness.unwrap();
        assert!(like.correlation >= correlation, "{speed}: {like:?}");
        assert!(like.lag_s.abs() <= 5e-4, "{speed}: {like:?}");
        let coil = actuator.coil.unwrap();
        assert!(coil.power_w < 0.15 && coil.excursion_mm < 0.7, "{coil:?}");
        // Ringing is felt at every speed.
        assert!(of(&found, Step::Ringing).level_db > 25.0);
        // Where it is wrong, it does less.
        for wrong in [Step::OnBrace, Step::HandOnLeg] {
            let wrong = of(&found, wrong);
            assert!(
                wrong.level_db < actuator.level_db - 10.0,
                "{speed}: {wrong:?}"
            );
        }
        // A bare knee at the same gain of one is some 20 dB quieter.
        let bare = of(&found, Step::BareKnee);
        assert!((15.0..25.0).contains(&(actuator.level_db - bare.level_db)));
        assert_eq!((bare.share, bare.coil), (None, None));
        assert!(
            found
                .spectrum
                .iter()
                .any(|(_, [bare, alone, device])| device > bare && bare > alone)
        );
    }
}

/// Of the paper's device, which has no shell, the hand on the leg gets what a bare knee gives at low speed, and less than it
/// could feel at high speed; a soft cuff without compensation brings nothing at either.
#[test]
fn the_motor_alone_is_felt_at_low_speed_through_a_stiff_seat() {
    let soft = [
        ("effects.cuff.stiffness_nm_per_rad", "120.0"),
        ("effects.cuff.damping_nms_per_rad", "1.0"),
        ("effects.friction-compensation.share", "0.0"),
    ];
    let level = |speed, set| of(&at(speed, set, 0), Step::MotorOnLeg).level_db;
    let (slow, fast) = (level(0.1, &[][..]), level(1.0, &[]));
    println!("on the leg: {slow:.1} dB at 0.1 rad/s, {fast:.1} dB at 1 rad/s");
    let (slow_soft, fast_soft) = (level(0.1, &soft[..]), level(1.0, &soft));
    println!("through a soft cuff: {slow_soft:.1} dB and {fast_soft:.1} dB");
    assert!(slow > 0.0 && fast < 0.0, "{slow} {fast}");
    assert!(
        slow_soft < -10.0 && fast_soft < -20.0,
        "{slow_soft} {fast_soft}"
    );
}

#[test]
fn without_the_gears_friction_it_is_as_alike_as_was_estimated() {
    // The estimate was linear, of a soft cuff: 0.82 at 0.1 rad/s.
    let soft = |friction| {
        let set = [
            ("effects.drivetrain.friction_nm", friction),
            ("effects.friction-compensation.share", "0.0"),
            ("effects.crepitus.restart", "\"elastic\""),
            ("effects.cuff.stiffness_nm_per_rad", "120.0"),
            ("effects.cuff.damping_nms_per_rad", "1.0"),
        ];
        of(&at(0.1, &set, 0), Step::Actuator).likeness.unwrap()
    };
    let like = soft("0.0");
    assert!((0.79..0.9).contains(&like.correlation), "{like:?}");
    // With it, less: the friction is what is missing.
    let with_friction = soft("0.5");
    assert!(
        with_friction.correlation < like.correlation - 0.02,
        "{with_friction:?}"
    );
}

#[test]
fn with_everything_off_it_stays_within_a_factor() {
    let draws = at(0.5, &[], 40).draws.expect("draws");
    let [low, middle, high] = draws.level;
    assert_eq!(draws.count, 40);
    assert!(
        low > 0.55 && high < 1.75 && (0.85..1.15).contains(&middle),
        "{draws}"
    );
    assert!(draws.within >= 0.9, "{draws}");
    assert!(draws.least_correlation > 0.85, "{draws}");
}

#[test]
fn a_gain_of_a_tenth_is_a_bare_knee() {
    let found = at(0.5, &[("effects.vibration-actuator.gain", "0.09")], 0);
    let (bare, device) = (of(&found, Step::BareKnee), of(&found, Step::Actuator));
    assert!(
        (device.level_db - bare.level_db).abs() < 2.0,
        "{bare:?} {device:?}"
    );
}

#[test]
fn what_is_missing_is_named() {
    let mut scene = scene(0.5, &[]);
    scene.listed.retain(|listed| listed.effect.name != "shell");
    let plan = Plan {
        scenes: vec![scene],
        draws: 0,
    };
    let refused = run(&plan, &mut Patient).expect_err("no shell");
    assert!(matches!(
        refused,
        VibrationError::Missing {
            missing: "shell",
            ..
        }
    ));
}

/// Swing of the shaft over the first and over the last part of a run in which the joint
/// sticks and nobody holds the leg on its stiff cuff: with the whole device's filters, this much more
/// force of the coil than they believe, a gear like this, a cuff like this, and everything so many ticks late.
fn swings(stronger: f64, gear: &str, cuff: &str, late_ticks: usize) -> (f64, f64) {
    use crepitus_model::parameters::Tabled;
    use crepitus_model::render::effects::vibration_actuator::{
        VibrationActuator, VibrationActuatorSettings,
    };
    use crepitus_model::render::effects::{DeviceEffect, Timing};
    use crepitus_model::render::position::Sensing;
    let text = "version = 1\ntitle = \"loop\"\nduration_s = 1.0\n[motion]\nkind = \"released\"\nfrom_deg = 90.02\n\
                [solver]\nkind = \"exact-events\"\nstep_s = 5e-5\n[effects.drivetrain]\nGEAR\n[effects.cuff]\nCUFF\n[effects.limb]\npassive = \"none\"\n\
                [effects.shell]\n[effects.reaction-mass]\n";
    let text = text.replace("GEAR", gear).replace("CUFF", cuff);
    let has_friction = gear.contains("backlash");
    let scene =
        Scene::parse(Path::new("loop.toml"), &text, &Overrides::default()).expect("allowed");
    let mut plant = scene.assemble().expect("in range");
    let mut walk = Walk::new(&scene.motion, 5e-5);
    let settings = VibrationActuatorSettings {
        gain: 1.0,
        ..VibrationActuatorSettings::defaults()
    };
    let timing = Timing {
        step_s: 5e-5,
        delay_ticks: 1,
        sensing: Sensing::IDEAL,
    };
    let mut law = VibrationActuator::<f64>::new(
        VibrationActuator::<f64>::coefficients(&settings, &timing).expect("in range"),
    );
    let start = plant.shaft().angle_rad;
    // 0.21 ms of lag on the motor's way are four ticks here.
    let mut late = vec![0.0; 5 + late_ticks];
    let mut late_v = vec![0.0; 1 + late_ticks];
    let (mut coil_v, mut first, mut last) = (0.0, 0.0_f64, 0.0_f64);
    for n in 0..40_000 {
        let torque_nm = 400.0 * (plant.shaft().angle_rad - start);
        late.rotate_left(1);
        late[4 + late_ticks] = torque_nm;
        late_v.rotate_left(1);
        late_v[late_ticks] = coil_v;
        // A push of 5 ms, so that a gear with friction moves, too.
        let is_pushed = has_friction && (1_000..1_100).contains(&n);
        let push_nm = if is_pushed { 2.0 } else { 0.0 };
        plant.command(late[0] + push_nm, 0.0);
        plant.set_coil(Coil::Driven(stronger * late_v[0]));
        coil_v = law.tick(torque_nm, true);
        walk.advance(&mut plant);
        let swing = plant.shaft().omega_rad_s.abs();
        match n {
            1_100..6_000 if has_friction => first = first.max(swing),
            6_000..12_000 if !has_friction => first = first.max(swing),
            34_000.. => last = last.max(swing),
            _ => {}
        }
    }
    (first, last)
}

/// A device that believes in half the force commands twice the voltage.
#[test]
fn margins_are_of_what_the_device_believes() {
    use crepitus_studies::vibration::loop_gain::margins;
    let right = margins(&scene(0.5, &[]));
    let key = "effects.vibration-actuator.force_constant_n_per_a";
    let wrong = margins(&scene(0.5, &[(key, "0.55")]));
    for (right, wrong) in right.iter().zip(&wrong) {
        assert!(
            (wrong.largest / right.largest - 2.0).abs() < 1e-9,
            "{wrong:?}"
        );
        assert!(
            (wrong.stable_to / right.stable_to - 0.5).abs() < 1e-9,
            "{wrong:?}"
        );
    }
}

#[test]
fn the_loop_oscillates_where_its_margin_ends() {
    use crepitus_studies::vibration::loop_gain::{STIFF_NM_PER_RAD, margins};
    let margins = margins(&scene(0.5, &[]));
    let worst = margins
        .iter()
        .find(|m| m.hand == "nobody" && m.cuff_nm_per_rad == 300.0 && m.late_ticks == 0)
        .expect("it is listed");
    println!("worst loop: {worst:?}");
    assert!((1.9..2.6).contains(&worst.stable_to), "{worst:?}");
    let free = "friction_nm = 0.0\nload_loss = 0.0";
    let cuff = "stiffness_nm_per_rad = 300.0";
    let (first, last) = swings(0.85 * worst.stable_to, free, cuff, 0);
    assert!(last < first, "within: {first} {last}");
    let (first, last) = swings(1.25 * worst.stable_to, free, cuff, 0);
    assert!(last > first, "beyond: {first} {last}");
    // A fifth of the gear's friction and its backlash keep it quiet beyond gain 2.5, and at 2 four
    // ticks late.
    let gear = "friction_nm = 0.1\n[effects.backlash]";
    for (gain, late_ticks) in [(2.6, 0), (2.0, 4)] {
        let (first, last) = swings(gain, gear, cuff, late_ticks);
        println!("gain {gain}, {late_ticks} ticks late, with friction: {first:e} {last:e} rad/s");
        assert!(
            first > 0.05 && last < 1e-3 * first,
            "{gain}: {first} {last}"
        );
    }
    // On every soft cuff gain 2 is stable, also four ticks late, and on the stiff seat in every hand.
    for margin in &margins {
        let is_stiff = margin.cuff_nm_per_rad == STIFF_NM_PER_RAD;
        if is_stiff && margin.hand == "nobody" {
            // What is left of the gear's friction keeps it quiet, see below.
            assert!(margin.stable_to < 1.0, "{margin:?}");
            continue;
        }
        assert!(margin.stable_to > 2.0, "{margin:?}");
        let is_held = !is_stiff && (margin.hand != "nobody" || margin.cuff_nm_per_rad < 300.0);
        assert!(!is_held || margin.largest < 0.4, "{margin:?}");
        assert!(!is_held || margin.stable_to > 2.5, "{margin:?}");
    }
}

/// On the paper's seat with nobody at the shell a leg swings on the joint's stick without any damping: there what a
/// compensation leaves of the gear's friction decides.
#[test]
fn on_a_stiff_seat_what_is_left_of_the_friction_keeps_the_loop_quiet() {
    let cuff = "stiffness_nm_per_rad = 2e4\ndamping_nms_per_rad = 10.0";
    let gear = "friction_nm = 0.1\n[effects.backlash]";
    for (gain, late_ticks) in [(1.0, 0), (1.0, 4)] {
        let (first, last) = swings(gain, gear, cuff, late_ticks);
        println!("gain {gain}, {late_ticks} ticks late: {first:e} {last:e} rad/s");
        assert!(
            first > 0.05 && last < 1e-3 * first,
            "{gain}: {first} {last}"
        );
    }
}
