//! `--pictures`: each chart of a report as a file of its own.

use crate::failure::Failure;
use crepitus_plot::{PdfError, Picture};

/// Names and contents of files.
pub(crate) type Files = Vec<(String, Vec<u8>)>;

/// The format of the files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PictureFormat {
    Svg,
    Pdf,
}

impl std::str::FromStr for PictureFormat {
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

/// The files, if they were asked for.
pub(crate) fn files(
    format: Option<PictureFormat>,
    draw: impl FnOnce() -> Vec<Picture>,
) -> Result<Files, Failure> {
    let Some(format) = format else {
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
