//! Warnings of a run where a scene's numbers are not to be trusted: each warning
//! on both sides of its limit.

use crepitus_scene::run::{STRUCK_COLUMN, columns};
use crepitus_scene::{Observer, Overrides, Scene, Summary, run};
use std::convert::Infallible;
use std::path::Path;

/// Keeps one column.
struct Keep {
    place: usize,
    values: Vec<f64>,
}

impl Observer for Keep {
    type Error = Infallible;

    fn row(&mut self, values: &[f64]) -> Result<(), Infallible> {
        self.values.push(values[self.place]);
        Ok(())
    }
}

const STEADY: &str = "kind = \"constant\"\nvelocity_rad_s = 1.0";
const SWING: &str = "kind = \"sine\"\namplitude_deg = 5\nfrequency_hz = 2";

fn scene(duration_s: f64, motion: &str, step_s: f64, effects: &str) -> Scene {
    let text = format!(
        "version = 1\ntitle = \"test\"\nduration_s = {duration_s:?}\n[motion]\n{motion}\n\
         [solver]\nkind = \"exact-events\"\nstep_s = {step_s:?}\n{effects}"
    );
    Scene::parse(Path::new("test.toml"), &text, &Overrides::default()).unwrap()
}

fn simulate(scene: &Scene, column: &str) -> (Vec<f64>, Summary) {
    let place = columns(scene)
        .iter()
        .position(|c| c.name == column)
        .unwrap();
    let mut keep = Keep {
        place,
        values: Vec::new(),
    };
    let summary = run(scene, &mut keep).unwrap();
    (keep.values, summary)
}

fn warns(summary: &Summary, of: &str) -> bool {
    summary.warnings.iter().any(|warning| warning.contains(of))
}

#[test]
fn a_step_with_more_events_than_it_takes_in_gives_no_frequency() {
    // A stick of 4 µs and a slip of 0.6 µs.
    let object = "[effects.crepitus]\nconvention = \"physical\"\ninertia_kg_m2 = 1e-9\n\
                  stiffness_nm_per_rad = 1e5\nkinetic_torque_nm = 0.2\nstatic_torque_nm = 0.4";
    for (effects, coupled) in [
        (object.to_owned(), false),
        (format!("[effects.drivetrain]\n{object}"), true),
    ] {
        let at = |step_s| simulate(&scene(0.02, STEADY, step_s, &effects), "torque_nm").1;
        let (long, short) = (at(5e-5), at(1e-6));
        assert_eq!(long.plant_energy.is_some(), coupled);
        assert!(warns(&long, "no frequency is given"), "{:?}", long.warnings);
        let cycles = long.cycles.unwrap();
        assert!(cycles.frequency_hz.is_none() && cycles.shortest_s.is_none());
        assert!(
            !warns(&short, "no frequency is given"),
            "{:?}",
            short.warnings
        );
        let hz = short.cycles.unwrap().frequency_hz.unwrap();
        // ωn/(2π + 2(λ − atan λ)) with ωn = 1e7 rad/s and λ = 20.
        assert!((hz / 231_260.0 - 1.0).abs() < 1e-3, "{hz}");
    }
}

/// The warnings of a run with this stiffness, damping and brace inertia on a leg
/// that moves as the scene says.
fn braced([stiffness, damping, inertia]: [f64; 3], substeps: u32) -> Summary {
    let effects = format!(
        "substeps = {substeps}\n[effects.crepitus]\n[effects.cuff]\nstiffness_nm_per_rad = {stiffness:?}\n\
         damping_nms_per_rad = {damping:?}\nbrace_inertia_kg_m2 = {inertia:?}\n"
    );
    simulate(&scene(0.05, STEADY, 5e-5, &effects), "brace_torque_nm").1
}

#[test]
fn a_cuff_too_fast_for_the_step_is_warned_of() {
    const WARNING: &str = "step long against the cuff";
    for (numbers, expected) in [
        // ω·h = √(k/J_b)·h is 0.1 at 400 N·m/rad.
        ([395.0, 0.01, 1e-4], false),
        ([405.0, 0.01, 1e-4], true),
        // b·h/J_b is 2 at 0.4 N·m·s/rad.
        ([30.0, 0.39, 1e-5], false),
        ([30.0, 0.41, 1e-5], true),
        ([1e6, 1.0, 1e-5], true),
        ([120.0, 1.0, 0.01], false),
    ] {
        let summary = braced(numbers, 1);
        let warned = warns(&summary, WARNING);
        assert_eq!(warned, expected, "{numbers:?}: {:?}", summary.warnings);
    }
    // The step of the plant counts, not that of the device.
    assert!(!warns(&braced([1600.0, 0.01, 1e-4], 4), WARNING));
}

#[test]
fn an_energy_balance_that_does_not_close_is_warned_of() {
    const WARNING: &str = "the energy of the plant balances to";
    // The smallest leg there is, thrown by the stretched ligaments, with and
    // without its damping.
    for (numbers, expected) in [
        (
            "body_mass_kg = 1.0\nheight_m = 0.3\ndamping_nms_per_rad = 0.0\n",
            true,
        ),
        ("body_mass_kg = 1.0\nheight_m = 0.3\n", false),
        ("", false),
    ] {
        let effects = format!("[effects.limb]\nposture = \"sitting\"\n{numbers}");
        let released = "kind = \"released\"\nfrom_deg = -20";
        let (_, summary) = simulate(&scene(1.0, released, 5e-5, &effects), "limb_torque_nm");
        let share = summary.plant_energy.as_ref().unwrap().residual_relative;
        println!("{numbers:?}: {share:.1e}");
        assert_eq!(share.abs() > 1e-3, expected, "{share}");
        assert_eq!(warns(&summary, WARNING), expected, "{:?}", summary.warnings);
    }
}

#[test]
fn an_impact_has_an_impulse_that_does_not_depend_on_the_step() {
    for holder in ["", "[effects.hand]\n"] {
        let effects =
            format!("[effects.crepitus]\n[effects.drivetrain]\n[effects.backlash]\n{holder}");
        let at = |step_s| {
            let (struck, summary) = simulate(&scene(2.0, SWING, step_s, &effects), STRUCK_COLUMN);
            let impacts = summary.impacts.unwrap();
            let most = struck.iter().fold(0.0_f64, |most, nms| most.max(nms.abs()));
            assert!((most - impacts.hand_largest_nms).abs() < 1e-15);
            assert!(impacts.count > 3 && impacts.mean_nms <= impacts.largest_nms);
            (impacts, summary.hand_torque.unwrap())
        };
        let ((one, torque), (quarter, same)) = (at(5e-5), at(1.25e-5));
        println!("{one:?} {quarter:?} {torque:?} {same:?}");
        let off = |a: f64, b: f64| (a / b - 1.0).abs();
        assert!(off(one.hand_largest_nms, quarter.hand_largest_nms) < 0.05);
        // Divided by the step it would be four times as much.
        assert!(off(torque.max_nm, same.max_nm) < 0.1, "{torque:?} {same:?}");
        let largest = torque.max_nm.max(-torque.min_nm);
        assert!(largest < 0.2 * one.hand_largest_nms / 5e-5, "{torque:?}");
    }
}

/// A small hand motion on a gear whose friction is all but cancelled: the teeth
/// part at every turn, and meet again.
#[test]
fn contact_that_chatters_keeps_its_energy_and_ends() {
    let mut most = 0;
    // 0.8 of 0.625 N·m is all that the gear has.
    for (believed_nm, amplitude_deg, frequency_hz) in [
        (0.5, 0.6, 0.5),
        (0.625, 0.6, 0.5),
        (0.5, 1.0, 6.0),
        (0.625, 1.0, 6.0),
        (0.625, 5.0, 2.0),
    ] {
        let motion = format!(
            "kind = \"sine\"\namplitude_deg = {amplitude_deg:?}\nfrequency_hz = {frequency_hz:?}"
        );
        let effects = format!(
            "[effects.crepitus]\n[effects.encoder]\n[effects.motor]\n[effects.drivetrain]\n\
             [effects.friction-compensation]\nfriction_nm = {believed_nm:?}\n[effects.backlash]\n[effects.hand]\n"
        );
        let (torque, summary) = simulate(&scene(4.0, &motion, 5e-5, &effects), "hand_torque_nm");
        let balance = summary.plant_energy.as_ref().unwrap().residual_relative;
        let impacts = summary.impacts.unwrap();
        println!("{believed_nm} {amplitude_deg} {frequency_hz}: {impacts:?} {balance:.1e}");
        // A hand of 16 N·m/rad cannot press harder.
        assert!(torque.iter().all(|nm| nm.abs() < 5.0));
        assert!(balance.abs() < 1e-9, "{balance}");
        let warned = summary
            .warnings
            .iter()
            .any(|w| w.contains("nothing is left"));
        assert_eq!(warned, believed_nm > 0.6, "{:?}", summary.warnings);
        assert_eq!(summary.warnings.len(), usize::from(warned));
        // One at each turn, and a bounce or two.
        let turns = 2.0 * 4.0 * frequency_hz;
        assert!(f64::from(u32::try_from(impacts.count).unwrap()) <= 3.0 * turns + 3.0);
        most = most.max(impacts.count);
    }
    assert!(most > 10, "{most}");
}
