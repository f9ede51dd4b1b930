//! Where a scene's numbers are not to be trusted, the run says so: each warning
//! on both sides of its limit.

use crepitus_scene::run::{STRUCK_COLUMN, columns};
use crepitus_scene::trace::EventRecord;
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

    fn event(&mut self, _: &EventRecord) -> Result<(), Infallible> {
        Ok(())
    }

    fn progress(&mut self, _: f64) -> Result<(), Infallible> {
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
        assert!((hz / 216_900.0 - 1.0).abs() < 0.02, "{hz}");
    }
}

/// A brace of 1e-4 kg·m² on a cuff of this stiffness, on a leg that moves as
/// the scene says, 50 µs a step: what the model shows, and the run.
fn braced(stiffness: f64, step_s: f64) -> (Vec<f64>, Summary) {
    let effects = format!(
        "[effects.crepitus]\n[effects.cuff]\nstiffness_nm_per_rad = {stiffness:?}\n\
         damping_nms_per_rad = 0.01\nbrace_inertia_kg_m2 = 1e-4\n"
    );
    simulate(&scene(0.2, STEADY, step_s, &effects), "cuff_torque_nm")
}

#[test]
fn a_cuff_too_stiff_for_the_step_is_warned_of() {
    const WARNING: &str = "step long against the cuff";
    // ω·h = √(k/J_b)·h is π/4 at 24,674 N·m/rad.
    for (stiffness, expected) in [(24_000.0, false), (25_400.0, true), (1e6, true)] {
        let (_, summary) = braced(stiffness, 5e-5);
        assert_eq!(
            warns(&summary, WARNING),
            expected,
            "{stiffness}: {:?}",
            summary.warnings
        );
    }
    // With a shorter step the same cuff is resolved.
    assert!(!warns(&braced(1e6, 5e-6).1, WARNING));
}

#[test]
fn an_energy_balance_that_does_not_close_is_warned_of() {
    const WARNING: &str = "the energy of the plant balances to";
    let limb = |numbers: &str| {
        let effects = format!("[effects.limb]\nposture = \"sitting\"\n{numbers}");
        let released = "kind = \"released\"\nfrom_deg = 30";
        simulate(&scene(1.0, released, 5e-5, &effects), "limb_torque_nm").1
    };
    let smallest = limb("body_mass_kg = 1.0\nheight_m = 0.3\n");
    let share = smallest.plant_energy.as_ref().unwrap().residual_relative;
    assert!(share.abs() > 1e-3, "{share}");
    assert!(warns(&smallest, WARNING), "{:?}", smallest.warnings);
    for numbers in ["", "body_mass_kg = 8.0\nheight_m = 0.7\n"] {
        let usual = limb(numbers);
        let share = usual.plant_energy.as_ref().unwrap().residual_relative;
        assert!(
            share.abs() < 1e-3 && !warns(&usual, WARNING),
            "{share}: {:?}",
            usual.warnings
        );
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

/// A hand that hardly moves on a gear whose friction is all but cancelled: the
/// teeth meet and part again and again.
#[test]
fn contact_that_chatters_keeps_its_energy_and_ends() {
    for (share, frequency_hz) in [(0.8, 0.5), (1.0, 0.5), (1.0, 5.0)] {
        let motion =
            format!("kind = \"sine\"\namplitude_deg = 0.6\nfrequency_hz = {frequency_hz:?}");
        let effects = format!(
            "[effects.crepitus]\n[effects.encoder]\n[effects.motor]\n[effects.drivetrain]\n\
             [effects.friction-compensation]\nshare = {share:?}\n[effects.backlash]\n[effects.hand]\n"
        );
        let (torque, summary) = simulate(&scene(4.0, &motion, 5e-5, &effects), "hand_torque_nm");
        let balance = summary.plant_energy.as_ref().unwrap();
        println!(
            "{share} {frequency_hz}: {:?} {:.1e}",
            summary.impacts, balance.residual_relative
        );
        assert!(torque.iter().all(|nm| nm.abs() < 10.0));
        assert!(
            balance.residual_relative.abs() < 1e-9,
            "{}",
            balance.residual_relative
        );
        // It meets at most once a tick, and not in every one.
        let impacts = summary.impacts.unwrap();
        assert!(
            impacts.count > 3 && impacts.count < summary.steps / 10,
            "{impacts:?}"
        );
        assert!(!warns(&summary, "energy"), "{:?}", summary.warnings);
    }
}
