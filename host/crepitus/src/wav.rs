//! `--wav`: a torque as a sound.

use crate::cli::Force;
use crate::failure::{Failure, print, warn};
use crate::output::to_stderr;
use clap::builder::{PathBufValueParser, TypedValueParser};
use clap::{Args, ValueEnum};
use crepitus_files::output::{Inputs, NewFile, is_stdout};
use crepitus_pages::sound::{Sound, SoundError, SoundSummary};
use crepitus_scene::trace::Column;
use std::path::{Path, PathBuf};

/// Whether a sound is wanted, and of what.
#[derive(Debug, Default, Args)]
pub(crate) struct Wav {
    /// Also write a torque as a sound: 48 kHz, from 30 Hz on, its largest sample 1 dB below full scale; `-`
    /// is standard output.
    #[arg(id = "wav", long = "wav", value_name = "FILE.wav", value_parser = PathBufValueParser::new().try_map(named))]
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

/// Refuses the name of something else than a sound.
fn named(path: PathBuf) -> Result<PathBuf, String> {
    if is_stdout(&path) {
        return Ok(path);
    }
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
    path: PathBuf,
    file: NewFile,
}

impl Wav {
    /// Ready for rows with these columns, this far apart; none without `--wav`.
    pub(crate) fn listener(
        &self,
        columns: &[Column],
        step_s: f64,
        force: Force,
        inputs: &Inputs,
    ) -> Result<Option<Listener>, Failure> {
        let Some(path) = &self.file else {
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
        let file = NewFile::create(path, force.force, inputs)?;
        let sound = Sound::new(step_s).map_err(|e| failed(path, &e))?;
        Ok(Some(Listener {
            sound,
            index,
            path: path.clone(),
            file,
        }))
    }

    fn is_stdout(&self) -> bool {
        self.file.as_deref().is_some_and(is_stdout)
    }

    /// Refuses a sound and JSON on standard output.
    pub(crate) fn check_stdout(&self, as_json: bool) -> Result<(), Failure> {
        if as_json && self.is_stdout() {
            return Err(Failure::input(
                "--json and --wav - would both write to standard output: name a file with --wav",
            ));
        }
        Ok(())
    }

    /// Prints the result of the verb: to stderr, if the sound goes to standard output.
    pub(crate) fn print(&self, text: &str) -> Result<(), Failure> {
        if self.is_stdout() {
            to_stderr(text.trim_end());
            return Ok(());
        }
        print(text)
    }
}

impl Listener {
    /// Takes a row, the first value of which is its time.
    pub(crate) fn row(&mut self, values: &[f64]) -> Result<(), Failure> {
        match (values.first(), values.get(self.index)) {
            (Some(time_s), Some(value)) => self
                .sound
                .row(*time_s, *value)
                .map_err(|e| failed(&self.path, &e)),
            _ => Ok(()),
        }
    }

    /// Writes the file.
    pub(crate) fn finish(self, title: &str) -> Result<SoundSummary, Failure> {
        let written = self.sound.write(self.file.as_file(), &self.path, title);
        let summary = written.map_err(|e| failed(&self.path, &e))?;
        self.file.persist()?;
        if summary.missing_rows > 0 {
            warn(format!(
                "{}: {} missing rows are silent",
                self.path.display(),
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
