//! The connection of a page.
//!
//! One task reads and one writes: a page that does not read can still stop, and a page
//! that hangs delays nobody.

use crate::archive::{Asked, Found, Question};
use crate::book;
use crate::control::Page;
use crate::request::{Message as FromPage, Request, Right};
use crate::shared::{Latest, Outcome, Shared};
use crate::tokens::Role;
use axum::extract::ws::{Message, Utf8Bytes, WebSocket};
use futures_util::stream::{SplitSink, SplitStream};
use futures_util::{SinkExt, StreamExt};
use serde::Deserialize;
use serde_json::{Value, json};
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::broadcast::error::RecvError;
use tokio::sync::{mpsc, oneshot};
use tokio::time::timeout;

/// Longest time until a page has said its token.
const TOKEN_TIMEOUT: Duration = Duration::from_secs(2);

/// A page that takes nothing for so long is disconnected.
const WRITE_TIMEOUT: Duration = Duration::from_secs(10);

/// Replies that wait to be written.
const REPLIES: usize = 64;

type Sink = SplitSink<WebSocket, Message>;

/// The first message of a page.
#[derive(Deserialize)]
struct First {
    token: String,
}

/// Talks to a page until it is gone; then it has no control, and no torque.
pub(crate) async fn talk(socket: WebSocket, shared: Arc<Shared>) {
    let (mut sink, mut stream) = socket.split();
    let Some(role) = role(&mut stream, &shared).await else {
        let _ = send(&mut sink, text(&json!({ "refused": "wrong-token" }))).await;
        let _ = sink.close().await;
        return;
    };
    let page = shared.control.page();
    let mut hello = shared.hello.clone();
    hello["page"] = json!(page);
    hello["role"] = json!(role.name());
    if send(&mut sink, text(&json!({ "hello": hello })))
        .await
        .is_err()
    {
        return;
    }
    let (replies, waiting) = mpsc::channel(REPLIES);
    let reader = read(stream, page, role, &shared, replies);
    let writer = write(sink, page, &shared, waiting);
    tokio::select! {
        () = reader => {}
        () = writer => {}
    }
    leave(page, &shared).await;
}

/// The role of the token that the page says first.
async fn role(stream: &mut SplitStream<WebSocket>, shared: &Shared) -> Option<Role> {
    let message = timeout(TOKEN_TIMEOUT, stream.next()).await.ok()??.ok()?;
    let first: First = serde_json::from_str(message.to_text().ok()?).ok()?;
    shared.tokens.role(&first.token)
}

/// The page has gone: torque ends without waiting for the watchdog.
async fn leave(page: Page, shared: &Shared) {
    if shared.control.release(page) {
        shared.watchdog.revoke();
        let _ = shared.order(Request::Disarm).await;
    }
}

async fn write(mut sink: Sink, page: Page, shared: &Shared, mut replies: mpsc::Receiver<Message>) {
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
            changed = control.changed() => {
                if changed.is_err() {
                    return;
                }
                let holder = *control.borrow_and_update();
                vec![text(&json!({ "holder": {
                    "taken": holder.is_some(),
                    "yours": holder == Some(page),
                } }))]
            }
            changed = latest.changed() => {
                if changed.is_err() {
                    return;
                }
                let now = latest.borrow_and_update().clone();
                let messages = news(&sent, &now);
                sent = now;
                messages
            }
            frame = frames.recv() => match frame {
                Ok(frame) => vec![Message::Binary(frame)],
                // A slow page loses frames; their times tell it.
                Err(RecvError::Lagged(_)) => continue,
                Err(RecvError::Closed) => return,
            },
        };
        for message in messages {
            if send(&mut sink, message).await.is_err() {
                return;
            }
        }
    }
}

/// Messages that are new for a page.
fn news(sent: &Latest, now: &Latest) -> Vec<Message> {
    let pairs = sent.messages().into_iter().zip(now.messages());
    let changed = pairs
        .filter(|(sent, now)| sent != now && !now.is_empty())
        .map(|(_, now)| now);
    let notes = now.notes.iter().skip(sent.notes.len());
    changed.chain(notes).cloned().map(Message::Text).collect()
}

async fn send(sink: &mut Sink, message: Message) -> Result<(), ()> {
    match timeout(WRITE_TIMEOUT, sink.send(message)).await {
        Ok(Ok(())) => Ok(()),
        _ => Err(()),
    }
}

async fn read(
    mut stream: SplitStream<WebSocket>,
    page: Page,
    role: Role,
    shared: &Shared,
    replies: mpsc::Sender<Message>,
) {
    while let Some(Ok(message)) = stream.next().await {
        let Message::Text(message) = message else {
            if matches!(message, Message::Close(_)) {
                return;
            }
            continue;
        };
        match serde_json::from_str(&message) {
            Ok(FromPage::Seen { seen }) => {
                if shared.control.holder() == Some(page) {
                    shared.watchdog.answered(seen);
                }
            }
            Ok(FromPage::Request { id, request }) => {
                let reply = match trace_of(id, &request) {
                    Some(asked) if role == Role::Teacher => trace(id, asked, shared).await,
                    _ => reply(id, &execute(request, page, role, shared).await),
                };
                // Full if the page reads no replies: it waits for its own.
                if replies.send(reply).await.is_err() {
                    return;
                }
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

/// Executes a request, if this page may make it.
async fn execute(request: Request, page: Page, role: Role, shared: &Shared) -> Outcome {
    let right = request.right();
    if right != Right::Anybody && role != Role::Teacher {
        return Err(
            "this link is for looking on: the teacher's link is needed for that".to_owned(),
        );
    }
    if right == Right::Control && shared.control.holder() != Some(page) {
        return Err("another page has control: take control first".to_owned());
    }
    match request {
        Request::Take => take(page, shared).await,
        Request::Release => {
            leave(page, shared).await;
            Ok(Value::Null)
        }
        Request::Fault { code } => {
            book::fault(code).ok_or_else(|| format!("there is no fault {code}"))
        }
        Request::Recordings => ask(Asked::List, shared).await,
        Request::Open { recording } => ask(Asked::Open { recording }, shared).await,
        request => shared.order(request).await,
    }
}

/// Gives control to a page; the arming by another page is not inherited.
async fn take(page: Page, shared: &Shared) -> Outcome {
    let before = shared.control.holder();
    if before.is_some_and(|holder| holder != page) {
        shared.watchdog.revoke();
        // Without a connection there is no torque.
        let _ = shared.order(Request::Disarm).await;
    }
    shared.control.take(page);
    shared.watchdog.begin();
    Ok(Value::Null)
}

async fn ask(what: Asked, shared: &Shared) -> Outcome {
    match question(what, shared).await? {
        Found::Facts(facts) => Ok(facts),
        Found::Trace(_) => Err("the answer is no text".to_owned()),
    }
}

async fn question(what: Asked, shared: &Shared) -> Result<Found, String> {
    let gone = || "the panel is closing".to_owned();
    let (reply, found) = oneshot::channel();
    let question = Question { what, reply };
    shared.questions.send(question).map_err(|_| gone())?;
    found.await.map_err(|_| gone())?
}

/// The question of a request for a trace.
fn trace_of(id: u32, request: &Request) -> Option<Asked> {
    match *request {
        Request::Trace {
            recording,
            from_s,
            to_s,
            points,
        } => Some(Asked::Trace {
            id,
            recording,
            from_s,
            to_s,
            points,
        }),
        _ => None,
    }
}

async fn trace(id: u32, asked: Asked, shared: &Shared) -> Message {
    match question(asked, shared).await {
        Ok(Found::Trace(frame)) => Message::Binary(frame),
        Ok(Found::Facts(facts)) => reply(id, &Ok(facts)),
        Err(error) => reply(id, &Err(error)),
    }
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
