//! A TCP tunnel that can hang: it keeps what both sides send, and forwards it when it goes on.

use std::io::{ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

/// A tunnel to a server, for connections to `host`.
pub(crate) struct Tunnel {
    hangs: Arc<AtomicBool>,
    /// Host and port at which it listens.
    pub(crate) host: String,
}

impl Tunnel {
    pub(crate) fn to(server: &str) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let host = listener.local_addr().unwrap().to_string();
        let hangs = Arc::new(AtomicBool::new(false));
        let (server, in_thread) = (server.to_owned(), hangs.clone());
        // Ends with the test program.
        thread::spawn(move || {
            for page in listener.incoming().map_while(Result::ok) {
                let panel = TcpStream::connect(&server).unwrap();
                for (from, to) in [(&page, &panel), (&panel, &page)] {
                    let (from, to) = (from.try_clone().unwrap(), to.try_clone().unwrap());
                    let hangs = in_thread.clone();
                    thread::spawn(move || forward(from, to, &hangs));
                }
            }
        });
        Self { hangs, host }
    }

    pub(crate) fn hang(&self, hangs: bool) {
        self.hangs.store(hangs, Ordering::Relaxed);
    }
}

fn forward(mut from: TcpStream, mut to: TcpStream, hangs: &AtomicBool) {
    let step = Duration::from_millis(2);
    from.set_read_timeout(Some(step)).unwrap();
    let mut buffer = [0; 4_096];
    loop {
        let count = match from.read(&mut buffer) {
            Ok(0) => return,
            Ok(count) => count,
            Err(error) if [ErrorKind::WouldBlock, ErrorKind::TimedOut].contains(&error.kind()) => {
                continue;
            }
            Err(_) => return,
        };
        while hangs.load(Ordering::Relaxed) {
            thread::sleep(step);
        }
        if to.write_all(&buffer[..count]).is_err() {
            return;
        }
    }
}
