//! `sign`, `scale`, `offset_deg` and `repeat` of a recording, as scenes read them.

use crepitus_plant::{Extremes, Motion};
use crepitus_scene::run::Blind;
use crepitus_scene::{Overrides, Scene, run};
use std::fmt::Write as _;
use std::path::Path;

/// A gait-like cycle of 1.1 s at 100 Hz, in degrees, flexion negative.
fn cycle_deg(t: f64) -> f64 {
    let turn = std::f64::consts::TAU * t / 1.1;
    -30.0 + 20.0 * turn.cos() - 12.0 * (2.0 * turn + 0.5).sin()
}

/// `cycles` cycles as a CSV file.
fn write(folder: &Path, name: &str, cycles: u32) {
    let rows = (0..=110 * cycles).fold(String::from("t,angle\n"), |mut text, i| {
        let t = f64::from(i % 110) * 0.01;
        let _ = writeln!(text, "{},{}", f64::from(i) / 100.0, cycle_deg(t));
        text
    });
    std::fs::write(folder.join(name), rows).unwrap();
}

fn scene(folder: &Path, file: &str, duration_s: f64, keys: &str) -> Result<Scene, String> {
    scene_with(
        folder,
        file,
        duration_s,
        keys,
        "kind = \"exact-events\"\nstep_s = 5e-5",
    )
}

fn scene_with(
    folder: &Path,
    file: &str,
    duration_s: f64,
    keys: &str,
    solver: &str,
) -> Result<Scene, String> {
    let text = format!(
        "version = 1\ntitle = \"x\"\nduration_s = {duration_s:?}\n[motion]\nkind = \"recording\"\n\
         file = \"{file}\"\ntime_column = \"t\"\nangle_column = \"angle\"\nunit = \"deg\"\n{keys}\n\
         [solver]\n{solver}\n[effects.crepitus]\npreset = \"coarse\"\n"
    );
    Scene::parse(&folder.join("scene.toml"), &text, &Overrides::default())
        .map_err(|e| e.to_string())
}

fn states(motion: &Motion, duration_s: f64) -> Vec<[f64; 3]> {
    (0..1000)
        .map(|i| motion.at(duration_s * f64::from(i) / 1000.0))
        .map(|s| [s.phi_rad, s.omega_rad_s, s.omega_dot])
        .collect()
}

#[test]
fn sign_scale_and_offset_act_on_the_angle_alone() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "knee.csv", 2);
    let read = |keys| {
        states(
            &scene(folder.path(), "knee.csv", 2.0, keys).unwrap().motion,
            2.0,
        )
    };
    let plain = read("");
    assert_eq!(
        read("sign = 1\nscale = 1\noffset_deg = 0\nrepeat = false"),
        plain
    );
    let negated: Vec<_> = plain.iter().map(|s| s.map(|x| -x)).collect();
    assert_eq!(read("sign = -1"), negated, "to the bit");
    let doubled: Vec<_> = plain.iter().map(|s| s.map(|x| 2.0 * x)).collect();
    assert_eq!(read("scale = 2"), doubled, "to the bit");
    for ([phi, omega, omega_dot], [p, o, d]) in read("sign = -1\nscale = 0.7\noffset_deg = 12")
        .iter()
        .zip(&plain)
    {
        assert!(
            (phi - (12_f64.to_radians() - 0.7 * p)).abs() < 1e-14,
            "{phi}"
        );
        assert!((omega + 0.7 * o).abs() < 1e-13 && (omega_dot + 0.7 * d).abs() < 1e-11);
    }
}

#[test]
fn joints_break_in_every_cycle_alike_under_every_kind_of_solver() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "cycle.csv", 1);
    let counts = |duration_s, solver| {
        let scene = scene_with(
            folder.path(),
            "cycle.csv",
            duration_s,
            "sign = -1\nrepeat = true",
            solver,
        );
        let summary = run(&scene.unwrap(), &mut Blind).unwrap();
        summary.events.unwrap().breaks
    };
    let stepped = "kind = \"exact-events\"\nstep_s = 5e-5";
    let reference = "kind = \"reference\"";
    let long = counts(11.0, stepped);
    assert!(long > 100, "{long:?}");
    let exact = counts(11.0, reference);
    assert!(long.abs_diff(exact) <= 1, "{long:?} {exact:?}");
    let half = counts(5.5, reference);
    assert!(exact.abs_diff(2 * half) <= 2, "{half:?} {exact:?}");
}

#[test]
fn nonsense_is_refused_with_its_key() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "cycle.csv", 1);
    let half: String = std::fs::read_to_string(folder.path().join("cycle.csv"))
        .unwrap()
        .lines()
        .take(60)
        .fold(String::new(), |text, line| text + line + "\n");
    std::fs::write(folder.path().join("half.csv"), half).unwrap();
    for (file, duration_s, keys, parts) in [
        ("cycle.csv", 1.0, "scale = 0", ["motion.scale", "above 0"]),
        ("cycle.csv", 1.0, "scale = -1", ["motion.scale", "above 0"]),
        ("cycle.csv", 1.0, "scale = nan", ["motion.scale", "above 0"]),
        (
            "cycle.csv",
            1.0,
            "scale = 1e9",
            ["motion.scale", "up to 100"],
        ),
        ("cycle.csv", 1.0, "sign = 0.5", ["motion.sign", "1, or -1"]),
        ("cycle.csv", 1.0, "sign = 0", ["motion.sign", "1, or -1"]),
        (
            "cycle.csv",
            1.0,
            "sign = \"-\"",
            ["motion.sign", "a number"],
        ),
        (
            "cycle.csv",
            1.0,
            "repeat = 3",
            ["motion.repeat", "true or false"],
        ),
        ("cycle.csv", 2.0, "", ["motion.file", "repeat = true"]),
        (
            "cycle.csv",
            1.0,
            "from_deg = 3",
            ["motion.from_deg", "offset_deg"],
        ),
        (
            "half.csv",
            5.0,
            "repeat = true",
            ["motion.repeat", "whole cycles"],
        ),
        (
            "cycle.csv",
            5.0,
            "repeat = true\ncutoff_hz = 70",
            ["motion.cutoff_hz", "50.0000"],
        ),
    ] {
        let error = scene(folder.path(), file, duration_s, keys)
            .map(|_| ())
            .unwrap_err();
        for part in parts {
            assert!(error.contains(part), "{keys}: {error}");
        }
    }
}

/// A laboratory's file says of itself what its numbers are; the summary of the run repeats it.
#[test]
#[expect(clippy::too_many_lines, reason = "a form after the other")]
fn the_form_of_a_file_is_taken_from_it_and_said() {
    let folder = tempfile::tempdir().unwrap();
    let angle = |i: i32| 50.0 + 40.0 * (f64::from(i) * std::f64::consts::PI / 100.0).sin();
    let mut dynamometer = String::from(
        "Test      : knee, passive, 60 deg/s\r\nSamples   : 400 at 100 Hz\r\n\r\n      Time  Torque  Position\r\n      \
         mSec     N-m   Degrees\r\n",
    );
    let mut motion = String::from("Coordinates\ninDegrees=yes\n  endheader\ntime\thip knee\n");
    for i in 0..400 {
        let _ = write!(
            dynamometer,
            "{:10} {:8.2} {:8.2}\r\n",
            10 * i,
            5.7,
            angle(i)
        );
        let _ = writeln!(motion, "{}\t1\t{}", f64::from(i) / 100.0, angle(i));
    }
    std::fs::write(folder.path().join("d.txt"), dynamometer).unwrap();
    std::fs::write(folder.path().join("k.mot.txt"), motion).unwrap();
    let scene = |keys: &str| {
        let text = format!(
            "version = 1\nduration_s = 3.9\n[motion]\nkind = \"recording\"\n{keys}\n[solver]\n\
             kind = \"exact-events\"\nstep_s = 5e-5\n[effects.crepitus]\npreset = \"coarse\"\n"
        );
        Scene::parse(
            &folder.path().join("walk.toml"),
            &text,
            &Overrides::default(),
        )
        .map_err(|e| e.to_string())
    };
    let of_table = "file = \"d.txt\"\ntime_column = \"Time\"\nangle_column = \"Position\"";
    let of_motion = "file = \"k.mot.txt\"\ntime_column = \"time\"\nangle_column = \"knee\"";
    for (keys, said) in [
        (
            of_table.to_owned(),
            &[
                "line 4",
                "blanks",
                "line 5 has the units",
                "times are in ms",
                "in deg",
            ][..],
        ),
        (
            format!("{of_table}\ntime_unit = \"ms\"\nunit = \"deg\""),
            &["line 4", "blanks", "line 5"],
        ),
        (
            of_motion.to_owned(),
            &["blanks, the rows by tabs", "the header (inDegrees=yes)"],
        ),
    ] {
        let scene = scene(&keys).unwrap();
        assert_eq!(scene.title, "walk");
        let Extremes { low, high }: Extremes<f64> = (0..390)
            .map(|i| scene.motion.at(f64::from(i) / 100.0).phi_rad.to_degrees())
            .collect();
        assert!(
            (low - 10.0).abs() < 0.5 && (high - 90.0).abs() < 0.5,
            "{low} {high}"
        );
        let read_as = &scene.data.as_ref().unwrap().read_as;
        assert_eq!(read_as.len(), said.len(), "{read_as:?}");
        for (found, part) in read_as.iter().zip(said) {
            assert!(found.contains(part), "{found}: {part}");
        }
        assert!(scene.as_run.contains("unit = \"deg\""), "{}", scene.as_run);
        assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    }
    for (keys, key, part) in [
        (
            format!("{of_motion}\nangle_column = \"k\""),
            "",
            "duplicate key",
        ),
        (
            format!("{of_table}\ntime_unit = \"clock\""),
            "`motion.time_unit`",
            "time of day",
        ),
        (
            format!("{of_table}\ntime_unit = \"days\""),
            "`motion.time_unit`",
            "allowed are s, ms, us, min and clock",
        ),
        (
            format!("{of_table}\nmax_gap_s = 60"),
            "`motion.max_gap_s`",
            "up to 10",
        ),
    ] {
        let error = scene(&keys).map(|_| ()).unwrap_err();
        assert!(error.contains(key) && error.contains(part), "{error}");
    }
    write(folder.path(), "cycle.csv", 1);
    let keys = "file = \"cycle.csv\"\ntime_column = \"t\"\nangle_column = \"angle\"";
    let error = scene(keys).map(|_| ()).unwrap_err();
    assert!(
        error.contains("`motion.unit`") && error.contains("write unit = \"deg\""),
        "{error}"
    );
}

/// Characters that only look like those of TOML are named, with their column and what to write.
#[test]
fn toml_of_word_processors_and_of_windows_is_explained() {
    let good = "version = 1\ntitle = \"x\"\nduration_s = 0.1\n[motion]\nkind = \"constant\"\nvelocity_rad_s = 1.0\n";
    for (from, to, parts) in [
        (
            "\"constant\"",
            "\u{201c}constant\u{201d}",
            [
                "line 5",
                "column 8 has U+201C (left double quotation mark), write \"",
            ],
        ),
        (
            "= 1.0",
            "= \u{2212}1.0",
            ["line 6", "column 18 has U+2212 (minus sign), write -"],
        ),
        (
            "= 0.1",
            "=\u{a0}0.1",
            [
                "line 3",
                "column 13 has U+00A0 (no-break space), write a plain space",
            ],
        ),
        (
            "\"x\"",
            "\"C:\\Users\\x\"",
            ["line 2", "write a path with single quotes"],
        ),
        ("= 1.0", "= 1.0.0", ["line 6", "not valid TOML"]),
    ] {
        let text = good.replace(from, to);
        let scene = Scene::parse(Path::new("x.toml"), &text, &Overrides::default());
        let error = scene.map(|_| ()).unwrap_err().to_string();
        for part in parts {
            assert!(error.contains(part), "{error}: {part}");
        }
    }
}

/// The summary of the run could not name it.
#[cfg(target_os = "linux")]
#[test]
fn a_recording_whose_path_is_not_utf_8_is_refused() {
    use std::os::unix::ffi::OsStrExt;
    let home = tempfile::tempdir().unwrap();
    let folder = home.path().join(std::ffi::OsStr::from_bytes(b"lab\xff"));
    std::fs::create_dir(&folder).unwrap();
    write(&folder, "cycle.csv", 1);
    let error = scene(&folder, "cycle.csv", 1.0, "")
        .map(|_| ())
        .unwrap_err();
    for part in ["motion.file", "cycle.csv", "expected a path in UTF-8"] {
        assert!(error.contains(part), "{error}");
    }
}

#[test]
fn the_scene_as_run_says_how_the_recording_was_taken() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "cycle.csv", 1);
    let first = scene(folder.path(), "cycle.csv", 3.0, "sign = -1\nrepeat = true").unwrap();
    for key in ["sign = -1", "scale = 1", "offset_deg = 0", "repeat = true"] {
        assert!(first.as_run.contains(key), "{key}: {}", first.as_run);
    }
    let again = Scene::parse(
        Path::new("elsewhere.toml"),
        &first.as_run,
        &Overrides::default(),
    );
    let again = again.unwrap();
    assert_eq!(again.motion, first.motion);
    assert_eq!(again.as_run, first.as_run);
}
