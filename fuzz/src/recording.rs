//! The readers of recordings, for any bytes as a file, CSV or OpenSim, and the
//! low-pass over what they accept:
//!
//! - neither panics, and an error has a message;
//! - accepted samples are at least `MIN_SAMPLES`, finite, strictly later one
//!   than the other, and begin at 0;
//! - the smooth motion is finite, and its pieces follow each other from the
//!   first sample to the last without a gap.
//!
//! The first byte chooses unit, cutoff, gaps and unit of time; the rest is the file. Its
//! columns are `t` and `a`.

use crepitus_plant::recording::{
    self, AngleUnit, Angles, CubicSegment, MIN_SAMPLES, Quantity, Samples, Source, TimeUnit,
};
use std::io::Write;
use tempfile::Builder;

/// Checks the laws.
///
/// # Panics
/// If one is broken.
pub fn body(data: &[u8]) {
    let Some((&how, file)) = data.split_first() else {
        return;
    };
    let suffix = [".csv", ".mot"][usize::from(how & 1)];
    let unit = [Some(AngleUnit::Deg), Some(AngleUnit::Rad), None][usize::from(how >> 1) % 3];
    let mut on_disk = Builder::new()
        .prefix("crepitus-fuzz-")
        .suffix(suffix)
        .tempfile()
        .expect("a temporary file");
    on_disk.write_all(file).expect("room for a small file");
    let source = Source {
        max_gap_s: f64::from(how >> 5 & 1),
        time_unit: (how >> 6 & 1 == 1).then_some(TimeUnit::Clock),
        ..Source::new(on_disk.path(), "t", "a", Quantity::Angles(Angles::of(unit)))
    };
    match recording::read(&source) {
        Err(error) => assert!(!error.to_string().trim().is_empty(), "{error:?}"),
        Ok(samples) => {
            good_samples(&samples);
            let cutoff_hz = 10_f64.powi(i32::from(how >> 2 & 7) - 3);
            match recording::smooth(&samples, cutoff_hz) {
                Err(error) => assert!(!error.to_string().trim().is_empty(), "{error:?}"),
                Ok(segments) => good_segments(&segments, &samples),
            }
        }
    }
}

fn good_samples(samples: &Samples) {
    let Samples {
        time_s, angle_rad, ..
    } = samples;
    assert!(time_s.len() >= MIN_SAMPLES && time_s.len() == angle_rad.len());
    assert!(time_s.iter().chain(angle_rad).all(|x| x.is_finite()));
    assert_eq!(time_s.first(), Some(&0.0));
    assert!(time_s.array_windows().all(|[a, b]| a < b), "{time_s:?}");
    for warning in &samples.warnings {
        assert!(!warning.trim().is_empty(), "{warning:?}");
    }
}

fn good_segments(segments: &[CubicSegment], samples: &Samples) {
    let ends = (
        segments.first().map(|s| s.start_s),
        segments.last().map(|s| s.end_s),
    );
    assert_eq!(ends.0, samples.time_s.first().copied());
    assert_eq!(ends.1, samples.time_s.last().copied());
    for segment in segments {
        assert!(segment.start_s < segment.end_s, "{segment:?}");
        assert!(segment.c.iter().all(|c| c.is_finite()), "{segment:?}");
    }
    assert!(
        segments.array_windows().all(|[a, b]| a.end_s == b.start_s),
        "a gap between two pieces"
    );
    assert!(recording::acceleration_ripple_rad_s2(segments).is_finite());
}
