//! Tests of the actuator on the shell: what the hand gets of it.

use crepitus_plant::plant::Coil;
use crepitus_scene::{Overrides, Scene, Walk};
use crepitus_study::vibration::{AtSpeed, Measured, Plan, Step, VibrationError, run};
use crepitus_study::{Cancelled, Watcher};
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
fn nine_tenths_of_the_ripple_arrive_where_the_motor_alone_brings_a_thousandth() {
    for (speed, correlation, most_lag_s) in
        [(0.1, 0.76, 5e-4), (0.5, 0.95, 5e-4), (1.0, 0.95, 5e-4)]
    {
        let found = at(speed, &[], 0);
        let actuator = of(&found, Step::Actuator);
        let alone = of(&found, Step::MotorAlone);
        assert!(actuator.share.unwrap() >= 0.9, "{speed}: {actuator:?}");
        assert!(alone.share.unwrap().abs() < 5e-3, "{speed}: {alone:?}");
        assert!(actuator.level_db > alone.level_db + 35.0);
        let like = actuator.likeness.unwrap();
        assert!(like.correlation >= correlation, "{speed}: {like:?}");
        assert!(like.lag_s.abs() <= most_lag_s, "{speed}: {like:?}");
        let coil = actuator.coil.unwrap();
        assert!(coil.power_w < 0.06 && coil.excursion_mm < 0.4, "{coil:?}");
        // Ringing is felt at every speed.
        assert!(of(&found, Step::Ringing).level_db > 25.0);
        // Where it is wrong, it does little.
        for wrong in [Step::OnBrace, Step::HandOnLeg] {
            let wrong = of(&found, wrong);
            assert!(wrong.share.unwrap() < 0.3, "{speed}: {wrong:?}");
            assert!(wrong.level_db < actuator.level_db - 20.0);
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

#[test]
fn without_the_gears_friction_it_is_what_was_estimated() {
    // The estimate was linear: 0.82 at 0.1 rad/s.
    let found = at(0.1, &[("effects.drivetrain.friction_nm", "0.0")], 0);
    let like = of(&found, Step::Actuator).likeness.unwrap();
    assert!((0.79..0.9).contains(&like.correlation), "{like:?}");
    // With it, less: the friction is what is missing.
    let found = at(0.1, &[], 0);
    let with_friction = of(&found, Step::Actuator).likeness.unwrap();
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
    assert!(draws.least_correlation > 0.95, "{draws}");
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
/// force of the coil than they believe, a gear like this, and everything so many ticks late.
fn swings(stronger: f64, gear: &str, late_ticks: usize) -> (f64, f64) {
    use crepitus_model::parameters::Tabled;
    use crepitus_model::render::effects::vibration_actuator::{
        VibrationActuator, VibrationActuatorSettings,
    };
    use crepitus_model::render::effects::{DeviceEffect, Timing};
    use crepitus_model::render::position::Sight;
    let text = "version = 1\ntitle = \"loop\"\nduration_s = 1.0\n[motion]\nkind = \"released\"\nfrom_deg = 90.02\n\
                [solver]\nkind = \"exact-events\"\nstep_s = 5e-5\n[effects.drivetrain]\nGEAR\n[effects.cuff]\nstiffness_nm_per_rad = 300.0\n[effects.limb]\npassive = \"none\"\n\
                [effects.shell]\n[effects.reaction-mass]\n";
    let text = text.replace("GEAR", gear);
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
        sight: Sight::IDEAL,
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
    use crepitus_study::vibration::loop_gain::margins;
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
    use crepitus_study::vibration::loop_gain::margins;
    let margins = margins(&scene(0.5, &[]));
    let worst = margins
        .iter()
        .find(|m| m.hand == "nobody" && m.cuff_nm_per_rad == 300.0 && m.late_ticks == 0)
        .expect("it is listed");
    println!("worst loop: {worst:?}");
    assert!((1.9..2.6).contains(&worst.stable_to), "{worst:?}");
    let free = "friction_nm = 0.0\nload_loss = 0.0";
    let (first, last) = swings(0.85 * worst.stable_to, free, 0);
    assert!(last < first, "within: {first} {last}");
    let (first, last) = swings(1.25 * worst.stable_to, free, 0);
    assert!(last > first, "beyond: {first} {last}");
    // A fifth of the gear's friction and its backlash keep it quiet beyond gain 2.5, and at 2 four
    // ticks late.
    let gear = "friction_nm = 0.1\n[effects.backlash]";
    for (gain, late_ticks) in [(2.6, 0), (2.0, 4)] {
        let (first, last) = swings(gain, gear, late_ticks);
        println!("gain {gain}, {late_ticks} ticks late, with friction: {first:e} {last:e} rad/s");
        assert!(
            first > 0.05 && last < 1e-3 * first,
            "{gain}: {first} {last}"
        );
    }
    // Over everything that is listed gain 2 is stable, also four ticks late.
    for margin in &margins {
        assert!(margin.stable_to > 2.0, "{margin:?}");
        let is_held = margin.hand != "nobody" || margin.cuff_nm_per_rad < 300.0;
        assert!(!is_held || margin.largest < 0.4, "{margin:?}");
        assert!(!is_held || margin.stable_to > 2.5, "{margin:?}");
    }
}
