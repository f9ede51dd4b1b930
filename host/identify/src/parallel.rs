//! Work in several threads.

/// Maps `work` over items, each in a thread of its own.
pub(crate) fn in_parallel<T: Sync, R: Send + Default>(
    items: &[T],
    work: impl Fn(&T) -> R + Sync,
) -> Vec<R> {
    std::thread::scope(|scope| {
        let work = &work;
        let threads: Vec<_> = (items.iter())
            .map(|item| scope.spawn(move || work(item)))
            .collect();
        // A thread that has panicked has found nothing.
        (threads.into_iter())
            .map(|thread| thread.join().unwrap_or_default())
            .collect()
    })
}
