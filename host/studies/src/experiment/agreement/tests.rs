use super::*;
use crate::experiment::order::SplitMix64;
use proptest::prelude::*;

/// Table, weights, kappa and standard error of `statsmodels.stats.inter_rater.cohens_kappa`
/// (statsmodels 0.15.0; `wt="linear"`), which uses the same formula.
#[test]
fn another_implementation_agrees() {
    use Weights::{Linear, Nominal};
    let three = [[20, 5, 1], [3, 15, 4], [2, 2, 18]];
    let few = [[2, 0, 0], [1, 1, 0], [0, 0, 2]];
    let below = [[0, 4, 1], [3, 1, 2], [2, 3, 0]];
    agrees(
        three,
        Nominal,
        0.634_969_325_153_374_2,
        0.076_878_002_555_838_33,
    );
    agrees(
        three,
        Linear,
        0.682_395_644_283_121_6,
        0.072_892_689_066_758_68,
    );
    agrees(few, Nominal, 0.75, 0.217_506_385_602_303_18);
    agrees(
        few,
        Linear,
        0.823_529_411_764_705_8,
        0.163_913_069_651_584_48,
    );
    agrees(
        below,
        Nominal,
        -0.428_571_428_571_428_55,
        0.089_346_432_221_521_7,
    );
    agrees(
        below,
        Linear,
        -0.384_615_384_615_384_6,
        0.069_699_520_647_277_94,
    );
    let levels = [[8, 1, 0, 0], [2, 9, 4, 0], [0, 3, 10, 2], [0, 1, 3, 7]];
    let gap = [[3, 0, 0, 0], [0, 0, 0, 0], [1, 2, 5, 2], [0, 0, 1, 4]];
    let far = [[1, 0, 1, 6], [2, 3, 1, 0], [0, 2, 4, 1], [5, 0, 1, 2]];
    agrees(
        levels,
        Linear,
        0.698_581_560_283_688,
        0.070_331_305_951_354_49,
    );
    agrees(
        gap,
        Nominal,
        0.513_513_513_513_513_5,
        0.155_880_957_578_776_37,
    );
    agrees(gap, Linear, 0.655_737_704_918_032_6, 0.134_958_143_204_962);
    agrees(
        far,
        Linear,
        -0.103_260_869_565_217_52,
        0.145_882_642_005_018_6,
    );
}

fn agrees<const K: usize>(counts: [[usize; K]; K], weights: Weights, value: f64, error: f64) {
    let kappa = Table(counts).kappa(weights).unwrap();
    assert!((kappa.value - value).abs() < 1e-13, "{kappa:?}, {value}");
    assert!(
        (kappa.standard_error - error).abs() < 1e-12,
        "{kappa:?}, {error}"
    );
}

#[test]
fn limits_stay_within_what_kappa_can_be() {
    let few = Table([[2, 0, 0], [1, 1, 0], [0, 0, 2]]);
    let (low, high) = few.kappa(Weights::Nominal).unwrap().interval();
    assert!((low - 0.323_695_317_812_004_2).abs() < 1e-12 && high == 1.0);
}

#[test]
fn kappa_is_undefined_without_variance() {
    for table in [Table([[0, 0], [0, 0]]), Table([[5, 0], [0, 0]])] {
        assert_eq!(table.kappa(Weights::Nominal), None);
        assert_eq!(table.kappa(Weights::Linear), None);
    }
    // One category of truth alone: no agreement beyond chance, whatever the answers.
    let kappa = Table([[5, 3], [0, 0]]).kappa(Weights::Nominal).unwrap();
    assert!(kappa.value.abs() < 1e-15);
}

#[test]
fn a_category_that_is_not_in_the_table_is_ignored() {
    let mut table = Table::<2>::default();
    table.count(2, 0);
    table.count(0, 2);
    table.count(1, 0);
    assert_eq!(
        (table, table.total(), table.truths()),
        (Table([[0, 0], [1, 0]]), 1, 1)
    );
}

/// 95 % of the intervals of samples contain the kappa of the population.
#[test]
fn the_interval_covers_what_it_says() {
    let population = Table([[16, 3, 1, 0], [4, 18, 8, 1], [1, 6, 20, 5], [0, 2, 6, 14]]);
    for weights in [Weights::Nominal, Weights::Linear] {
        let truth = population.kappa(weights).unwrap().value;
        let mut random = SplitMix64::new(1);
        let samples = 4_000;
        let mut covered = 0;
        for _ in 0..samples {
            let mut sample = Table::<4>::default();
            for _ in 0..100 {
                let (i, j) = draw(&population, &mut random);
                sample.count(i, j);
            }
            let (low, high) = sample.kappa(weights).unwrap().interval();
            covered += usize::from(low <= truth && truth <= high);
        }
        let share = covered as f64 / f64::from(samples);
        assert!((share - 0.95).abs() < 0.015, "{weights:?}: {share}");
    }
}

/// An answer of a population.
fn draw(population: &Table<4>, random: &mut SplitMix64) -> (usize, usize) {
    let mut left = usize::try_from(random.below(population.total() as u64)).unwrap();
    for i in 0..4 {
        for j in 0..4 {
            match left.checked_sub(population.0[i][j]) {
                Some(rest) => left = rest,
                None => return (i, j),
            }
        }
    }
    unreachable!("the counts are those of the total")
}

fn tables() -> impl Strategy<Value = Table<4>> {
    prop::array::uniform4(prop::array::uniform4(0_usize..12)).prop_map(Table)
}

proptest! {
    #[test]
    fn kappa_is_at_most_one(table in tables()) {
        for weights in [Weights::Nominal, Weights::Linear] {
            if let Some(kappa) = table.kappa(weights) {
                prop_assert!(kappa.value <= 1.0 + 1e-12 && kappa.standard_error >= 0.0);
                let (low, high) = kappa.interval();
                prop_assert!((-1.0..=1.0).contains(&low) && low <= high && high <= 1.0);
            }
        }
    }

    #[test]
    fn agreement_of_all_is_one(diagonal in prop::array::uniform4(0_usize..12)) {
        let mut table = Table::<4>::default();
        for (i, count) in diagonal.into_iter().enumerate() {
            table.0[i][i] = count;
        }
        for weights in [Weights::Nominal, Weights::Linear] {
            let kappa = table.kappa(weights);
            prop_assert_eq!(kappa.is_some(), table.truths() > 1);
            if let Some(kappa) = kappa {
                prop_assert!((kappa.value - 1.0).abs() < 1e-12 && kappa.standard_error < 1e-6);
            }
        }
    }
}
