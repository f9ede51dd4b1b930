//! Order of the trials, from a seed.
//!
//! Equal plans, seeds and numbers of repeats give the same order, in every version and on every
//! machine: a lesson can be held again, with another group, and the two be compared. So the
//! generator is a few lines of our own, which no library's next release changes, and a test
//! holds golden orders.
//!
//! 1. **Random numbers**: SplitMix64 (Steele, Lea and Flood, *Fast splittable pseudorandom number
//!    generators*, OOPSLA 2014). The state `s` begins as the seed; every number is
//!    ```text
//!    s = s + 9e3779b97f4a7c15            (mod 2^64)
//!    z = (s xor s>>30) · bf58476d1ce4e5b9
//!    z = (z xor z>>27) · 94d049bb133111eb
//!    z xor z>>31
//!    ```
//!    A number below `n` is `x mod n`; an `x` of the last, incomplete block of `n` is rejected,
//!    so all are equally likely.
//! 2. **Shuffle**: Fisher and Yates (Durstenfeld, *Algorithm 235*, CACM 7(7), 1964): for `i` from
//!    the last place down to 1, swap places `i` and `random(0..=i)`.
//! 3. **No knee twice in a row**: the shuffled trials are taken from left to right; each time the
//!    first one that is not the same knee as the one before, and that leaves a rest which can be
//!    finished without repetition. Where no order without repetition exists, the one with the
//!    fewest is made. A list without repeats stays as shuffled.

/// Largest seed: a number that JavaScript, JSON and a person's note keep exactly, 2⁵³ - 1.
pub const MOST_SEED: u64 = (1 << 53) - 1;

/// SplitMix64.
#[derive(Clone, Debug)]
pub struct SplitMix64(u64);

impl SplitMix64 {
    /// A generator with this seed.
    pub const fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next number.
    pub const fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number below `n`, all equally likely; 0 if `n` is 0.
    pub const fn below(&mut self, n: u64) -> u64 {
        if n == 0 {
            return 0;
        }
        // 2^64 mod n numbers at the end are one block too few.
        let incomplete = (u64::MAX % n + 1) % n;
        loop {
            let x = self.next();
            if x <= u64::MAX - incomplete {
                return x % n;
            }
        }
    }
}

/// Order of a blind lesson: indices into `knees`, each as often as `repeats`. Equal elements of
/// `knees` are the same knee.
pub fn shuffled<K: PartialEq>(knees: &[K], repeats: usize, seed: u64) -> Vec<usize> {
    let mut order = planned(knees.len(), repeats);
    let mut random = SplitMix64::new(seed);
    for i in (1..order.len()).rev() {
        let j = usize::try_from(random.below(i as u64 + 1)).unwrap_or(i);
        order.swap(i, j);
    }
    // Equal knees have the same number.
    let kind = |knee: &K| knees.iter().position(|other| other == knee).unwrap_or(0);
    let kinds: Vec<_> = knees.iter().map(kind).collect();
    separated(order, &kinds)
}

/// Order of an open lesson: the plan's, as often as `repeats`.
pub fn planned(knees: usize, repeats: usize) -> Vec<usize> {
    std::iter::repeat_n(0..knees, repeats).flatten().collect()
}

/// The order with the fewest repetitions of a kind that keeps as close as possible to this one.
fn separated(mut rest: Vec<usize>, kinds: &[usize]) -> Vec<usize> {
    let kind = |place: usize| kinds.get(place).copied().unwrap_or(place);
    let mut counts = vec![0; kinds.len()];
    for place in &rest {
        change(&mut counts, kind(*place), |count| count + 1);
    }
    let mut order = Vec::with_capacity(rest.len());
    let mut last = None;
    while !rest.is_empty() {
        let cost = |at: &usize| {
            let first = rest.get(*at).map_or(0, |place| kind(*place));
            let mut counts = counts.clone();
            change(&mut counts, first, |count| count - 1);
            usize::from(last == Some(first)) + fewest_repetitions(first, &counts)
        };
        let best = (0..rest.len()).min_by_key(cost);
        let place = rest.remove(best.unwrap_or(0));
        change(&mut counts, kind(place), |count| count - 1);
        last = Some(kind(place));
        order.push(place);
    }
    order
}

fn change(counts: &mut [usize], kind: usize, by: impl Fn(usize) -> usize) {
    if let Some(count) = counts.get_mut(kind) {
        *count = by(*count);
    }
}

/// Fewest repetitions with which kinds can follow a last one, by how often each is left.
///
/// A kind that occurs `m` times has the `o` others between its own, so `m - 1 - o` of its steps
/// are repetitions at least, one more if the last one is of that kind.
fn fewest_repetitions(last: usize, counts: &[usize]) -> usize {
    let all: usize = counts.iter().sum();
    let repetitions = |(kind, count): (usize, &usize)| {
        let own = count + usize::from(kind == last);
        own.saturating_sub(1 + all - count)
    };
    counts
        .iter()
        .enumerate()
        .map(repetitions)
        .max()
        .unwrap_or(0)
}

#[cfg(test)]
mod tests;
