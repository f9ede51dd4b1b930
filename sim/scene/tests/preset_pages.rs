//! The tables of presets in the book are those of the files. `CREPITUS_BLESS=1` writes them.

use crepitus_scene::preset::{Disorder, Level, Preset, shipped};
use std::fmt::Write;
use std::fs;
use std::path::Path;

const END: &str = "<!-- end -->";

/// A disorder's presets as a table.
fn table(disorder: Disorder) -> String {
    let mut text = String::from(
        "\n| preset | grade | level | what to feel for | numbers |\n|---|---|---|---|---|\n",
    );
    let of = |preset: &&Preset| preset.disorder == Some(disorder);
    for preset in shipped().iter().filter(of) {
        let [severity, feel, source] = [&preset.severity, &preset.feel, &preset.source]
            .map(|line| line.as_deref().expect("a shipped preset says what it is"));
        let evidence = preset.evidence.expect("and how well founded").name();
        let level = preset.level.map_or("–", Level::name);
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "| `{}` | {severity} | {level} | {feel} | {evidence}: {source} |",
            preset.name
        );
    }
    text + "\n"
}

#[test]
fn the_book_lists_every_preset_as_its_file_says() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/disorders.md");
    let page = fs::read_to_string(&path).expect("the page");
    let mut made = page.clone();
    for disorder in Disorder::ALL {
        let mark = format!("<!-- presets: {} -->\n", disorder.name());
        let begin = made.find(&mark).expect(&mark) + mark.len();
        let end = begin + made[begin..].find(END).expect("the end of a table");
        made.replace_range(begin..end, &table(disorder));
    }
    if std::env::var_os("CREPITUS_BLESS").is_some() {
        fs::write(&path, &made).expect("the page is written");
    } else {
        assert!(
            page == made,
            "docs/disorders.md: CREPITUS_BLESS=1 cargo test -p crepitus-scene --test preset_pages"
        );
    }
}
