//! A torque in, a file out: frequency, level, length, silence, what the file says of itself.

use crepitus_pages::sound::{RATE_HZ, Sound, SoundError, SoundSummary};
use crepitus_plant::spectrum::Welch;
use std::f64::consts::TAU;
use std::fs::File;
use std::path::Path;

/// The file of a torque, in its place, with its samples as shares of full scale.
fn heard(
    folder: &Path,
    step_s: f64,
    duration_s: f64,
    torque: impl Fn(f64) -> f64,
) -> (SoundSummary, Vec<f64>) {
    let file = folder.join("sound.wav");
    let mut sound = Sound::new(step_s).unwrap();
    let times = (0_u32..).map(|i| f64::from(i) * step_s);
    for t in times.take_while(|t| *t < duration_s - 0.5 * step_s) {
        sound.row(t, torque(t)).unwrap();
    }
    let mut options = File::options();
    let out = options
        .read(true)
        .write(true)
        .create(true)
        .truncate(true)
        .open(&file)
        .unwrap();
    let summary = sound.write(&out, &file, "A test").unwrap();
    let mut wav = hound::WavReader::open(&file).unwrap();
    assert_eq!(wav.spec().sample_rate, RATE_HZ);
    let samples = wav
        .samples::<i16>()
        .map(|s| f64::from(s.unwrap()) / 32_767.0);
    (summary, samples.collect())
}

/// Frequency and amplitude of the strongest line, and the strongest of what is not within 20 Hz.
fn lines(samples: &[f64]) -> [(f64, f64); 2] {
    let mut welch = Welch::new(1.0 / f64::from(RATE_HZ), samples.len() as u64).unwrap();
    for sample in samples {
        welch.push(*sample);
    }
    let spectrum = welch.finish().unwrap();
    let mut all: Vec<(f64, f64)> = (0..)
        .zip(&spectrum.amplitudes)
        .map(|(i, a)| (f64::from(i) * spectrum.resolution_hz, *a))
        .collect();
    all.sort_by(|a, b| b.1.total_cmp(&a.1));
    let first = all[0];
    let other = all
        .iter()
        .find(|line| (line.0 - first.0).abs() > 20.0)
        .unwrap();
    [first, *other]
}

#[test]
fn a_sine_is_a_sine_of_the_same_frequency_and_its_level_is_stated() {
    let folder = tempfile::tempdir().unwrap();
    for (step_s, hz) in [
        (5e-5, 440.0),
        (5e-5, 8_000.0),
        (1e-4, 200.0),
        (7e-5, 1_234.0),
        (1e-5, 2_000.0),
    ] {
        let (summary, samples) = heard(folder.path(), step_s, 2.0, |t| {
            1.5 + 0.3 * (TAU * hz * t).sin()
        });
        let [(found_hz, amplitude), other] = lines(&samples[4_800..samples.len() - 4_800]);
        assert!((found_hz - hz).abs() < 3.0, "{found_hz} Hz for {hz} Hz");
        let torque_nm = amplitude * summary.full_scale_nm.unwrap();
        // Between two lines of the spectrum up to 15 % are missing.
        assert!(
            (0.25..0.305).contains(&torque_nm),
            "{hz} Hz: {torque_nm} N·m"
        );
        let other_db = 20.0 * (other.1 / amplitude).log10();
        assert!(
            other_db < -60.0,
            "{hz} Hz, step {step_s}: {other:?}, {other_db} dB"
        );
        assert!((summary.peak_nm - 0.3).abs() < 0.05, "{}", summary.peak_nm);
        assert!((summary.duration_s - 2.0).abs() < 2.0 * step_s.max(1.0 / 48_000.0));
    }
}

#[test]
fn nothing_clips_whatever_comes() {
    let folder = tempfile::tempdir().unwrap();
    // Clicks, large and small.
    for size in [1e-4, 0.4, 1e6] {
        let click = |t: f64| {
            if (t * 31.0).fract() < 0.5 {
                size
            } else {
                -size
            }
        };
        let (summary, samples) = heard(folder.path(), 5e-5, 0.5, click);
        let peak = samples.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        assert!((peak - 0.891).abs() < 1e-3, "{size}: {peak}");
        assert!((summary.full_scale_nm.unwrap() * 0.891 / summary.peak_nm - 1.0).abs() < 1e-9);
    }
}

#[test]
fn no_torque_is_silence_and_so_is_a_constant_one() {
    let folder = tempfile::tempdir().unwrap();
    for torque in [0.0, 0.25] {
        let (summary, samples) = heard(folder.path(), 5e-5, 0.3, |_| torque);
        assert!(samples.iter().all(|sample| *sample == 0.0));
        assert_eq!((summary.full_scale_nm, summary.peak_nm), (None, 0.0));
        assert!(summary.level().contains("silence"));
    }
}

#[test]
fn a_slow_torque_is_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let torque = |t: f64| 5.0 * (TAU * t).cos() + 0.01 * (TAU * 500.0 * t).sin();
    let (summary, samples) = heard(folder.path(), 5e-5, 2.0, torque);
    let [(hz, _), _] = lines(&samples);
    assert!((hz - 500.0).abs() < 3.0, "{hz}");
    // 5 N·m at 1 Hz are 5.6 mN·m behind the filter.
    assert!(summary.peak_nm < 0.02, "{}", summary.peak_nm);
}

#[test]
fn missing_rows_keep_the_time() {
    let mut sound = Sound::new(1e-3).unwrap();
    for i in (0..500).chain(800..1_000) {
        sound.row(f64::from(i) * 1e-3, f64::from(i % 7)).unwrap();
    }
    let out = tempfile::tempfile().unwrap();
    let summary = sound.write(&out, Path::new("x.wav"), "x").unwrap();
    assert_eq!(summary.missing_rows, 300);
    assert!(
        (summary.duration_s - 1.0).abs() < 2e-3,
        "{}",
        summary.duration_s
    );
}

#[test]
fn the_file_says_what_it_is_and_its_chunks_are_whole() {
    let folder = tempfile::tempdir().unwrap();
    let (summary, samples) = heard(folder.path(), 5e-5, 0.1, |t| (TAU * 100.0 * t).sin());
    let bytes = std::fs::read(folder.path().join("sound.wav")).unwrap();
    let number = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!(
        (&bytes[..4], number(4) + 8),
        (b"RIFF".as_slice(), bytes.len())
    );
    // Name and content of each chunk of a part of the file.
    let chunks = |mut at: usize, end: usize| {
        let mut chunks = Vec::new();
        while at < end {
            let content = at + 8..at + 8 + number(at + 4);
            chunks.push((bytes[at..at + 4].to_vec(), content.clone()));
            at = content.start + content.len().next_multiple_of(2);
        }
        assert_eq!(at, end);
        chunks
    };
    let whole = chunks(12, bytes.len());
    let of = |name: &[u8]| &whole.iter().find(|chunk| chunk.0 == name).unwrap().1;
    assert_eq!(of(b"data").len(), 2 * samples.len());
    let list = of(b"LIST");
    assert_eq!(&bytes[list.start..list.start + 4], b"INFO");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let texts: Vec<_> = chunks(list.start + 4, list.end)
        .into_iter()
        .map(|(name, content)| [text(&name), text(&bytes[content])])
        .collect();
    // Each with the zero at its end. A dot between units has two bytes.
    let comment = format!("torque above 30 Hz, {}\0", summary.level());
    assert!(comment.contains("N·m"), "{comment}");
    let software = concat!("crepitus ", env!("CARGO_PKG_VERSION"), "\0");
    let expected = [
        ["INAM", "A test\0"],
        ["ICMT", comment.as_str()],
        ["ISFT", software],
    ];
    assert_eq!(texts, expected);
}

#[test]
fn rows_too_far_apart_and_no_rows_are_errors() {
    for step_s in [0.1, 0.02, 0.0, -1.0, f64::NAN] {
        assert!(
            matches!(Sound::new(step_s), Err(SoundError::TooCoarse { .. })),
            "{step_s}"
        );
    }
    let out = tempfile::tempfile().unwrap();
    let sound = Sound::new(5e-5).unwrap();
    let error = sound.write(&out, Path::new("x.wav"), "x").unwrap_err();
    assert!(matches!(error, SoundError::Nothing));
}

/// A recording through which a computer slept for a night is not filled with silence up to the limit.
#[test]
fn a_gap_longer_than_any_sound_ends_it_at_once() {
    let mut sound = Sound::new(5e-5).unwrap();
    for row in 0..100 {
        sound.row(f64::from(row) * 5e-5, 0.1).unwrap();
    }
    let began = std::time::Instant::now();
    let ended = sound.row(86_400.0, 0.1);
    assert!(matches!(ended, Err(SoundError::TooLong)), "{ended:?}");
    assert!(began.elapsed().as_secs() < 5);
}
