//! Tables of the book that tests make and check.

use std::fs;
use std::path::Path;

/// A page of the book, and the command that writes its tables.
pub(crate) struct Page {
    pub(crate) file: &'static str,
    pub(crate) bless: &'static str,
}

impl Page {
    /// Compares a table of the page with these lines; `CREPITUS_BLESS=1` writes them there. Tests of
    /// one page must not write at the same time.
    pub(crate) fn hold(&self, name: &str, lines: &[String]) {
        let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs");
        let path = docs.join(self.file);
        let page = fs::read_to_string(&path).expect("the page");
        let begin_mark = format!("<!-- generated: {name} -->\n");
        let begin = page.find(&begin_mark).expect("the table's mark") + begin_mark.len();
        let end = begin + page[begin..].find("<!-- end -->").expect("its end");
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
}
