//! Data and channels that the threads of the panel share.
//!
//! ```text
//!  keeper ── frames, latest ──> server ──> pages
//!    ↑  ↑                         │
//!    │  └──────── orders ─────────┤
//!    └──────── watchdog ──────────┘        archive <── questions about recordings
//! ```

use crate::archive::Question;
use crate::control::Control;
use crate::request::Request;
use crate::tickets::Tickets;
use crate::tokens::Tokens;
use crate::watchdog::PageWatchdog;
use axum::body::Bytes;
use axum::extract::ws::Utf8Bytes;
use serde_json::Value;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, mpsc};
use tokio::sync::{broadcast, oneshot, watch};

/// Result of a request: the reply's content, or a text for people.
pub(crate) type Outcome = Result<Value, String>;

/// A request for the keeper, and where its outcome goes.
pub(crate) struct Order {
    pub(crate) request: Request,
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
    pub(crate) lesson: Utf8Bytes,
    /// All so far.
    pub(crate) notes: Vec<Utf8Bytes>,
}

impl Latest {
    /// All but the notes.
    pub(crate) fn messages(&self) -> [&Utf8Bytes; 5] {
        [
            &self.status,
            &self.parameters,
            &self.presets,
            &self.target,
            &self.lesson,
        ]
    }
}

/// Data and channels that the threads share.
pub(crate) struct Shared {
    pub(crate) frames: broadcast::Sender<Bytes>,
    pub(crate) latest: watch::Sender<Latest>,
    pub(crate) watchdog: PageWatchdog,
    pub(crate) control: Control,
    pub(crate) tokens: Tokens,
    pub(crate) tickets: Tickets,
    /// Content of the first message to a page.
    pub(crate) hello: Value,
    /// A folder whose recordings must not be opened: of a blind lesson.
    pub(crate) hidden: Arc<Mutex<Option<PathBuf>>>,
    pub(crate) orders: mpsc::Sender<Order>,
    pub(crate) questions: mpsc::Sender<Question>,
}

impl Shared {
    pub(crate) fn new(
        tokens: Tokens,
        hello: Value,
        orders: mpsc::Sender<Order>,
        questions: mpsc::Sender<Question>,
    ) -> Self {
        Self {
            frames: broadcast::channel(FRAMES).0,
            latest: watch::channel(Latest::default()).0,
            watchdog: PageWatchdog::new(),
            control: Control::new(),
            tokens,
            tickets: Tickets::default(),
            hello,
            hidden: Arc::default(),
            orders,
            questions,
        }
    }

    /// Has the keeper execute a request.
    pub(crate) async fn order(&self, request: Request) -> Outcome {
        let gone = || "the panel is closing".to_owned();
        let (reply, outcome) = oneshot::channel();
        self.orders
            .send(Order { request, reply })
            .map_err(|_| gone())?;
        outcome.await.map_err(|_| gone())?
    }
}
