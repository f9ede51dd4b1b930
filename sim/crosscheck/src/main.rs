//! `crepitus-crosscheck`: runs the corpus, sums it up, shows a case.

mod show;

use clap::{Parser, Subcommand};
use crepitus_crosscheck::corpus::Case;
use crepitus_crosscheck::journal::{self, PIECE};
use crepitus_crosscheck::summary::Summary;
use crepitus_crosscheck::theirs::Theirs;
use crepitus_crosscheck::watched::LIMIT;
use crepitus_crosscheck::wire;
use indicatif::{ProgressBar, ProgressStyle};
use std::io;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

/// Compares the reference solver with a second one on random cases.
#[derive(Parser)]
#[command(version)]
struct Cli {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Subcommand)]
enum Verb {
    /// Runs the corpus in pieces; an interrupted run continues.
    ///
    /// Example: crepitus-crosscheck corpus --to 1000 --out out/corpus.csv
    Corpus {
        /// First case; the piece that holds it is run from its beginning.
        #[arg(long, default_value_t = 0)]
        from: u64,
        /// End of the cases; the piece that holds the last is run to its end.
        #[arg(long, default_value_t = 10_000)]
        to: u64,
        /// The journal, which grows by every piece.
        #[arg(long, default_value = JOURNAL)]
        out: PathBuf,
        /// Seconds that the reference may take for one case.
        #[arg(long, default_value_t = LIMIT.as_secs())]
        limit_s: u64,
    },
    /// Sums up a journal and prints its tables.
    Summary {
        /// The journal.
        #[arg(long, default_value = JOURNAL)]
        out: PathBuf,
    },
    /// Prints one case in full: the joint, the motion, both event lists and
    /// where they part.
    Case {
        /// Its number.
        number: u64,
    },
    /// Writes what the reference solver says of cases, for the run of a corpus.
    #[command(hide = true)]
    Reference {
        #[arg(long)]
        from: u64,
        #[arg(long)]
        to: u64,
    },
}

/// The journal of the repository, from its root.
const JOURNAL: &str = "sim/crosscheck/corpus.csv";

fn main() -> ExitCode {
    let result = match Cli::parse().verb {
        Verb::Corpus {
            from,
            to,
            out,
            limit_s,
        } => corpus(from, to, &out, Duration::from_secs(limit_s)),
        Verb::Summary { out } => summary(&out),
        Verb::Case { number } => show::case(number),
        Verb::Reference { from, to } => reference(from, to),
    };
    match result {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn corpus(from: u64, to: u64, out: &Path, limit: Duration) -> io::Result<bool> {
    let mut pieces = journal::read(out)?;
    // Drops an incomplete piece of an interrupted run.
    journal::rewrite(out, &pieces)?;
    let program = std::env::current_exe()?;
    let bar = ProgressBar::new(to.div_ceil(PIECE).saturating_sub(from / PIECE) * PIECE);
    if let Ok(style) = ProgressStyle::with_template("{bar:40} {pos}/{len} cases, {eta} left") {
        bar.set_style(style);
    }
    for piece in from / PIECE..to.div_ceil(PIECE) {
        let done = pieces.iter().flatten().any(|row| row.piece == piece);
        if done {
            bar.inc(PIECE);
            continue;
        }
        let tally = journal::run_piece(&program, limit, piece, || bar.inc(1))?;
        journal::append(out, tally.rows())?;
        pieces.push(tally.rows().to_vec());
    }
    bar.finish_and_clear();
    pieces.sort_by_key(|rows| rows.first().map(|row| row.piece));
    Ok(report(&pieces))
}

fn summary(out: &Path) -> io::Result<bool> {
    let mut pieces = journal::read(out)?;
    pieces.sort_by_key(|rows| rows.first().map(|row| row.piece));
    Ok(report(&pieces))
}

/// Prints the tables; returns whether all is well.
fn report(pieces: &[Vec<journal::Row>]) -> bool {
    let summary = Summary::of(pieces);
    print!("{}", summary.markdown());
    for fault in &summary.faults {
        eprintln!("error: {fault}");
    }
    summary.faults.is_empty() && summary.sum(|_, _| true).is_clean()
}

fn reference(from: u64, to: u64) -> io::Result<bool> {
    // The parent holds our input open. When it has ended, a case that never
    // ends must end, too.
    std::thread::spawn(|| {
        let _ = io::copy(&mut io::stdin(), &mut io::sink());
        std::process::exit(1);
    });
    let mut out = io::stdout().lock();
    for number in from..to {
        wire::write(&mut out, number, &Theirs::of(&Case::new(number)))?;
    }
    Ok(true)
}
