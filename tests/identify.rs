//! `crepitus identify` on recordings of a simulated device.

mod support;

use serde_json::Value;
use std::fs;
use std::path::Path;
use support::{WEIGHT_IN_THE_BRACE, names, refuses, run, stderr, stdout};

/// Values of the brace of the scene `weight-in-the-brace`, which the estimator does not know.
const TRUTH: [(&str, f64); 9] = [
    ("friction_nm", 0.42),
    ("load_loss", 0.24),
    ("limb.damping_nms_per_rad", 0.06),
    ("inertia_kg_m2", 0.044),
    ("brace_inertia_kg_m2", 0.013),
    ("gap_deg", 1.3),
    ("stiffness_nm_per_rad", 95.0),
    ("cuff.damping_nms_per_rad", 0.8),
    ("torque_constant_nm_per_a", 0.0389),
];

/// A release on the simulated device; armed it renders the joint `coarse`.
fn recorded(folder: &Path, name: &str, how: &[&str]) -> String {
    let file = folder.join(name);
    let file = file.to_str().unwrap();
    let device = ["--device", "sim", "--scene", "weight-in-the-brace"];
    let record = ["record", file, "--for", "7s"];
    let done = run(&[&record[..], &device, how].concat());
    assert!(done.status.success(), "{}", stderr(&done));
    file.to_owned()
}

fn value<'v>(summary: &'v Value, key: &str) -> &'v Value {
    let values = summary["values"].as_array().unwrap();
    let is_it = |value: &&Value| {
        let name = value["key"].as_str().unwrap();
        name == key || format!("{}.{name}", value["effect"].as_str().unwrap()) == key
    };
    values.iter().find(is_it).unwrap()
}

#[test]
fn a_recorded_device_is_identified() {
    let folder = tempfile::tempdir().unwrap();
    let swing = recorded(folder.path(), "swing", &[]);
    let armed = recorded(folder.path(), "armed", &["--arm", "--zero"]);
    let (out, scene) = (folder.path().join("out"), folder.path().join("brace.toml"));
    let [out_name, scene_name] = [&out, &scene].map(|path| path.to_str().unwrap());
    let results = ["--out", out_name, "--scene-out", scene_name];
    let verb = ["identify", &swing, &armed];
    let done = run(&[&verb[..], &WEIGHT_IN_THE_BRACE, &results].concat());
    assert!(done.status.success(), "{}", stderr(&done));
    let text = stdout(&done);
    assert!(text.contains("drivetrain.friction_nm"), "{text}");
    assert_eq!(
        names(&out),
        ["identified.json", "report.html", "residual.svg"]
    );
    let svg = fs::read_to_string(out.join("residual.svg")).unwrap();
    assert!(svg.contains("Residual (°)"));
    let html = fs::read_to_string(out.join("report.html")).unwrap();
    assert!(html.contains("backlash.gap_deg") || html.contains("gap_deg"));
    let written = fs::read_to_string(out.join("identified.json")).unwrap();
    let written: Value = serde_json::from_str(&written).unwrap();
    for (key, truth) in TRUTH {
        let found = value(&written, key);
        let number = |name: &str| found[name].as_f64().unwrap_or_else(|| panic!("{found}"));
        let (value, half_width) = (number("value"), number("half_width"));
        assert!(
            (value - truth).abs() <= half_width,
            "{key} {truth}: {found}"
        );
        assert!(half_width < 0.35 * value, "{found}");
    }
    // The tables make a scene.
    let tables = fs::read_to_string(&scene).unwrap();
    let whole = format!(
        "version = 1\ntitle = \"Found\"\nduration_s = 0.1\n[motion]\nkind = \"released\"\nfrom_deg = 30.0\n\
         [solver]\nkind = \"exact-events\"\nstep_s = 5e-5\n{tables}"
    );
    let file = folder.path().join("found.toml");
    fs::write(&file, whole).unwrap();
    let run_out = folder.path().join("run");
    let ran = run(&[
        "run",
        file.to_str().unwrap(),
        "--out",
        run_out.to_str().unwrap(),
    ]);
    assert!(ran.status.success(), "{}\n{tables}", stderr(&ran));
    // An existing file is kept.
    let again = run(&[
        &verb[..],
        &WEIGHT_IN_THE_BRACE,
        &["--scene-out", scene_name],
    ]
    .concat());
    assert_eq!(again.status.code(), Some(2));
    assert!(stderr(&again).contains("already exists"));
}

#[test]
fn what_one_recording_does_not_show_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let swing = recorded(folder.path(), "swing", &[]);
    let done = run(&[&["--json", "identify", &swing][..], &WEIGHT_IN_THE_BRACE].concat());
    assert!(done.status.success(), "{}", stderr(&done));
    let printed: Value = serde_json::from_str(&stdout(&done)).unwrap();
    let loss = value(&printed["identified"], "load_loss");
    assert_eq!(loss["value"], Value::Null);
    assert!(loss["not_visible"].as_str().unwrap().contains("--arm"));
    let plain = run(&[&["identify", &swing][..], &WEIGHT_IN_THE_BRACE].concat());
    let text = stdout(&plain);
    assert!(
        text.contains("load-dependent friction: not visible in this recording, because"),
        "{text}"
    );
    assert!(stderr(&plain).contains("nothing here checks the weight"));
}

#[test]
fn a_table_of_another_laboratory_is_identified() {
    let folder = tempfile::tempdir().unwrap();
    let swing = recorded(folder.path(), "swing", &[]);
    let exported = folder.path().join("swing.csv");
    let to = ["--format", "csv", "--out", exported.to_str().unwrap()];
    let done = run(&[&["export", &swing][..], &to].concat());
    assert!(done.status.success(), "{}", stderr(&done));
    let text = fs::read_to_string(&exported).unwrap();
    let (names, rows) = text.split_once('\n').unwrap();
    let names: Vec<&str> = names.trim().split(',').collect();
    let at = |name: &str| names.iter().position(|known| *known == name).unwrap();
    let (t, angle) = (at("t_s"), at("angle_rad"));
    // 500 Hz, in degrees, with decimal commas.
    let lines: Vec<String> = (rows.lines().step_by(40))
        .map(|row| {
            let cells: Vec<f64> = (row.split(','))
                .map(|cell| cell.parse().unwrap_or(0.0))
                .collect();
            format!("{:.4};{:.5}", cells[t], cells[angle].to_degrees()).replace('.', ",")
        })
        .collect();
    let table = folder.path().join("table.csv");
    let table = table.to_str().unwrap();
    fs::write(table, format!("Zeit (s);phi (deg)\n{}\n", lines.join("\n"))).unwrap();
    let verb = ["--json", "identify", table];
    let arguments = [&verb[..], &["--angle", "phi (deg)"], &WEIGHT_IN_THE_BRACE].concat();
    let done = run(&arguments);
    assert!(done.status.success(), "{}", stderr(&done));
    let printed: Value = serde_json::from_str(&stdout(&done)).unwrap();
    for (key, truth) in [TRUTH[0], TRUTH[3], TRUTH[5], TRUTH[6]] {
        let found = value(&printed["identified"], key);
        let number = |name: &str| found[name].as_f64().unwrap_or_else(|| panic!("{found}"));
        assert!(
            (number("value") - truth).abs() <= number("half_width"),
            "{key} {truth}: {found}"
        );
    }
    // Too few rows a second for the strike of the teeth.
    let slow: Vec<&String> = lines.iter().step_by(10).collect();
    let text = slow
        .iter()
        .fold(String::new(), |text, line| text + line + "\n");
    fs::write(table, format!("Zeit (s);phi (deg)\n{text}")).unwrap();
    refuses(&arguments[1..], 2, "record at 200 Hz or more");
}

#[test]
fn what_is_refused_has_its_exit_code_and_its_reason() {
    let folder = tempfile::tempdir().unwrap();
    let swing = recorded(folder.path(), "swing", &[]);
    // A knee that is examined is no weight that swings.
    let knee = folder.path().join("knee");
    let knee = knee.to_str().unwrap();
    let done = run(&["record", knee, "--for", "3s", "--device", "sim"]);
    assert!(done.status.success(), "{}", stderr(&done));
    let never = [
        &["identify", knee, "--out", "never"][..],
        &WEIGHT_IN_THE_BRACE,
    ]
    .concat();
    refuses(&never, 1, "nothing is identified: ");
    assert!(!Path::new("never").exists());
    let weight = ["--weight-kg", "2", "--lever-m", "1"];
    let sure = [&[&*swing][..], &weight, &["--weight-tolerance", "0"]].concat();
    for (arguments, part) in [
        (&[&*swing][..], "--weight-kg"),
        (
            &[&swing, "--weight-kg", "0", "--lever-m", "0.3"],
            "--weight-kg: expected",
        ),
        (
            &[&swing, "--weight-kg", "2", "--lever-m", "nan"],
            "--lever-m: expected",
        ),
        (&sure, "--weight-tolerance"),
        (&[&["nowhere"][..], &weight].concat(), "nowhere"),
        (&[&["Cargo.toml"][..], &weight].concat(), "not a recording"),
    ] {
        refuses(&[&["identify"], arguments].concat(), 2, part);
    }
}
