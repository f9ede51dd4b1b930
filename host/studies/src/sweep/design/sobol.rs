//! Sobol's sequence with random access to points, which a shard needs; libraries give one point
//! after another.

use super::hash;

/// Primitive polynomial (degree, coefficients) and first direction numbers of each
/// dimension after the first: Joe and Kuo, SIAM J. Sci. Comput. 30 (2008), 2635–2654,
/// the set "new-joe-kuo-6".
const JOE_KUO: [(u32, u32, &[u32]); 20] = [
    (1, 0, &[1]),
    (2, 1, &[1, 3]),
    (3, 1, &[1, 3, 1]),
    (3, 2, &[1, 1, 1]),
    (4, 1, &[1, 1, 3, 3]),
    (4, 4, &[1, 3, 5, 13]),
    (5, 2, &[1, 1, 5, 5, 17]),
    (5, 4, &[1, 1, 5, 5, 5]),
    (5, 7, &[1, 1, 7, 11, 19]),
    (5, 11, &[1, 1, 5, 1, 1]),
    (5, 13, &[1, 1, 1, 3, 11]),
    (5, 14, &[1, 3, 5, 5, 31]),
    (6, 1, &[1, 3, 3, 9, 7, 49]),
    (6, 13, &[1, 1, 1, 15, 21, 21]),
    (6, 16, &[1, 3, 1, 13, 27, 49]),
    (6, 19, &[1, 1, 1, 15, 7, 5]),
    (6, 22, &[1, 3, 1, 15, 13, 25]),
    (6, 25, &[1, 1, 5, 5, 19, 61]),
    (7, 1, &[1, 3, 7, 11, 23, 15, 103]),
    (7, 4, &[1, 3, 7, 13, 13, 15, 69]),
];

/// Most axes.
pub(super) const MOST_AXES: usize = JOE_KUO.len() + 1;

/// Bits of a coordinate and of a point's number.
const BITS: u32 = 32;

/// Returns the direction numbers of an axis: number `k` is the contribution of bit `k` of the Gray
/// code of a point's number.
fn directions(axis: usize) -> [u32; BITS as usize] {
    let mut numbers = [0_u32; BITS as usize];
    let Some((degree, coefficients, first)) = axis.checked_sub(1).and_then(|i| JOE_KUO.get(i))
    else {
        for (number, shift) in numbers.iter_mut().zip((0..BITS).rev()) {
            *number = 1 << shift;
        }
        return numbers;
    };
    let degree = *degree as usize;
    for place in 0..numbers.len() {
        numbers[place] = match first.get(place) {
            Some(m) => m << (BITS - 1 - u32::try_from(place).unwrap_or(0)),
            None => (1..degree).fold(
                numbers[place - degree] ^ (numbers[place - degree] >> degree),
                |sum, k| {
                    let is_in = coefficients >> (degree - 1 - k) & 1 == 1;
                    sum ^ if is_in { numbers[place - k] } else { 0 }
                },
            ),
        };
    }
    numbers
}

/// Returns the coordinate of a point before the digital shift, in units of 2⁻³².
fn unshifted(point: u64, axis: usize) -> u32 {
    let gray = point ^ (point >> 1);
    directions(axis)
        .into_iter()
        .enumerate()
        .filter(|(bit, _)| gray >> bit & 1 == 1)
        .fold(0, |x, (_, direction)| x ^ direction)
}

/// Returns a coordinate of a point, in (0, 1), after a digital shift of all points by the seed: it
/// keeps every property of the net and leaves no point at 0.
pub(super) fn coordinate(seed: u64, point: u64, axis: usize) -> f64 {
    let shift = (hash(&[seed, axis as u64]) >> 32) as u32;
    (f64::from(unshifted(point, axis) ^ shift) + 0.5) / f64::from(2_u32).powi(BITS.cast_signed())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares with SciPy 1.17's `scipy.stats.qmc.Sobol(d=21, scramble=False)`, points 1, 6, 511
    /// and 1000, times 2^30: what another program has for the same set of numbers.
    #[test]
    fn the_points_are_those_of_another_program() {
        for case in include_str!("sobol_cases.txt").lines() {
            let (point, coordinates) = case.split_once(": ").unwrap();
            let coordinates: Vec<u32> =
                coordinates.split(' ').map(|c| c.parse().unwrap()).collect();
            assert_eq!(coordinates.len(), MOST_AXES);
            for (axis, expected) in coordinates.into_iter().enumerate() {
                let found = unshifted(point.parse().unwrap(), axis) >> 2;
                assert_eq!(found, expected, "point {point}, axis {axis}");
            }
        }
    }

    #[test]
    fn every_dyadic_box_has_its_share_at_any_seed() {
        // A (0, m, 2)-net: 256 points, every box of 1/2^k by 1/2^(8-k) holds one.
        for seed in [0, 1, 77] {
            for k in 0..=8_u32 {
                let mut found = vec![0; 256];
                for point in 0..256 {
                    let along = |axis, bits: u32| {
                        (coordinate(seed, point, axis) * f64::from(1_u32 << bits)).floor()
                    };
                    let place = along(0, k) * f64::from(1_u32 << (8 - k)) + along(1, 8 - k);
                    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
                    let place = place as usize;
                    found[place] += 1;
                }
                assert!(found.iter().all(|&n| n == 1), "seed {seed}, 2^-{k}");
            }
        }
    }
}
