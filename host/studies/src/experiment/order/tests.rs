use super::*;
use proptest::prelude::*;

/// The published sequence of the generator.
#[test]
fn random_numbers_are_splitmix64() {
    let mut random = SplitMix64::new(1_234_567);
    let numbers: Vec<_> = (0..5).map(|_| random.next()).collect();
    assert_eq!(
        numbers,
        [
            6_457_827_717_110_365_317,
            3_203_168_211_198_807_973,
            9_817_491_932_198_370_423,
            4_593_380_528_125_082_431,
            16_408_922_859_458_223_821,
        ]
    );
}

#[test]
fn numbers_below_a_limit_are_equally_likely() {
    let mut random = SplitMix64::new(7);
    let mut counts = [0_u32; 6];
    for _ in 0..60_000 {
        counts[usize::try_from(random.below(6)).unwrap()] += 1;
    }
    // Five standard deviations of a binomial count.
    assert!(
        counts.iter().all(|n| n.abs_diff(10_000) < 460),
        "{counts:?}"
    );
    assert_eq!((random.below(1), random.below(0)), (0, 0));
    // A third; half of them if the last, incomplete block came a second time.
    let low = (0..10_000).filter(|_| random.below(3 << 62) < 1 << 62);
    let low = low.count();
    assert!(low.abs_diff(3_333) < 300, "{low}");
    // Half of all numbers are rejected here.
    assert!(random.below((1 << 63) + 1) <= 1 << 63);
}

/// These orders must never change: a seed in a report is a promise. They were computed by a
/// second program, from the description alone.
#[test]
fn golden_orders() {
    let six = ["a", "b", "c", "d", "e", "f"];
    for (seed, order) in GOLDEN_ONCE {
        assert_eq!(shuffled(&six, 1, seed), order, "{seed}");
    }
    for (seed, order) in GOLDEN_THRICE {
        assert_eq!(shuffled(&["a", "b", "c"], 3, seed), order, "{seed}");
    }
}

const GOLDEN_ONCE: [(u64, [usize; 6]); 3] = [
    (0, [4, 2, 5, 3, 0, 1]),
    (1, [0, 1, 3, 2, 4, 5]),
    (20_261_124, [2, 3, 5, 4, 0, 1]),
];

const GOLDEN_THRICE: [(u64, [usize; 9]); 2] = [
    (1, [2, 1, 0, 2, 0, 1, 0, 1, 2]),
    (2, [2, 1, 0, 1, 2, 0, 2, 0, 1]),
];

#[test]
fn an_open_lesson_keeps_the_order_of_its_plan() {
    assert_eq!(planned(3, 2), [0, 1, 2, 0, 1, 2]);
    assert!(planned(0, 2).is_empty() && shuffled::<u8>(&[], 3, 1).is_empty());
}

fn repetitions(kinds: &[u8]) -> usize {
    kinds.windows(2).filter(|pair| pair[0] == pair[1]).count()
}

/// Fewest repetitions over all orders.
fn fewest(kinds: &mut Vec<u8>, done: usize) -> usize {
    if done == kinds.len() {
        return repetitions(kinds);
    }
    let mut least = usize::MAX;
    for other in done..kinds.len() {
        kinds.swap(done, other);
        least = least.min(fewest(kinds, done + 1));
        kinds.swap(done, other);
    }
    least
}

proptest! {
    #[test]
    fn no_order_has_fewer_repetitions(
        knees in prop::collection::vec(0_u8..4, 1..8),
        seed in any::<u64>(),
    ) {
        let order = shuffled(&knees, 1, seed);
        let kinds: Vec<_> = order.iter().map(|place| knees[*place]).collect();
        prop_assert_eq!(repetitions(&kinds), fewest(&mut knees.clone(), 0));
        let mut sorted = order;
        sorted.sort_unstable();
        prop_assert_eq!(sorted, (0..knees.len()).collect::<Vec<_>>());
    }

    #[test]
    fn different_knees_are_never_repeated(count in 2_usize..21, repeats in 1_usize..11, seed in any::<u64>()) {
        let knees: Vec<_> = (0..count).collect();
        let order = shuffled(&knees, repeats, seed);
        prop_assert!(order.windows(2).all(|pair| pair[0] != pair[1]));
        for knee in knees {
            prop_assert_eq!(order.iter().filter(|place| **place == knee).count(), repeats);
        }
    }
}
