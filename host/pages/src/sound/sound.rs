//! Conversion of torque samples to a normalised WAV file.

use crate::sound::high_pass::{HIGH_PASS_HZ, HighPass};
use crate::sound::info_chunk;
use crate::sound::resampler::{PASSED, Resampler};
use serde::{Serialize, Serializer};
use std::fs::File;
use std::io::{self, BufReader, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Sampling rate of every sound, Hz.
pub const RATE_HZ: u32 = 48_000;

/// Peak level of a sound, as a share of full scale: −1 dB, so that no converter overshoots between
/// two samples.
pub(super) const PEAK: f64 = 0.891;

/// Peak torque below which a sound is silence, N·m: rounding noise of a constant.
const SILENCE_NM: f64 = 1e-9;

/// Longest sound, in samples: 12 hours, which the size fields of a WAV file hold.
const LONGEST: u64 = 12 * 3600 * RATE_HZ as u64;

/// Error of making a sound.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SoundError {
    /// The rows are too far apart for any frequency of a sound.
    #[error(
        "rows {step_s} s apart hold nothing above {HIGH_PASS_HZ} Hz, where a sound begins: shorten the trace's step \
         (output.trace_step_s) to 5e-5 s, at least to {} s",
        PASSED / HIGH_PASS_HZ
    )]
    TooCoarse {
        /// Time from row to row, s.
        step_s: f64,
    },
    /// No row was given.
    #[error("there are no rows to hear")]
    Nothing,
    /// The sound is longer than a WAV file holds.
    #[error("a WAV file holds 12 hours: take a shorter part")]
    TooLong,
    /// The file, or the temporary one, cannot be written.
    #[error("{0}")]
    Io(#[from] io::Error),
    /// The WAV format cannot be written.
    #[error("{0}")]
    Wav(#[from] hound::Error),
}

/// Sound of a torque, sample by sample.
#[derive(Debug)]
pub struct Sound {
    step_s: f64,
    resampler: Resampler,
    kept: SampleFile,
    first_s: Option<f64>,
    rows: u64,
    missing: u64,
    last: f64,
}

/// High-passed samples so far, in a temporary file.
#[derive(Debug)]
struct SampleFile {
    high_pass: HighPass,
    file: BufWriter<File>,
    samples: u64,
    peak_nm: f64,
}

impl SampleFile {
    fn take(&mut self, value: f64) -> Result<(), SoundError> {
        let value = self.high_pass.next(value);
        self.peak_nm = self.peak_nm.max(value.abs());
        self.samples += 1;
        if self.samples > LONGEST {
            return Err(SoundError::TooLong);
        }
        Ok(self.file.write_all(&value.to_le_bytes())?)
    }
}

/// Writes a path as JSON can have it.
fn path<S: Serializer>(file: &Path, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(&crepitus_files::json_path(file))
}

/// Level, length and band of a sound.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SoundSummary {
    /// Path of the file.
    #[serde(serialize_with = "path")]
    pub file: PathBuf,
    /// Sampling rate, Hz.
    pub rate_hz: u32,
    /// Duration, s.
    pub duration_s: f64,
    /// Lower and upper end of the band, Hz.
    pub band_hz: [f64; 2],
    /// Torque at full scale, N·m; none for a silent sound.
    pub full_scale_nm: Option<f64>,
    /// Peak torque above 30 Hz, N·m; 0 for a silent sound.
    pub peak_nm: f64,
    /// Number of missing rows, in which the last value holds: silence.
    pub missing_rows: u64,
}

impl SoundSummary {
    /// Returns the level as text.
    pub fn level(&self) -> String {
        match self.full_scale_nm {
            Some(nm) => format!("full scale is {nm:.5} N·m"),
            None => "silence: the torque has nothing above 30 Hz".to_owned(),
        }
    }
}

impl Sound {
    /// Creates a sound of values that are `step_s` apart, s.
    ///
    /// # Errors
    /// [`SoundError::TooCoarse`], or [`SoundError::Io`] if no temporary file can be created.
    pub fn new(step_s: f64) -> Result<Self, SoundError> {
        if !(step_s > 0.0 && PASSED / step_s > HIGH_PASS_HZ) {
            return Err(SoundError::TooCoarse { step_s });
        }
        let rate_hz = f64::from(RATE_HZ);
        Ok(Self {
            step_s,
            resampler: Resampler::new(1.0 / step_s, rate_hz),
            kept: SampleFile {
                high_pass: HighPass::new(rate_hz),
                file: BufWriter::new(tempfile::tempfile()?),
                samples: 0,
                peak_nm: 0.0,
            },
            first_s: None,
            rows: 0,
            missing: 0,
            last: 0.0,
        })
    }

    /// Takes the torque, N·m, at a time, s. Where rows are missing, or a value is not finite, the
    /// last one holds. A row that comes early, as the last of a run may, is left out.
    ///
    /// # Errors
    /// [`SoundError::Io`] or [`SoundError::TooLong`].
    pub fn row(&mut self, time_s: f64, torque_nm: f64) -> Result<(), SoundError> {
        let value = if torque_nm.is_finite() {
            torque_nm
        } else {
            self.last
        };
        let first_s = *self.first_s.get_or_insert(time_s);
        let place = (time_s - first_s) / self.step_s;
        // At once: a gap of days would be written as silence up to the limit.
        if (time_s - first_s) * f64::from(RATE_HZ) > LONGEST as f64 {
            return Err(SoundError::TooLong);
        }
        while (self.rows as f64) < place - 0.5 {
            self.missing += 1;
            self.push(self.last)?;
        }
        if (self.rows as f64) > place + 0.25 {
            return Ok(());
        }
        self.push(value)
    }

    fn push(&mut self, value: f64) -> Result<(), SoundError> {
        self.last = value;
        self.rows += 1;
        let kept = &mut self.kept;
        self.resampler.push(value, &mut |y| kept.take(y))
    }

    /// Writes the sound into `out`, an empty file that will be called `file`, with title and level in its
    /// `INFO` chunk.
    ///
    /// # Errors
    /// [`SoundError::Nothing`] without rows, or an error of writing.
    pub fn write(
        self,
        mut out: &File,
        file: &Path,
        title: &str,
    ) -> Result<SoundSummary, SoundError> {
        let Self {
            resampler,
            mut kept,
            missing,
            step_s,
            ..
        } = self;
        resampler.finish(&mut |y| kept.take(y))?;
        if kept.samples == 0 {
            return Err(SoundError::Nothing);
        }
        let rate_hz = f64::from(RATE_HZ);
        let is_silent = kept.peak_nm < SILENCE_NM;
        let summary = SoundSummary {
            file: file.to_owned(),
            rate_hz: RATE_HZ,
            duration_s: kept.samples as f64 / rate_hz,
            band_hz: [HIGH_PASS_HZ, PASSED * rate_hz.min(1.0 / step_s)],
            full_scale_nm: (!is_silent).then_some(kept.peak_nm / PEAK),
            peak_nm: if is_silent { 0.0 } else { kept.peak_nm },
            missing_rows: missing,
        };
        let scale = summary.full_scale_nm.map_or(0.0, |nm| 1.0 / nm);
        let specification = hound::WavSpec {
            channels: 1,
            sample_rate: RATE_HZ,
            bits_per_sample: 16,
            sample_format: hound::SampleFormat::Int,
        };
        let mut wav = hound::WavWriter::new(BufWriter::new(out), specification)?;
        let mut values = kept
            .file
            .into_inner()
            .map_err(io::IntoInnerError::into_error)?;
        values.seek(SeekFrom::Start(0))?;
        let mut values = BufReader::new(values);
        let mut bytes = [0; 8];
        for _ in 0..kept.samples {
            values.read_exact(&mut bytes)?;
            let share = f64::from_le_bytes(bytes) * scale;
            // At most 0.891 of the range.
            #[expect(clippy::cast_possible_truncation, reason = "within ±29,195")]
            wav.write_sample((share * f64::from(i16::MAX)).round() as i16)?;
        }
        wav.finalize()?;
        let comment = format!("torque above {HIGH_PASS_HZ} Hz, {}", summary.level());
        let software = concat!("crepitus ", env!("CARGO_PKG_VERSION"));
        info_chunk::append(
            &mut out,
            &[(b"INAM", title), (b"ICMT", &comment), (b"ISFT", software)],
        )?;
        out.sync_all()?;
        Ok(summary)
    }
}
