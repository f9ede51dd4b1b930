//! Reference cases through the public interface: a scene file in, `events.csv`
//! out, compared with 50-digit results.

mod support;

use serde_json::Value;
use std::fmt::Write;
use std::fs;
use support::{csv, done, number, repository};

/// The case as a scene.
fn scene(case: &Value) -> String {
    let p = &case["params"];
    let text = |v: &Value| v.as_str().unwrap().to_owned();
    let drive = &case["drive"];
    let motion = match drive["kind"].as_str().unwrap() {
        "const" => format!(
            "kind = \"constant\"\nvelocity_rad_s = {}",
            text(&drive["Omega"])
        ),
        kind @ ("sine_position" | "minus_cosine_position") => format!(
            "kind = \"sine\"\namplitude_rad = {}\nfrequency_hz = {}\nphase_deg = {}",
            text(&drive["A"]),
            text(&drive["f_hz"]),
            if kind == "sine_position" { 0 } else { -90 }
        ),
        _ => {
            let mut knots = String::from("kind = \"velocity-knots\"\nknots = [\n");
            for k in drive["knots"].as_array().unwrap() {
                writeln!(
                    knots,
                    "  {{ t_s = {}, omega_left_rad_s = {}, omega_right_rad_s = {} }},",
                    text(&k["t"]),
                    text(&k["Omega_left"]),
                    text(&k["Omega_right"])
                )
                .unwrap();
            }
            knots + "]"
        }
    };
    let convention = case["convention"].as_str().unwrap();
    format!(
        "version = 1\ntitle = \"case\"\nduration_s = {}\n[motion]\n{motion}\n[solver]\nkind = \"reference\"\n\
         [effects.crepitus]\nconvention = \"{convention}\"\ninertia_kg_m2 = {}\nstiffness_nm_per_rad = {}\n\
         damping_nms_per_rad = {}\nkinetic_torque_nm = {}\nstatic_torque_nm = {}\n[output]\ntrace_step_s = 1e-2\n",
        text(&case["t_end"]),
        text(&p["J"]),
        text(&p["kr"]),
        text(&p["c"]),
        text(&p["Tk"]),
        text(&p["Ts"])
    )
}

#[test]
fn reference_cases_hold_through_the_files() {
    let mut checked = 0;
    for name in [
        "c01_const_0p05",
        "s07p_sine_0p25Hz_paper",
        "m23_lambda_0p1_below",
        "m23_lambda_0p1_above",
        "j21_light_1e-8",
        "k15_stiff",
        "q10_velocity_jumps",
        "w27_wander_physical",
        "w27z_wander_frozen",
        "z14_zero_kinetic",
    ] {
        let file = repository().join(format!("tests/reference-cases/{name}.json"));
        let case: Value = serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap();
        let home = tempfile::tempdir().unwrap();
        let path = home.path().join("case.toml");
        fs::write(&path, scene(&case)).unwrap();
        let out = home.path().join("out");
        done(&format!("run {} --out {}", path.display(), out.display()));
        let (_, events) = csv(&out.join("events.csv"));
        let expected = case["events"].as_array().unwrap();
        assert_eq!(events.len(), expected.len(), "{name}");
        for (event, truth) in events.iter().zip(expected) {
            assert_eq!(event[2], truth["type"].as_str().unwrap(), "{name}");
            let error = (number(&event[0]) - number(truth["t"].as_str().unwrap())).abs();
            assert!(error <= 1e-12, "{name}: {error:e} s");
            checked += 1;
        }
    }
    assert!(checked > 500);
}
