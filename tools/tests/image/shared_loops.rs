//! Bounds of loops for all images.

use crate::common::*;
use crepitus_tools::image::budget::Budget;
use crepitus_tools::image::needless_loops;
use std::path::Path;

const SHARED: &str = "[[loops]]\nfunction = \"count_down\"\nbounds = [8]\nreason = \"r0 <= 8\"\n";

/// An image whose interrupt counts, and one whose does not.
fn images() -> [Maker; 2] {
    let down = function("count_down", &[SUBS_R0, 0xD1FD, BX_LR]);
    [
        Maker::new(calls("IRQ0", &[3]), vec![down]),
        Maker::new(calls("IRQ0", &[]), vec![]),
    ]
}

#[test]
fn a_bound_for_all_images_is_needed_by_any() {
    let [with, without] = images().map(|image| image.report(SHARED));
    assert_eq!(with.loops[0].bound, Some(8));
    for report in [&with, &without] {
        assert_eq!(failures(report), [""; 0]);
    }
    let shared = Budget::parse(Path::new("b.toml"), &budget(SHARED)).unwrap();
    let needless = needless_loops(&shared.loops, std::slice::from_ref(&without));
    assert_eq!(
        needless[0].what,
        "the entry in loops for count_down is needed by no image"
    );
    assert_eq!(needless_loops(&shared.loops, &[with, without]), []);
}

#[test]
fn a_bound_for_all_images_is_no_second_one() {
    let own = SHARED.replace("[[loops]]", "[[images.it.loops]]");
    let text = budget(&format!("{SHARED}{own}"));
    let error = Budget::parse(Path::new("b.toml"), &text).unwrap_err();
    assert_eq!(
        error.to_string(),
        "b.toml: it: count_down is in loops twice"
    );
}
