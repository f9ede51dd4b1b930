//! `crepitus stability`: which hard cases hold on which solver, and by what
//! margin.

mod case_text;
mod coupled;
mod list;
mod page;
mod plan;
mod summary;
mod table;

use crate::cli::StabilityArguments;
use crate::failure::{Failure, print, print_json};
use crate::studying::{self, Watch};
use crepitus_scene::output::Folder;
use crepitus_study::stability::story::{self, Stories};
use crepitus_study::stability::{Matrix, matrix};
use serde_json::json;
use std::path::{Path, PathBuf};
use summary::Summary;

/// Runs the cases, writes the files, says what holds.
pub(crate) fn stability(arguments: &StabilityArguments, as_json: bool) -> Result<(), Failure> {
    if arguments.coupled {
        let out = arguments.out.as_deref().unwrap_or(Path::new("out/coupled"));
        return coupled::coupled(out, arguments.pictures, as_json);
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
    // A folder that cannot be written is better known before the work.
    let folder = Folder::create(&out).map_err(|e| Failure::at(&out, "cannot be written", &e))?;
    let matrix = matrix::run(&plan, &mut Watch::new()).map_err(studying::failed)?;
    let summary = Summary::new(&plan, &matrix);
    let stories = stories(arguments)?;
    studying::write(
        folder,
        &out,
        page::files(&matrix, stories.as_ref(), &summary, arguments.pictures)?,
    )?;
    if as_json {
        print_json(&json!({ "out": out, "summary": summary }))?;
        // Its cells are in the summary.
        return if matrix.broken().next().is_some() {
            Err(Failure::Negative)
        } else {
            Ok(())
        };
    }
    let told = match (matrix.rows.as_slice(), arguments.cases.is_empty()) {
        ([row], false) => case_text::case(row),
        _ => table::table(&matrix, &summary),
    };
    print(&format!(
        "{told}{}\nreport: {}\n",
        table::broken(&matrix),
        out.join("report.html").display()
    ))?;
    judge(&matrix)
}

/// The stories belong to the whole catalogue; beside single cases they come
/// only where pictures are asked for.
fn stories(arguments: &StabilityArguments) -> Result<Option<Stories>, Failure> {
    if arguments.cases.is_empty() || arguments.pictures.is_some() {
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
    use crepitus_study::stability::{Cell, Failure as Broken, Row, Subject, Verdict, catalogue};

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
        let told = table::broken(&matrix);
        assert!(told.contains("overflow at t = 0.250 s"), "{told}");
        assert!(told.contains("the first trial"), "{told}");
    }
}
