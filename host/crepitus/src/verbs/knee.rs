//! `crepitus knee`: a knee to move, on one page.

use crate::cli::Force;
use crate::failure::{Failure, print, print_json};
use crate::output::to_stderr;
use clap::Args;
use clap::builder::PossibleValuesParser;
use crepitus_files::json_path;
use crepitus_files::output::{Inputs, NewFile, is_stdout};
use crepitus_panel::{knee_page, page_languages};
use serde_json::json;
use std::io::Write;
use std::path::PathBuf;

/// Write a page with a knee to move: one file for any browser, without this program or a network.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus knee --out knee.html
  crepitus knee --out knie.html --language de

The page has the model of the device itself under a simulated leg that pointer, touch or arrow keys \
move: every knee that ships, by its name or as a quiz, its sound, its inside, and what was measured. \
Open the file in a browser, or send it to somebody.")]
pub(crate) struct Arguments {
    /// The new file; `-` is standard output.
    #[arg(long, value_name = "FILE", default_value = "knee.html")]
    out: PathBuf,

    /// Language of the page [default: all, and the reader chooses].
    #[arg(long, value_parser = PossibleValuesParser::new(page_languages()))]
    language: Option<String>,

    #[command(flatten)]
    force: Force,
}

/// Writes the page.
pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    let out = &arguments.out;
    if is_stdout(out) && as_json {
        return Err(Failure::input(
            "--json and --out - would both write to standard output: name a file with --out",
        ));
    }
    let new = NewFile::create(out, arguments.force.force, &Inputs::default())?;
    let on_stdout = new.is_stdout();
    let language = arguments.language.as_deref();
    let page = knee_page(language).map_err(|e| Failure::Work(e.to_string()))?;
    let mut file = new.as_file();
    file.write_all(page.as_bytes())
        .and_then(|()| file.sync_all())
        .map_err(|e| Failure::at(out, "cannot be written", &e))?;
    new.persist()?;
    if as_json {
        return print_json(&json!({ "out": json_path(out), "bytes": page.len() }));
    }
    let text = format!("{}: open it in a browser", out.display());
    if on_stdout {
        to_stderr(&text);
        return Ok(());
    }
    print(&(text + "\n"))
}
