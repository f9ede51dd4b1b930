//! Output of a run for a paper: pictures at a column's width, measured curves over computed ones,
//! sound.

mod support;

use serde_json::Value;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use support::{csv, done, names, run, stderr, stdout, words};

/// Runs a scene that ships for a second into `out`, with more arguments; its JSON.
fn played(scene: &str, out: &Path, more: &[&str]) -> Value {
    let output = run(&[
        &[
            "run",
            scene,
            "--json",
            "--set",
            "duration_s=1",
            "--out",
            out.to_str().unwrap(),
        ],
        more,
    ]
    .concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    serde_json::from_str(&stdout(&output)).unwrap()
}

/// Exit code 2, these words, and nothing written.
fn refused(scene: &str, more: &[&str], words: &[&str]) {
    let home = tempfile::tempdir().unwrap();
    let out = home.path().join("out");
    let output = run(&[&["run", scene, "--out", out.to_str().unwrap()], more].concat());
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{more:?}: {message}");
    for word in words {
        assert!(message.contains(word), "{more:?}: {message}");
    }
    assert_eq!(names(home.path()), [""; 0], "{more:?}");
}

#[test]
fn pictures_of_a_run_have_the_width_of_a_column_and_their_letters_with_them() {
    let home = tempfile::tempdir().unwrap();
    for (column, mm, pt) in [("one", "88.9mm", 252.0), ("two", "182mm", 515.906)] {
        let [svg, pdf] = ["svg", "pdf"].map(|kind| home.path().join(column).join(kind));
        played(
            "slow-examination",
            &svg,
            &["--pictures", "--column", column],
        );
        played(
            "slow-examination",
            &pdf,
            &["--pictures=pdf", "--column", column],
        );
        for name in ["motion", "torque", "zoom-1"] {
            let drawn = fs::read_to_string(svg.join(name).with_extension("svg")).unwrap();
            assert!(drawn.contains(&format!("width=\"{mm}\"")), "{name}");
            assert!(!drawn.contains("<text"), "{name}");
            let bytes = fs::read(pdf.join(name).with_extension("pdf")).unwrap();
            let text = String::from_utf8_lossy(&bytes);
            let media = text.split_once("/MediaBox [0 0 ").unwrap().1;
            let across: f64 = media.split_once(' ').unwrap().0.parse().unwrap();
            assert!((across - pt).abs() < 0.01, "{name}: {across} pt");
            let fonts = text.matches("/Type /FontDescriptor").count();
            assert!(
                fonts > 0 && text.matches("/FontFile").count() == fonts,
                "{name}"
            );
        }
    }
    refused("slow-examination", &["--column", "one"], &["--pictures"]);
    refused(
        "slow-examination",
        &["--pictures", "--column", "three"],
        &["one or two"],
    );
}

/// A bench's table of a run: every 50th row, torque in mN·m with the other sign, angle in degrees.
fn bench(run: &Path, file: &Path, torque_off_nm: f64) {
    let (header, rows) = csv(&run.join("trace.csv"));
    let place = |name: &str| header.iter().position(|h| h == name).unwrap();
    let (t, angle, torque) = (place("t_s"), place("angle_rad"), place("torque_nm"));
    let number = |row: &[String], at: usize| row[at].parse::<f64>().unwrap();
    let lines: Vec<String> = rows
        .iter()
        .step_by(5)
        .map(|row| {
            format!(
                "{},{},{}",
                number(row, t),
                -1e3 * (number(row, torque) + torque_off_nm),
                number(row, angle).to_degrees() + 3.0
            )
        })
        .collect();
    fs::write(file, format!("time,T,knee\n{}\n", lines.join("\n"))).unwrap();
}

#[test]
fn measured_curves_lie_over_those_of_the_run() {
    let home = tempfile::tempdir().unwrap();
    let [first, second] = ["first", "second"].map(|name| home.path().join(name));
    let file = home.path().join("bench.csv");
    played("slow-examination", &first, &[]);
    bench(&first, &file, 0.02);
    let overlay = format!(
        "--overlay {} --overlay-columns t_s=time,torque_nm=T,angle_deg=knee \
         --overlay-scale torque_nm=-0.001 --overlay-offset angle_deg=-3 --pictures",
        file.display()
    );
    let overlay = words(&overlay);
    let printed = played("slow-examination", &second, &overlay);
    let found = printed["overlay"].as_array().unwrap();
    assert_eq!(found.len(), 2, "{found:?}");
    let near = |value: &Value, expected: f64| {
        assert!(
            (value.as_f64().unwrap() - expected).abs() < 1e-9,
            "{value} {expected}"
        );
    };
    assert_eq!(
        (&found[0]["column"], &found[0]["points"]),
        (&"torque_nm".into(), &401.into())
    );
    near(&found[0]["rms_difference"], 0.02);
    near(&found[0]["mean_difference"], 0.02);
    near(&found[0]["correlation"], 1.0);
    assert_eq!(found[1]["column"], "angle_rad");
    near(&found[1]["rms_difference"], 0.0);
    assert!(names(&second).contains(&"overlay.svg".to_owned()));
    let page = fs::read_to_string(second.join("report.html")).unwrap();
    for words in [
        "Measured torque against this run",
        "RMS difference",
        "correlation",
    ] {
        assert!(page.contains(words), "{words}");
    }
    // Shifted out of the run: said, and not compared.
    let shifted = [&overlay[..], &["--overlay-shift", "100"]].concat();
    let printed = played("slow-examination", &home.path().join("third"), &shifted);
    assert_eq!(printed["overlay"][0]["points"], 0);
    assert!(printed["overlay"][0]["correlation"].is_null());
    // A trace of ours needs no mapping.
    let trace = first.join("trace.csv");
    let printed = played(
        "slow-examination",
        &home.path().join("fourth"),
        &["--overlay", trace.to_str().unwrap()],
    );
    let found = printed["overlay"].as_array().unwrap();
    assert_eq!(found.len(), 3, "{found:?}");
    for difference in found {
        near(&difference["rms_difference"], 0.0);
    }
}

#[test]
fn a_bad_overlay_is_refused_before_the_run() {
    let home = tempfile::tempdir().unwrap();
    let file = home.path().join("bench.csv");
    let path = file.to_str().unwrap();
    let write = |rows: &str| fs::write(&file, format!("time,T\n{rows}")).unwrap();
    write("0,1\n0.1,2\n0.2,3\n0.3,4\n");
    let with = |more: &[&'static str], words: &[&str]| {
        refused(
            "slow-examination",
            &[&["--overlay", path], more].concat(),
            words,
        );
    };
    with(&[], &["t_s", "\"time\"", "--overlay-columns"]);
    with(
        &["--overlay-columns", "t_s=time"],
        &["no such column", "--overlay-columns"],
    );
    with(
        &["--overlay-columns", "t_s=time,torque_nm=M"],
        &["\"M\"", "line 1"],
    );
    with(
        &["--overlay-columns", "t_s=time,torque_ncm=T"],
        &["torque_ncm", "torque_nm"],
    );
    with(
        &["--overlay-columns", "t_s=time,hand_torque_nm=T"],
        &["no hand_torque_nm"],
    );
    with(
        &["--overlay-columns", "t_s=time,torque_nm=T,torque_nm=T"],
        &["twice"],
    );
    with(
        &[
            "--overlay-columns",
            "t_s=time,torque_nm=T",
            "--overlay-scale",
            "torque_nm=0",
        ],
        &["other than 0"],
    );
    with(
        &[
            "--overlay-columns",
            "t_s=time,torque_nm=T",
            "--overlay-offset",
            "torque_nm=x",
        ],
        &["a number"],
    );
    write("0,1\n0.2,2\n0.1,3\n0.3,4\n");
    with(
        &["--overlay-columns", "t_s=time,torque_nm=T"],
        &["line 4", "time"],
    );
    write("0,1\n0.1,NaN\n0.2,3\n0.3,4\n");
    with(
        &["--overlay-columns", "t_s=time,torque_nm=T"],
        &["line 3", "NaN"],
    );
}

/// The unit of a header counts, the start is said, and a name may have a comma or be a position.
#[test]
fn an_overlay_is_read_as_its_file_says() {
    let home = tempfile::tempdir().unwrap();
    let first = home.path().join("first");
    played("slow-examination", &first, &[]);
    let (header, rows) = csv(&first.join("trace.csv"));
    let column = |name: &str| header.iter().position(|other| other == name).unwrap();
    let [time, angle, torque] = ["t_s", "angle_rad", "torque_nm"].map(column);
    let number = |row: &[String], at: usize| row[at].parse::<f64>().unwrap();
    let mut text =
        String::from("Coordinates\ninDegrees=yes\nendheader\ntime\tknee\tT, N·m\tT\tT\n");
    for row in rows.iter().step_by(20) {
        let (t, deg) = (1.0 + number(row, time), number(row, angle).to_degrees());
        let nm = number(row, torque);
        writeln!(text, "{t}\t{deg}\t{nm}\t{nm}\t{nm}").unwrap();
    }
    let file = home.path().join("knee.mot.txt");
    fs::write(&file, text).unwrap();
    let overlaid = |name: &str, columns: &str| {
        let out = home.path().join(name);
        run(&[
            "run",
            "slow-examination",
            "--set",
            "duration_s=1",
            "--json",
            "--out",
            out.to_str().unwrap(),
            "--overlay",
            file.to_str().unwrap(),
            "--overlay-columns",
            columns,
        ])
    };
    for (name, columns) in [
        ("a", "t_s=time,angle_rad=knee,torque_nm=\"T, N·m\""),
        ("b", "t_s=#1,angle_rad=#2,torque_nm=#5"),
    ] {
        let output = overlaid(name, columns);
        let said = stderr(&output);
        assert!(output.status.success(), "{said}");
        for part in [
            "inDegrees=yes",
            "taken as deg",
            "the times begin at 1 s, which is laid at 0 s",
        ] {
            assert!(said.contains(part), "{said}: {part}");
        }
        let printed: Value = serde_json::from_str(&stdout(&output)).unwrap();
        for difference in printed["overlay"].as_array().unwrap() {
            let rms = difference["rms_difference"].as_f64().unwrap();
            assert!(rms < 1e-9, "{difference}");
        }
        assert_eq!(printed["overlay"].as_array().unwrap().len(), 2);
    }
    let output = overlaid("c", "t_s=time,torque_nm=T");
    assert_eq!(output.status.code(), Some(2));
    let printed: Value = serde_json::from_str(&stdout(&output)).unwrap();
    let said = printed["error"]["message"].as_str().unwrap();
    assert!(
        said.contains("used twice, for columns 4 and 5") && said.contains("\"#4\""),
        "{said}"
    );
}

#[test]
fn a_run_can_be_heard() {
    let home = tempfile::tempdir().unwrap();
    let file = home.path().join("knee.wav");
    let wav = ["--wav", file.to_str().unwrap()];
    let printed = played("slow-examination", &home.path().join("a"), &wav);
    let sound = &printed["sound"];
    assert_eq!(
        (&sound["rate_hz"], &sound["missing_rows"]),
        (&48_000.into(), &0.into())
    );
    let full_scale_nm = sound["full_scale_nm"].as_f64().unwrap();
    // Ts is 0.4 N·m: the steps of the torque are no larger.
    assert!((0.1..0.6).contains(&full_scale_nm), "{sound}");
    let mut reader = hound::WavReader::open(&file).unwrap();
    let samples: Vec<i16> = reader.samples().map(Result::unwrap).collect();
    assert!(samples.len().abs_diff(48_000) < 5, "{}", samples.len());
    let peak = samples.iter().map(|s| i32::from(*s).abs()).max().unwrap();
    assert!((peak - 29_195).abs() < 40, "{peak}");
    // With a hand, what it feels; from the same run the same bytes.
    let hand = [&wav[..], &["--wav-of", "hand", "--force"]].concat();
    played("fig8", &home.path().join("b"), &hand);
    let once = fs::read(&file).unwrap();
    played("fig8", &home.path().join("c"), &hand);
    assert!(once == fs::read(&file).unwrap());

    refused("slow-examination", &["--wav", "knee.mp3"], &[".wav"]);
    // Whatever its name is, what is no sound is not replaced by one.
    let other = home.path().join("other.wav");
    fs::write(&other, "CREPITUS").unwrap();
    let named = other.to_str().unwrap();
    refused(
        "slow-examination",
        &["--wav", named],
        &["already exists", "--force"],
    );
    assert_eq!(fs::read(&other).unwrap(), b"CREPITUS");
    refused(
        "slow-examination",
        &["--wav", "k.wav", "--wav-of", "hand"],
        &["[effects.hand]"],
    );
    refused("slow-examination", &["--wav-of", "hand"], &["--wav"]);
    let coarse = ["--wav", "k.wav", "--set", "output.trace_step_s=2e-2"];
    refused("slow-examination", &coarse, &["trace_step_s"]);
    refused(
        "slow-examination",
        &["--wav", "k.wav", "--no-trace"],
        &["--no-trace"],
    );
}

#[test]
fn a_recording_can_be_heard_and_compared() {
    let home = tempfile::tempdir().unwrap();
    let path = |name: &str| home.path().join(name).to_str().unwrap().to_owned();
    let recording = path("knee");
    done(&format!(
        "record --device sim --for 1s --arm --zero -- {recording}"
    ));
    let [csv, wav, out] = ["r.csv", "r.wav", "report"].map(path);
    done(&format!("export {recording} --format csv --out {csv}"));
    let printed = done(&format!(
        "report {recording} --json --out {out} --wav {wav} --overlay {csv} \
         --overlay-columns torque_nm=model_torque_nm,angle_rad=angle_rad"
    ));
    let printed: Value = serde_json::from_str(&printed).unwrap();
    for difference in printed["overlay"].as_array().unwrap() {
        // Torques are written with the digits of an f32.
        assert_eq!(difference["outside"], 0, "{difference}");
        assert!(
            difference["rms_difference"].as_f64().unwrap() < 1e-7,
            "{difference}"
        );
    }
    assert!(
        printed["sound"]["full_scale_nm"].as_f64().unwrap() > 0.0,
        "{printed}"
    );
    assert!(hound::WavReader::open(wav).unwrap().duration() > 20_000);
}
