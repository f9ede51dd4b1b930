//! `crepitus stability`: which hard cases hold on which solver, and by what
//! margin.

mod case_text;
mod coupled;
mod headline;
mod list;
mod page;
mod plan;
mod summary;
mod table;

use crate::cli::Force;
use crate::failure::{Failure, print, print_json};
use crate::pictures::Pictures;
use crate::results::{self, REPORT};
use crate::screen::{All, screen};
use crate::studying::{self, Watch};
use clap::Args;
use crepitus_files::json_path;
use crepitus_studies::stability::story::{self, Stories};
use crepitus_studies::stability::{Matrix, matrix};
use serde_json::json;
use std::path::{Path, PathBuf};
use summary::Summary;

/// Try the hard cases on the solvers that they concern: what holds, and by what margin.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus stability
  crepitus stability --case sudden-stop
  crepitus stability --case H10 --case H16 --solver exact-events --solver rk4
  crepitus stability --long --out /tmp/stability
  crepitus stability --coupled

A hard case runs on the solvers that it concerns, under the conventions that they have, in f32 and f64; many are of the \
device, and run on its solver alone. A cell of the matrix \
holds, with the measured margin; or degrades: right in kind, but a number exceeds its limit; or \
fails: the simulated joint is not the one that was asked for. Some cells must hold; if one \
does not, the exit code is 1. The answer comes first; --all prints a line a case, or, with one --case, everything about it.

With --coupled a hand that stops is put to the whole device instead: which stiffness stays quiet \
with which cuff, lag and friction left in the gear, and what the presets have left.")]
pub(crate) struct Arguments {
    /// Only this case, by number or name: H05, reversal-in-stick. May be repeated.
    #[arg(long = "case", value_name = "NAME")]
    cases: Vec<String>,

    /// Only this solver: exact, exact-events, rk4, … May be repeated.
    #[arg(long = "solver", value_name = "KIND")]
    solvers: Vec<String>,

    /// Only this convention: frozen, paper or physical. May be repeated.
    #[arg(long = "convention", value_name = "CONVENTION")]
    conventions: Vec<String>,

    /// Only this precision: the device computes in f32.
    #[arg(long, value_name = "PRECISION", value_parser = ["f32", "f64"])]
    precision: Option<String>,

    /// Include the cases that take hours of simulated time.
    #[arg(long)]
    long: bool,

    /// List the cases with inputs, criteria and sources, without running them.
    #[arg(long)]
    list: bool,

    /// Map the stiffness at which the device begins to ring on a leg, instead of the cases.
    #[arg(long, conflicts_with_all = ["cases", "solvers", "conventions", "precision", "long", "list"])]
    coupled: bool,

    #[command(flatten)]
    all: All,

    /// Folder for cases.csv, summary.json and report.html [default: out/stability; out/coupled].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    #[command(flatten)]
    force: Force,

    #[command(flatten)]
    pictures: Pictures,
}

/// Runs the cases, writes the files, prints the matrix.
pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    if arguments.coupled {
        let out = arguments.out.as_deref().unwrap_or(Path::new("out/coupled"));
        return coupled::coupled(out, arguments, as_json);
    }
    let plan = plan::plan(arguments)?;
    if arguments.list {
        return if as_json {
            print_json(&list::value(&plan.cases))
        } else {
            print(&list::markdown(&plan.cases))
        };
    }
    let out = arguments
        .out
        .clone()
        .unwrap_or_else(|| PathBuf::from("out/stability"));
    let claim = arguments.force.claim("stability", [""; 0]);
    let folder = results::folder(&out, claim, [&REPORT[..], &["cases.csv"]].concat())?;
    let matrix = matrix::run(&plan, &mut Watch::new()).map_err(studying::failed)?;
    let summary = Summary::new(&plan, &matrix);
    let stories = stories(arguments)?;
    results::write(
        folder,
        &out,
        page::files(&matrix, stories.as_ref(), &summary, &arguments.pictures)?,
    )?;
    if as_json {
        print_json(&json!({ "out": json_path(&out), "summary": summary }))?;
        // The broken cells are in the summary.
        return if matrix.broken().next().is_some() {
            Err(Failure::Negative)
        } else {
            Ok(())
        };
    }
    let answer = headline::answer(&matrix, &summary);
    let broken = table::broken(&matrix);
    let report = out.join("report.html");
    let only = match (matrix.rows.as_slice(), arguments.cases.is_empty()) {
        ([row], false) => Some(case_text::case(row)),
        _ => None,
    };
    let text = if arguments.all.all {
        let table = only.unwrap_or_else(|| table::table(&matrix, &summary));
        format!(
            "{answer}\n\n{table}{broken}\nreport: {}\n",
            report.display()
        )
    } else {
        let table = only.unwrap_or_else(|| headline::table(&matrix));
        let last = format!("report: {}; --all prints every case", report.display());
        screen(&answer, &(broken + &table), &last)
    };
    print(&text)?;
    judge(&matrix)
}

/// The stories: with the whole catalogue, or if `--pictures` is given.
fn stories(arguments: &Arguments) -> Result<Option<Stories>, Failure> {
    if arguments.cases.is_empty() || arguments.pictures.wanted() {
        story::all()
            .map(Some)
            .map_err(|e| Failure::Work(format!("a story cannot be computed: {e}")))
    } else {
        Ok(None)
    }
}

/// Fails if a cell that must hold does not.
fn judge(matrix: &Matrix) -> Result<(), Failure> {
    let broken: Vec<String> = matrix
        .broken()
        .map(|(case, cell)| {
            format!(
                "{} {} on {}",
                case.id,
                case.name,
                table::subject(cell.subject)
            )
        })
        .collect();
    match broken.as_slice() {
        [] => Ok(()),
        [only] => Err(Failure::Work(format!("{only} must hold and does not"))),
        several => Err(Failure::Work(format!(
            "{} cells that must hold do not: {}",
            several.len(),
            several.join("; ")
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_studies::stability::{Cell, Failure as Broken, Row, Subject, Verdict, catalogue};

    /// One case in which the first of two subjects overflows.
    fn overflow(must_hold: bool) -> Matrix {
        let cells = Subject::all().into_iter().take(2).map(|subject| Cell {
            subject,
            must_hold,
            verdict: Verdict::Fails {
                what: Broken::Overflow,
                at_s: Some(0.25),
                flagged: false,
            },
            detail: "the first trial".to_owned(),
        });
        Matrix {
            rows: vec![Row {
                case: catalogue::find("H01").unwrap(),
                cells: cells.collect(),
            }],
            wall_s: 0.0,
        }
    }

    #[test]
    fn a_cell_that_must_hold_decides_the_exit_code_and_is_named() {
        assert!(judge(&overflow(false)).is_ok());
        assert_eq!(table::broken(&overflow(false)), "");
        let matrix = overflow(true);
        let Err(Failure::Work(message)) = judge(&matrix) else {
            panic!("must fail");
        };
        assert!(message.starts_with("2 cells"), "{message}");
        assert!(
            message.contains("H01 constant-speed on exact, frozen, f32"),
            "{message}"
        );
        let text = table::broken(&matrix);
        assert!(text.contains("overflow at t = 0.250 s"), "{text}");
        assert!(text.contains("the first trial"), "{text}");
    }
}
