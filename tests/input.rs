//! Careless and hostile input: escapes, endless words, places
//! without write permission, values out of range.

#[cfg(target_os = "linux")]
#[path = "input/bad_files.rs"]
mod bad_files;
mod support;

use std::process::Output;
use support::{run, stderr, stdout};

const ESCAPE: char = '\u{1b}';

fn refused(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(2), "{}", stderr(output));
    let printed = stderr(output);
    assert!(!printed.contains(ESCAPE), "{printed:?}");
    printed
}

#[test]
fn terminal_escapes_are_shown_and_not_executed() {
    let home = tempfile::tempdir().unwrap();
    let scene = home.path().join("scene.toml");
    let text = "version = 1\ntitle = \"red \\u001b[31m title\"\nduration_s = 0.1\n\
        [motion]\nkind = \"constant\"\nvelocity_rad_s = 1.0\n\
        [solver]\nkind = \"exact\"\nstep_s = 1e-3\n[effects.crepitus]\n";
    std::fs::write(&scene, text).unwrap();
    let out = home.path().join("out");
    let (scene, out) = (scene.to_str().unwrap(), out.to_str().unwrap());
    let ran = run(&["run", scene, "--out", out]);
    assert_eq!(ran.status.code(), Some(0), "{}", stderr(&ran));
    let printed = stdout(&ran);
    assert!(
        printed.contains("red \\u{1b}[31m title") && !printed.contains(ESCAPE),
        "{printed:?}"
    );

    let bad = "\u{1b}[2J";
    for arguments in [
        &["run", bad][..],
        &["run", scene, "--set", &format!("effects.crepitus.{bad}=1")],
        &["stability", "--case", bad],
        &["params", "set", &format!("{bad}=1"), "--device", "sim"],
        &[
            "params",
            "set",
            &format!("crepitus.restart={bad}"),
            "--device",
            "sim",
        ],
        &["info", "--device", bad],
        &[bad],
        &["--json", "run", scene, bad],
    ] {
        let printed = refused(&run(arguments));
        assert!(
            printed.contains("u{1b}") || printed.contains("u001b"),
            "{arguments:?}: {printed}"
        );
    }
}

#[test]
fn no_input_is_repeated_at_length() {
    let long = "x".repeat(5_000);
    let words = "several words ".repeat(400);
    for input in [&long, &words] {
        for arguments in [
            &["run", input.as_str()][..],
            &["run", "fig6-ideal-cycle", "--set", input],
            &[
                "run",
                "fig6-ideal-cycle",
                "--set",
                &format!("title.{input}=1"),
            ],
            &["stability", "--case", input],
            &["accuracy", "--need", input],
            &["params", "get", input, "--device", "sim"],
            &["info", "--device", input],
            &[input],
        ] {
            let printed = refused(&run(arguments));
            let verb = arguments
                .first()
                .map_or("", |verb| verb.get(..9.min(verb.len())).unwrap_or(""));
            assert!(
                printed.chars().count() < 1_800,
                "{verb}: {} characters\n{printed}",
                printed.len()
            );
            for line in printed.lines() {
                assert!(!line.contains(&"x".repeat(201)), "{verb}: {line}");
            }
        }
    }
}

#[test]
fn permission_denied_and_invalid_values_are_bad_input() {
    // Not even root may make a folder there.
    #[cfg(target_os = "linux")]
    for arguments in [
        &["run", "fig6-ideal-cycle", "--out", "/sys/kernel/crepitus"][..],
        &[
            "stability",
            "--case",
            "H05",
            "--out",
            "/sys/kernel/crepitus",
        ],
        &[
            "record",
            "--device",
            "sim",
            "--for",
            "0.1s",
            "/sys/kernel/crepitus",
        ],
    ] {
        let printed = refused(&run(arguments));
        assert!(printed.contains("/sys/kernel/crepitus"), "{printed}");
    }
    for (name, value) in [
        ("crepitus.static_torque_nm", "9"),
        ("friction-compensation.share", "0.95"),
        ("crepitus.kinetic_torque_nm", "0.5"),
        ("crepitus.stiffness_nm_per_rad", "4000"),
        ("crepitus.nothing", "1"),
        ("crepitus.restart", "sideways"),
    ] {
        let printed = refused(&run(&[
            "params",
            "set",
            &format!("{name}={value}"),
            "--device",
            "sim",
        ]));
        assert!(printed.contains(name), "{printed}");
    }
}

/// Twice an input is as bad as a long one.
#[test]
fn no_input_is_repeated_at_length_piece_by_piece() {
    let long = "x".repeat(5_000);
    let value = format!("limits.torque_nm={long}");
    let points = tempfile::NamedTempFile::new().unwrap();
    let header = "pa ".repeat(400);
    std::fs::write(points.path(), format!("{header},b\n1,2\n")).unwrap();
    let points = points.path().to_str().unwrap();
    for arguments in [
        &["run", "fig6-ideal-cycle", "--step", &long][..],
        &["run", "fig6-ideal-cycle", "--set", &format!("a.b.c={long}")],
        &["params", "set", &value, "--device", "sim"],
        &["serve-sim", "--usbip", &format!("--usbip={long}")],
        &["serve-sim", "--name", &long],
        &["sweep", "low-speed", "--points", points],
    ] {
        let printed = refused(&run(arguments));
        let repeated = printed.matches("xx").count() * 2 + printed.matches("pa ").count() * 3;
        assert!(repeated <= 200, "{repeated}: {printed}");
    }
}

#[test]
fn no_input_forges_a_line() {
    let forged = "1\nerror: forged";
    for arguments in [
        &["run", "fig6-ideal-cycle", "--step", forged][..],
        &["run", "fig6-ideal-cycle", "--set", &format!("a={forged}")],
        &["run", forged],
        &["stability", "--case", forged],
        &[
            "params",
            "set",
            &format!("limits.torque_nm={forged}"),
            "--device",
            "sim",
        ],
        &["stream", "--rate", forged],
        &[forged],
    ] {
        let printed = refused(&run(arguments));
        let lines = printed
            .lines()
            .filter(|line| line.starts_with("error: "))
            .count();
        assert_eq!(lines, 1, "{arguments:?}: {printed}");
    }
}

/// A rule must be stated as one: the value broke it.
#[test]
fn a_rule_is_not_told_as_a_fact() {
    let printed = refused(&run(&[
        "params",
        "set",
        "texture.seed=1.5",
        "texture.render=on",
        "--device",
        "sim",
    ]));
    assert!(printed.contains("seed must be a whole number"), "{printed}");
}

/// JSON has no bytes for a path that is not UTF-8; the work that was done is reported all the same.
#[cfg(target_os = "linux")]
#[test]
fn paths_that_are_not_utf_8_are_printed_as_json() {
    use std::ffi::{OsStr, OsString};
    use std::os::unix::ffi::OsStrExt;
    let home = tempfile::tempdir().unwrap();
    let odd = home.path().join(OsStr::from_bytes(b"lab\xff"));
    std::fs::create_dir(&odd).unwrap();
    let at = |name: &str| odd.join(name).into_os_string();
    let words = |text: &str| -> Vec<OsString> { text.split(' ').map(OsString::from).collect() };
    let run = |text: &str, last: &[OsString]| {
        let all = [&words(text)[..], last].concat();
        let output = support::crepitus()
            .current_dir(home.path())
            .args(&all)
            .arg("--json")
            .output()
            .unwrap();
        assert_eq!(
            output.status.code(),
            Some(0),
            "{all:?}: {}",
            stderr(&output)
        );
        let printed: serde_json::Value = serde_json::from_str(&stdout(&output)).unwrap();
        assert!(
            printed.to_string().contains("lab\u{fffd}"),
            "{all:?}: {printed}"
        );
    };
    let wav = [at("run"), "--wav".into(), at("knee.wav")];
    run("run fig8 --set duration_s=0.2 --out", &wav);
    run(
        "effects fig8-4-cuff --set duration_s=0.2 --out",
        &[at("effects")],
    );
    run("stability --case H01 --out", &[at("stability")]);
    let sweep = "sweep fig8 --set duration_s=0.05 --format csv --vary effects.crepitus.static_torque_nm=1,2 --out";
    run(sweep, &[at("sweep")]);
    let half = |shard: &str, name: &str| [at(name), "--shard".into(), shard.into()];
    run(sweep, &half("1/2", "one"));
    run(sweep, &half("2/2", "two"));
    run("sweep --format csv --merge", &[at("one"), at("two")]);
    run("record --device sim --for 100ms", &[at("knee")]);
    run("report --out", &[at("report"), at("knee")]);
    run("export --format csv", &[at("knee")]);
    run("demo --out", &[at("demo")]);
}

/// A page that could not be written is no success.
#[cfg(target_os = "linux")]
#[test]
fn help_on_a_full_disk_is_a_failure() {
    for arguments in [&["--help"][..], &["--version"], &["run", "--help"]] {
        let full = std::fs::File::options()
            .write(true)
            .open("/dev/full")
            .unwrap();
        let output = support::crepitus()
            .args(arguments)
            .stdout(full)
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(1), "{arguments:?}");
        assert!(stderr(&output).contains("stdout cannot be written"));
        assert_eq!(run(arguments).status.code(), Some(0));
    }
}
