//! The server: files, the WebSocket, reports. A thread of its own with one runtime.

use crate::assets;
use crate::guard::{self, Names, SOCKET};
use crate::pending::{Listener, Peer, Pending};
use crate::shared::Shared;
use crate::socket;
use axum::Router;
use axum::extract::ws::WebSocketUpgrade;
use axum::extract::{ConnectInfo, Path, Request, State};
use axum::http::{StatusCode, header};
use axum::middleware::{Next, from_fn};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use std::net::TcpListener;
use std::sync::Arc;

/// Longest message of a page.
const MOST_MESSAGE: usize = 64 * 1024;

/// The report has its style in itself, and no script.
const REPORT_POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; img-src data:; \
                             base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// Everything that is served.
pub(crate) fn router(shared: Arc<Shared>, names: Names) -> Router {
    let names = Arc::new(names);
    Router::new()
        .route(SOCKET, get(upgrade))
        .route("/report/{name}", get(report))
        .fallback(file)
        .layer(from_fn(move |request: Request, next: Next| {
            guard::check(names.clone(), request, next)
        }))
        .with_state(shared)
}

/// Serves until the program ends.
///
/// # Errors
/// The listener fails.
pub(crate) async fn serve(
    listener: TcpListener,
    router: Router,
    pending: Pending,
) -> std::io::Result<()> {
    listener.set_nonblocking(true)?;
    let listener = tokio::net::TcpListener::from_std(listener)?;
    let service = router.into_make_service_with_connect_info::<Peer>();
    axum::serve(Listener { listener, pending }, service).await
}

async fn file(request: Request) -> Response {
    match assets::find(request.uri().path()) {
        Some(asset) => (
            // Another version of this program may be at the same address tomorrow.
            [
                (header::CONTENT_TYPE, asset.kind),
                (header::CACHE_CONTROL, "no-cache"),
            ],
            asset.body,
        )
            .into_response(),
        None => (StatusCode::NOT_FOUND, "there is no such page").into_response(),
    }
}

async fn upgrade(
    socket: WebSocketUpgrade,
    ConnectInfo(Peer(peer)): ConnectInfo<Peer>,
    State(shared): State<Arc<Shared>>,
) -> Response {
    socket
        .max_message_size(MOST_MESSAGE)
        .max_frame_size(MOST_MESSAGE)
        .on_upgrade(move |socket| socket::talk(socket, peer, shared))
}

async fn report(Path(name): Path<String>, State(shared): State<Arc<Shared>>) -> Response {
    match shared.tickets.take(&name) {
        Some(html) => (
            [
                (header::CONTENT_TYPE, "text/html; charset=utf-8"),
                (header::CACHE_CONTROL, "no-store"),
                (header::CONTENT_SECURITY_POLICY, REPORT_POLICY),
            ],
            html,
        )
            .into_response(),
        None => (
            StatusCode::NOT_FOUND,
            "this report was opened before, or its minute is over: open it again from the panel",
        )
            .into_response(),
    }
}
