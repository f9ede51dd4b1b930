//! Tables of the book that tests make and check.

use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// A page of the book, and the command that writes its tables.
pub(crate) struct Page {
    pub(crate) file: &'static str,
    pub(crate) bless: &'static str,
}

impl Page {
    /// Compares a table of the page with these lines; `CREPITUS_BLESS=1` writes them there. Tests of
    /// one page must not write at the same time.
    pub(crate) fn hold(&self, name: &str, lines: &[String]) {
        let path = self.path();
        let page = fs::read_to_string(&path).expect("the page");
        let Range { start: begin, end } = place(&page, name);
        let table = format!("\n{}\n\n", lines.join("\n"));
        if page[begin..end] == table {
            return;
        }
        assert!(
            std::env::var_os("CREPITUS_BLESS").is_some_and(|value| value != "0"),
            "docs/{} is not what was found:{table}CREPITUS_BLESS=1 {}",
            self.file,
            self.bless
        );
        fs::write(&path, [&page[..begin], &table, &page[end..]].concat()).expect("a page");
    }

    /// Compares these rows of a table, each by its first cell, and leaves the others as the page has them.
    #[allow(dead_code, reason = "for tables that are made in parts")]
    pub(crate) fn hold_rows(&self, name: &str, head: &[String], rows: &[String], order: &[&str]) {
        let page = fs::read_to_string(self.path()).expect("the page");
        let of = |lines: &[String], first: &str| {
            let first = format!("| {first} |");
            lines.iter().find(|line| line.starts_with(&first)).cloned()
        };
        let there: Vec<String> = page[place(&page, name)]
            .lines()
            .map(str::to_owned)
            .collect();
        let merged = order
            .iter()
            .filter_map(|first| of(rows, first).or_else(|| of(&there, first)));
        self.hold(
            name,
            &head.iter().cloned().chain(merged).collect::<Vec<_>>(),
        );
    }

    fn path(&self) -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../../docs")
            .join(self.file)
    }
}

/// Returns where a page has a table.
fn place(page: &str, name: &str) -> Range<usize> {
    let begin_mark = format!("<!-- generated: {name} -->\n");
    let begin = page.find(&begin_mark).expect("the table's mark") + begin_mark.len();
    begin..begin + page[begin..].find("<!-- end -->").expect("its end")
}
