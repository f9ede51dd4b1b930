//! The book's tables of presets are those of the files. `CREPITUS_BLESS=1` writes them.

use crepitus_scene::preset::{Disorder, Level, Preset, shipped};
use std::fmt::Write;
use std::fs;
use std::path::Path;

const BEGIN: &str = "# Presets

Made by `CREPITUS_BLESS=1 cargo test -p crepitus-scene --test preset_pages`; [what each disorder feels like](../disorders.md).
";

/// A disorder's presets as a table.
fn table(disorder: Disorder) -> String {
    let mut text = format!(
        "\n## {}\n\n| preset | grade | level | what to feel for | numbers |\n|---|---|---|---|---|\n",
        disorder.name()
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
    text
}

#[test]
fn the_book_lists_every_preset_as_its_file_says() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/generated/presets.md");
    let made: String = std::iter::once(BEGIN.to_owned())
        .chain(Disorder::ALL.map(table))
        .collect();
    if std::env::var_os("CREPITUS_BLESS").is_some() {
        fs::write(&path, &made).expect("the page is written");
    } else {
        assert!(
            fs::read_to_string(&path).is_ok_and(|page| page == made),
            "docs/generated/presets.md: CREPITUS_BLESS=1 cargo test -p crepitus-scene --test preset_pages"
        );
    }
}
