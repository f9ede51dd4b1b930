//! Symptoms as a scene lists them.

use crate::support::{constant, events, given};
use crepitus_model::parameters::{Choice, ParameterSpec};
use crepitus_plant::assembly::Listed;
use crepitus_plant::effect::{Effect, Given, Part};
use crepitus_scene::reference::symptoms::{ListedSymptoms, Word as Kind};

const fn number(key: &'static str, default: f64) -> ParameterSpec {
    ParameterSpec {
        key,
        symbol: "x",
        unit: "1",
        min: 0.0,
        max: 200.0,
        default,
        meaning: "",
    }
}

const fn effect(
    name: &'static str,
    parameters: &'static [ParameterSpec],
    choices: &'static [Choice],
) -> Effect {
    Effect {
        name,
        adds: "",
        states: &[],
        parameters,
        choices,
        needs: &[],
        part: Part::Joint,
    }
}

static LEAD_PIPE: Effect = effect("lead-pipe", &[number("torque_nm", 1.2)], &[]);
static TEXTURE: Effect = effect("texture", &[number("irregularity", 0.0)], &[]);
static MOTOR: Effect = effect("motor", &[], &[]);
static SPASTICITY: Effect = effect(
    "spasticity",
    &[number("threshold_deg", 75.0), number("torque_nm", 4.5)],
    &[Choice {
        key: "form",
        names: &["catch", "reflex"],
        default: 0,
        meaning: "",
    }],
);

#[test]
fn the_symptoms_of_a_scene_are_found_by_name() {
    let listed: Vec<_> = [&LEAD_PIPE, &SPASTICITY, &MOTOR, &TEXTURE]
        .map(|effect| Listed {
            effect,
            given: Given {
                numbers: effect.parameters.iter().map(|p| p.default).collect(),
                choices: vec![1; effect.choices.len()],
            },
        })
        .into();
    let motion = constant(20.0, 60.0);
    let mut all = ListedSymptoms::new(&listed, &motion).unwrap();
    let mut paid = Vec::new();
    let found = all.advance(1.0, &mut |step| paid.push(*step));
    // A reflex gives energy, a lead-pipe does not.
    assert!(paid.iter().all(|step| step.effect == "spasticity"));
    let length_s: f64 = paid.iter().map(|step| step.step_s).sum();
    assert!((length_s - 1.0).abs() < 1e-9 && paid.last().unwrap().end_s == 1.0);
    let names: Vec<_> = all.torques().map(|(name, _)| name).collect();
    assert_eq!(names, ["lead-pipe", "spasticity", "texture"]);
    assert!(
        found
            .windows(2)
            .all(|e| e[0].event.time_s <= e[1].event.time_s)
    );
    let own = |effect: &str| -> Vec<_> {
        let own = found.iter().filter(|e| e.effect == effect);
        own.map(|e| e.event).collect()
    };
    assert_eq!(own("spasticity")[0].kind, Kind::Onset);
    assert_eq!(
        own("spasticity"),
        events(
            "spasticity",
            &given(&[], &[("form", "reflex")]),
            &motion,
            1.0
        )
    );
    assert_eq!(
        own("texture"),
        events(
            "texture",
            &given(&[("irregularity", 0.0)], &[]),
            &motion,
            1.0
        )
    );
    let torque = all.torques().next().unwrap().1;
    assert!((torque - 1.2).abs() < 1e-12);
}
