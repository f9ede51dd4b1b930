//! Data and channels that the threads of the panel share.
//!
//! ```text
//!  device_thread ── frames, latest ──> server ──> pages
//!    ↑  ↑                         │
//!    │  └──────── orders ─────────┤
//!    └───── watchdog, hand ───────┘        archive <── questions about recordings
//! ```

use crate::archive::Question;
use crate::control::{Control, Page};
use crate::hand::HandRequests;
use crate::invitations::Invitations;
use crate::pending::Pending;
use crate::request::Request;
use crate::tickets::Tickets;
use crate::tokens::{Role, Tokens};
use crate::watchdog::PageWatchdog;
use axum::body::Bytes;
use axum::extract::ws::Utf8Bytes;
use serde_json::Value;
use std::collections::HashMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc;
use std::time::Instant;
use tokio::sync::{broadcast, oneshot, watch};

/// Result of a request: the reply's content, or a text for people.
pub(crate) type Outcome = Result<Value, String>;

/// A request for the device thread, the page that makes it, and where its outcome goes.
///
/// The right to make it is checked when it is executed: until then the page may lose control.
pub(crate) struct Order {
    pub(crate) request: Request,
    pub(crate) page: Page,
    pub(crate) role: Role,
    pub(crate) queued_at: Instant,
    /// Number of stops that were queued before it.
    pub(crate) stops: u64,
    pub(crate) reply: oneshot::Sender<Outcome>,
}

/// Frames that a page may lag behind before it loses some: two seconds.
const FRAMES: usize = 128;

/// Content of pages besides the curves: a message each, sent when it changes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Latest {
    pub(crate) status: Utf8Bytes,
    pub(crate) parameters: Utf8Bytes,
    pub(crate) presets: Utf8Bytes,
    pub(crate) target: Utf8Bytes,
    pub(crate) examination: Utf8Bytes,
    pub(crate) lesson: Utf8Bytes,
    /// Session of an experiment, for the teacher's pages.
    pub(crate) experiment: Utf8Bytes,
    /// Students who have joined.
    pub(crate) class: Utf8Bytes,
    /// Part of the status for students.
    pub(crate) state: Utf8Bytes,
    /// Public part of the lesson.
    pub(crate) public_lesson: Utf8Bytes,
    /// Public part of the class.
    pub(crate) public_class: Utf8Bytes,
    /// The knee, also while it is hidden.
    pub(crate) knee: Utf8Bytes,
    /// A student's part of the lesson, for each page that has joined.
    pub(crate) own: HashMap<Page, Utf8Bytes>,
    /// All so far.
    pub(crate) notes: Vec<Utf8Bytes>,
}

impl Latest {
    /// Messages for a page of this role, but the notes: always as many, empty where there is none.
    pub(crate) fn messages(&self, role: Role, page: Page) -> Vec<Utf8Bytes> {
        let messages = match role {
            Role::Teacher => vec![
                &self.status,
                &self.parameters,
                &self.presets,
                &self.target,
                &self.examination,
                &self.lesson,
                &self.class,
                &self.experiment,
            ],
            Role::Viewer => vec![
                &self.status,
                &self.parameters,
                &self.presets,
                &self.target,
                &self.examination,
                &self.public_lesson,
                &self.public_class,
            ],
            Role::Remote => vec![&self.status, &self.lesson, &self.knee],
            Role::Student => {
                let own = self.own.get(&page).cloned();
                return vec![self.state.clone(), own.unwrap_or_default()];
            }
        };
        messages.into_iter().cloned().collect()
    }

    /// Notes on the time line, for a page of this role.
    pub(crate) fn notes(&self, role: Role) -> &[Utf8Bytes] {
        match role {
            Role::Teacher | Role::Viewer => &self.notes,
            Role::Remote | Role::Student => &[],
        }
    }
}

/// Data and channels that the threads share.
pub(crate) struct Shared {
    pub(crate) frames: broadcast::Sender<Bytes>,
    /// Frames of samples, for pages that listen.
    pub(crate) samples: broadcast::Sender<Bytes>,
    pub(crate) latest: watch::Sender<Latest>,
    pub(crate) watchdog: PageWatchdog,
    pub(crate) control: Control,
    /// Angles to which the page in control moves the leg.
    pub(crate) hand_requests: HandRequests,
    /// Number of stops that pages have queued.
    pub(crate) stops: AtomicU64,
    pub(crate) tokens: Tokens,
    pub(crate) tickets: Tickets,
    /// Connections without a token.
    pub(crate) pending: Pending,
    /// Tables of the first message to a page.
    pub(crate) hello: Value,
    /// Links that a teacher's page hands on.
    pub(crate) invitations: Invitations,
    pub(crate) orders: mpsc::Sender<Order>,
    pub(crate) questions: mpsc::Sender<Question>,
}

impl Shared {
    pub(crate) fn new(
        tokens: Tokens,
        hello: Value,
        invitations: Invitations,
        orders: mpsc::Sender<Order>,
        questions: mpsc::Sender<Question>,
    ) -> Self {
        Self {
            frames: broadcast::channel(FRAMES).0,
            samples: broadcast::channel(FRAMES).0,
            latest: watch::channel(Latest::default()).0,
            watchdog: PageWatchdog::new(),
            control: Control::new(),
            hand_requests: HandRequests::default(),
            stops: AtomicU64::new(0),
            tokens,
            tickets: Tickets::default(),
            pending: Pending::default(),
            hello,
            invitations,
            orders,
            questions,
        }
    }

    /// Queues a request of a page for the device thread; returns the receiver of its outcome.
    pub(crate) fn order(
        &self,
        request: Request,
        page: Page,
        role: Role,
    ) -> Result<oneshot::Receiver<Outcome>, String> {
        if request == Request::Take {
            // At once: what the page before still orders is rejected from now on.
            self.control.withdraw_for(page);
        }
        if request == Request::Stop {
            // At once, too: an order to arm that still waits is rejected.
            self.stops.fetch_add(1, Ordering::Relaxed);
        }
        let (reply, outcome) = oneshot::channel();
        let order = Order {
            request,
            page,
            role,
            queued_at: Instant::now(),
            stops: self.stops.load(Ordering::Relaxed),
            reply,
        };
        self.orders.send(order).map_err(|_| gone())?;
        Ok(outcome)
    }

    /// Takes control away from a page that has gone or gives it up, and queues the end of its
    /// torque. Also for a page without control: its request to take it may still be queued.
    pub(crate) fn leave(
        &self,
        page: Page,
        role: Role,
    ) -> Result<oneshot::Receiver<Outcome>, String> {
        self.control.release(page);
        self.order(Request::Release, page, role)
    }
}

/// Text for requests to a panel that is closing.
pub(crate) fn gone() -> String {
    "the panel is closing".to_owned()
}
