//! Both solvers on the first cases of the corpus, and the journal of the whole
//! run.

use crepitus_crosscheck::compare::compare;
use crepitus_crosscheck::corpus::Case;
use crepitus_crosscheck::journal::{self, PIECE, Tally};
use crepitus_crosscheck::summary::Summary;
use crepitus_crosscheck::watched::{Answer, LIMIT, Watched};
use crepitus_model::Convention;
use std::path::{Path, PathBuf};

/// The program whose child processes run `reference`.
fn program() -> &'static Path {
    Path::new(env!("CARGO_BIN_EXE_crepitus-crosscheck"))
}

fn committed() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus.csv")
}

#[test]
fn the_committed_journal_adds_up_and_the_book_names_every_disagreement() {
    let pieces = journal::read(&committed()).unwrap();
    let rows = std::fs::read_to_string(committed())
        .unwrap()
        .lines()
        .count()
        - 1;
    assert_eq!(
        rows,
        pieces.len() * journal::ROWS,
        "every row belongs to a whole piece"
    );
    let summary = Summary::of(&pieces);
    assert!(summary.faults.is_empty(), "{:?}", summary.faults);
    let all = summary.sum(|_, _| true);
    assert!(all.cases >= 10_000, "{} cases", all.cases);
    assert_eq!(all.law_broken, 0, "{:?}", all.notable);
    let book = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/crosscheck.md");
    let book = std::fs::read_to_string(book).unwrap();
    for (number, verdict) in all.notable.iter().filter_map(|n| n.split_once(':')) {
        assert!(
            !["HUNG", "DIED"].contains(&verdict),
            "case {number}: {verdict}"
        );
        let differs = verdict.starts_with(char::is_uppercase);
        assert!(
            !differs || book.contains(&format!("`{number}`")),
            "case {number}: {verdict}"
        );
    }
    for convention in Convention::ALL {
        assert!(summary.sum(|c, _| c == convention).cases >= 3000);
    }
    // What rounding decides is the exception.
    assert!(
        all.undecidable * 50 < all.cases,
        "{} undecidable",
        all.undecidable
    );
}

#[test]
fn the_first_piece_comes_out_as_committed() {
    let pieces = journal::read(&committed()).unwrap();
    let mut tally = Tally::new(0);
    for answer in Watched::new(program(), LIMIT, 0, PIECE) {
        let (number, answer) = answer.unwrap();
        let case = Case::new(number);
        let comparison = compare(&case, &answer);
        assert!(
            matches!(answer, Answer::Solved(_)) && !comparison.law_broken,
            "case {number}: {comparison:?}"
        );
        tally.add(&case, &comparison);
    }
    for (row, committed) in tally.rows().iter().zip(&pieces[0]) {
        assert_eq!(row.line(), committed.line());
    }
}

#[test]
fn a_child_that_hangs_or_dies_is_reported_and_the_next_case_goes_on() {
    // `false` ends at once without an answer, for every case.
    let answers: Vec<_> = Watched::new(Path::new("/bin/false"), LIMIT, 5, 8)
        .map(Result::unwrap)
        .collect();
    assert_eq!(
        answers,
        [(5, Answer::Died), (6, Answer::Died), (7, Answer::Died)]
    );
}
