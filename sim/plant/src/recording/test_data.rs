//! Real recordings, where the folder of them is present: gait, squats, running.

use super::test_smooth::jumps;
use super::{
    AngleUnit, Angles, Quantity, Samples, Source, acceleration_ripple_rad_s2, read, smooth,
};
use std::path::{Path, PathBuf};

const CUTOFF_HZ: f64 = 6.0;

/// Name, samples, peak speed in deg/s (mean over 20 ms), and the share by which 6 Hz may change it.
/// The crouch gait has its peak in its first 35 ms, where samples are on one side only, and a swing
/// of 10° in a time axis that was normalised to 1 s: 6 Hz cannot keep it.
const RECORDINGS: [(&str, usize, f64, f64); 8] = [
    ("opensim_walk_100hz", 238, 431.0, 0.15),
    ("opensim_crouch_gait_118hz", 119, 140.0, 0.35),
    ("opensim_normal_gait_50hz", 51, 349.0, 0.15),
    ("opencap_squat_100hz", 801, 223.0, 0.15),
    ("opencap_walk_100hz", 158, 352.0, 0.15),
    ("bmc_run_150hz", 122, 818.0, 0.15),
    ("bmc_walk_150hz", 182, 331.0, 0.15),
    ("predsim_walk_100hz", 146, 352.0, 0.15),
];

fn folder() -> Option<PathBuf> {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data"));
    if folder.is_dir() {
        return Some(folder.to_owned());
    }
    eprintln!("skipped: no recordings in {}", folder.display());
    None
}

fn read_csv(folder: &Path, name: &str) -> Samples {
    let path = folder.join(format!("{name}.csv"));
    let angle_column = "knee_flexion_deg";
    let angles = Quantity::Angles(Angles::of(Some(AngleUnit::Deg)));
    read(&Source::new(&path, "time_s", angle_column, angles)).unwrap()
}

#[test]
fn recordings_are_read_and_smoothed() {
    let Some(folder) = folder() else { return };
    for (name, count, peak_deg_s, tolerance) in RECORDINGS {
        let samples = read_csv(&folder, name);
        assert_eq!(samples.time_s.len(), count, "{name}");
        assert_eq!(samples.warnings, Vec::<String>::new(), "{name}");
        let segments = smooth(&samples, CUTOFF_HZ).unwrap();
        assert_eq!(segments.len(), count - 1);

        let peak = |values: &[f64]| values.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        let omega: Vec<f64> = segments.iter().map(|s| s.omega_rad_s(s.start_s)).collect();
        let found_deg_s = peak(&omega).to_degrees();
        let off: Vec<f64> = segments
            .iter()
            .zip(&samples.angle_rad)
            .map(|(s, y)| s.angle_rad(s.start_s) - y)
            .collect();
        let off_deg = peak(&off).to_degrees();
        let worst = jumps(&segments).into_iter().fold(0.0, f64::max);
        println!(
            "{name}: {found_deg_s:.0} deg/s ({peak_deg_s:.0}), off {off_deg:.2} deg, \
             jump {worst:.1e}, ripple {:.1} rad/s²",
            acceleration_ripple_rad_s2(&segments)
        );
        assert!(
            (found_deg_s / peak_deg_s - 1.0).abs() < tolerance,
            "{name}: {found_deg_s}"
        );
        // Running turns the knee within a few samples, and is off the most.
        assert!(off_deg < 5.0, "{name}: {off_deg} deg");
        assert!(worst < 1e-14, "{name}: {worst:e}");
    }
}

#[test]
fn opensim_files_agree_with_their_csv() {
    let Some(folder) = folder() else { return };
    for (raw, csv, sign) in [
        ("opencap_walk", "opencap_walk_100hz", 1.0),
        ("opensim_walk", "opensim_walk_100hz", 1.0),
        ("opensim_crouch_gait", "opensim_crouch_gait_118hz", -1.0),
    ] {
        let path = folder.join("raw").join(format!("{raw}.mot"));
        let angles = Angles {
            factor: sign,
            ..Angles::of(Some(AngleUnit::Deg))
        };
        let source = Source::new(&path, "time", "knee_angle_r", Quantity::Angles(angles));
        let samples = read(&source).unwrap();
        let expected = read_csv(&folder, csv);
        assert_eq!(samples.time_s.len(), expected.time_s.len(), "{raw}");
        for i in 0..samples.time_s.len() {
            assert!(
                (samples.time_s[i] - expected.time_s[i]).abs() < 1e-5,
                "{raw} row {i}"
            );
            let off = sign * samples.angle_rad[i] - expected.angle_rad[i];
            assert!(off.to_degrees().abs() < 1e-3, "{raw} row {i}");
        }
        if raw == "opensim_crouch_gait" {
            assert!(matches!(
                samples.warnings.as_slice(),
                [only] if only.contains("declares 120 rows, the file has 119")
            ));
        } else {
            assert_eq!(samples.warnings, Vec::<String>::new(), "{raw}");
        }
    }
}
