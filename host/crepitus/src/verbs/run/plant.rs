//! A plant in the summary of a run: where its energy went, and what
//! the rendered torque did.

use crate::sections::{millijoule, nm, section};
use crepitus_pages::report::Section;
use crepitus_scene::Summary;
use std::borrow::Cow;

/// A line on the hand and one on the balance, as far as there are any.
pub(super) fn in_brief(s: &Summary) -> Vec<String> {
    let mut lines = Vec::new();
    if let Some(t) = &s.hand_torque {
        lines.push(format!(
            "  torque at the hand {} to {}, mean {}",
            nm(t.min_nm),
            nm(t.max_nm),
            nm(t.mean_nm)
        ));
    }
    if let Some(i) = s.impacts.filter(|i| i.count > 0) {
        lines.push(format!(
            "  {} impacts in the gear of up to {:.2e} N·m·s, at the hand {:.2e} N·m·s in a tick",
            i.count, i.largest_nms, i.hand_largest_nms
        ));
    }
    if let Some(e) = &s.plant_energy {
        lines.push(format!(
            "  energy of the plant balances to {}",
            match e.residual_relative.abs() {
                0.0 => "the last bit".to_owned(),
                share => format!("{share:.0e} of all that moved"),
            }
        ));
    }
    lines
}

/// Sources of the work of the rendered torque, in words. None if there
/// is nothing to render.
pub(super) fn rendered_section(s: &Summary) -> Option<Section> {
    let rendering = &s.plant_energy.as_ref()?.rendering;
    let mut rows: Vec<(Cow<'_, str>, String)> = Vec::new();
    if s.energy.is_some() {
        rows.push((
            "the model’s torque took".into(),
            millijoule(rendering.model_j),
        ));
        rows.push((
            "holding it over each tick, and what the sensor does not see, added".into(),
            millijoule(rendering.sampling_j),
        ));
    }
    for stage in &rendering.stages {
        rows.push((
            format!("{} added", stage.effect.replace('-', " ")).into(),
            millijoule(stage.joule),
        ));
    }
    if let Some(limits_j) = rendering.limits_j {
        rows.push((
            "the device’s guards and limits added".into(),
            millijoule(limits_j),
        ));
    }
    if rows.is_empty() && rendering.absorbed_j == 0.0 {
        return None;
    }
    if s.effects.iter().any(|e| e.name == "motor") {
        rows.push((
            "the motor added, where its torque was not the one commanded".into(),
            millijoule(rendering.actuator_j),
        ));
    }
    rows.push((
        "in all: taken out of the mechanics".into(),
        millijoule(rendering.absorbed_j),
    ));
    Some(section("Work of the rendered torque", rows))
}

/// The impacts in the gear: what each hands over, which takes no time. None if
/// there is no gap to strike across.
pub(super) fn impacts_section(s: &Summary) -> Option<Section> {
    let impacts = s.impacts?;
    let impulse = |nms: f64| format!("{nms:.3e} N·m·s");
    let mut rows = vec![("how many", impacts.count.to_string())];
    if impacts.count > 0 {
        rows.push(("largest impulse", impulse(impacts.largest_nms)));
        rows.push(("mean impulse", impulse(impacts.mean_nms)));
        rows.push((
            "largest at the hand in a tick",
            impulse(impacts.hand_largest_nms),
        ));
    }
    Some(section("Impacts in the gear", rows))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_plant::energy_balance::Account;
    use crepitus_scene::run::{Blind, EnergyTerm};
    use crepitus_scene::{Overrides, Scene};
    use std::path::Path;

    /// The summary of a short run.
    fn summary(motion: &str, effects: &str) -> Summary {
        let text = format!(
            "version = 1\ntitle = \"short\"\nduration_s = 0.05\n[motion]\n{motion}\n\
             [solver]\nkind = \"exact-events\"\nstep_s = 5e-5\n{effects}"
        );
        let scene = Scene::parse(Path::new("short.toml"), &text, &Overrides::default());
        let scene = scene.expect("a scene");
        crepitus_scene::run(&scene, &mut Blind).expect("it runs")
    }

    const STEADY: &str = "kind = \"constant\"\nvelocity_rad_s = 1.0";

    fn names(section: Option<Section>) -> Vec<String> {
        let rows = section.map(|s| s.rows).unwrap_or_default();
        rows.into_iter().map(|(name, _)| name).collect()
    }

    #[test]
    fn a_joint_alone_has_none_of_this() {
        let s = summary(STEADY, "[effects.crepitus]\n");
        assert!(in_brief(&s).is_empty());
        assert!(s.plant_energy.is_none() && rendered_section(&s).is_none());
    }

    #[test]
    fn a_plant_has_a_hand_and_a_balance() {
        let s = summary(
            STEADY,
            "[effects.crepitus]\n[effects.motor]\n[effects.friction-compensation]\n\
             [effects.drivetrain]\n",
        );
        let lines = in_brief(&s);
        assert!(lines[0].contains("torque at the hand"), "{lines:?}");
        assert!(lines[1].contains("balances to"), "{lines:?}");
        let balance = s.plant_energy.as_ref().expect("there is a plant");
        let given = |t: &EnergyTerm| t.effect == "motor" && t.account == Account::Given;
        assert!(balance.terms.iter().any(given));
        let names = names(rendered_section(&s));
        assert!(names.iter().any(|n| n == "friction compensation added"));
        assert!(names.iter().any(|n| n.starts_with("the motor added")));
    }

    #[test]
    fn a_released_leg_renders_nothing() {
        let s = summary("kind = \"released\"\nfrom_deg = 20", "[effects.limb]\n");
        assert_eq!(in_brief(&s).len(), 1);
        assert!(s.plant_energy.is_some() && rendered_section(&s).is_none());
    }
}
