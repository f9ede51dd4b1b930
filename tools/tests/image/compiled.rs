//! An image from the real compiler, with a panic planted in an interrupt.

use crate::compiler::compile;
use crepitus_tools::image::Report;
use crepitus_tools::image::lines::Lines;

const PROGRAM: &str = r#"
#![no_std]
#![no_main]
use core::sync::atomic::{AtomicU32, Ordering};

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

/// Cannot panic: the length is what it is.
#[unsafe(no_mangle)]
extern "C" fn SOUND() {
    let table = [3_u32, 1, 4, 1, 5, 9, 2, 6];
    let n = INPUT.load(Ordering::Relaxed) as usize % table.len();
    INPUT.store(table[n], Ordering::Relaxed);
    unrolled();
}

/// Three rounds, of which the compiler makes straight code.
#[inline(always)]
fn unrolled() {
    for bit in 0..3 {
        INPUT.store(INPUT.load(Ordering::Relaxed) ^ 1 << bit, Ordering::Relaxed);
    }
}

/// Panics on an odd number.
#[unsafe(no_mangle)]
extern "C" fn PLANTED() {
    INPUT.store(half(INPUT.load(Ordering::Relaxed)).unwrap(), Ordering::Relaxed);
}

#[inline(never)]
fn half(n: u32) -> Option<u32> {
    (n % 2 == 0).then_some(n / 2)
}

/// Ends, but nobody has said when.
#[inline(always)]
fn drain(by: u32) {
    let get = || INPUT.load(Ordering::SeqCst);
    let put = |n| INPUT.store(n, Ordering::SeqCst);
    while get() >= by { put(get() / by); while get() > 99 { put(get() - by); } put(get() + 1); }
}

#[unsafe(no_mangle)]
extern "C" fn COUNTS() {
    drain(2);
}

#[unsafe(no_mangle)]
extern "C" fn COUNTS_TOO() {
    drain(3);
}

union Vector {
    handler: extern "C" fn(),
    reset: extern "C" fn() -> !,
    stack: u32,
}
unsafe impl Sync for Vector {}

#[used]
#[unsafe(link_section = ".vector_table")]
static VECTORS: [Vector; 20] = {
    const DEFAULT: Vector = Vector { handler: DefaultHandler };
    let mut all = [DEFAULT; 20];
    all[0] = Vector { stack: 0x2000_4000 };
    all[1] = Vector { reset: Reset };
    all[16] = Vector { handler: SOUND };
    all[17] = Vector { handler: PLANTED };
    all[18] = Vector { handler: COUNTS };
    all[19] = Vector { handler: COUNTS_TOO };
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
handler = "SOUND"
irq = 0
priority = 3
[[images.it.interrupts]]
handler = "PLANTED"
irq = 1
priority = 2
[[images.it.interrupts]]
handler = "COUNTS"
irq = 2
priority = 1
[[images.it.interrupts]]
handler = "COUNTS_TOO"
irq = 3
priority = 1
"#;

fn report(bytes: &[u8], lines: &Lines, more: &str) -> Report {
    crate::compiler::report(bytes, lines, &format!("{BUDGET}{more}"))
}

#[test]
fn a_planted_unwrap_is_found_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let Some(bytes) = compile(folder.path(), PROGRAM) else {
        return;
    };
    let lines = Lines::of(&folder.path().join("it.elf"));
    let found = report(&bytes, &lines, "").failures;
    let [panic, bound] = found.as_slice() else {
        panic!("{found:#?}");
    };
    assert_eq!(panic.what, "PLANTED can reach core::option::unwrap_failed");
    let planted = PROGRAM
        .lines()
        .position(|l| l.contains(".unwrap()"))
        .unwrap()
        + 1;
    let line = format!("it.rs:{planted}");
    assert!(panic.at[0].contains(&line), "{:?} without {line}", panic.at);
    // Inlined twice, they are two loops of the source, on one line.
    assert!(
        bound
            .what
            .ends_with("reaches 2 loops in it::drain without a bound")
    );
    let bounded = "[[images.it.loops]]
function = \"it::drain\"
bounds = [32, 9]
reason = \"bits\"";
    let report = report(&bytes, &lines, bounded);
    let loops = report.loops.iter().map(|l| (l.copies, l.bound));
    assert_eq!(loops.collect::<Vec<_>>(), [(2, Some(32)), (2, Some(9))]);
    assert_eq!(report.failures.len(), 1, "the panic stays");
}

#[test]
fn a_bound_outlives_the_mood_of_the_compiler() {
    let folder = tempfile::tempdir().unwrap();
    let Some(bytes) = compile(folder.path(), PROGRAM) else {
        return;
    };
    let lines = Lines::of(&folder.path().join("it.elf"));
    let entry = |function: &str, bound: &str| {
        format!("[[images.it.loops]]\nfunction = \"it::{function}\"\n{bound}\nreason = \"so\"\n")
    };
    let drain = entry("drain", "bounds = [32, 9]");
    // Dissolved, but its function is there: the entry may stay.
    let dissolved = drain.clone() + &entry("unrolled", "bounds = [3]");
    let found = report(&bytes, &lines, &dissolved);
    assert_eq!(found.failures.len(), 1, "{:#?}", found.failures);
    assert_eq!(
        found.hints[0].what,
        "it::unrolled has 0 loops left; the budget bounds 1"
    );
    let gone = drain + &entry("gone", "bounds = [3]");
    let found = report(&bytes, &lines, &gone).failures;
    assert_eq!(found.len(), 2, "{found:#?}");
    assert!(found[1].what.contains("it::gone is not needed"));
    // One bound for all is for code that nobody here edits.
    let found = report(&bytes, &lines, &entry("drain", "at_most = 32")).failures;
    assert!(found[1].what.starts_with("it::drain is no library's"));
}

#[test]
fn it_is_found_without_debug_information_too() {
    let folder = tempfile::tempdir().unwrap();
    let Some(bytes) = compile(folder.path(), PROGRAM) else {
        return;
    };
    let report = report(&bytes, &Lines::default(), "");
    let found: Vec<&str> = report.failures.iter().map(|f| f.check).collect();
    assert_eq!(found, ["panic", "loop", "loop"]);
}
