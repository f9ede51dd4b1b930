//! `crepitus run`, `scenes`, `presets`, `completions` as a person or a script
//! uses them.

mod listed;
mod refused;
#[path = "../support/mod.rs"]
mod support;

use std::fs;
use support::{crepitus, csv, done, names, number, refuses, run_line, stderr, stdout, summary};

const FILES: [&str; 4] = ["events.csv", "report.html", "summary.json", "trace.csv"];

#[test]
fn a_scene_becomes_four_files() {
    let home = tempfile::tempdir().unwrap();
    let output = crepitus()
        .args(["run", "fig6-ideal-cycle"])
        .current_dir(home.path())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let folder = home.path().join("out/fig6-ideal-cycle");
    assert_eq!(names(&folder), FILES);
    assert_eq!(names(&home.path().join("out")), ["fig6-ideal-cycle"]);
    let report = "out/fig6-ideal-cycle/report.html";
    assert!(stdout(&output).replace('\\', "/").contains(report));

    let (header, rows) = csv(&folder.join("trace.csv"));
    assert_eq!(
        header.join(","),
        "t_s,angle_rad,omega_rad_s,phase,theta_rad,theta_dot_rad_s,torque_nm"
    );
    assert_eq!(rows.len(), 4_001);
    assert_eq!(
        (rows[600][0].as_str(), rows[4_000][0].as_str()),
        ("0.3", "2.0")
    );
    for row in &rows {
        assert!(["stick", "slip+", "slip-"].contains(&row[3].as_str()));
        assert!(number(&row[6]) <= 0.4 && number(&row[6]) >= 0.0);
    }

    let (header, events) = csv(&folder.join("events.csv"));
    assert_eq!(
        header.join(","),
        "t_s,effect,event,angle_rad,theta_rad,omega_rad_s,torque_before_nm,torque_after_nm"
    );
    assert_eq!(events.len(), 127);
    assert_eq!(
        (number(&events[0][0]), &events[0][1..3]),
        (1e-3, &["crepitus".to_owned(), "break".to_owned()][..])
    );

    let summary = summary(&folder);
    assert_eq!(summary["events"]["break"], 64);
    assert_eq!(summary["effects"][0]["name"], "crepitus");
    // Nothing is timed that nobody asked for: absent, not zero.
    for key in ["ns_per_step", "ns_resolution"] {
        assert!(summary["effects"][0].get(key).is_none(), "{key}");
    }
    assert_eq!(summary["convention"], "frozen");

    let report = fs::read_to_string(folder.join("report.html")).unwrap();
    assert!(report.len() < 5_000_000);
    assert!(!report.contains("http://") && !report.contains("https://"));
    assert!(!report.contains("<script"));
    assert!(report.matches("<svg").count() >= 5);
}

#[test]
fn effects_are_timed_when_that_is_asked_for() {
    let home = tempfile::tempdir().unwrap();
    for (name, more) in [("trace", ""), ("alone", " --no-trace")] {
        let to = home.path().join(name).display().to_string();
        done(&format!(
            "run encoder --set duration_s=0.2 --costs --out {to}{more}"
        ));
        let summary = summary(&home.path().join(name));
        for effect in summary["effects"].as_array().unwrap() {
            assert!(effect["ns_resolution"].as_f64().unwrap() > 0.0, "{effect}");
            assert!(effect.get("ns_per_step").is_some(), "{effect}");
        }
    }
    let report = fs::read_to_string(home.path().join("trace/report.html")).unwrap();
    assert!(report.contains("ns per step"));
}

#[test]
fn trace_rows_can_be_thinned_and_stay_the_same_rows() {
    let home = tempfile::tempdir().unwrap();
    let rows = |every: &str| {
        let out = home.path().join(every);
        done(&format!(
            "run encoder --set duration_s=0.2 --set output.trace_step_s=5e-5 --trace-every {every} \
             --out {}",
            out.display()
        ));
        csv(&out.join("trace.csv")).1
    };
    let (all, some) = (rows("1"), rows("7"));
    assert_eq!(all.len(), 4001);
    assert_eq!(some, all.into_iter().step_by(7).collect::<Vec<_>>());
}

#[test]
fn the_same_run_gives_the_same_bytes() {
    let home = tempfile::tempdir().unwrap();
    for solver in ["exact", "exact-events"] {
        let files = |name: &str| {
            let out = home.path().join(format!("{solver}-{name}"));
            let to = out.display();
            done(&format!(
                "run encoder --solver {solver} --set duration_s=1 --out {to}"
            ));
            ["trace.csv", "events.csv"].map(|f| fs::read(out.join(f)).unwrap())
        };
        assert_eq!(files("a"), files("b"));
    }
}

#[test]
fn options_change_the_scene() {
    let home = tempfile::tempdir().unwrap();
    let out = home.path().join("run");
    let printed = done(&format!(
        "--json run high-speed --solver exact --step 1e-3 --precision f32 \
         --set effects.crepitus.preset=fine --set duration_s=0.5 --out {}",
        out.display()
    ));
    let printed: serde_json::Value = serde_json::from_str(&printed).unwrap();
    assert_eq!(printed["summary"], summary(&out));
    assert_eq!(printed["out"], out.to_str().unwrap());
    let summary = &printed["summary"];
    assert_eq!(summary["solver"], "exact");
    assert_eq!(summary["step_s"], 1e-3);
    assert_eq!(summary["precision"], "f32");
    assert_eq!(summary["preset"], "fine");
    assert_eq!(summary["simulated_s"], 0.5);
    // The scene's rows are closer than this step.
    assert_eq!(csv(&out.join("trace.csv")).1.len(), 501);
    let warnings = summary["warnings"].to_string();
    assert!(
        warnings.contains("step longer than a stick phase"),
        "{warnings}"
    );
}

#[test]
fn a_solver_that_diverges_is_exit_code_1_and_writes_nothing() {
    let home = tempfile::tempdir().unwrap();
    let out = home.path().join("out");
    let output = run_line(&format!(
        "run knee-pass-physical --solver euler --step 5e-5 \
         --set effects.crepitus.inertia_kg_m2=1e-5 \
         --set effects.crepitus.stiffness_nm_per_rad=4e4 --out {}",
        out.display()
    ));
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    let said = stderr(&output);
    assert!(
        said.contains("\"euler\" diverged") && said.contains("ωn·h = 3.162"),
        "{said}"
    );
    assert!(!out.exists());
}

#[test]
fn what_scenes_promise_comes_true() {
    let home = tempfile::tempdir().unwrap();
    let breaks = |name: &str| {
        let out = home.path().join(name);
        done(&format!("run {name} --out {}", out.display()));
        let summary = summary(&out);
        assert_eq!(
            summary["warnings"].as_array().unwrap().len(),
            0,
            "{summary}"
        );
        summary["events"]["break"].as_u64().unwrap()
    };
    assert_eq!(breaks("knee-pass-frozen"), 124);
    assert_eq!(breaks("knee-pass-physical"), 3);
    assert_eq!(breaks("presliding"), 0);
    assert_eq!(breaks("reversal-inside-stick"), 24);
    assert!(breaks("restart-from-kinetic") > breaks("restart-elastic"));
}

#[test]
fn pictures_are_svg_or_pdf() {
    let home = tempfile::tempdir().unwrap();
    let pictures = |format: &str| {
        let out = home.path().join(format);
        let to = out.display();
        done(&format!(
            "run fig6-ideal-cycle --set duration_s=0.2 {format} --out {to}"
        ));
        out
    };
    let of = |folder: &std::path::Path, kind: &str| -> Vec<String> {
        let names = names(folder).into_iter();
        names
            .filter_map(|name| Some(name.strip_suffix(kind)?.to_owned()))
            .collect()
    };
    let (svg, pdf) = (pictures("--pictures"), pictures("--pictures=pdf"));
    assert_eq!(of(&svg, ".svg"), of(&pdf, ".pdf"));
    assert!(of(&pdf, ".svg").is_empty() && of(&svg, ".svg").len() > 3);
    for name in of(&pdf, ".pdf") {
        let drawn = fs::read_to_string(svg.join(format!("{name}.svg"))).unwrap();
        let size = drawn
            .split_once("viewBox=\"0 0 ")
            .unwrap()
            .1
            .split_once('"')
            .unwrap()
            .0;
        let points: Vec<f64> = size.split(' ').map(|px| number(px) * 0.75).collect();
        let file = fs::read(pdf.join(format!("{name}.pdf"))).unwrap();
        assert!(
            file.starts_with(b"%PDF-") && file.len() > 5000,
            "{name}: {} bytes",
            file.len()
        );
        let text = String::from_utf8_lossy(&file);
        let page = format!("/MediaBox [0 0 {} {}]", points[0], points[1]);
        assert_eq!(text.matches(&page).count(), 1, "{name}: {page}");
        assert_eq!(text.matches("/Type /Page\n").count(), 1, "{name}");
    }
    let bmp = ["run", "fig6-ideal-cycle", "--pictures=bmp"];
    refuses(&bmp, 2, "expected svg or pdf");
}
