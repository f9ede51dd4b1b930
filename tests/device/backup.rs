//! Backup and restoration of a whole device.

use crate::support::served::Served;
use crate::support::{stderr, stdout};

/// A brace that is replaced by another one, of another version.
#[test]
fn a_device_is_backed_up_and_restored_by_name() {
    let served = Served::new();
    let home = tempfile::tempdir().unwrap();
    let file = home.path().join("brace.toml");
    let file = file.to_str().unwrap();
    let said = |arguments: &[&str]| {
        let output = served.run(arguments);
        assert!(
            output.status.success(),
            "{arguments:?}: {}",
            stderr(&output)
        );
        stdout(&output) + &stderr(&output)
    };
    let get = || {
        said(&["params", "get"])
            .lines()
            .skip(1)
            .collect::<Vec<_>>()
            .join("\n")
    };
    let own = [
        "encoder.lines=1024",
        "clonus.render=on",
        "clonus.amplitude_nm=1.125",
    ];
    said(&[&["params", "set"][..], &own].concat());
    // Active, and not saved.
    assert!(said(&["params", "backup", file]).contains("are not saved on it"));
    let text = std::fs::read_to_string(file).unwrap();
    assert!(
        text.contains("saved = false") && text.contains("lines = 1024"),
        "{text}"
    );
    let before = get();
    let again = served.run(&["params", "backup", file]);
    assert_eq!(again.status.code(), Some(2), "it replaces nothing");
    // Nor are they saved where they are restored.
    said(&["params", "reset", "encoder", "clonus"]);
    let restored = said(&["params", "restore", file]);
    assert!(
        restored.contains("as on the device of the backup"),
        "{restored}"
    );
    assert_eq!(get(), before);
    let status = &served.info()["status"];
    assert_ne!(status["saved"], status["revision"]);
    said(&["params", "save"]);
    std::fs::remove_file(file).unwrap();
    assert!(!said(&["params", "backup", file]).contains("not saved"));
    said(&["params", "reset", "encoder", "clonus"]);
    assert_ne!(get(), before);
    let restored = said(&["params", "restore", file, "--no-save"]);
    assert!(
        restored.contains("a restart brings back the old values"),
        "{restored}"
    );
    assert_eq!(get(), before);
    said(&["params", "restore", file]);
    let status = &served.info()["status"];
    assert_eq!(status["saved"], status["revision"]);
    // Another version's names, both ways.
    let text = std::fs::read_to_string(file).unwrap();
    let other = text
        .replace("lines = 1024", "pulses = 1024")
        .replace("[parameters.clonus]", "[parameters.tremble]");
    std::fs::write(file, other).unwrap();
    let restored = said(&["params", "restore", file]);
    for part in [
        "encoder.pulses",
        "tremble.amplitude_nm",
        "not in the file",
        "clonus.render, clonus",
    ] {
        assert!(restored.contains(part), "{part}: {restored}");
    }
    assert_eq!(get(), before, "what the file does not have stays");
    // One value out of range: nothing is set.
    std::fs::write(
        file,
        text.replace("lines = 1024", "lines = 1e9")
            .replace("1.125", "0.5"),
    )
    .unwrap();
    let refused = served.run(&["params", "restore", file]);
    assert_eq!(refused.status.code(), Some(2), "{}", stderr(&refused));
    assert!(
        stderr(&refused).contains("invalid encoder.lines"),
        "{}",
        stderr(&refused)
    );
    assert_eq!(get(), before);
}
