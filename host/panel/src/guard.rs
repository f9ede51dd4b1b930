//! Rules that decide which requests of the web are answered.
//!
//! A page of another site can make a browser send requests here, also to `localhost`, and
//! by a name whose address it changes (DNS rebinding). So the host must be one of ours, a
//! WebSocket must come from our own page, and everything else is refused before it is
//! looked at.

use crate::assets;
use axum::body::Body;
use axum::extract::Request;
use axum::http::{HeaderMap, HeaderValue, Method, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use std::sync::Arc;

/// Path of the WebSocket.
pub(crate) const SOCKET: &str = "/ws";

/// Headers of every answer.
const HEADERS: [(&str, &str); 7] = [
    (
        "content-security-policy",
        "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; \
         img-src 'self' data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    ),
    ("x-content-type-options", "nosniff"),
    ("x-frame-options", "DENY"),
    ("referrer-policy", "no-referrer"),
    ("cross-origin-opener-policy", "same-origin"),
    ("cross-origin-resource-policy", "same-origin"),
    ("cross-origin-embedder-policy", "require-corp"),
];

/// Names under which this server is reached.
#[derive(Clone, Debug)]
pub(crate) struct Names {
    /// `http` or `https`.
    pub(crate) scheme: &'static str,
    /// Host and port.
    pub(crate) hosts: Vec<String>,
}

/// Refuses, or answers with the headers.
pub(crate) async fn check(names: Arc<Names>, request: Request, next: Next) -> Response {
    let refused = refusal(
        &names,
        request.method(),
        request.uri().path(),
        authority(&request).as_ref(),
        request.headers(),
    );
    let mut response = match refused {
        Some((status, text)) => (status, text).into_response(),
        None => next.run(request).await,
    };
    for (name, value) in HEADERS {
        let headers = response.headers_mut();
        // The report has a policy of its own.
        if !headers.contains_key(name) {
            headers.insert(name, HeaderValue::from_static(value));
        }
    }
    response
}

/// The host that the client asked for. HTTP/2 has no `Host`, but an authority.
fn authority(request: &axum::http::Request<Body>) -> Option<String> {
    let host = request.headers().get(header::HOST);
    match host {
        Some(host) => host.to_str().ok().map(str::to_owned),
        None => request.uri().authority().map(ToString::to_string),
    }
}

/// Reason why a request is refused, with its status.
fn refusal(
    names: &Names,
    method: &Method,
    path: &str,
    host: Option<&String>,
    headers: &HeaderMap,
) -> Option<(StatusCode, &'static str)> {
    let text = |name: &str| {
        headers
            .get(name)
            .map(|value| value.to_str().unwrap_or_default())
    };
    let Some(host) = host.filter(|host| names.hosts.contains(host)) else {
        return Some((
            StatusCode::MISDIRECTED_REQUEST,
            "this is not the name of this server: open the link that the program has printed",
        ));
    };
    if *method != Method::GET && *method != Method::HEAD {
        return Some((StatusCode::METHOD_NOT_ALLOWED, "only GET is answered"));
    }
    let own = format!("{}://{host}", names.scheme);
    match text("origin") {
        Some(origin) if origin != own => {
            return Some((StatusCode::FORBIDDEN, "a page of another origin is refused"));
        }
        // Browsers always send it with a WebSocket: without one this is no page.
        None if path == SOCKET => {
            return Some((StatusCode::FORBIDDEN, "a WebSocket needs an origin"));
        }
        _ => {}
    }
    let site = text("sec-fetch-site").unwrap_or("none");
    let is_foreign = !["same-origin", "none"].contains(&site);
    // A link in an e-mail leads to a page, which shows nothing without its token.
    let is_link = text("sec-fetch-mode") == Some("navigate")
        && text("sec-fetch-dest").is_none_or(|dest| dest == "document");
    if is_foreign && !(is_link && assets::is_page(path)) {
        return Some((
            StatusCode::FORBIDDEN,
            "a request of another site is refused",
        ));
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn status(path: &str, host: &str, headers: &[(&'static str, &str)]) -> u16 {
        let names = Names {
            scheme: "http",
            hosts: vec!["127.0.0.1:80".to_owned(), "localhost:80".to_owned()],
        };
        let mut map = HeaderMap::new();
        for (name, value) in headers {
            map.insert(*name, value.parse().unwrap());
        }
        let host = Some(host.to_owned());
        let refused = refusal(&names, &Method::GET, path, host.as_ref(), &map);
        refused.map_or(200, |(status, _)| status.as_u16())
    }

    #[test]
    fn pages_of_others_are_refused() {
        let host = "127.0.0.1:80";
        for origin in [
            "http://evil.example",
            "http://127.0.0.1:81",
            "https://127.0.0.1:80",
            "null",
            "http://localhost:80",
        ] {
            assert_eq!(status("/ws", host, &[("origin", origin)]), 403, "{origin}");
            assert_eq!(status("/", host, &[("origin", origin)]), 403, "{origin}");
        }
        assert_eq!(status("/ws", host, &[]), 403);
        let site = |path, mode| {
            status(
                path,
                host,
                &[("sec-fetch-site", "cross-site"), ("sec-fetch-mode", mode)],
            )
        };
        assert_eq!(site("/", "no-cors"), 403);
        assert_eq!(site("/main.js", "navigate"), 403);
        assert_eq!(site("/ws", "websocket"), 403);
        // A link may lead to a page.
        for page in ["/", "/student.html", "/remote.html"] {
            assert_eq!(site(page, "navigate"), 200, "{page}");
        }
        let framed = [
            ("sec-fetch-site", "cross-site"),
            ("sec-fetch-mode", "navigate"),
            ("sec-fetch-dest", "iframe"),
        ];
        assert_eq!(status("/", host, &framed), 403);
    }

    #[test]
    fn nothing_can_be_posted() {
        let names = Names {
            scheme: "http",
            hosts: vec!["localhost:80".to_owned()],
        };
        let host = Some("localhost:80".to_owned());
        for method in [Method::POST, Method::PUT, Method::DELETE, Method::OPTIONS] {
            let refused = refusal(&names, &method, "/", host.as_ref(), &HeaderMap::new());
            assert_eq!(refused.map(|(status, _)| status.as_u16()), Some(405));
        }
    }
}
