//! The tables of docs/fault-matrix.md, which these tests make and check.

use std::fs;
use std::path::Path;

const PAGE: &str = "../../docs/fault-matrix.md";
const BLESS: &str =
    "CREPITUS_BLESS=1 cargo test -p crepitus-board --test fault_table -- --test-threads=1";

/// Compares a table of the page with these lines, or writes them there.
pub(crate) fn hold(name: &str, lines: &[String]) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(PAGE);
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
        "docs/fault-matrix.md is not what was found:{table}{BLESS}"
    );
    fs::write(&path, [&page[..begin], &table, &page[end..]].concat()).expect("a page");
}
