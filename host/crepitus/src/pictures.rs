//! `--pictures`: each chart of a report as a file of its own, for a screen or for a paper.

use crate::failure::{Failure, warn};
use crate::results::Files;
use clap::Args;
use crepitus_pages::plot::{Column, Paper, PdfError, Picture};
use std::ffi::OsString;
use std::str::FromStr;

/// Whether pictures are wanted, and how.
#[derive(Debug, Args)]
pub(crate) struct Pictures {
    /// Also write each figure of the report as a file: SVG, or PDF.
    #[arg(id = "pictures", long = "pictures", value_name = "svg|pdf", num_args = 0..=1, require_equals = true,
          default_missing_value = "svg")]
    format: Option<PictureFormat>,

    /// Lay the pictures out for a paper: one column is 88.9 mm wide, two are 182 mm, letters from 7 pt on,
    /// fonts embedded (PDF) or letters as outlines (SVG).
    #[arg(long, value_name = "one|two", requires = "pictures", value_parser = column)]
    column: Option<Column>,
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

/// Arguments with `--pictures pdf` as `--pictures=pdf`. The format may be left out, so what
/// follows it would be taken for an argument of its own.
pub(crate) fn joined(arguments: impl IntoIterator<Item = OsString>) -> Vec<OsString> {
    let mut joined: Vec<OsString> = Vec::new();
    let mut are_options = true;
    for argument in arguments {
        are_options &= argument != "--";
        match joined.last_mut() {
            Some(last)
                if are_options
                    && *last == "--pictures"
                    && (argument == "svg" || argument == "pdf") =>
            {
                last.push("=");
                last.push(argument);
            }
            _ => joined.push(argument),
        }
    }
    joined
}

/// Parses the width of a paper's figures.
fn column(name: &str) -> Result<Column, String> {
    match name {
        "one" | "two" if !Picture::HAS_PDF => Err(PdfError::NotBuilt.to_string()),
        "one" => Ok(Column::One),
        "two" => Ok(Column::Two),
        _ => Err("expected one or two".to_owned()),
    }
}

impl Pictures {
    /// Returns whether they are wanted.
    pub(crate) const fn wanted(&self) -> bool {
        self.format.is_some()
    }

    /// The files, if they are wanted.
    pub(crate) fn files(&self, draw: impl FnOnce(Paper) -> Vec<Picture>) -> Result<Files, Failure> {
        let Some(format) = self.format else {
            return Ok(Vec::new());
        };
        let column = self.column;
        let drawn = draw(column.map_or(Paper::Screen, Paper::Print));
        drawn
            .into_iter()
            .map(|picture| match column {
                Some(column) => {
                    warn_of_width(&picture, column);
                    file(&picture.in_print(), format, true)
                }
                None => file(&picture, format, false),
            })
            .collect()
    }
}

/// Warns of a picture that has to be wider than was asked for: one that cannot be laid out again.
fn warn_of_width(picture: &Picture, column: Column) {
    let mm = picture.print_mm();
    if mm > column.mm() {
        warn(format!(
            "{} is {mm:.0} mm wide: at {} mm its letters would be smaller than {} pt",
            picture.name,
            column.mm(),
            crepitus_pages::plot::paper::SMALLEST_PT
        ));
    }
}

fn file(
    picture: &Picture,
    format: PictureFormat,
    in_print: bool,
) -> Result<(String, Vec<u8>), Failure> {
    let (extension, made) = match format {
        PictureFormat::Svg if in_print => ("svg", picture.outlined().map(String::into_bytes)),
        PictureFormat::Svg => ("svg", Ok(picture.svg.clone().into())),
        PictureFormat::Pdf => ("pdf", picture.pdf()),
    };
    let name = format!("{}.{extension}", picture.name);
    match made {
        Ok(content) => Ok((name, content)),
        Err(e) => Err(Failure::Work(format!("{name} cannot be made: {e}"))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_format_belongs_to_the_option_before_it() {
        for (given, meant) in [
            (
                "run a --pictures pdf --force",
                "run a --pictures=pdf --force",
            ),
            ("run --pictures svg a", "run --pictures=svg a"),
            ("run --pictures a", "run --pictures a"),
            ("run --pictures=svg pdf", "run --pictures=svg pdf"),
            ("run -- --pictures pdf", "run -- --pictures pdf"),
        ] {
            let made = joined(given.split(' ').map(OsString::from));
            assert_eq!(made.join(" ".as_ref()), *meant, "{given}");
        }
    }
}
