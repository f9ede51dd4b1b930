//! The panel in a process of its own, and pages without a browser.

use crate::support::{crepitus, served};
use serde_json::{Value, json};
use std::collections::HashMap;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, ExitStatus, Stdio};
use std::time::{Duration, Instant};
use tungstenite::client::IntoClientRequest;
use tungstenite::{Message, WebSocket};

/// Longest time for anything; mostly it takes milliseconds.
const PATIENCE: Duration = Duration::from_secs(20);

/// `crepitus panel`, until it is dropped.
pub(crate) struct Panel {
    pub(crate) child: Child,
    pub(crate) teacher: String,
    pub(crate) viewer: String,
    pub(crate) student: String,
    pub(crate) remote: String,
    /// Host and port.
    pub(crate) host: String,
    _home: tempfile::TempDir,
}

impl Panel {
    /// Starts the panel with these arguments, and a home folder of its own.
    pub(crate) fn new(arguments: &[&str]) -> Self {
        Self::at(arguments, None)
    }

    /// Starts the panel in the run-time folder of a simulated device.
    pub(crate) fn at(arguments: &[&str], runtime: Option<&Path>) -> Self {
        let home = tempfile::tempdir().unwrap();
        let mut command = crepitus();
        command
            .args(["panel", "--json"])
            .args(arguments)
            .env("CREPITUS_PRESETS", home.path().join("presets"))
            .stdout(Stdio::piped());
        if let Some(runtime) = runtime {
            command.env("XDG_RUNTIME_DIR", runtime);
        }
        let mut child = command.spawn().unwrap();
        let mut text = String::new();
        let mut out = BufReader::new(child.stdout.as_mut().unwrap());
        while !text.contains("\n}") {
            assert!(out.read_line(&mut text).unwrap() > 0, "{text}");
        }
        let links: Value = serde_json::from_str(&text).unwrap();
        let link = |name: &str| links[name].as_str().unwrap().to_owned();
        let teacher = link("teacher");
        let host = teacher.split('/').nth(2).unwrap().to_owned();
        Self {
            child,
            viewer: link("viewer"),
            student: link("student"),
            remote: link("remote"),
            teacher,
            host,
            _home: home,
        }
    }

    /// A page with the teacher's link that has control.
    pub(crate) fn controlling(&self) -> Page {
        let mut page = self.teacher_page();
        page.ask("take", json!({})).unwrap();
        page
    }

    pub(crate) fn teacher_page(&self) -> Page {
        self.page(&self.teacher)
    }

    pub(crate) fn viewer_page(&self) -> Page {
        self.page(&self.viewer)
    }

    /// The teacher's own phone, which has its first frame.
    pub(crate) fn remote_page(&self) -> Page {
        let mut page = Page::open(&self.host, Some(token(&self.remote)));
        page.until("the first messages", |page| {
            let has = |name: &str| page.latest.contains_key(name);
            has("status") && has("holder") && has("knee") && page.newest().is_some()
        });
        page
    }

    /// A student's phone, which has not joined.
    pub(crate) fn student_page(&self) -> Page {
        let mut page = Page::open(&self.host, Some(token(&self.student)));
        page.until("the greeting", |page| page.latest.contains_key("status"));
        page
    }

    /// A student's phone that has joined, and its key.
    pub(crate) fn joined(&self, name: &str, key: Option<&str>) -> (Page, String) {
        let mut page = self.student_page();
        let seat = page.ask("join", json!({ "name": name, "key": key }));
        let key = seat.unwrap()["key"].as_str().unwrap().to_owned();
        page.until("its seat", |page| page.message("own")["name"] == name);
        (page, key)
    }

    /// A page of a link that has received all that there is.
    fn page(&self, link: &str) -> Page {
        let mut page = Page::open(&self.host, Some(token(link)));
        page.until("the first messages", |page| {
            let has = |name: &str| page.latest.contains_key(name);
            let is_replay = has("hello") && page.latest["hello"]["source"]["kind"] == "replay";
            let has_frame = page.newest().is_some();
            has("status") && has("holder") && has_frame && (is_replay || has("lesson"))
        });
        page
    }

    /// Status of a bare request with these headers.
    pub(crate) fn status(&self, path: &str, headers: &[(&str, &str)]) -> u16 {
        let answer = self.get(path, headers);
        answer.split(' ').nth(1).unwrap().parse().unwrap()
    }

    /// The answer to a bare request; without a `Host` among the headers with the right one.
    pub(crate) fn get(&self, path: &str, headers: &[(&str, &str)]) -> String {
        let mut stream = TcpStream::connect(&self.host).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        let mut request = format!("GET {path} HTTP/1.1\r\nConnection: close\r\n");
        if !headers.iter().any(|(name, _)| *name == "Host") {
            request = request + "Host: " + &self.host + "\r\n";
        }
        for (name, value) in headers {
            request = request + name + ": " + value + "\r\n";
        }
        stream.write_all((request + "\r\n").as_bytes()).unwrap();
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).unwrap();
        String::from_utf8_lossy(&answer).into_owned()
    }

    /// Asks it to end and waits.
    pub(crate) fn end(mut self) -> ExitStatus {
        served::signal(&self.child, "-INT");
        self.child.wait().unwrap()
    }
}

/// The token of a link.
pub(crate) fn token(link: &str) -> &str {
    link.split_once('#').unwrap().1
}

impl Drop for Panel {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A live frame.
#[derive(Clone, Debug)]
pub(crate) struct Frame {
    pub(crate) bins: u16,
    pub(crate) number: u32,
    pub(crate) begin_s: f64,
    pub(crate) bin_s: f64,
    pub(crate) masks: u32,
    pub(crate) bytes: Vec<u8>,
}

impl Frame {
    fn of(bytes: &[u8]) -> Self {
        let u32_at = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
        let f64_at = |at: usize| f64::from_le_bytes(bytes[at..at + 8].try_into().unwrap());
        Self {
            bins: u16::from_le_bytes(bytes[2..4].try_into().unwrap()),
            number: u32_at(4),
            begin_s: f64_at(16),
            bin_s: f64_at(24),
            masks: u32_at(36),
            bytes: bytes.to_vec(),
        }
    }

    /// A number of a bin: torque, model, speed, angle, hand, low and high each.
    pub(crate) fn value(&self, bin: u16, place: usize) -> f32 {
        let at = 40 + usize::from(bin) * 48 + place * 4;
        f32::from_le_bytes(self.bytes[at..at + 4].try_into().unwrap())
    }

    pub(crate) fn states(&self, bin: u16) -> u32 {
        self.value(bin, 10).to_bits()
    }

    pub(crate) fn marks(&self, bin: u16) -> u32 {
        self.value(bin, 11).to_bits() >> 16
    }
}

/// A page, as the server sees it.
pub(crate) struct Page {
    socket: WebSocket<TcpStream>,
    /// The last message of each kind.
    pub(crate) latest: HashMap<String, Value>,
    pub(crate) notes: Vec<Value>,
    /// All messages but replies.
    pub(crate) history: Vec<Value>,
    pub(crate) frames: Vec<Frame>,
    replies: HashMap<u64, Value>,
    traces: HashMap<u32, Frame>,
    next: u32,
    newest: Option<u32>,
    /// Whether it answers frames.
    pub(crate) answers: bool,
    pub(crate) is_closed: bool,
}

impl Page {
    /// Connects and says this token, or nothing.
    pub(crate) fn open(host: &str, token: Option<&str>) -> Self {
        Self::connected(host, host, token)
    }

    /// Connects through a tunnel at another address.
    pub(crate) fn through(tunnel: &str, host: &str, token: &str) -> Self {
        Self::connected(tunnel, host, Some(token))
    }

    fn connected(address: &str, host: &str, token: Option<&str>) -> Self {
        let mut request = format!("ws://{host}/ws").into_client_request().unwrap();
        let origin = format!("http://{host}").parse().unwrap();
        request.headers_mut().insert("origin", origin);
        let stream = TcpStream::connect(address).unwrap();
        let (mut socket, _) = tungstenite::client(request, stream).unwrap();
        (socket.get_mut())
            .set_read_timeout(Some(Duration::from_millis(2)))
            .unwrap();
        if let Some(token) = token {
            let first = json!({ "token": token }).to_string();
            socket.send(Message::text(first)).unwrap();
        }
        Self {
            socket,
            latest: HashMap::new(),
            notes: Vec::new(),
            history: Vec::new(),
            frames: Vec::new(),
            replies: HashMap::new(),
            traces: HashMap::new(),
            next: 0,
            newest: None,
            answers: true,
            is_closed: false,
        }
    }

    /// Takes a message, or waits for 2 ms.
    fn step(&mut self) {
        match self.socket.read() {
            Ok(Message::Binary(bytes)) => {
                let frame = Frame::of(&bytes);
                if bytes[1] == 2 {
                    self.traces.insert(frame.number, frame);
                    return;
                }
                if self.answers {
                    let seen = json!({ "seen": frame.number }).to_string();
                    let _ = self.socket.send(Message::text(seen));
                }
                self.newest = Some(frame.number);
                self.frames.push(frame);
            }
            Ok(Message::Text(text)) => {
                let message: Value = serde_json::from_str(&text).unwrap();
                if let Some(id) = message["re"].as_u64() {
                    self.replies.insert(id, message);
                    return;
                }
                self.history.push(message.clone());
                for (name, value) in message.as_object().unwrap() {
                    if name == "note" {
                        self.notes.push(value.clone());
                    } else {
                        self.latest.insert(name.clone(), value.clone());
                    }
                }
            }
            Ok(_) => {}
            Err(tungstenite::Error::Io(error))
                if [std::io::ErrorKind::WouldBlock, std::io::ErrorKind::TimedOut]
                    .contains(&error.kind()) => {}
            Err(_) => self.is_closed = true,
        }
    }

    /// Takes messages until this is so.
    pub(crate) fn until(&mut self, what: &str, is_so: impl Fn(&Self) -> bool) {
        let end = Instant::now() + PATIENCE;
        while !is_so(self) {
            assert!(
                Instant::now() < end,
                "waited for {what}: {:?}",
                self.latest.get("status")
            );
            assert!(
                !self.is_closed || what.contains("close"),
                "closed while waiting for {what}"
            );
            self.step();
        }
    }

    /// Takes messages for a time.
    pub(crate) fn go_on(&mut self, time: Duration) {
        let end = Instant::now() + time;
        while Instant::now() < end && !self.is_closed {
            self.step();
        }
    }

    /// Sends a request and waits for its reply.
    pub(crate) fn ask(&mut self, what: &str, mut more: Value) -> Result<Value, String> {
        self.next += 1;
        let id = self.next;
        more["id"] = json!(id);
        if more.get("newest").is_none() {
            more["newest"] = json!(self.newest());
        }
        more["do"] = json!(what);
        self.send(&more.to_string());
        self.until(&format!("the reply to {what}"), |page| {
            page.replies.contains_key(&u64::from(id)) || page.traces.contains_key(&id)
        });
        let Some(reply) = self.replies.remove(&u64::from(id)) else {
            return Ok(Value::Null);
        };
        match reply["error"].as_str() {
            Some(error) => Err(error.to_owned()),
            None => Ok(reply["ok"].clone()),
        }
    }

    /// The reply to a request that was sent.
    pub(crate) fn reply(&mut self, id: u64) -> Value {
        self.until("a reply", |page| page.replies.contains_key(&id));
        self.replies.remove(&id).unwrap_or_default()
    }

    /// The bins of a recording.
    pub(crate) fn trace(&mut self, recording: u64, from_s: f64, to_s: f64, points: u16) -> Frame {
        let request =
            json!({ "recording": recording, "from_s": from_s, "to_s": to_s, "points": points });
        self.ask("trace", request).unwrap();
        self.traces.remove(&self.next).expect("a trace")
    }

    /// Number of the newest frame, which requests carry.
    pub(crate) fn newest(&self) -> Option<u32> {
        self.newest
    }

    pub(crate) fn send(&mut self, text: &str) {
        let _ = self.socket.send(Message::text(text));
    }

    /// The last message of a kind; null if none has come.
    pub(crate) fn message(&self, kind: &str) -> &Value {
        self.latest.get(kind).unwrap_or(&Value::Null)
    }

    pub(crate) fn status(&self, key: &str) -> &Value {
        &self.latest["status"][key]
    }

    pub(crate) fn until_state(&mut self, state: &str) {
        self.until(state, |page| page.status("state") == state);
    }

    /// Arms; the simulated leg was zeroed at its start. While other tests keep the computer
    /// busy, this page may answer too late: then it arms again.
    pub(crate) fn arm(&mut self) {
        let was_late = |page: &Self| {
            let message = page.status("message").as_str().unwrap_or_default();
            message.contains("200 ms") && page.status("state") == "disarmed"
        };
        for _ in 0..5 {
            if self.ask("arm", json!({})).is_ok() {
                self.until("an end of arming", |page| {
                    page.status("state") == "armed" || was_late(page)
                });
            }
            if self.status("state") == "armed" {
                return;
            }
            self.go_on(Duration::from_millis(100));
        }
        panic!("not armed: {:?}", self.latest["status"]);
    }
}
