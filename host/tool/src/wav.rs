//! `--wav`: a torque as a sound.

use crate::failure::{Failure, warn};
use clap::{Args, ValueEnum};
use crepitus_files::input;
use crepitus_recording::new_file;
use crepitus_scene::trace::Column;
use crepitus_sound::{Sound, SoundError, SoundSummary};
use std::io::Read;
use std::path::{Path, PathBuf};

/// Whether a sound is wanted, and of what.
#[derive(Debug, Default, Args)]
pub(crate) struct Wav {
    /// Also write a torque as a sound: 48 kHz, from 30 Hz on, its largest sample 1 dB below full scale.
    /// Replaces the file.
    #[arg(id = "wav", long = "wav", value_name = "FILE.wav", value_parser = named)]
    file: Option<PathBuf>,

    /// Which torque.
    #[arg(long, value_enum, default_value_t, requires = "wav")]
    wav_of: Of,
}

/// The torques that can be heard.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum Of {
    /// That of the model.
    #[default]
    Torque,
    /// That at the hand.
    Hand,
}

impl Of {
    fn column(self) -> &'static str {
        match self {
            Self::Torque => "torque_nm",
            Self::Hand => "hand_torque_nm",
        }
    }
}

/// Keeps a wrong name from being replaced by a sound.
fn named(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    if path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("wav"))
    {
        Ok(path)
    } else {
        Err("expected a name that ends in .wav".to_owned())
    }
}

/// A sound while rows come.
#[derive(Debug)]
pub(crate) struct Listener {
    sound: Sound,
    index: usize,
    file: PathBuf,
}

impl Wav {
    /// Ready for rows with these columns, this far apart; none without `--wav`.
    pub(crate) fn listener(
        &self,
        columns: &[Column],
        step_s: f64,
    ) -> Result<Option<Listener>, Failure> {
        let Some(file) = &self.file else {
            return Ok(None);
        };
        let name = self.wav_of.column();
        let Some(index) = columns.iter().position(|column| column.name == name) else {
            return Err(Failure::Input(match self.wav_of {
                Of::Torque => "--wav: there is no torque to hear: the scene has no [effects.crepitus]; with a hand, \
                               --wav-of hand"
                    .to_owned(),
                Of::Hand => "--wav-of hand: there is no torque at the hand: a scene has one with [effects.hand], a \
                             recording has none"
                    .to_owned(),
            }));
        };
        // Before the work, so that a place where no file can be is reported early.
        if file.is_dir() {
            return Err(Failure::Input(format!(
                "--wav {}: this is a folder: name a file",
                file.display()
            )));
        }
        if is_of_another_kind(file) {
            return Err(Failure::Input(format!(
                "--wav {}: this file is no sound, and would be replaced: choose another name",
                file.display()
            )));
        }
        new_file(file).map_err(|e| Failure::at(file, "cannot be written", &e))?;
        let sound = Sound::new(step_s).map_err(|e| failed(file, &e))?;
        Ok(Some(Listener {
            sound,
            index,
            file: file.clone(),
        }))
    }
}

/// Returns whether there is something in the file, and no sound.
fn is_of_another_kind(file: &Path) -> bool {
    let mut head = Vec::new();
    let read = input::open(file).and_then(|file| Ok(file.take(4).read_to_end(&mut head)?));
    read.is_ok() && !head.is_empty() && head != *b"RIFF"
}

impl Listener {
    /// Takes a row, the first value of which is its time.
    pub(crate) fn row(&mut self, values: &[f64]) -> Result<(), Failure> {
        match (values.first(), values.get(self.index)) {
            (Some(time_s), Some(value)) => self
                .sound
                .row(*time_s, *value)
                .map_err(|e| failed(&self.file, &e)),
            _ => Ok(()),
        }
    }

    /// Writes the file.
    pub(crate) fn finish(self, title: &str) -> Result<SoundSummary, Failure> {
        let file = self.file;
        let written = self.sound.write(&file, title);
        let summary = written
            .map_err(|e| failed(&file, &e))?
            .persist()
            .map_err(|e| Failure::at(&file, "cannot be written", &e))?;
        if summary.missing_rows > 0 {
            warn(format!(
                "{}: {} missing rows are silent",
                file.display(),
                summary.missing_rows
            ));
        }
        Ok(summary)
    }
}

fn failed(file: &Path, error: &SoundError) -> Failure {
    match error {
        SoundError::Io(e) => Failure::at(file, "cannot be written", e),
        SoundError::TooCoarse { .. } => Failure::Input(format!("{}: {error}", file.display())),
        _ => Failure::Work(format!("{}: {error}", file.display())),
    }
}

/// A line for people.
pub(crate) fn in_brief(sound: Option<&SoundSummary>) -> String {
    sound.map_or_else(String::new, |sound| {
        format!(
            "sound: {}, {:.0} to {:.0} Hz, {}\n",
            sound.file.display(),
            sound.band_hz[0],
            sound.band_hz[1],
            sound.level()
        )
    })
}
