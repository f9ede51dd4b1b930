//! # One device for several programs
//!
//! The program that opens a device first serves it to the others:
//!
//! ```text
//!  first program                                     another program
//!  ┌──────────────────────────────────┐              ┌──────────────┐
//!  │ Client ── [`Shared`] ══ socket ═╗ │              │ Client       │
//!  │                                 ╠═╪══ socket ══════ [`Shared`]  │
//!  │ device ── port ── hub ══════════╝ │              └──────────────┘
//!  └──────────────────────────────────┘
//! ```
//!
//! Towards the device the hub merges whole frames; what the device says goes to
//! all. Each program has its own session, and at most one holds the lease, so the
//! hub knows nothing of requests, with one exception: when a program ends
//! without a word, the hub disarms and unsubscribes for it; for the program of a hub
//! that was killed, the next one does.
//!
//! **When the first program ends,** the others find their sockets closed. One of
//! them gets the lock, opens the port and serves it; the rest connect to that
//! one. It takes milliseconds, and the device notices nothing: sessions, lease and
//! subscriptions go on, and samples of the time between are accounted for as lost
//! on the connection.
//!
//! **Who may connect:** the same user. Socket and lock are in a folder of that
//! user alone; where there are no Unix sockets, a secret is.
//!
//! | to find | look in |
//! |---|---|
//! | the transport of a program | [`Shared`] |
//! | its connection to the hub | `link.rs` |
//! | merging and distributing frames | `hub.rs` |
//! | what the hub knows of each program | `member.rs` |
//! | what should end with a program | `left_open.rs` |
//! | names of socket and lock | `place.rs` |
//! | making them again when they were removed | `held.rs` |
//! | sockets of each system | `socket.rs` |
//! | messages between programs, which the device never sees | `note.rs` |

mod frames;
mod held;
mod hub;
mod left_open;
mod link;
mod member;
mod note;
mod place;
mod shared;
mod socket;

pub use note::Program;
pub use shared::Shared;
