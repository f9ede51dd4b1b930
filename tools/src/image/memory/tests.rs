use super::{Region, parse};
use crate::image::error::ImageError;

fn regions(script: &str) -> Vec<(String, u32, u32)> {
    let regions = parse(script).unwrap();
    regions
        .into_iter()
        .map(|r| (r.name, r.origin, r.length))
        .collect()
}

#[test]
fn reads_what_linkers_read() {
    let script = "/* MEMORY { X : ORIGIN = 0 } */\n\
        MEMORY\n{\n  FLASH (rx) : ORIGIN = 0x08000000, LENGTH = 1024K // all\n\
        RAM(rwx): org = 0x20000000 , len = 128K - 64\n\
        CCM : o = 0x10000000, l = 0x10000\n}\n\
        _stack_start = ORIGIN(CCM) + LENGTH(CCM);\n";
    let named = |name: &str, origin, length| (name.to_owned(), origin, length);
    assert_eq!(
        regions(script),
        [
            named("FLASH", 0x0800_0000, 1 << 20),
            named("RAM", 0x2000_0000, 128 * 1024 - 64),
            named("CCM", 0x1000_0000, 0x1_0000),
        ]
    );
}

#[test]
fn says_where_it_does_not_understand() {
    for (script, line, word) in [
        ("SECTIONS {}", 1, "no MEMORY"),
        (
            "\nMEMORY {\n A : ORIGIN = x, LENGTH = 1K }",
            3,
            "not a number",
        ),
        ("MEMORY { A : ORIGIN = 0, LENGTH = 1K", 1, "no }"),
        (
            "MEMORY {\n\n A : LENGTH = 1K, ORIGIN = 0 }",
            3,
            "ORIGIN expected",
        ),
        (
            "MEMORY { A : ORIGIN = 1 - 2, LENGTH = 1K }",
            1,
            "no address",
        ),
        ("MEMORY { A }", 1, "no ':'"),
        (
            "MEMORY { A : ORIGIN = 99999999999999999999, LENGTH = 1 }",
            1,
            "not a number",
        ),
    ] {
        match parse(script) {
            Err(ImageError::Memory { line: at, what }) => {
                assert_eq!(at, line, "{script}");
                assert!(what.contains(word), "{what}");
            }
            other => panic!("{script}: {other:?}"),
        }
    }
}

#[test]
fn regions_know_their_bounds() {
    let region = |origin, length| Region {
        name: String::new(),
        origin,
        length,
    };
    let flash = region(0x1000, 0x100);
    assert!(flash.holds(0x1000, 0x100) && !flash.holds(0x1000, 0x101) && !flash.holds(0xFFF, 1));
    assert!(flash.overlaps(&region(0x10FF, 1)) && !flash.overlaps(&region(0x1100, 1)));
    assert!(region(u32::MAX, 1).holds(u32::MAX, 1));
}
