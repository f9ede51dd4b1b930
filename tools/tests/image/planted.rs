//! Images with something planted in an interrupt's path: each must be found,
//! at its place, and what is innocent must pass.

use crate::common::*;

#[test]
fn an_innocent_interrupt_passes() {
    let leaf = function("leaf", &[NOP, BX_LR]);
    let report = Maker::new(calls("IRQ0", &[3]), vec![leaf]).report("");
    assert_eq!(failures(&report), [""; 0]);
    assert_eq!(report.interrupts[0].functions, 2);
}

#[test]
fn a_panic_is_found_with_the_way_to_it() {
    let middle = calls("middle", &[4]);
    let panic = function("core::panicking::panic_fmt", &[PUSH_R7_LR, FOREVER]);
    let report = Maker::new(calls("IRQ0", &[3]), vec![middle, panic]).report("");
    assert_eq!(
        failures(&report),
        ["panic: IRQ0 can reach core::panicking::panic_fmt"]
    );
    let at = &report.failures[0].at;
    assert_eq!(
        at.as_slice(),
        [
            format!("IRQ0 at {:#010x}", Maker::address(2) + 2),
            format!("middle at {:#010x}", Maker::address(3) + 2),
            "panics in core::panicking::panic_fmt".to_owned(),
        ]
    );
}

#[test]
fn a_panic_behind_a_tail_call_is_found() {
    let tail = parts("tail", vec![Part::Code(vec![NOP]), Part::Jump(4)]);
    let panic = function("core::option::unwrap_failed", &[FOREVER]);
    let report = Maker::new(calls("IRQ0", &[3]), vec![tail, panic]).report("");
    assert_eq!(
        failures(&report),
        ["panic: IRQ0 can reach core::option::unwrap_failed"]
    );
}

#[test]
fn a_trap_is_found_unless_nothing_gets_there() {
    // cbz r0, udf; bx lr; udf
    let trap = function("trap", &[0xB100, BX_LR, UDF]);
    let report = Maker::new(calls("IRQ0", &[3]), vec![trap]).report("");
    assert_eq!(
        failures(&report),
        ["fault: IRQ0 can reach an undefined instruction"]
    );
    let dead = function("dead", &[BX_LR, UDF]);
    assert!(
        Maker::new(calls("IRQ0", &[3]), vec![dead])
            .report("")
            .passes()
    );
}

#[test]
fn an_indirect_call_needs_its_targets() {
    let by_pointer = function("by_pointer", &[PUSH_R7_LR, BLX_R3, POP_R7_PC]);
    let target = function("target", &[0xB08A, 0xB00A, BX_LR]); // 40 bytes
    let maker = Maker::new(calls("IRQ0", &[3]), vec![by_pointer, target]);
    let report = maker.report("");
    assert_eq!(
        failures(&report),
        ["indirect: IRQ0 calls through a pointer"]
    );
    assert!(report.sizes[2].at_least, "the stack is a lower bound");

    let vouched = "[[images.it.indirect]]\nfunction = \"by_pointer\"\n\
                   targets = [\"target\"]\nreason = \"the only one\"";
    let report = maker.report(vouched);
    assert_eq!(failures(&report), [""; 0]);
    assert_eq!(report.interrupts[0].stack, 8 + 8 + 40);
    assert!(!report.sizes[2].at_least);

    let gone = vouched.replace("\"target\"", "\"other\"");
    assert!(
        failures(&maker.report(&gone))
            .iter()
            .any(|f| f.contains("no function other"))
    );
}

#[test]
fn a_call_through_a_known_constant_is_direct() {
    let to = Maker::address(4) | 1;
    let half = |value: u32| u16::try_from(value & 0xFFFF).unwrap();
    let wide = |first: u16, value: u32| {
        let (imm4, i) = (half(value) >> 12, half(value) >> 11 & 1);
        let low = (half(value) & 0x700) << 4 | 3 << 8 | half(value) & 0xFF;
        [first | i << 10 | imm4, low]
    };
    let mut code = wide(0xF240, to).to_vec(); // movw r3
    code.extend(wide(0xF2C0, to >> 16)); // movt r3
    code.extend([0x4718]); // bx r3
    let veneer = function("veneer", &code);
    let panic = function("core::panicking::panic", &[FOREVER]);
    let report = Maker::new(calls("IRQ0", &[3]), vec![veneer, panic]).report("");
    assert_eq!(
        failures(&report),
        ["panic: IRQ0 can reach core::panicking::panic"]
    );
}

#[test]
fn loops_need_bounds_and_endless_ones_have_none() {
    // subs r0, #1; bne -4
    let down = function("count_down", &[SUBS_R0, 0xD1FD, BX_LR]);
    let maker = Maker::new(calls("IRQ0", &[3]), vec![down]);
    let found = failures(&maker.report(""));
    assert_eq!(
        found,
        ["loop: IRQ0 reaches 1 loop in count_down without a bound"]
    );
    let bound =
        "[[images.it.loops]]\nfunction = \"count_down\"\nbounds = [8]\nreason = \"r0 <= 8\"";
    let report = maker.report(bound);
    assert_eq!(failures(&report), [""; 0]);
    assert_eq!(report.loops[0].bound, Some(8));
    // The compiler may dissolve a loop: the largest bound is for the others.
    let two = bound.replace("[8]", "[8, 9]");
    let report = maker.report(&two);
    assert_eq!(failures(&report), [""; 0]);
    assert_eq!(report.loops[0].bound, Some(9));
    assert_eq!(
        report.hints[0].what,
        "count_down has 1 loop left; the budget bounds 2"
    );

    let endless = function("endless", &[NOP, 0xE7FD]);
    let report = Maker::new(calls("IRQ0", &[3]), vec![endless]).report("");
    assert_eq!(
        failures(&report),
        ["loop: IRQ0 can reach a loop that never ends"]
    );
}

#[test]
fn one_more_loop_than_is_bounded_fails() {
    // subs r0, #1; bne -4; subs r0, #1; bne -4
    let twice = [SUBS_R0, 0xD1FD, SUBS_R0, 0xD1FD, BX_LR];
    let twice = function("count_twice", &twice);
    let maker = Maker::new(calls("IRQ0", &[3]), vec![twice]);
    let bound =
        "[[images.it.loops]]\nfunction = \"count_twice\"\nbounds = [8]\nreason = \"r0 <= 8\"";
    assert_eq!(
        failures(&maker.report(bound)),
        ["loop: count_twice has 2 loops; the budget bounds 1"]
    );
}

#[test]
fn a_library_has_one_bound_for_all_its_loops() {
    let down = function("mem_set", &[SUBS_R0, 0xD1FD, BX_LR]);
    let twice = [SUBS_R0, 0xD1FD, SUBS_R0, 0xD1FD, BX_LR];
    let maker = Maker::new(
        calls("IRQ0", &[3, 4]),
        vec![down, function("mem_copy", &twice)],
    );
    let all = "[[images.it.loops]]\nfunction = \"mem_*\"\nat_most = 64\nreason = \"bytes\"";
    let report = maker.report(all);
    assert_eq!(failures(&report), [""; 0]);
    let bounds: Vec<_> = report.loops.iter().map(|l| l.bound).collect();
    assert_eq!(bounds, [Some(64); 3]);
    // A name is a name, and what begins otherwise is something else.
    for other in ["mem_", "memory_*"] {
        assert_eq!(
            failures(&maker.report(&all.replace("mem_*", other))).len(),
            3
        );
    }
}

#[test]
fn a_loop_that_only_ends_in_a_trap_is_endless() {
    // cbz r0, udf; b -4; udf
    let trap = function("trapped", &[0xB100, 0xE7FD, UDF]);
    let report = Maker::new(calls("IRQ0", &[3]), vec![trap]).report("");
    let found = failures(&report);
    assert!(
        found.contains(&"loop: IRQ0 can reach a loop that never ends".to_owned()),
        "{found:?}"
    );
}

#[test]
fn recursion_is_found() {
    let one = calls("one", &[4]);
    let two = calls("two", &[3]);
    let report = Maker::new(calls("IRQ0", &[3]), vec![one, two]).report("");
    assert_eq!(
        failures(&report),
        ["recursion: IRQ0 reaches functions that call themselves"]
    );
    assert!(report.interrupts[0].at_least);
}

#[test]
fn jump_tables_are_followed() {
    // tbb [pc, r0]; 2 offsets; bx lr; a panic behind the second
    let table = parts(
        "choose",
        vec![
            Part::Code(vec![0xE8DF, 0xF000]),
            Part::Data(vec![1, 2]),
            Part::Code(vec![BX_LR]),
            Part::Call(4),
        ],
    );
    let panic = function("core::panicking::panic", &[FOREVER]);
    let report = Maker::new(calls("IRQ0", &[3]), vec![table, panic]).report("");
    assert_eq!(
        failures(&report),
        ["panic: IRQ0 can reach core::panicking::panic"]
    );
    assert_eq!(report.interrupts[0].instructions, 3 + 3 + 1);
}

#[test]
fn the_stack_adds_up_along_the_worst_path() {
    // sub sp, #256; bl leaf; add sp, #256; bx lr
    let big = parts(
        "big",
        vec![
            Part::Code(vec![0xB0C0]),
            Part::Call(5),
            Part::Code(vec![0xB040, BX_LR]),
        ],
    );
    let small = calls("small", &[5]);
    // vpush {d8, d9}; vpop; bx lr
    let leaf = function("leaf", &[0xED2D, 0x8B04, 0xECBD, 0x8B04, BX_LR]);
    let report = Maker::new(calls("IRQ0", &[3, 4]), vec![big, small, leaf]).report("");
    assert_eq!(failures(&report), [""; 0]);
    let level = &report.levels[1];
    assert_eq!((level.exception, level.bytes), (27 * 4, 8 + 256 + 16));
    let names: Vec<&str> = level.path.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["IRQ0", "big", "leaf"]);
    assert_eq!(report.sizes[2].used, 108 + 280);
}

#[test]
fn a_computed_stack_pointer_must_be_vouched_for() {
    // mov r4, sp; mov sp, r4; bx lr
    let aligned = function("aligned", &[0x466C, 0x46A5, BX_LR]);
    let maker = Maker::new(calls("IRQ0", &[3]), vec![aligned]);
    let found = failures(&maker.report(""));
    assert_eq!(
        found,
        ["stack: IRQ0 reaches aligned, whose stack cannot be counted"]
    );
    let vouched =
        "[[images.it.dynamic_stack]]\nfunction = \"aligned\"\nbytes = 12\nreason = \"to 16\"";
    let report = maker.report(vouched);
    assert_eq!(failures(&report), [""; 0]);
    assert_eq!(report.interrupts[0].stack, 8 + 12);
}

#[test]
fn a_stack_that_grows_in_a_loop_is_found() {
    // push {r0}; subs r0, #1; bne -6; bx lr
    let growing = function("growing", &[0xB401, SUBS_R0, 0xD1FC, BX_LR]);
    let report = Maker::new(calls("IRQ0", &[3]), vec![growing]).report("");
    let found = failures(&report);
    assert!(found.iter().any(|f| f.starts_with("stack: ")), "{found:?}");
}

#[test]
fn what_ends_an_interrupt_is_not_followed_but_must_not_return() {
    let reset = function("stop", &[FOREVER]);
    let maker = Maker::new(calls("IRQ0", &[3]), vec![reset]);
    let ends = "[[images.it.ends]]\nfunction = \"stop\"\nreason = \"resets\"";
    assert_eq!(failures(&maker.report(ends)), [""; 0]);
    let returns = function("stop", &[BX_LR]);
    let report = Maker::new(calls("IRQ0", &[3]), vec![returns]).report(ends);
    assert_eq!(
        failures(&report),
        ["budget: stop is listed in `ends`, but can return"]
    );
}

#[test]
fn entries_that_nothing_needs_fail() {
    let stale = "[[images.it.loops]]\nfunction = \"gone\"\nbounds = [1]\nreason = \"was\"";
    let report = Maker::new(calls("IRQ0", &[]), vec![]).report(stale);
    assert_eq!(
        failures(&report),
        ["budget: the entry in loops for gone is not needed"]
    );
}

#[test]
fn interrupts_that_are_not_gated_may_do_as_they_like() {
    let loose = function("IRQ0", &[PUSH_R7_LR, BLX_R3, SUBS_R0, 0xD1FC, POP_R7_PC]);
    let report = Maker::new(loose, vec![]).report("gated = false");
    assert_eq!(failures(&report), [""; 0]);
    assert!(report.hints.iter().any(|hint| hint.check == "stack"));
}
