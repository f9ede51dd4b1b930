//! Every error in a scene is reported: file, line, key, valid values.

use crepitus_scene::{Overrides, Scene};
use std::path::Path;

const GOOD: &str = r#"version = 1
title = "A scene"
duration_s = 1.0

[motion]
kind = "constant"
velocity_rad_s = 1.0

[solver]
kind = "exact-events"
step_s = 5e-5

[effects.crepitus]
preset = "coarse"
"#;

fn error_of(text: &str, overrides: &Overrides) -> String {
    match Scene::parse(Path::new("scenes/x.toml"), text, overrides) {
        Err(e) => e.to_string(),
        Ok(_) => panic!("this scene must be refused:\n{text}"),
    }
}

fn refused(from: &str, to: &str) -> String {
    assert!(GOOD.contains(from), "{from}");
    error_of(&GOOD.replace(from, to), &Overrides::default())
}

#[test]
fn the_good_scene_is_good() {
    let scene = Scene::parse(Path::new("x.toml"), GOOD, &Overrides::default()).unwrap();
    assert!(scene.has("crepitus") && scene.effects().len() == 1);
    assert!(scene.warnings.is_empty());
}

#[test]
#[expect(clippy::too_many_lines, reason = "one table")]
fn every_error_names_line_key_and_what_is_allowed() {
    let cases = [
        (
            refused("version = 1", "version = 2"),
            ["line 1", "`version`", "version 1"],
        ),
        (
            refused("version = 1\n", ""),
            ["x.toml", "missing", "needs `version = 1`"],
        ),
        (
            refused("duration_s = 1.0", "duration_s = -1.0"),
            ["line 3", "`duration_s`", "above 0"],
        ),
        (
            refused("duration_s = 1.0", "duration_s = \"1 s\""),
            ["line 3", "`duration_s`", "the text \"1 s\""],
        ),
        (
            refused("duration_s = 1.0", "duration_s = nan"),
            ["line 3", "`duration_s`", "above 0"],
        ),
        (
            refused("title = \"A scene\"", "title = 3"),
            ["x.toml", "`title`", "a text in quotes"],
        ),
        (
            refused("kind = \"constant\"", "kind = \"constnat\""),
            ["line 6", "`motion.kind`", "did you mean constant"],
        ),
        (
            refused(
                "kind = \"constant\"\nvelocity_rad_s = 1.0",
                "kind = \"strokes\"\nfrom_deg = 0\nto_deg = 1e-12\npeak_speed_deg_s = 1e6\npause_s = 0",
            ),
            [
                "line 9",
                "`motion.peak_speed_deg_s`",
                "between 1e-3 and 1e7 s",
            ],
        ),
        (
            refused(
                "kind = \"constant\"\nvelocity_rad_s = 1.0",
                "kind = \"velocity-knots\"\nknots = [{ t_s = 0, omega_rad_s = 1 }, { t_s = 1e-12, omega_rad_s = 2 }]",
            ),
            ["line 7", "t_s`", "by at least 1e-9 s"],
        ),
        (
            refused("velocity_rad_s", "velocity_deg_s"),
            ["line 5", "`motion.velocity_rad_s`", "missing"],
        ),
        (
            refused("velocity_rad_s = 1.0", "velocity_rad_s = 1.0\nvelocity = 3"),
            ["line 8", "`motion.velocity`", "velocity_rad_s"],
        ),
        (
            refused("exact-events", "exact-event"),
            [
                "line 10",
                "`solver.kind`",
                "exact-events, rk4-events, exact-hermite and reference",
            ],
        ),
        (
            refused("exact-events", "exact-hermite"),
            ["line 10", "`solver.kind`", "no acceleration of the shaft"],
        ),
        (
            refused(
                "exact-events\"\nstep_s = 5e-5\n\n[effects.crepitus]\n",
                "exact-hermite\"\nstep_s = 5e-5\nprecision = \"f32\"\n[effects.crepitus]\nconvention = \"physical\"\n",
            ),
            ["line 12", "`solver.precision`", "use precision \"f64\""],
        ),
        (
            refused(
                "exact-events\"\nstep_s = 5e-5\n\n[effects.crepitus]\n",
                "exact-hermite\"\nstep_s = 5e-5\n[effects.encoder]\n[effects.crepitus]\nconvention = \"physical\"\n",
            ),
            ["line 10", "`solver.kind`", "leave out [effects.encoder]"],
        ),
        (
            refused("step_s = 5e-5\n", ""),
            ["line 9", "`solver.step_s`", "missing"],
        ),
        (
            refused("step_s = 5e-5", "step_s = 0"),
            ["line 11", "`solver.step_s`", "above 0"],
        ),
        (
            refused("\"exact-events\"", "\"reference\""),
            ["line 11", "`solver.step_s`", "has no step"],
        ),
        (
            refused("step_s = 5e-5", "step_s = 5e-5\nprecision = \"f16\""),
            ["line 12", "`solver.precision`", "f32 and f64"],
        ),
        (
            refused("preset = \"coarse\"", "preset = \"rough\""),
            [
                "line 14",
                "`effects.crepitus.preset`",
                "coarse, fine and bone-on-bone",
            ],
        ),
        (
            refused("preset = \"coarse\"", "kinetic_torque_nm = 0.5"),
            ["line 13", "`effects.crepitus`", "Tk ≤ Ts"],
        ),
        (
            refused("preset = \"coarse\"", "inertia_kg_m2 = 0"),
            ["line 14", "`effects.crepitus.inertia_kg_m2`", "from 1e-12"],
        ),
        (
            refused("preset = \"coarse\"", "damping_nms_per_rad = 0.1"),
            ["line 13", "`effects.crepitus`", "frozen"],
        ),
        (
            refused(
                "preset = \"coarse\"",
                "convention = \"paper\"\nrestart = \"from-kinetic\"",
            ),
            ["line 13", "`effects.crepitus`", "frozen"],
        ),
        (
            refused("[effects.crepitus]", "[effects.crepitation]"),
            ["line 13", "`effects.crepitation`", "did you mean crepitus"],
        ),
        (
            refused(
                "[effects.crepitus]",
                "[output]\ntrace_step_s = 7e-5\n[effects.crepitus]",
            ),
            ["line 14", "`output.trace_step_s`", "whole number of steps"],
        ),
        (refused("[motion]", "[motion"), ["line 5", "TOML", ""]),
        (
            refused("title", "version = 1\ntitle"),
            ["line 2", "TOML", "duplicate"],
        ),
    ];
    for (message, parts) in cases {
        assert!(message.starts_with("scenes/x.toml"), "{message}");
        for part in parts {
            assert!(message.contains(part), "{message:?} does not say {part:?}");
        }
    }
}

#[test]
fn motions_are_checked_key_by_key() {
    let motion = |text: &str| {
        let scene = GOOD.replace("kind = \"constant\"\nvelocity_rad_s = 1.0", text);
        error_of(&scene, &Overrides::default())
    };
    let cases = [
        (
            "kind = \"sine\"\nfrequency_hz = 1",
            "amplitude_deg or amplitude_rad",
        ),
        (
            "kind = \"sine\"\nfrequency_hz = 1\namplitude_deg = 1\namplitude_rad = 1",
            "not both",
        ),
        (
            "kind = \"sine\"\nfrequency_hz = 1e-322\namplitude_deg = 1",
            "from 1e-7 up to 10000",
        ),
        ("kind = \"velocity-knots\"\nknots = []", "at least one knot"),
        ("kind = \"velocity-knots\"\nknots = 3", "a list of tables"),
        (
            "kind = \"velocity-knots\"\nknots = [{ t_s = 1.0, omega_rad_s = 0 }]",
            "first knot must be at t_s = 0",
        ),
        (
            "kind = \"velocity-knots\"\nknots = [{ t_s = 0, omega_rad_s = 0 }, { t_s = 0, omega_rad_s = 0 }]",
            "not after the knot before",
        ),
        (
            "kind = \"velocity-knots\"\nknots = [{ t_s = 0, omega_left_rad_s = 0 }]",
            "omega_left_rad_s and omega_right_rad_s",
        ),
        (
            "kind = \"velocity-knots\"\nknots = [{ t_s = 0, omega_rad_s = 0, x = 1 }]",
            "motion.knots[0].x",
        ),
        (
            "kind = \"strokes\"\nfrom_deg = 10\nto_deg = 10\npeak_speed_deg_s = 5\npause_s = 0",
            "two different angles",
        ),
        (
            "kind = \"strokes\"\nfrom_deg = 10\nto_deg = 20\npeak_speed_deg_s = 0\npause_s = 0",
            "above 0",
        ),
        (
            "kind = \"constant\"\nvelocity_rad_s = 1\nseed = 1.5",
            "whole number",
        ),
        (
            "kind = \"recording\"\nfile = \"none.csv\"\ntime_column = \"t\"\nangle_column = \"a\"\nunit = \"deg\"",
            "none.csv",
        ),
    ];
    for (text, part) in cases {
        let message = motion(text);
        assert!(
            message.contains(part) && message.contains("line "),
            "{message:?} does not say {part:?}"
        );
    }
}

#[test]
fn overrides_are_checked_and_named() {
    let set = |path: &str, value: &str| Overrides {
        set: vec![(path.to_owned(), value.to_owned())],
        ..Overrides::default()
    };
    let message = error_of(GOOD, &set("solver.step", "1e-3"));
    assert!(
        message.contains("--set solver.step=1e-3") && message.contains("step_s"),
        "{message}"
    );
    let message = error_of(GOOD, &set("title.x", "1"));
    assert!(message.contains("`title` is not a table"), "{message}");
    let message = error_of(
        GOOD,
        &Overrides {
            step: Some("fast".into()),
            ..Overrides::default()
        },
    );
    assert!(
        message.contains("--step fast") && message.contains("solver.step_s"),
        "{message}"
    );

    let scene = |o: &Overrides| Scene::parse(Path::new("x.toml"), GOOD, o).unwrap();
    // Plain text needs no quotes; numbers are numbers.
    let changed = scene(&set("effects.crepitus.preset", "fine"));
    assert_eq!(changed.crepitus.unwrap().preset, Some("fine"));
    let reference = scene(&Overrides {
        solver: Some("reference".into()),
        ..Overrides::default()
    });
    assert_eq!(reference.solver.name(), "reference");
}

/// An error of the good scene with these effects and this motion.
fn refused_plant(effects: &str, motion: &str) -> String {
    let text = GOOD.replace("kind = \"constant\"\nvelocity_rad_s = 1.0", motion);
    error_of(&format!("{text}\n{effects}\n"), &Overrides::default())
}

#[test]
fn effects_that_do_not_go_together_are_refused() {
    let steady = "kind = \"constant\"\nvelocity_rad_s = 1.0";
    let released = "kind = \"released\"\nfrom_deg = 30";
    for (effects, motion, wanted) in [
        ("[effects.backlash]", steady, "needs [effects.drivetrain]"),
        (
            "[effects.friction-compensation]",
            steady,
            "no friction to compensate",
        ),
        ("[effects.cuff]", released, "there is no leg to fall"),
        (
            "[effects.limb]\n[effects.hand]",
            released,
            "nobody holds the leg",
        ),
        (
            "[effects.limb]\nposture = \"lying\"",
            steady,
            "allowed are sitting, standing, prone and supine",
        ),
        (
            "[effects.cuff]\nstiffness_nm_per_rad = -1",
            steady,
            "from 0.1 up to 1e6",
        ),
        ("[effects.cuf]", steady, "did you mean cuff?"),
        ("[effects.motor]\nvolts = 24", steady, "no such key"),
    ] {
        let error = refused_plant(effects, motion);
        assert!(error.contains(wanted), "{error}");
    }
    let alone = refused(
        "[effects.crepitus]\npreset = \"coarse\"",
        "[effects.bone-shaping]",
    );
    assert!(alone.contains("needs [effects.crepitus]"), "{alone}");
    for (from, to, wanted) in [
        (
            "step_s = 5e-5",
            "step_s = 5e-5\nsubsteps = 4",
            "there is no plant to step",
        ),
        (
            "step_s = 5e-5",
            "step_s = 5e-5\nsubsteps = 1.5",
            "not a whole number",
        ),
        (
            "kind = \"exact-events\"\nstep_s = 5e-5",
            "kind = \"reference\"\n[effects.motor]",
            "knows a joint's symptoms alone",
        ),
    ] {
        let error = refused(from, to);
        assert!(error.contains(wanted), "{error}");
    }
}
