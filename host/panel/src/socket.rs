//! The connection of a page.
//!
//! One task reads and one writes: a page that does not read can still stop, and a page
//! that hangs delays nobody.

use crate::archive::{ArchiveAnswer, Asked, Question};
use crate::book;
use crate::control::{Holder, Page};
use crate::hand::HandRequest;
use crate::hello;
use crate::request::{Message as FromPage, Request, Right};
use crate::shared::{Latest, Outcome, Shared, gone};
use crate::tokens::Role;
use axum::body::Bytes;
use axum::extract::ws::{Message, Utf8Bytes, WebSocket};
use futures_util::stream::{SplitSink, SplitStream};
use futures_util::{SinkExt, StreamExt};
use serde::Deserialize;
use serde_json::{Value, json};
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::broadcast::error::RecvError;
use tokio::sync::{broadcast, mpsc, oneshot, watch};
use tokio::task::JoinSet;
use tokio::time::{Instant, sleep_until, timeout};

/// Longest time until a page has said its token.
const TOKEN_TIMEOUT: Duration = Duration::from_secs(2);

/// A page that takes nothing for so long is disconnected.
const WRITE_TIMEOUT: Duration = Duration::from_secs(10);

/// Longest time without a message to a page: it blanks what it shows after 0.4 s of silence,
/// also where the device keeps its thread too busy to make frames.
const BEAT_EVERY: Duration = Duration::from_millis(100);

/// Replies that wait to be written.
const REPLIES: usize = 64;

/// Requests of a page that wait for their outcome; more are read later.
const PENDING: usize = 32;

/// Longest delay of a request on its way here: what gives torque or changes the knee is
/// rejected after a longer one, as the person who asked for it may have turned away since.
const EXPIRES_AFTER: Duration = Duration::from_secs(1);

type Sink = SplitSink<WebSocket, Message>;

/// The first message of a page.
#[derive(Deserialize)]
struct First {
    token: String,
}

/// Talks to a page until it is gone; then it has no control, and no torque.
pub(crate) async fn talk(socket: WebSocket, peer: SocketAddr, shared: Arc<Shared>) {
    let (mut sink, mut stream) = socket.split();
    let Some(role) = role(&mut stream, &shared).await else {
        let _ = send(&mut sink, text(&json!({ "refused": "wrong-token" }))).await;
        let _ = sink.close().await;
        return;
    };
    shared.pending.admit(peer);
    let page = shared.control.page();
    let hello = hello::greeting(&shared.hello, &shared.invitations, role, page);
    if send(&mut sink, text(&json!({ "hello": hello })))
        .await
        .is_err()
    {
        return;
    }
    let (replies, waiting) = mpsc::channel(REPLIES);
    let (listens, listening) = watch::channel(false);
    let reader = read(stream, page, role, &shared, (replies, listens));
    let writer = write(sink, (page, role), &shared, (waiting, listening));
    tokio::select! {
        () = reader => {}
        () = writer => {}
    }
    // The page has gone: torque ends without waiting for the watchdog.
    let _ = shared.leave(page, role);
}

/// The role of the token that the page says first.
async fn role(stream: &mut SplitStream<WebSocket>, shared: &Shared) -> Option<Role> {
    let message = timeout(TOKEN_TIMEOUT, stream.next()).await.ok()??.ok()?;
    let first: First = serde_json::from_str(message.to_text().ok()?).ok()?;
    shared.tokens.role(&first.token)
}

async fn write(
    mut sink: Sink,
    (page, role): (Page, Role),
    shared: &Shared,
    (mut replies, mut listening): (mpsc::Receiver<Message>, watch::Receiver<bool>),
) {
    // A student's phone shows no curves, and cannot take control.
    let looks = role != Role::Student;
    let mut beat_at = Instant::now() + BEAT_EVERY;
    let mut samples = None;
    let mut frames = shared.frames.subscribe();
    let mut latest = shared.latest.subscribe();
    let mut control = shared.control.subscribe();
    latest.mark_changed();
    control.mark_changed();
    let mut sent = Latest::default();
    loop {
        let messages = tokio::select! {
            // Answers before curves.
            biased;
            reply = replies.recv() => match reply {
                Some(reply) => vec![reply],
                None => return,
            },
            changed = control.changed(), if looks => {
                if changed.is_err() {
                    return;
                }
                let holder = *control.borrow_and_update();
                vec![text(&json!({ "holder": {
                    "taken": holder != Holder::Nobody,
                    "yours": holder == Holder::Page(page),
                } }))]
            }
            changed = latest.changed() => {
                if changed.is_err() {
                    return;
                }
                let now = latest.borrow_and_update().clone();
                let messages = news(&sent, &now, role, page);
                sent = now;
                messages
            }
            frame = frames.recv(), if looks => match frame {
                Ok(frame) => vec![Message::Binary(frame)],
                // A slow page loses frames; their times tell it.
                Err(RecvError::Lagged(_)) => continue,
                Err(RecvError::Closed) => return,
            },
            changed = listening.changed() => {
                if changed.is_err() {
                    return;
                }
                let listens = *listening.borrow_and_update();
                samples = listens.then(|| shared.samples.subscribe());
                continue;
            }
            frame = next_of(&mut samples) => match frame {
                Ok(frame) => vec![Message::Binary(frame)],
                Err(RecvError::Lagged(_)) => continue,
                Err(RecvError::Closed) => return,
            },
            () = sleep_until(beat_at) => vec![text(&json!({ "beat": Value::Null }))],
        };
        // What is news for others only is not heard here.
        if !messages.is_empty() {
            beat_at = Instant::now() + BEAT_EVERY;
        }
        for message in messages {
            if send(&mut sink, message).await.is_err() {
                return;
            }
        }
    }
}

/// The next frame of samples for a page that listens; never one for a page that does not.
async fn next_of(samples: &mut Option<broadcast::Receiver<Bytes>>) -> Result<Bytes, RecvError> {
    match samples {
        Some(samples) => samples.recv().await,
        None => std::future::pending().await,
    }
}

/// Messages that are new for a page.
fn news(sent: &Latest, now: &Latest, role: Role, page: Page) -> Vec<Message> {
    let before = sent.messages(role, page).into_iter();
    let pairs = before.zip(now.messages(role, page));
    let changed = pairs
        .filter(|(sent, now)| sent != now && !now.is_empty())
        .map(|(_, now)| now);
    let notes = now.notes(role).iter().skip(sent.notes(role).len());
    changed.chain(notes.cloned()).map(Message::Text).collect()
}

async fn send(sink: &mut Sink, message: Message) -> Result<(), ()> {
    match timeout(WRITE_TIMEOUT, sink.send(message)).await {
        Ok(Ok(())) => Ok(()),
        _ => Err(()),
    }
}

/// Reads what a page sends. Requests are queued in the order in which they come, and no
/// request waits for the outcome of the one before: a stop does not wait for a recording that
/// is being read.
async fn read(
    mut stream: SplitStream<WebSocket>,
    page: Page,
    role: Role,
    shared: &Arc<Shared>,
    (replies, listens): (mpsc::Sender<Message>, watch::Sender<bool>),
) {
    // Ends with this function: a page that has gone reads no replies.
    let mut pending = JoinSet::new();
    while let Some(Ok(message)) = stream.next().await {
        let Message::Text(message) = message else {
            if matches!(message, Message::Close(_)) {
                return;
            }
            continue;
        };
        match serde_json::from_str(&message) {
            Ok(FromPage::Seen { seen }) => {
                if shared.control.is_held_by(page) {
                    shared.watchdog.answered(seen);
                }
            }
            Ok(FromPage::Request {
                id,
                newest,
                request,
            }) => {
                let answer = begin(request, (id, newest), (page, role), shared);
                let replies = replies.clone();
                // Full if the page reads no replies: the task waits, and the page for it.
                pending.spawn(async move { replies.send(answer.message(id).await).await });
                while pending.try_join_next().is_some() {}
                if pending.len() >= PENDING
                    && !matches!(pending.join_next().await, Some(Ok(Ok(()))))
                {
                    return;
                }
            }
            Ok(FromPage::Hand { hand, holds }) => {
                if Right::Control.is_of(role) && shared.control.is_held_by(page) {
                    shared.hand_requests.put(HandRequest {
                        page,
                        angle_deg: hand,
                        holds,
                    });
                }
            }
            Ok(FromPage::Listen { listen }) => {
                listens.send_replace(listen && Right::Look.is_of(role));
            }
            Err(_) => {
                let id = serde_json::from_str::<Value>(&message)
                    .ok()
                    .and_then(|value| u32::try_from(value.get("id")?.as_u64()?).ok());
                // Not a message of our page.
                let Some(id) = id else { return };
                let error = Err("the page and the program do not fit: reload the page".to_owned());
                if replies.send(reply(id, &error)).await.is_err() {
                    return;
                }
            }
        }
    }
}

/// Answer to a request, which may still be worked on.
enum Answer {
    Known(Outcome),
    Ordered(oneshot::Receiver<Outcome>),
    Asked(oneshot::Receiver<Result<ArchiveAnswer, String>>),
}

impl Answer {
    async fn message(self, id: u32) -> Message {
        let outcome = match self {
            Self::Known(outcome) => outcome,
            Self::Ordered(outcome) => outcome.await.unwrap_or_else(|_| Err(gone())),
            Self::Asked(found) => match found.await.unwrap_or_else(|_| Err(gone())) {
                Ok(ArchiveAnswer::Trace(frame)) => return Message::Binary(frame),
                Ok(ArchiveAnswer::Facts(facts)) => Ok(facts),
                Err(error) => Err(error),
            },
        };
        reply(id, &outcome)
    }
}

/// Begins a request, if this link may make it and it is not too old. Control is checked by
/// the device thread, when the request is executed.
fn begin(
    request: Request,
    (id, newest): (u32, Option<u32>),
    (page, role): (Page, Role),
    shared: &Shared,
) -> Answer {
    if !request.right().is_of(role) {
        return Answer::Known(Err(beyond(role).to_owned()));
    }
    if request.expires()
        && let Err(error) = check_age(newest, shared)
    {
        return Answer::Known(Err(error));
    }
    let begun = match request {
        Request::Release => shared.leave(page, role).map(Answer::Ordered),
        Request::Fault { code } => book::fault(code)
            .ok_or_else(|| format!("there is no fault {code}"))
            .map(|page| Answer::Known(Ok(page))),
        Request::Recordings => question(Asked::List, shared),
        Request::Lessons => question(Asked::Lessons, shared),
        Request::Open { recording } => question(Asked::Open { recording }, shared),
        Request::Trace {
            recording,
            from_s,
            to_s,
            points,
        } => {
            let what = Asked::Trace {
                id,
                recording,
                from_s,
                to_s,
                points,
            };
            question(what, shared)
        }
        request => shared.order(request, page, role).map(Answer::Ordered),
    };
    begun.unwrap_or_else(|error| Answer::Known(Err(error)))
}

/// Text for a request to which a link of this role gives no right.
fn beyond(role: Role) -> &'static str {
    match role {
        Role::Teacher => "this is for a student's link: answers are entered in the lesson here",
        Role::Remote => "the remote cannot do that: use the teacher's page",
        Role::Viewer => "this link is for looking on: the teacher's link is needed for that",
        Role::Student => "this link is for answers: the teacher's link is needed for that",
    }
}

/// Rejects a request that was delayed on its way.
fn check_age(newest: Option<u32>, shared: &Shared) -> Result<(), String> {
    let Some(newest) = newest else {
        return Err(
            "the request does not say which live frame its page had: reload the page, and wait \
             for the curves"
                .to_owned(),
        );
    };
    match shared.watchdog.age(newest) {
        Some(age) if age <= EXPIRES_AFTER => Ok(()),
        Some(age) => Err(expired(&format!("{:.1} s", age.as_secs_f64()))),
        None => Err(expired("several seconds")),
    }
}

fn expired(late: &str) -> String {
    format!(
        "the request arrived {late} late, so it was not carried out: the connection hangs. Look \
         at the device, then try again"
    )
}

fn question(what: Asked, shared: &Shared) -> Result<Answer, String> {
    let (reply, found) = oneshot::channel();
    let question = Question { what, reply };
    shared.questions.send(question).map_err(|_| gone())?;
    Ok(Answer::Asked(found))
}

fn reply(id: u32, outcome: &Outcome) -> Message {
    text(&match outcome {
        Ok(value) => json!({ "re": id, "ok": value }),
        Err(error) => json!({ "re": id, "error": error }),
    })
}

fn text(value: &Value) -> Message {
    Message::Text(Utf8Bytes::from(value.to_string()))
}
