//! The smallest sufficient set of effects: all sets are tried, the small ones
//! first, until one of a size suffices.

/// A set of a scene's effects, a bit for each index.
pub(super) type Set = u32;

/// Result of the search.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SmallestSet<T> {
    /// The sufficient sets of the smallest size, and their results.
    pub(super) sets: Vec<(Set, T)>,
    /// Number of sets tried.
    pub(super) tried: usize,
}

/// Tries sets of growing size until one suffices. `needs` has for each effect
/// those that it needs; `judge` returns the sufficient ones of some sets with
/// their results.
pub(super) fn smallest<T, E>(
    needs: &[Set],
    mut judge: impl FnMut(&[Set]) -> Result<Vec<Option<T>>, E>,
) -> Result<SmallestSet<T>, E> {
    let mut tried = 0;
    for size in 0..=needs.len() {
        let sets: Vec<Set> = sets(needs)
            .filter(|set| usize::try_from(set.count_ones()) == Ok(size))
            .collect();
        tried += sets.len();
        let judged = judge(&sets)?;
        let sets: Vec<_> = sets
            .into_iter()
            .zip(judged)
            .filter_map(|(set, judged)| Some((set, judged?)))
            .collect();
        if !sets.is_empty() {
            return Ok(SmallestSet { sets, tried });
        }
    }
    Ok(SmallestSet {
        sets: Vec::new(),
        tried,
    })
}

/// All sets in which each effect has those that it needs.
pub(super) fn sets(needs: &[Set]) -> impl Iterator<Item = Set> {
    let all: Set = (1 << needs.len()) - 1;
    (0..=all).filter(|set| {
        needs
            .iter()
            .enumerate()
            .all(|(i, needs)| set & (1 << i) == 0 || set & needs == *needs)
    })
}

/// `set` without an effect and without those that need it.
pub(super) fn without(set: Set, effect: usize, needs: &[Set]) -> Set {
    let mut left = set & !(1 << effect);
    loop {
        let missing = needs
            .iter()
            .enumerate()
            .find(|(i, needs)| left & (1 << i) != 0 && left & **needs != **needs);
        match missing {
            None => return left,
            Some((i, _)) => left &= !(1 << i),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Effects 0 to 4; 3 needs 1, 4 needs 3.
    const NEEDS: [Set; 5] = [0, 0, 0, 0b10, 0b1000];

    /// The error is the sum over the missing effects; effects 1 and 2 cancel.
    fn error(set: Set) -> f64 {
        [0.5, 1.0, -1.0, 0.02, 0.01]
            .iter()
            .enumerate()
            .filter(|(i, _)| set & (1 << i) == 0)
            .map(|(_, x)| x)
            .sum::<f64>()
            .abs()
    }

    fn within(limit: f64) -> SmallestSet<f64> {
        smallest(&NEEDS, |sets| {
            let judged = sets.iter().map(|set| error(*set));
            Ok::<_, ()>(judged.map(|e| (e <= limit).then_some(e)).collect())
        })
        .unwrap()
    }

    #[test]
    fn the_search_is_exact_and_stops_at_the_first_size() {
        assert_eq!(within(10.0).tried, 1);
        // Effects that cancel are dropped together, though neither alone could be.
        let found = within(0.1);
        assert_eq!(found.sets.len(), 1);
        assert_eq!(found.sets[0].0, 0b00001);
        assert!((found.sets[0].1 - 0.03).abs() < 1e-12);
        assert_eq!(found.tried, 1 + 3);
        // Only everything leaves nothing.
        let found = within(0.0);
        assert_eq!((found.sets.len(), found.sets[0].0), (1, 0b11111));
        assert_eq!(found.tried, sets(&NEEDS).count());
    }

    #[test]
    fn every_set_has_what_it_needs() {
        let all: Vec<Set> = sets(&NEEDS).collect();
        // Of 1, 3 and 4: none, 1, 1 and 3, all; times four of 0 and 2.
        assert_eq!(all.len(), 16);
        assert!(all.iter().all(|set| set & 0b1000 == 0 || set & 0b10 != 0));
        assert_eq!(without(0b11111, 1, &NEEDS), 0b00101);
        assert_eq!(without(0b11111, 4, &NEEDS), 0b01111);
        assert_eq!(sets(&[]).collect::<Vec<_>>(), [0]);
    }

    #[test]
    fn nothing_found_is_nothing() {
        let found = smallest(&NEEDS, |sets| Ok::<_, ()>(vec![None::<()>; sets.len()])).unwrap();
        assert_eq!((found.sets.len(), found.tried), (0, 16));
        assert_eq!(smallest(&NEEDS, |_| Err::<Vec<Option<()>>, _>(3)), Err(3));
    }
}
