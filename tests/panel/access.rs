//! Access: tokens of links, requests that are half open, names and pages of other sites.

use crate::SIM;
use crate::page::{Page, Panel, token};
use std::io::{ErrorKind, Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

/// Checks that the page is closed and has received the reason and nothing else.
fn is_refused(page: &mut Page) {
    page.until("its close", |page| page.is_closed);
    assert_eq!(page.latest["refused"], "wrong-token");
    assert!(page.frames.is_empty() && !page.latest.contains_key("hello"));
}

#[test]
fn only_a_link_opens_it() {
    let panel = Panel::new(&SIM);
    let cut = &token(&panel.student)[1..];
    let guess = "0123456789abcdef0123456789abcdef";
    for wrong in ["", guess, &panel.teacher, &panel.student, cut] {
        is_refused(&mut Page::open(&panel.host, Some(wrong)));
    }
    // A page that says nothing is disconnected.
    is_refused(&mut Page::open(&panel.host, None));
    let mut viewer = panel.viewer_page();
    assert_eq!(viewer.latest["hello"]["role"], "viewer");
    viewer.until("frames", |page| page.frames.len() > 10);
}

/// Connections without a token are closed within seconds, and hinder nobody.
#[test]
fn half_open_requests_are_closed_and_others_served() {
    let panel = Panel::new(&SIM);
    let mut viewer = panel.viewer_page();
    let half = format!("GET / HTTP/1.1\r\nHost: {}\r\n", panel.host);
    let is_open = |stream: &TcpStream| {
        let read = (&mut &*stream).read(&mut [0; 64]);
        read.is_err_and(|error| error.kind() == ErrorKind::WouldBlock)
    };
    let mut open = Vec::new();
    for nth in 0..1000 {
        let mut stream = TcpStream::connect(&panel.host).unwrap();
        if nth % 2 == 0 {
            stream.write_all(half.as_bytes()).unwrap();
        }
        stream.set_nonblocking(true).unwrap();
        open.push(stream);
        if nth % 100 == 99 {
            viewer.go_on(Duration::from_millis(10));
            open.retain(is_open);
        }
    }
    // The newest make room for others at once.
    assert_eq!(panel.status("/", &[]), 200);
    assert!(open.len() < 1000, "none of them is closed early");
    // One whose header goes on and on is no exception.
    let mut endless = TcpStream::connect(&panel.host).unwrap();
    endless.write_all(half.as_bytes()).unwrap();
    endless.set_nonblocking(true).unwrap();
    open.push(endless.try_clone().unwrap());
    let begun = Instant::now();
    while !open.is_empty() {
        // An error once it is closed.
        let _ = endless.write_all(b"a");
        viewer.go_on(Duration::from_millis(100));
        open.retain(is_open);
        assert!(begun.elapsed() < Duration::from_secs(8), "{}", open.len());
    }
    // A page with a token outlasts them all, and another one is let in.
    let frames = viewer.frames.len();
    viewer.until("frames", |page| page.frames.len() > frames + 10);
    panel.teacher_page();
}

#[test]
fn other_sites_names_and_origins_are_refused() {
    let panel = Panel::new(&SIM);
    let host = panel.host.clone();
    let own = format!("http://{host}");
    let port = host.split_once(':').unwrap().1;
    let upgrade = |origin: &str| {
        let headers = [
            ("Upgrade", "websocket"),
            ("Sec-WebSocket-Version", "13"),
            ("Sec-WebSocket-Key", "dGhlIHNhbXBsZSBub25jZQ=="),
            ("Origin", origin),
        ];
        panel.status("/ws", &headers)
    };
    assert_eq!(panel.status("/", &[]), 200);
    assert_eq!(
        panel.status("/", &[("Host", &format!("localhost:{port}"))]),
        200
    );
    for rebound in [
        "evil.example",
        &format!("evil.example:{port}"),
        "127.0.0.1",
        &format!("127.0.0.1:{port}.evil.example"),
        "localhost:1",
    ] {
        assert_eq!(panel.status("/", &[("Host", rebound)]), 421, "{rebound}");
    }
    assert_ne!(upgrade(&own), 403);
    for origin in [
        "http://evil.example",
        "null",
        "http://localhost:1",
        &format!("https://{host}"),
    ] {
        assert_eq!(upgrade(origin), 403, "{origin}");
    }
    let cross = [
        ("Sec-Fetch-Site", "cross-site"),
        ("Sec-Fetch-Mode", "no-cors"),
    ];
    assert_eq!(panel.status("/main.js", &cross), 403);
    assert_eq!(panel.status("/../Cargo.toml", &[]), 404);
    assert_eq!(
        panel.status("/report/0123456789abcdef0123456789abcdef", &[]),
        404
    );
    let answer = panel.get("/", &[]);
    for header in [
        "content-security-policy: default-src 'none'; script-src 'self';",
        "frame-ancestors 'none'",
        "x-content-type-options: nosniff",
        "referrer-policy: no-referrer",
        "cross-origin-opener-policy: same-origin",
    ] {
        assert!(answer.contains(header), "{header}");
    }
    assert!(!answer.to_lowercase().contains("set-cookie"));
    assert!(!answer.contains("unsafe"));
}
