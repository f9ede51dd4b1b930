//! The examiner of a simulated device shows what every preset promises: both controllers, with a leg.

mod support;

use crepitus_knee::Examination;
use crepitus_knee::examination::{Finding, Measure, Outcome, Rule, Step};
use crepitus_model::render::effects::spasticity::SpasticitySettings;
use crepitus_protocol::{DeviceSettings, Fault, TICK_S, Values};
use crepitus_scene::preset::{self, Disorder, Preset};
use crepitus_scene::values::with_preset;
use crepitus_scene::{Scene, shipped};
use crepitus_virtual_device::Start;
use std::thread;
use support::Host;

/// A torque that a hand tells from none, N·m.
const FELT_NM: f64 = 0.25;

/// A rough or rigid knee that moves: the least of all, N·m.
const ROUGH_NM: f64 = 0.05;

/// Time of the longest plan, s: three stretches. In the shortest there is time for an overload.
const LONGEST_S: f64 = 24.0;
const SHORTEST_S: f64 = 8.0;

/// Time of the plan of a blind trial, and of the way to it, s.
const BLIND_S: f64 = 43.0;

/// An examination by the examiner.
struct Examined {
    examination: Examination,
    /// Time, angle, velocity and torque of each tick, s, rad, rad/s, N·m.
    samples: Vec<[f64; 4]>,
    /// Faults of drive and comms at the end.
    faults: (Option<Fault>, Option<Fault>),
}

/// The examiner's knee, straight until the device is armed.
fn scene() -> Scene {
    Scene {
        begins_straight: true,
        ..shipped::examination().expect("it ships")
    }
}

/// Examines a knee until all of its signs were shown, and four seconds more; in a blind trial for its whole plan.
fn examined(preset: &Preset, is_blind: bool) -> Examined {
    let mut host = Host::new(&scene(), &Start::default());
    host.run(400);
    host.device.board().leg().hand().set_blind(is_blind);
    host.commit(|values| *values = with_preset(values, preset, false))
        .expect("a commit");
    host.arm();
    let values = with_preset(&Values::default(), preset, false);
    let settings = DeviceSettings::of(&values).expect("a preset's values");
    let grates = settings.crepitus.is_some();
    let mut found = Examined {
        examination: Examination::new(&settings.effects, grates),
        samples: Vec::new(),
        faults: (None, None),
    };
    let mut shown_for_s = 0.0;
    for tick in 0_u32.. {
        host.tick();
        let board = host.device.board();
        let (leg, rendered) = (board.leg().leg(), board.drive().rendered());
        let time_s = f64::from(tick) * TICK_S;
        let nm = f64::from(rendered.unwrap_or_default().model_torque_nm);
        let (at_rad, rad_s) = (leg.angle_rad, leg.omega_rad_s);
        found.examination.take(time_s, at_rad, rad_s, nm);
        found.samples.push([time_s, at_rad, rad_s, nm]);
        let mut findings = found.examination.findings();
        if findings.all(|finding| finding.outcome == Outcome::Shown) {
            shown_for_s += TICK_S;
        }
        let is_over = if is_blind {
            time_s >= BLIND_S
        } else {
            (shown_for_s >= 4.0 && time_s >= SHORTEST_S) || time_s >= LONGEST_S
        };
        found.faults = (board.drive().fault(), board.comms().fault());
        if is_over || found.faults != (None, None) {
            break;
        }
    }
    found
}

/// Returns whether a sign has its torque where it is expected.
fn has_torque(examined: &Examined, finding: &Finding) -> bool {
    let sense = finding.sign.sense;
    let degrees = |rad: f64| sense * rad.to_degrees();
    let mut samples = examined.samples.iter();
    match finding.sign.rule {
        Rule::Move { .. } => samples.any(|s| s[2].abs() > 0.1 && s[3].abs() >= ROUGH_NM),
        // In the wall, or where the resistance has built up.
        Rule::Reach { angle_deg } => samples.any(|s| {
            let beyond = degrees(s[1]) - sense * angle_deg;
            (-2.0..6.0).contains(&beyond) && sense * s[3] >= FELT_NM
        }),
        // Where the threshold is at that speed, or as late as a reflex answers.
        Rule::Stretch {
            threshold_deg,
            shift_s,
            ..
        } => samples.any(|s| {
            let late_deg = 0.1 * degrees(s[2]).max(0.0);
            let beyond = degrees(s[1]) - sense * threshold_deg + shift_s * degrees(s[2]);
            beyond >= -3.0 - late_deg && sense * s[3] >= FELT_NM
        }),
        Rule::Hold { angle_deg, .. } => samples.any(|s| {
            let beyond = degrees(s[1]) - sense * angle_deg;
            beyond > 0.0 && sense * s[3] >= FELT_NM
        }),
    }
}

/// Asserts that the movements were made that show this knee's signs, and that each has its torque.
fn shows_its_signs(preset: &Preset, examined: &Examined) {
    let name = &preset.name;
    let end_s = examined.samples.last().map(|sample| sample[0]);
    assert_eq!(examined.faults, (None, None), "{name} at {end_s:?} s");
    let findings: Vec<Finding> = examined.examination.findings().collect();
    assert!(!findings.is_empty(), "{name} has no sign");
    // What is empty has no torque by its definition.
    let is_empty = name == "end-feel-empty";
    for finding in &findings {
        assert_eq!(finding.outcome, Outcome::Shown, "{name}: {finding:?}");
        let has_torque = has_torque(examined, finding);
        assert_ne!(has_torque, is_empty, "{name}: {finding:?}");
    }
}

/// Asserts that the measures are those of its parameters.
fn is_measured(preset: &Preset, examined: &Examined) {
    let name = &preset.name;
    let measure = |measure| examined.examination.measure(measure);
    let effects = preset.effect_settings();
    if let Some(limit) = effects.range_limit
        && limit.extension_torque_nm > 1.0
    {
        // 0.8 N·m within.
        let off = measure(Measure::Deficit).expect(name) - limit.extension_limit_deg;
        assert!((-3.0..1.0).contains(&off), "{name}: {off}");
    }
    if let Some(muscle) = effects.spasticity.filter(SpasticitySettings::catches) {
        let caught = measure(Measure::Catch).expect(name);
        assert!(caught < muscle.threshold_deg, "{name}: {caught}");
        let end = measure(Measure::SlowEnd).expect(name);
        assert!((end - 100.0).abs() < 1.0, "{name}: {end}");
        assert!(measure(Measure::Dynamic).expect(name) > 0.0, "{name}");
    }
    if preset.disorder == Some(Disorder::Clonus) {
        assert!(measure(Measure::Beats).expect(name) >= 8.0, "{name}");
        let rate = measure(Measure::BeatRate).expect(name);
        assert!((5.0..6.5).contains(&rate), "{name}: {rate}");
        assert!(examined.examination.has_done(Step::Hold), "{name}");
    }
    if preset.disorder == Some(Disorder::Rigidity) {
        assert_eq!(measure(Measure::Catch), None, "{name}");
    }
}

/// All presets that ship, on as many threads as there are processors.
#[test]
fn every_preset_shows_its_signs_and_none_is_an_overload() {
    let threads = thread::available_parallelism().map_or(2, usize::from);
    thread::scope(|scope| {
        for nth in 0..threads {
            let own = preset::shipped().iter().skip(nth).step_by(threads);
            scope.spawn(move || {
                for preset in own {
                    let examined = examined(preset, false);
                    shows_its_signs(preset, &examined);
                    is_measured(preset, &examined);
                }
            });
        }
    });
}

/// Those that load gear and motor most: by their height, by the angle at which they are held, until they give way.
#[test]
fn a_blind_trial_shows_the_signs_of_the_stiffest_knees_without_an_overload() {
    thread::scope(|scope| {
        for name in ["mas-4-lead-pipe", "mas-3-reflex", "clasp-knife-severe"] {
            scope.spawn(move || {
                let preset = preset::find(name).expect("it ships");
                shows_its_signs(preset, &examined(preset, true));
            });
        }
    });
}

/// The baseline: whatever the examiner does, a healthy knee has no torque.
#[test]
fn a_healthy_knee_has_nothing_to_show() {
    let healthy = Preset::default();
    let examined = examined(&healthy, false);
    assert_eq!(examined.faults, (None, None));
    assert!(examined.samples.iter().all(|sample| sample[3] == 0.0));
    for measure in [Measure::Catch, Measure::Beats] {
        assert_eq!(examined.examination.measure(measure), None);
    }
}
