//! Warnings in the summary of a run.

use super::{EXACT_EVENTS, ONE_RAD_S, crepitus, scene, simulate};
use crepitus_scene::Summary;

#[test]
fn steps_too_long_to_see_are_warned_of() {
    let slow = "kind = \"exact\"\nstep_s = 1e-3";
    let fast = "kind = \"constant\"\nvelocity_rad_s = 3.0";
    let (_, summary) = simulate(&scene(1.0, fast, slow, &crepitus("frozen")));
    assert!(
        summary
            .warnings
            .iter()
            .any(|w| w.contains("step longer than a stick phase"))
    );
    // That rung locates every event, however many fall into a step.
    let located = "kind = \"exact-events\"\nstep_s = 1e-3";
    let (_, summary) = simulate(&scene(1.0, fast, located, &crepitus("frozen")));
    let all = summary.warnings.join("\n");
    assert!(!all.contains("stick phase"), "{all}");
    let (_, summary) = simulate(&scene(1.0, fast, EXACT_EVENTS, &crepitus("frozen")));
    assert!(summary.warnings.is_empty(), "{:?}", summary.warnings);
}

#[test]
fn steps_longer_than_a_pitch_are_warned_of() {
    let texture = "[effects.texture]\npitch_deg = 0.5";
    let teeth = "[effects.cogwheel]\nmode = \"space\"\npitch_deg = 2.0";
    let warned = |omega_rad_s: f64, step_s: &str, effect: &str| {
        let motion = format!("kind = \"constant\"\nvelocity_rad_s = {omega_rad_s:?}");
        let solver = format!("kind = \"exact-events\"\nstep_s = {step_s}");
        let (_, summary) = simulate(&scene(0.05, &motion, &solver, effect));
        summary
            .warnings
            .iter()
            .any(|w| w.contains("longer than its pitch"))
    };
    assert!(warned(9.0, "1e-3", texture) && !warned(8.0, "1e-3", texture));
    assert!(!warned(9.0, "5e-4", texture));
    assert!(warned(36.0, "1e-3", teeth) && !warned(34.0, "1e-3", teeth));
}

#[test]
fn a_joint_that_the_device_refuses_is_warned_of() {
    // Two counts of 512 lines are 71.35 µrad; (Ts − Tk)/kr is 72 and 70.
    for (stiffness, lines, refused) in [
        ("2777.7", "512", false),
        ("2857.2", "512", true),
        ("2857.2", "1024", false),
        ("4000.0", "512", true),
    ] {
        let joint = format!(
            "{}\nstiffness_nm_per_rad = {stiffness}\ninertia_kg_m2 = 0.07",
            crepitus("frozen")
        );
        let encoder = format!("[effects.encoder]\nlines = {lines}");
        let effects = format!("{joint}\n{encoder}");
        let (_, summary) = simulate(&scene(0.1, ONE_RAD_S, EXACT_EVENTS, &effects));
        let is_warned = |summary: &Summary| {
            let warnings = &summary.warnings;
            warnings.iter().any(|w| w.contains("the device refuses"))
        };
        assert_eq!(is_warned(&summary), refused, "{:?}", summary.warnings);
        // Without an encoder there is no count, and under another convention
        // no such slip.
        let (_, summary) = simulate(&scene(0.1, ONE_RAD_S, EXACT_EVENTS, &joint));
        assert!(!is_warned(&summary));
        let physical = effects.replace("frozen", "physical");
        let (_, summary) = simulate(&scene(0.1, ONE_RAD_S, EXACT_EVENTS, &physical));
        assert!(!is_warned(&summary));
    }
}

#[test]
fn a_duration_of_no_whole_number_of_steps_is_a_warning() {
    let (keep, summary) = simulate(&scene(
        0.00012,
        ONE_RAD_S,
        EXACT_EVENTS,
        &crepitus("frozen"),
    ));
    assert_eq!(keep.rows.len(), 3);
    assert!(
        summary.warnings[0].contains("the run ends at 0.0001 s"),
        "{:?}",
        summary.warnings
    );
}
