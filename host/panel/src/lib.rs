//! # The trainer's panel
//!
//! A page on localhost: choose a knee, see what the hand does, stop it, hold a lesson.
//!
//! ```text
//!  device ── Client ── device_thread ── bins, 60 frames a second ──> server ══ WebSocket ══ pages
//!                        ↑  └ watchdog <── every frame is answered ──┘
//!                        └──── orders of the page that has control
//!                      archive: recordings, read in a thread of its own
//! ```
//!
//! The device thread owns the client and runs in the caller's thread; the server and the archive
//! have a thread each. `docs/panel.md` lists what could be done to it, and the answers.
//!
//! | to find | look in |
//! |---|---|
//! | what is served, and to whom | `server.rs`, `guard.rs`, `pending.rs`, `tokens.rs`, `tickets.rs` |
//! | links for phones and a wall, students who join | `invitations.rs`, `qr.rs`, `class.rs` |
//! | the connection of a page | `socket.rs`, `request.rs`, `control.rs` |
//! | what is done with the device | `device_thread.rs` |
//! | requests of a page's hand on a simulated leg | `hand.rs` |
//! | who turns torque off when a page hangs | `watchdog.rs` |
//! | the layout of frames | `frame.rs` |
//! | the tables that a page shows | `hello.rs`, `book.rs` |
//! | lessons: plans, blind trials, scores, folders of sessions | [`lesson`] |
//! | sessions of experiments | `experiment.rs` |
//! | what a live view shows: envelope, states, target speeds | [`live`] |
//! | the page itself | `assets` |
//! | the knee on one page, without a program | `page.rs`, `assets/page` |
#![forbid(unsafe_code)]
#![deny(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

mod archive;
mod assets;
mod book;
mod class;
mod control;
mod device_thread;
mod experiment;
mod frame;
mod guard;
mod hand;
mod hello;
mod invitations;
pub mod lesson;
pub mod live;
mod page;
mod panel;
mod panel_error;
mod pending;
#[cfg(feature = "lan")]
mod qr;
mod replay;
mod request;
mod server;
mod shared;
mod socket;
mod strings;
mod tickets;
#[cfg(feature = "lan")]
mod tls;
mod tokens;
mod watchdog;

pub use device_thread::Program;
pub use experiment::Experiments;
pub use page::{PageError, knee_page, page_languages};
pub use panel::{Links, Panel, Settings, Source};
pub use panel_error::PanelError;
