//! Latin hypercube sampling with random access to points, so that a shard needs no memory for all.

use super::hash;

/// Rounds of the Feistel network: four make a permutation that no test tells from a
/// random one (Luby and Rackoff, SIAM J. Comput. 17 (1988), 373–386).
const ROUNDS: u64 = 4;

/// Returns a coordinate of a point, in [0, 1). Each of `count` equal strata of an axis has exactly
/// one point, anywhere in it.
pub(super) fn coordinate(seed: u64, point: u64, axis: usize, count: u64) -> f64 {
    let axis = axis as u64;
    let part = permuted(seed, axis, point, count);
    #[expect(clippy::cast_precision_loss, reason = "53 bits are kept")]
    let within = (hash(&[seed, axis, point, ROUNDS]) >> 11) as f64 * 2.0_f64.powi(-53);
    #[expect(clippy::cast_precision_loss, reason = "below 2^53")]
    let coordinate = (part as f64 + within) / count as f64;
    coordinate.min(1.0 - f64::EPSILON)
}

/// Returns the image of `place` under a keyed permutation of `0..count`: a permutation of the next
/// power of four, walked until it is below `count`.
fn permuted(seed: u64, axis: u64, place: u64, count: u64) -> u64 {
    let half_bits = (64 - count.saturating_sub(1).leading_zeros())
        .div_ceil(2)
        .max(1);
    let mask = (1_u64 << half_bits) - 1;
    let mut walked = place;
    loop {
        let (mut left, mut right) = (walked >> half_bits, walked & mask);
        for round in 0..ROUNDS {
            (left, right) = (right, left ^ (hash(&[seed, axis, round, right]) & mask));
        }
        walked = left << half_bits | right;
        if walked < count {
            return walked;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_of_every_axis_has_one_point() {
        for count in [1, 2, 3, 7, 64, 1000, 1025] {
            for (seed, axis) in [(0, 0), (0, 1), (9, 0)] {
                let mut found: Vec<_> = (0..count)
                    .map(|point| {
                        let x = coordinate(seed, point, axis, count);
                        assert!((0.0..1.0).contains(&x));
                        #[expect(
                            clippy::cast_possible_truncation,
                            clippy::cast_sign_loss,
                            clippy::cast_precision_loss
                        )]
                        let part = (x * count as f64) as u64;
                        part
                    })
                    .collect();
                found.sort_unstable();
                assert_eq!(
                    found,
                    (0..count).collect::<Vec<_>>(),
                    "{count} {seed} {axis}"
                );
            }
        }
    }

    #[test]
    fn axes_and_seeds_are_independent() {
        let count = 4000;
        let column = |seed, axis| -> Vec<f64> {
            (0..count)
                .map(|p| coordinate(seed, p, axis, count) - 0.5)
                .collect()
        };
        let correlation = |a: &[f64], b: &[f64]| {
            let sum: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
            sum * 12.0 / 4000.0
        };
        let (one, other, reseeded) = (column(1, 0), column(1, 1), column(2, 0));
        let order: Vec<_> = (0..4000).map(|i| f64::from(i) / 4000.0 - 0.5).collect();
        // Four standard deviations of independent columns.
        let bound = 4.0 / 4000.0_f64.sqrt();
        for (name, r) in [
            ("axes", correlation(&one, &other)),
            ("seeds", correlation(&one, &reseeded)),
            ("order", correlation(&one, &order)),
        ] {
            assert!(r.abs() < bound, "{name}: {r}");
        }
    }
}
