//! `crepitus calibrate` on simulated devices.

mod support;

use serde_json::Value;
use std::fs;
use std::path::Path;
use support::{WEIGHT_IN_THE_BRACE, names, refuses, run, stderr, stdout, words};

/// Arguments for the weight that hangs on the arm of the scene `weight-on-the-arm`.
const WEIGHT: [&str; 4] = ["--weight-kg", "0.61", "--lever-m", "0.25"];

const ARM: [&str; 5] = ["--yes", "--device", "sim", "--scene", "weight-on-the-arm"];

fn calibrate(steps: &str, more: &[&[&str]]) -> std::process::Output {
    let first: &[&str] = &["calibrate", "--steps", steps];
    run(&[&[first], more].concat().concat())
}

fn step<'v>(calibration: &'v Value, name: &str) -> &'v Value {
    let steps = calibration["steps"].as_array().unwrap();
    steps
        .iter()
        .find(|step| step["step"] == name)
        .unwrap_or_else(|| panic!("{name}: {calibration}"))
}

fn value(step: &Value, name: &str) -> (f64, f64) {
    let values = step["values"].as_array().unwrap();
    let found = values
        .iter()
        .find(|value| value["name"] == name)
        .unwrap_or_else(|| panic!("{name}: {step}"));
    (
        found["value"].as_f64().unwrap(),
        found["half_width"].as_f64().unwrap_or_default(),
    )
}

fn holds(step: &Value, name: &str, truth: f64) {
    let (value, half_width) = value(step, name);
    assert!(
        (value - truth).abs() <= half_width && half_width < 0.2 * truth,
        "{name} {truth}: {value} ± {half_width}"
    );
}

#[test]
fn a_hanging_weight_is_found_written_and_applied() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let written = ["--out", out.to_str().unwrap(), "--apply"];
    let done = calibrate("zero,polarity,torque-constant", &[&WEIGHT, &ARM, &written]);
    assert!(done.status.success(), "{}{}", stdout(&done), stderr(&done));
    let text = stdout(&done);
    assert!(text.contains("is applied and saved"), "{text}");
    for what in ["Straighten the joint", "let go of it", "let it hang still"] {
        assert!(stderr(&done).contains(what), "{}", stderr(&done));
    }
    assert_eq!(
        names(&out),
        ["calibration.json", "currents.svg", "report.html"]
    );
    let json: Value =
        serde_json::from_str(&fs::read_to_string(out.join("calibration.json")).unwrap()).unwrap();
    for name in ["connect", "zero", "polarity", "torque-constant"] {
        assert_eq!(step(&json, name)["result"], "good");
    }
    let found = step(&json, "torque-constant");
    holds(found, "torque constant", 0.0389);
    holds(found, "load-dependent friction", 0.24);
    holds(found, "dry friction at 8 deg/s", 0.38 + 0.14 * 0.06);
    let parameters = json["parameters"].as_array().unwrap();
    let set: Vec<_> = parameters
        .iter()
        .map(|parameter| parameter["name"].as_str().unwrap())
        .collect();
    assert_eq!(
        set,
        [
            "motor.torque_constant_nm_per_a",
            "friction-compensation.friction_nm",
            "friction-compensation.share",
            "friction-compensation.render"
        ]
    );
    // Of the gear's 0.38 N·m a fifth is left, or more.
    let set = |at: usize| parameters[at]["value"].as_f64().unwrap();
    let cancelled_nm = set(1) * set(2);
    assert!(
        (0.2..0.8 * 0.38).contains(&cancelled_nm) && set(3) == 1.0,
        "{parameters:?}"
    );
    assert!(text.contains("friction-compensation.render=on"), "{text}");
    assert!(json["revision"].as_u64().unwrap() > 1);
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains("torque constant") && page.contains("<svg"));
}

#[test]
fn a_swinging_weight_shows_friction() {
    let device = words("--yes --device sim --scene weight-in-the-brace --for 8s --json");
    let done = calibrate("friction", &[&WEIGHT_IN_THE_BRACE, &device]);
    assert!(done.status.success(), "{}", stderr(&done));
    let json: Value = serde_json::from_str(&stdout(&done)).unwrap();
    let found = step(&json["calibration"], "friction");
    holds(found, "dry friction", 0.42);
    holds(found, "backlash", 1.3);
    // A lever that was measured wrongly, and a hand that never let go.
    let wrong = ["--weight-kg", "2.44", "--lever-m", "0.3"];
    for (weight, scene) in [
        (&wrong[..], "weight-in-the-brace"),
        (&WEIGHT_IN_THE_BRACE[..], "passive-examination"),
    ] {
        let device = ["--yes", "--device", "sim", "--scene", scene, "--for", "8s"];
        let refused = calibrate("friction", &[weight, &device]);
        assert_eq!(refused.status.code(), Some(1), "{}", stdout(&refused));
        assert!(
            stdout(&refused).contains("nothing is identified: "),
            "{}",
            stdout(&refused)
        );
    }
}

#[test]
fn a_wrong_weight_is_said_and_nothing_applied() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let written = ["--out", out.to_str().unwrap(), "--apply"];
    let half = ["--weight-kg", "0.3", "--lever-m", "0.25"];
    let done = calibrate("zero,torque-constant", &[&half, &ARM, &written]);
    assert_eq!(done.status.code(), Some(1), "{}", stderr(&done));
    let text = stdout(&done);
    assert!(
        text.contains("torque-constant: bad") && text.contains("weigh the weight again"),
        "{text}"
    );
    assert!(text.contains("nothing is applied: a step is bad"), "{text}");
    let json: Value =
        serde_json::from_str(&fs::read_to_string(out.join("calibration.json")).unwrap()).unwrap();
    assert_eq!(
        (
            &json["revision"],
            json["parameters"].as_array().unwrap().len()
        ),
        (&Value::Null, 0)
    );
}

/// A joint that a hand moves from straight to both angles and back, after two seconds at rest.
fn moved_to(folder: &Path, first_deg: f64, then_deg: f64) -> String {
    let (mut t_s, mut at_deg, mut knots) = (2.0, 0.0, vec![(0.0, 0.0)]);
    for (to_deg, takes_s) in [(first_deg, 1.0), (then_deg, 3.0), (0.0, 2.0)] {
        // Half of the time at full speed.
        let speed: f64 = f64::to_radians(to_deg - at_deg) / (0.75 * takes_s);
        knots.extend([
            (t_s, 0.0),
            (t_s + 0.25 * takes_s, speed),
            (t_s + 0.75 * takes_s, speed),
        ]);
        (t_s, at_deg) = (t_s + takes_s, to_deg);
    }
    knots.extend([(t_s, 0.0), (20.0, 0.0)]);
    let knots: Vec<String> = knots
        .iter()
        .map(|(t, omega)| format!("{{ t_s = {t:?}, omega_rad_s = {omega:?} }}"))
        .collect();
    let scene = format!(
        "version = 1\ntitle = \"A range\"\nduration_s = 20.0\n[motion]\nkind = \"velocity-knots\"\nknots = [{}]\n\
         [solver]\nkind = \"exact-events\"\nstep_s = 5e-5\nprecision = \"f32\"\n[effects.encoder]\n[effects.motor]\n",
        knots.join(", ")
    );
    let file = folder.join(format!("range{first_deg}to{then_deg}.toml"));
    fs::write(&file, scene).unwrap();
    file.to_str().unwrap().to_owned()
}

#[test]
fn a_range_is_looked_at_by_hand() {
    let folder = tempfile::tempdir().unwrap();
    for (first_deg, then_deg, code, words) in [
        (-10.0, 128.0, 0, ["range: good", "range.most_deg"]),
        (-10.0, 60.0, 1, ["range: bad", "bends to about 140"]),
        (3.0, -120.0, 1, ["range: bad", "swap A and B"]),
        (-10.0, 250.0, 1, ["range: bad", "encoder.lines"]),
        (0.0, 1.0, 1, ["range: bad", "move the joint"]),
        (0.0, 128.0, 1, ["range: bad", "extension stop"]),
    ] {
        let scene = moved_to(folder.path(), first_deg, then_deg);
        let device = ["--yes", "--for", "8s", "--device", "sim", "--scene", &scene];
        let done = calibrate("zero,range", &[&device]);
        let text = stdout(&done);
        assert_eq!(
            done.status.code(),
            Some(code),
            "{then_deg}: {text}{}",
            stderr(&done)
        );
        assert!(text.contains("zero: good"), "{text}");
        for word in words {
            assert!(text.contains(word), "{then_deg}: {word} is not in {text}");
        }
    }
}

#[test]
fn what_is_refused_has_its_exit_code_and_its_reason() {
    let light = ["--weight-kg", "0", "--lever-m", "0.2", "--yes"];
    let sure = [
        &["--weight-kg", "2", "--lever-m", "0.2", "--yes"][..],
        &["--weight-tolerance", "0"],
    ]
    .concat();
    for (arguments, part) in [
        (
            &["--steps", "friction", "--yes"][..],
            "--weight-kg KG --lever-m M",
        ),
        (&["--weight-kg", "2", "--yes"], "--lever-m"),
        (&light, "--weight-kg"),
        (&sure, "--weight-tolerance"),
        (&["--steps", "weight", "--yes"], "torque-constant"),
        (&["--device", "sim"], "--yes"),
    ] {
        refuses(&[&["calibrate"], arguments].concat(), 2, part);
    }
    // A zero that was set while the joint moved is none.
    let moving = ["--yes", "--device", "sim", "--scene", "passive-examination"];
    let done = calibrate("zero,polarity", &[&moving]);
    assert_eq!(done.status.code(), Some(1));
    let text = stdout(&done);
    assert!(
        text.contains("zero: bad") && text.contains("polarity: skipped"),
        "{text}"
    );
    // Without a zero nothing is armed.
    let done = calibrate("torque-constant", &[&WEIGHT, &ARM]);
    assert_eq!(done.status.code(), Some(1));
    assert!(
        stdout(&done).contains("the angle has no zero"),
        "{}",
        stdout(&done)
    );
}

#[cfg(target_os = "linux")]
mod on_a_served_device {
    use super::{WEIGHT, moved_to, support};
    use serde_json::Value;
    use std::process::{Child, Stdio};
    use std::thread::sleep;
    use std::time::{Duration, Instant};
    use support::served::Served;
    use support::{stdout, words};

    /// A device whose weight is being lifted by `calibrate`, and its parameters from before.
    fn lifting(served: &Served) -> (Child, Value) {
        assert!(served.run(&["zero", "--device", "knee"]).status.success());
        let before = parameters(served);
        let steps = words("calibrate --device knee --yes --steps torque-constant");
        let child = served
            .command(&[&steps[..], &WEIGHT].concat())
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        until(served, "armed");
        sleep(Duration::from_millis(500));
        (child, before)
    }

    fn parameters(served: &Served) -> Value {
        let listed = served.run(&["params", "get", "--json", "--device", "knee"]);
        let json: Value = serde_json::from_str(&stdout(&listed)).unwrap();
        json["values"].clone()
    }

    fn until(served: &Served, state: &str) {
        let end = Instant::now() + Duration::from_secs(20);
        while served.info()["status"]["state"] != state {
            assert!(Instant::now() < end, "{}", served.info());
            sleep(Duration::from_millis(50));
        }
    }

    fn ended(child: Child) -> (Option<i32>, String) {
        let done = child.wait_with_output().unwrap();
        (done.status.code(), support::stderr(&done))
    }

    #[test]
    fn what_is_applied_is_saved() {
        let folder = tempfile::tempdir().unwrap();
        let served = Served::with_scene(&moved_to(folder.path(), -10.0, 128.0));
        assert!(served.run(&["zero", "--device", "knee"]).status.success());
        let before = parameters(&served);
        let steps = ["calibrate", "--device", "knee", "--yes", "--steps", "range"];
        let more = ["--for", "7s", "--apply", "--json"];
        let done = served.run(&[&steps[..], &more].concat());
        assert!(done.status.success(), "{}", support::stderr(&done));
        let json: Value = serde_json::from_str(&stdout(&done)).unwrap();
        let (set, now) = (&json["calibration"], parameters(&served));
        let changes = set["parameters"].as_array().unwrap();
        assert!(!changes.is_empty());
        for change in changes {
            let name = change["name"].as_str().unwrap();
            assert_eq!(now[name], change["value"], "{name}");
            assert_ne!(now[name], before[name], "{name}");
        }
        let status = &served.info()["status"];
        assert_eq!(status["revision"], set["revision"]);
        assert_eq!(status["saved"], set["revision"]);
    }

    #[test]
    fn ctrl_c_disarms_and_restores_the_parameters() {
        let served = Served::with_scene("weight-on-the-arm");
        let (child, before) = lifting(&served);
        let pid = child.id().to_string();
        assert!(
            std::process::Command::new("kill")
                .args(["-INT", &pid])
                .status()
                .unwrap()
                .success()
        );
        let (code, text) = ended(child);
        assert_eq!(code, Some(1), "{text}");
        assert!(text.contains("interrupted: torque is off"), "{text}");
        assert_eq!(served.info()["status"]["state"], "disarmed");
        assert_eq!(parameters(&served), before);
    }

    #[test]
    fn a_stop_in_the_middle_is_said() {
        let served = Served::with_scene("weight-on-the-arm");
        let (child, before) = lifting(&served);
        assert!(served.run(&["stop", "--device", "knee"]).status.success());
        let (code, text) = ended(child);
        assert_eq!(code, Some(1), "{text}");
        assert!(
            text.contains("step torque-constant: ") && text.contains("nothing was written"),
            "{text}"
        );
        assert_eq!(served.info()["status"]["state"], "disarmed");
        assert_eq!(parameters(&served), before);
    }
}
