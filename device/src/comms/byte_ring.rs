//! A queue of bytes that are put in and taken out in runs.

/// A queue of at most `N` bytes.
#[derive(Clone, Debug)]
pub(super) struct ByteRing<const N: usize> {
    bytes: [u8; N],
    /// Index of the oldest byte, below `N`.
    begin: usize,
    /// Bytes in it, at most `N`.
    length: usize,
}

impl<const N: usize> ByteRing<N> {
    /// An empty queue.
    pub(super) const fn new() -> Self {
        Self {
            bytes: [0; N],
            begin: 0,
            length: 0,
        }
    }

    /// Number of bytes in the queue.
    pub(super) fn len(&self) -> usize {
        self.length
    }

    /// Drops all.
    pub(super) fn clear(&mut self) {
        (self.begin, self.length) = (0, 0);
    }

    /// Appends all bytes; false, and none, if there is no room for them.
    pub(super) fn push(&mut self, bytes: &[u8]) -> bool {
        if bytes.len() > N.saturating_sub(self.length) {
            return false;
        }
        let end = Self::wrapped(self.begin.saturating_add(self.length));
        let (first, second) = bytes.split_at(bytes.len().min(N.saturating_sub(end)));
        put(&mut self.bytes, end, first);
        put(&mut self.bytes, 0, second);
        self.length = self.length.saturating_add(bytes.len());
        true
    }

    /// The oldest bytes, as far as they are contiguous.
    pub(super) fn front(&self) -> &[u8] {
        let end = self.begin.saturating_add(self.length).min(N);
        self.bytes.get(self.begin..end).unwrap_or_default()
    }

    /// Drops the oldest `count` bytes.
    pub(super) fn drop_front(&mut self, count: usize) {
        let count = count.min(self.length);
        self.begin = Self::wrapped(self.begin.saturating_add(count));
        self.length = self.length.saturating_sub(count);
    }

    /// A place below 2 N as one below N.
    fn wrapped(place: usize) -> usize {
        place.checked_sub(N).unwrap_or(place)
    }
}

/// Copies bytes to a place where they fit.
fn put(bytes: &mut [u8], at: usize, from: &[u8]) {
    let to = bytes.get_mut(at..).and_then(|to| to.get_mut(..from.len()));
    if let Some(to) = to {
        to.copy_from_slice(from);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::VecDeque;

    proptest! {
        #[test]
        fn it_is_a_queue(steps in prop::collection::vec((0_usize..14, 0_usize..14), 1..200)) {
            let mut ring = ByteRing::<13>::new();
            let mut queue = VecDeque::new();
            let mut next = 0_u8;
            for (put, taken) in steps {
                let bytes: std::vec::Vec<u8> = (0..put).map(|_| {
                    next = next.wrapping_add(1);
                    next
                }).collect();
                let fits = queue.len() + put <= 13;
                prop_assert_eq!(ring.push(&bytes), fits);
                if fits {
                    queue.extend(bytes);
                }
                let front = ring.front();
                prop_assert_eq!(front.is_empty(), queue.is_empty());
                prop_assert!(front.iter().eq(queue.iter().take(front.len())));
                ring.drop_front(taken);
                queue.drain(..taken.min(queue.len()));
                prop_assert_eq!(ring.len(), queue.len());
            }
        }
    }
}
