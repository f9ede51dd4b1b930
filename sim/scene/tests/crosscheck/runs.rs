//! Both solvers on the first cases of the corpus, and the journal of the whole
//! run.

use crate::journal::{self, PIECE};
use crate::summary::Summary;
use crate::watched::{Answer, LIMIT, Watched};
use crepitus_model::Convention;
use std::path::{Path, PathBuf};

fn committed() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/crosscheck/corpus.csv")
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
    print!("{}", summary.markdown());
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

/// The first piece; all with `CREPITUS_LONG` set. `CREPITUS_CORPUS=N` adds pieces to the journal, up to case N.
#[test]
fn the_pieces_come_out_as_committed() {
    let program = std::env::current_exe().unwrap();
    let pieces = journal::read(&committed()).unwrap();
    let run = |piece| {
        println!("piece {piece}");
        journal::run_piece(&program, LIMIT, piece).unwrap()
    };
    let is_long = std::env::var_os("CREPITUS_LONG").is_some();
    for committed in pieces.iter().take(if is_long { pieces.len() } else { 1 }) {
        let tally = run(committed[0].piece);
        for (row, committed) in tally.rows().iter().zip(committed) {
            assert_eq!(row.line(), committed.line());
        }
    }
    let next = pieces.last().unwrap()[0].piece + 1;
    let end = std::env::var("CREPITUS_CORPUS").map_or(0, |end| end.parse().unwrap());
    for piece in next..u64::div_ceil(end, PIECE) {
        journal::append(&committed(), run(piece).rows()).unwrap();
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
