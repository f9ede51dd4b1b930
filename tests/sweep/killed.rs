//! Sweeps that are killed, interrupted, damaged, or run twice at once.

use crate::support::{names, stderr, table};
use crate::{GRID, done, refused, sweep};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Sweep of so many short runs that on any computer a part is written before the last of them: after
/// 8192 rows, or two seconds.
const MANY: &str = "low-speed --latin 16000 --seed 5 \
                    --vary effects.crepitus.stiffness_nm_per_rad=60:300:log \
                    --vary effects.crepitus.preset=coarse,fine --set duration_s=5e-4";

/// One core, and where to.
const ON_ONE_CORE: &str = "--out s --threads 1 --format csv";

/// Number of whole parts in a folder; one that is being written has a name with a dot before it.
fn whole_parts(folder: &Path) -> usize {
    let names = names(&folder.join("parts"));
    names.iter().filter(|name| !name.starts_with('.')).count()
}

#[test]
fn rows_do_not_depend_on_cores_or_on_kills() {
    let home = tempfile::tempdir().unwrap();
    let home = home.path();
    let few = "everything --latin 300 --seed 5 --vary effects.cuff.stiffness_nm_per_rad=60:300:log \
               --vary effects.crepitus.preset=coarse,fine --set duration_s=0.2";
    for format in ["csv", "parquet"] {
        for folder in ["one", "three", "whole", "killed"] {
            let _ = fs::remove_dir_all(home.join(folder));
        }
        let with = |runs: &str, folder: &str, threads: u32| {
            format!("{runs} --out {folder} --threads {threads} --format {format}")
        };
        done(home, &with(few, "one", 1));
        done(home, &with(few, "three", 3));
        let read = |folder| fs::read(home.join(folder).join(format!("sweep.{format}"))).unwrap();
        assert!(read("one") == read("three"), "{format}: cores");

        // Killed each time that there is a new part, and begun again.
        done(home, &with(MANY, "whole", 2));
        let mut kills = 0;
        while !home.join("killed").join(format!("sweep.{format}")).exists() && kills < 3 {
            let mut child = sweep(home, &with(MANY, "killed", 1))
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .spawn()
                .unwrap();
            let before = whole_parts(&home.join("killed"));
            let begun = Instant::now();
            while child.try_wait().unwrap().is_none()
                && whole_parts(&home.join("killed")) <= before
                && begun.elapsed() < Duration::from_mins(1)
            {
                std::thread::sleep(Duration::from_millis(5));
            }
            kills += u32::from(child.try_wait().unwrap().is_none());
            let _ = child.kill();
            let _ = child.wait();
        }
        assert!(kills > 0, "{format}: it was over before it was killed");
        done(home, &with(MANY, "killed", 2));
        assert!(
            read("whole") == read("killed"),
            "{format}: killed {kills} times"
        );
        let mut left = vec!["sweep.json".to_owned(), format!("sweep.{format}")];
        left.sort();
        assert_eq!(names(&home.join("killed")), left);
    }
}

/// Two at once in one folder, and what becomes of a part that was damaged.
#[test]
fn one_program_runs_a_sweep_and_a_damaged_part_makes_no_table() {
    let home = tempfile::tempdir().unwrap();
    let home = home.path();
    let arguments = format!("{MANY} {ON_ONE_CORE}");
    let child = sweep(home, &arguments)
        .stderr(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let begun = Instant::now();
    let is_running = || {
        let names = names(&home.join("s/parts"));
        names.iter().any(|name| name.starts_with(".running-"))
    };
    while !is_running() {
        assert!(begun.elapsed() < Duration::from_mins(1), "it does not run");
        std::thread::sleep(Duration::from_millis(2));
    }
    for force in ["", " --force"] {
        let text = refused(home, &format!("{arguments}{force}"), 2);
        let words = "another program is running points 0 to 15999";
        assert!(text.contains(words) && text.contains("--out"), "{text}");
    }
    let kill = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status()
        .unwrap();
    assert!(kill.success());
    let output = child.wait_with_output().unwrap();
    assert!(!is_running(), "{}", stderr(&output));

    let shard = |part| done(home, &format!("{GRID} --format csv --out t --shard {part}"));
    shard("1/2");
    shard("2/2");
    let part = home.join("t/parts/0000000007-0000000015.csv");
    let mut bytes = fs::read(&part).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(&part, bytes).unwrap();
    let text = refused(home, "--merge t --format csv", 1);
    assert!(
        text.contains("0000000007-0000000015.csv") && text.contains("move it away"),
        "{text}"
    );
    assert!(!home.join("t/sweep.csv").exists());
    fs::remove_file(part).unwrap();
    shard("2/2");
    done(home, "--merge t --format csv");
    assert_eq!(names(&home.join("t")), ["sweep.csv", "sweep.json"]);
}

#[test]
fn an_interrupted_sweep_goes_on() {
    let home = tempfile::tempdir().unwrap();
    let home = home.path();
    let arguments = format!("{MANY} {ON_ONE_CORE}");
    let child = sweep(home, &arguments)
        .stderr(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let begun = Instant::now();
    while whole_parts(&home.join("s")) == 0 {
        assert!(begun.elapsed() < Duration::from_mins(1), "there is no part");
        std::thread::sleep(Duration::from_millis(5));
    }
    let kill = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status()
        .unwrap();
    assert!(kill.success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    let text = stderr(&output);
    assert!(
        text.contains("interrupted after") && text.contains("goes on from there"),
        "{text}"
    );
    let parts = names(&home.join("s/parts"));
    assert!(!parts.is_empty() && parts.iter().all(|p| !p.starts_with('.')));
    // Only the others run.
    let told = done(home, &format!("{arguments} --json"));
    let told: Value = serde_json::from_str(&told).unwrap();
    let ran = told["ran"].as_u64().unwrap();
    assert!((1..16_000).contains(&ran), "{told}");
    let (_, rows) = table(&home.join("s/sweep.csv"));
    assert_eq!(rows.len(), 16_000);
}
