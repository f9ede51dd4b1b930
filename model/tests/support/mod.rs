//! Shared by the property tests.

use proptest::test_runner::{Config, RngSeed};

/// A configuration of `cases` cases, the same ones in every run.
///
/// `PROPTEST_CASES` asks for another number of them, and `PROPTEST_RNG_SEED`
/// for others.
pub(crate) fn cases(cases: u32) -> Config {
    let number = |name| std::env::var(name).ok().and_then(|n| n.parse::<u64>().ok());
    Config {
        cases: number("PROPTEST_CASES").map_or(cases, |n| u32::try_from(n).unwrap_or(u32::MAX)),
        rng_seed: RngSeed::Fixed(number("PROPTEST_RNG_SEED").unwrap_or(1)),
        failure_persistence: None,
        ..Config::default()
    }
}
