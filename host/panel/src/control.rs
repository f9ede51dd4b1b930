//! Control of the device: by one page at most.

use std::sync::atomic::{AtomicU64, Ordering};
use tokio::sync::watch;

/// Number of a page.
pub(crate) type Page = u64;

/// Record of the page that controls the device.
pub(crate) struct Control {
    next: AtomicU64,
    holder: watch::Sender<Option<Page>>,
}

impl Control {
    pub(crate) fn new() -> Self {
        Self {
            next: AtomicU64::new(1),
            holder: watch::channel(None).0,
        }
    }

    /// The number of a new page.
    pub(crate) fn page(&self) -> Page {
        self.next.fetch_add(1, Ordering::Relaxed)
    }

    /// The page that has control.
    pub(crate) fn holder(&self) -> Option<Page> {
        *self.holder.borrow()
    }

    /// Tells changes.
    pub(crate) fn subscribe(&self) -> watch::Receiver<Option<Page>> {
        self.holder.subscribe()
    }

    /// This page takes it.
    pub(crate) fn take(&self, page: Page) {
        self.holder.send_replace(Some(page));
    }

    /// This page gives it away; true if it had it.
    pub(crate) fn release(&self, page: Page) -> bool {
        self.holder.send_if_modified(|holder| {
            let had = *holder == Some(page);
            if had {
                *holder = None;
            }
            had
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_who_has_it_gives_it_away() {
        let control = Control::new();
        let [first, second] = [control.page(), control.page()];
        assert_ne!(first, second);
        control.take(first);
        assert!(!control.release(second));
        assert_eq!(control.holder(), Some(first));
        control.take(second);
        assert!(!control.release(first));
        assert!(control.release(second));
        assert_eq!(control.holder(), None);
    }
}
