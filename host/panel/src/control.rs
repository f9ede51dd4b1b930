//! Control of the device: by one page at most.
//!
//! ```text
//!  Nobody ── take ──> Page ── release ──> Nobody
//!                      │  ↑
//!          withdraw (a │  │ take (executed by the device thread: torque is off)
//!         take-over)   ↓  │
//!                     Passing
//! ```
//!
//! A page gets control in the device thread only, between two orders; it loses control at
//! once, wherever that is noticed. So an order of a page that has lost control is rejected
//! when its turn comes.

use std::sync::atomic::{AtomicU64, Ordering};
use tokio::sync::watch;

/// Number of a page.
pub(crate) type Page = u64;

/// State of the control.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Holder {
    /// No page has it.
    Nobody,
    /// This page has it.
    Page(Page),
    /// Control was withdrawn from a page for another one, which gets it when torque is off.
    Passing,
}

/// Record of the page that controls the device.
pub(crate) struct Control {
    next: AtomicU64,
    holder: watch::Sender<Holder>,
}

impl Control {
    pub(crate) fn new() -> Self {
        Self {
            next: AtomicU64::new(1),
            holder: watch::channel(Holder::Nobody).0,
        }
    }

    /// The number of a new page.
    pub(crate) fn page(&self) -> Page {
        self.next.fetch_add(1, Ordering::Relaxed)
    }

    /// State of the control.
    pub(crate) fn holder(&self) -> Holder {
        *self.holder.borrow()
    }

    /// Returns whether this page has control.
    pub(crate) fn is_held_by(&self, page: Page) -> bool {
        self.holder() == Holder::Page(page)
    }

    /// Receiver of changes.
    pub(crate) fn subscribe(&self) -> watch::Receiver<Holder> {
        self.holder.subscribe()
    }

    /// Withdraws control from any other page; returns whether one had it.
    pub(crate) fn withdraw_for(&self, page: Page) -> bool {
        self.holder.send_if_modified(|holder| {
            let is_other = matches!(*holder, Holder::Page(other) if other != page);
            if is_other {
                *holder = Holder::Passing;
            }
            is_other
        })
    }

    /// Gives control to a page. Only the device thread may do so, after torque is off.
    pub(crate) fn give(&self, page: Page) {
        self.holder.send_replace(Holder::Page(page));
    }

    /// This page gives it away; true if it had it.
    pub(crate) fn release(&self, page: Page) -> bool {
        self.holder.send_if_modified(|holder| {
            let had = *holder == Holder::Page(page);
            if had {
                *holder = Holder::Nobody;
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
        control.give(first);
        assert!(!control.release(second));
        assert!(control.is_held_by(first));
        control.give(second);
        assert!(!control.release(first));
        assert!(control.release(second));
        assert_eq!(control.holder(), Holder::Nobody);
    }

    #[test]
    fn a_take_over_withdraws_from_others_only() {
        let control = Control::new();
        let [first, second] = [control.page(), control.page()];
        assert!(!control.withdraw_for(second));
        control.give(first);
        assert!(!control.withdraw_for(first));
        assert!(control.is_held_by(first));
        assert!(control.withdraw_for(second));
        assert_eq!(control.holder(), Holder::Passing);
        assert!(!control.is_held_by(first) && !control.is_held_by(second));
    }
}
