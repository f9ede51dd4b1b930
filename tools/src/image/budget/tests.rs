use super::{Budget, bless};
use std::path::Path;

const TEXT: &str = "# sizes\n[images.a]\nelf = \"a\"\nmemory = \"m\"\n\
    [images.a.recorded]\nflash = 1_000 # of 1 MB\nram=20\nstack = 3\n";

fn parse(text: &str) -> Result<Budget, String> {
    Budget::parse(Path::new("b.toml"), text).map_err(|e| e.to_string())
}

#[test]
fn defaults() {
    let budget = parse(TEXT).unwrap();
    let image = &budget.images["a"];
    assert_eq!(image.flash, ["FLASH"]);
    assert!((budget.tolerance_percent - 2.0).abs() < 1e-9);
    assert!(image.interrupts.is_empty());
}

#[test]
fn blessing_changes_numbers_and_nothing_else() {
    let budget = parse(TEXT).unwrap();
    let old = &budget.images["a"].recorded;
    let blessed = bless(TEXT, &[(&old.ram, 1_234_567), (&old.flash, 7)]);
    let expected = TEXT
        .replace("1_000", "7")
        .replace("ram=20", "ram=1_234_567");
    assert_eq!(blessed, expected);
    assert_eq!(
        *parse(&blessed).unwrap().images["a"].recorded.ram.get_ref(),
        1_234_567
    );
}

#[test]
fn says_what_is_wrong() {
    for (more, word) in [
        ("colour = 1\n", "colour"),
        (
            "[[images.a.loops]]\nfunction = \"f\"\nbounds = [1]\nreason = \" \"\n",
            "without a reason",
        ),
        (
            "[[images.a.ends]]\nfunction = \"f\"\nreason = \"r\"\n\
             [[images.a.ends]]\nfunction = \"f\"\nreason = \"r\"\n",
            "twice",
        ),
        (
            "[[images.a.loops]]\nfunction = \"f\"\nreason = \"r\"\n",
            "either `bounds` or `at_most`",
        ),
        (
            "[[images.a.loops]]\nfunction = \"f\"\nbounds = [1]\nat_most = 1\nreason = \"r\"\n",
            "either `bounds` or `at_most`",
        ),
        (
            "[[images.a.reserved]]\nfrom = 2\nto = 2\nwhat = \"w\"\n",
            "behind its end",
        ),
        (
            "[[loops]]\nfunction = \"f\"\nbounds = [1]\nreason = \"\"\n",
            "f is in loops without a reason",
        ),
        (
            "[[loops]]\nfunction = \"f\"\nreason = \"r\"\n",
            "either `bounds` or `at_most`",
        ),
        (
            "[[images.a.panics]]\nlibrary = \"l\"\nat_most = 0\nreason = \"r\"\n",
            "a: l is in panics with `at_most = 0`",
        ),
        (
            "[[images.a.panics]]\nlibrary = \"l\"\nat_most = 1\nreason = \"\"\n",
            "l is in panics without a reason",
        ),
        (
            "[[images.a.panics]]\nlibrary = \"l\"\nreason = \"r\"\n",
            "missing field `at_most`",
        ),
        (
            "[[images.a.panics]]\nfunction = \"f\"\nat_most = 1\nreason = \"r\"\n",
            "unknown field `function`, expected one of `library`",
        ),
        ("[[images.a.interrupts]]\nhandler = \"X\"\n", "irq"),
    ] {
        let error = parse(&format!("{TEXT}{more}")).unwrap_err();
        assert!(
            error.contains(word) && error.starts_with("b.toml"),
            "{error}"
        );
    }
    let error = parse(&format!("tolerance_percent = 200\n{TEXT}")).unwrap_err();
    assert!(error.contains("tolerance_percent"), "{error}");
}
