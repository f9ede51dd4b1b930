//! Panics inside a library, in an image from the real compiler: an allowance is
//! for the library's own, by number.

use crate::compiler::compile;
use crepitus_tools::image::Report;
use crepitus_tools::image::lines::Lines;
use std::path::Path;

const HELPER: &str = "
/// Panics beyond the end.
#[inline(never)]
pub fn entry(table: &[u32], n: usize) -> u32 {
    table[n]
}

/// Panics without a number.
#[inline(always)]
pub fn number(given: Option<u32>) -> u32 {
    given.unwrap()
}

/// Calls what it is given.
#[inline(always)]
pub fn next(give: impl FnOnce() -> u32) -> u32 {
    give().wrapping_add(1)
}
";

const PROGRAM: &str = r#"
#![no_std]
#![no_main]
use core::sync::atomic::{AtomicU32, Ordering};

#[path = "registry/src/index/helper-1.2.0/src/lib.rs"]
mod helper;

static INPUT: AtomicU32 = AtomicU32::new(0);

#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    loop {}
}

#[unsafe(no_mangle)]
extern "C" fn Reset() -> ! {
    loop {}
}

#[unsafe(no_mangle)]
extern "C" fn DefaultHandler() {
    INPUT.store(!0, Ordering::SeqCst);
}

fn odd() -> Option<u32> {
    let n = INPUT.load(Ordering::SeqCst);
    (n % 2 == 1).then_some(n)
}

/// Two panics of the library.
#[unsafe(no_mangle)]
extern "C" fn LIBRARY() {
    let n = helper::number(odd());
    INPUT.store(helper::entry(&[3, 1, 4], n as usize), Ordering::SeqCst);
}

/// A panic of this program, inlined into a function of the library.
#[unsafe(no_mangle)]
extern "C" fn OWN() {
    INPUT.store(helper::next(|| odd().unwrap()), Ordering::SeqCst);
}

union Vector {
    handler: extern "C" fn(),
    reset: extern "C" fn() -> !,
    stack: u32,
}
unsafe impl Sync for Vector {}

#[used]
#[unsafe(link_section = ".vector_table")]
static VECTORS: [Vector; 18] = {
    const DEFAULT: Vector = Vector { handler: DefaultHandler };
    let mut all = [DEFAULT; 18];
    all[0] = Vector { stack: 0x2000_4000 };
    all[1] = Vector { reset: Reset };
    all[16] = Vector { handler: LIBRARY };
    all[17] = Vector { handler: OWN };
    all
};
"#;

const BUDGET: &str = r#"
[images.it]
elf = "it.elf"
memory = "it.x"
[images.it.recorded]
flash = 10_000
ram = 10_000
stack = 10_000
[[images.it.interrupts]]
handler = "LIBRARY"
irq = 0
priority = 2
[[images.it.interrupts]]
handler = "OWN"
irq = 1
priority = 1
"#;

fn build(folder: &Path) -> Option<Vec<u8>> {
    let source = folder.join("registry/src/index/helper-1.2.0/src");
    std::fs::create_dir_all(&source).unwrap();
    std::fs::write(source.join("lib.rs"), HELPER).unwrap();
    compile(folder, PROGRAM)
}

fn allowing(bytes: &[u8], lines: &Lines, library: &str, at_most: usize) -> Report {
    let entry = format!(
        "[[images.it.panics]]\nlibrary = \"{library}\"\nat_most = {at_most}\nreason = \"so\""
    );
    crate::compiler::report(bytes, lines, &format!("{BUDGET}{entry}"))
}

fn failures(report: &Report) -> Vec<&str> {
    report.failures.iter().map(|f| f.what.as_str()).collect()
}

/// Hints about panics, without those of sizes.
fn hints(report: &Report) -> Vec<&str> {
    let hints = report.hints.iter().filter(|hint| hint.check == "panic");
    hints.map(|hint| hint.what.as_str()).collect()
}

const OWN: &str = "OWN can reach core::option::unwrap_failed";

#[test]
fn an_allowance_excuses_the_librarys_panics_and_no_others() {
    let folder = tempfile::tempdir().unwrap();
    let Some(bytes) = build(folder.path()) else {
        return;
    };
    let lines = Lines::of(&folder.path().join("it.elf"));
    let report = crate::compiler::report(&bytes, &lines, BUDGET);
    let found = failures(&report);
    assert_eq!(found.len(), 3, "{found:?}");
    let named = report.failures.iter();
    let named = named.filter(|f| f.todo.contains("library = \"helper\""));
    assert_eq!(
        named.count(),
        2,
        "a hint for the library's, none for others"
    );

    let report = allowing(&bytes, &lines, "helper", 2);
    assert_eq!(failures(&report), [OWN]);
    assert_eq!((report.panics[0].calls, report.panics[0].at_most), (2, 2));
    assert_eq!(hints(&report), [""; 0]);
}

#[test]
fn one_panic_more_fails_and_one_less_is_a_hint() {
    let folder = tempfile::tempdir().unwrap();
    let Some(bytes) = build(folder.path()) else {
        return;
    };
    let lines = Lines::of(&folder.path().join("it.elf"));
    let report = allowing(&bytes, &lines, "helper", 1);
    let too_many = "helper calls panics in 2 places; the budget allows 1";
    assert_eq!(failures(&report), [OWN, too_many]);
    assert_eq!(report.failures[1].at.len(), 2, "with the places");

    let report = allowing(&bytes, &lines, "helper", 3);
    assert_eq!(failures(&report), [OWN]);
    let fewer = "helper calls panics in 2 places; the budget allows 3";
    assert_eq!(hints(&report), [fewer]);
}

#[test]
fn an_allowance_that_nothing_needs_fails() {
    let folder = tempfile::tempdir().unwrap();
    let Some(bytes) = build(folder.path()) else {
        return;
    };
    let lines = Lines::of(&folder.path().join("it.elf"));
    // Neither part of a name, nor this program's, nor the compiler's library.
    for other in ["help", "it", "core"] {
        let report = allowing(&bytes, &lines, other, 9);
        let stale = format!("the entry in panics for {other} is not needed");
        assert_eq!(failures(&report).len(), 4);
        assert!(failures(&report).contains(&stale.as_str()));
    }
    // Nothing is known of a place without debug information.
    let report = allowing(&bytes, &Lines::default(), "helper", 2);
    assert_eq!(failures(&report).len(), 4);
}
