//! `--pictures`: each chart of a report as a file of its own.

use crate::failure::Failure;
use crate::results::Files;
use clap::Args;
use crepitus_plot::{PdfError, Picture};
use std::str::FromStr;

/// Whether pictures are wanted, and how.
#[derive(Debug, Args)]
pub(crate) struct Pictures {
    /// Also write each figure of the report as a file: SVG, or PDF.
    #[arg(long = "pictures", value_name = "svg|pdf", num_args = 0..=1, require_equals = true,
          default_missing_value = "svg")]
    format: Option<PictureFormat>,
}

/// The format of the files.
#[derive(Clone, Copy, Debug)]
enum PictureFormat {
    Svg,
    Pdf,
}

impl FromStr for PictureFormat {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        match name {
            "svg" => Ok(Self::Svg),
            "pdf" if Picture::HAS_PDF => Ok(Self::Pdf),
            "pdf" => Err(format!("{}; or use svg", PdfError::NotBuilt)),
            _ => Err("expected svg or pdf".to_owned()),
        }
    }
}

impl Pictures {
    /// Whether they are wanted.
    pub(crate) const fn wanted(&self) -> bool {
        self.format.is_some()
    }

    /// The files, if they are wanted.
    pub(crate) fn files(&self, draw: impl FnOnce() -> Vec<Picture>) -> Result<Files, Failure> {
        let Some(format) = self.format else {
            return Ok(Vec::new());
        };
        let file = |picture: Picture| match format {
            PictureFormat::Svg => Ok((format!("{}.svg", picture.name), picture.svg.into())),
            PictureFormat::Pdf => match picture.pdf() {
                Ok(pdf) => Ok((format!("{}.pdf", picture.name), pdf)),
                Err(e) => Err(Failure::Work(format!(
                    "{}.pdf cannot be made: {e}",
                    picture.name
                ))),
            },
        };
        draw().into_iter().map(file).collect()
    }
}
