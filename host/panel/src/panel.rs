//! Starts the panel.

use crate::archive::Archive;
use crate::device_thread::{DeviceThread, Program};
use crate::experiment::Experiments;
use crate::guard::Names;
use crate::hand;
use crate::hello;
use crate::invitations::Invitations;
use crate::panel_error::PanelError;
use crate::pending::Pending;
use crate::server;
use crate::shared::{Order, Shared};
use crate::tokens::Tokens;
use crepitus_client::connection::HandInput;
use crepitus_client::{Client, Error, Transport};
use serde_json::{Value, json};
use std::net::{IpAddr, Ipv4Addr, SocketAddr, TcpListener};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::thread;

/// Settings of the panel.
#[derive(Clone, Debug, Default)]
pub struct Settings {
    /// Port; 0 is any free one.
    pub port: u16,
    /// The address at which other computers reach this one, with TLS; none: this computer
    /// alone.
    pub lan: Option<IpAddr>,
    /// Folder in which sessions and recordings are stored; none: nowhere.
    pub sessions: Option<PathBuf>,
    /// Protocols of experiments, and their study; none: no experiments.
    pub experiments: Option<Experiments>,
    /// Recordings to look at.
    pub recordings: Vec<PathBuf>,
}

/// Source of what is shown.
#[derive(Clone, Debug)]
pub enum Source {
    /// A device.
    Device {
        /// Name of the device for people.
        name: String,
        /// Serial number of the device.
        serial: String,
        /// Hand that moves its leg, if it is a simulated one.
        hand: Option<HandInput>,
    },
    /// Recordings only.
    Replay,
}

/// The links to the page.
#[derive(Clone, Debug)]
pub struct Links {
    /// Link whose holder may control.
    pub teacher: String,
    /// Link whose holder may look on, and stop.
    pub viewer: String,
    /// Link whose holders may answer, each as a student, and stop.
    pub student: String,
    /// Link whose holder may run a lesson while another page controls.
    pub remote: String,
    /// QR code of the students' link as text, where phones can reach it: light modules are full blocks.
    pub student_code: Option<String>,
    /// SHA-256 of the certificate, if there is one.
    pub certificate: Option<String>,
}

/// A panel that is served.
pub struct Panel {
    shared: Arc<Shared>,
    inbox: Receiver<Order>,
    sessions: Option<PathBuf>,
    experiments: Option<Experiments>,
    hand: Option<HandInput>,
    links: Links,
}

impl Panel {
    /// Serves the page.
    ///
    /// # Errors
    /// [`PanelError`].
    pub fn open(settings: Settings, source: &Source) -> Result<Self, PanelError> {
        let system = |error: &dyn std::fmt::Display| PanelError::System(error.to_string());
        let tokens = Tokens::draw().map_err(|e| system(&e))?;
        let address = settings.lan.unwrap_or(IpAddr::V4(Ipv4Addr::LOCALHOST));
        let in_use = |source: std::io::Error| match source.kind() {
            std::io::ErrorKind::AddrNotAvailable => PanelError::Address { address },
            _ => PanelError::Port {
                address,
                port: settings.port,
                source,
            },
        };
        let listener =
            TcpListener::bind(SocketAddr::new(address, settings.port)).map_err(in_use)?;
        let port = listener.local_addr().map_err(in_use)?.port();
        let first = SocketAddr::new(address, port).to_string();
        let mut hosts = vec![first.clone()];
        if settings.lan.is_none() {
            hosts.push(format!("localhost:{port}"));
        }
        let (scheme, usual) = match settings.lan {
            Some(_) => ("https", 443),
            None => ("http", 80),
        };
        if port == usual {
            // Browsers leave it out.
            let short: Vec<_> = (hosts.iter())
                .filter_map(|host| host.strip_suffix(&format!(":{port}")))
                .map(str::to_owned)
                .collect();
            hosts.extend(short);
        }
        let (orders, inbox) = channel();
        let (questions, asked) = channel();
        let has_experiments = settings.experiments.is_some();
        let sessions = settings.sessions.as_deref();
        let tables = hello::tables(&described(source), sessions, has_experiments);
        let link = |page: &str, token: &str| format!("{scheme}://{first}/{page}#{token}");
        let student = link("student.html", &tokens.student);
        let remote = link("remote.html", &tokens.remote);
        let projector = link("?projector", &tokens.viewer);
        let is_lan = settings.lan.is_some();
        let invitations = Invitations::new(&student, &remote, &projector, is_lan);
        let mut links = Links {
            teacher: link("", &tokens.teacher),
            viewer: link("", &tokens.viewer),
            student_code: code(&student).filter(|_| is_lan),
            student,
            remote,
            certificate: None,
        };
        let shared = Shared::new(tokens, tables, invitations, orders, questions);
        let shared = Arc::new(shared);
        let archive = Archive::new(settings.recordings, settings.sessions.clone());
        let named = |name: &str| thread::Builder::new().name(name.to_owned());
        named("archive")
            .spawn(move || archive.run(&asked))
            .map_err(|e| system(&e))?;
        let router = server::router(shared.clone(), Names { scheme, hosts });
        links.certificate = spawn(listener, router, shared.pending.clone(), settings.lan)?;
        Ok(Self {
            shared,
            inbox,
            sessions: settings.sessions,
            experiments: settings.experiments,
            hand: match source {
                Source::Device { hand, .. } => hand.clone(),
                Source::Replay => None,
            },
            links,
        })
    }

    /// The links to the page.
    pub fn links(&self) -> &Links {
        &self.links
    }

    /// Keeps a device until the program is asked to end.
    ///
    /// # Errors
    /// The device does not answer, or did not disarm at the end.
    pub fn keep<T: Transport>(
        self,
        client: Client<T>,
        program: &dyn Program<T>,
    ) -> Result<(), Error> {
        let Self {
            shared,
            inbox,
            sessions,
            experiments,
            hand,
            ..
        } = self;
        DeviceThread::new(client, program, shared, inbox, sessions, experiments, hand)?.run()
    }

    /// Shows recordings until the program is asked to end.
    pub fn replay(self, has_ended: impl Fn() -> bool) {
        crate::replay::run(&self.shared, &self.inbox, has_ended);
    }
}

/// QR code of a link, as text.
#[cfg(feature = "lan")]
fn code(link: &str) -> Option<String> {
    crate::qr::text(link)
}

/// Without TLS no phone reaches it.
#[cfg(not(feature = "lan"))]
fn code(_: &str) -> Option<String> {
    None
}

fn described(source: &Source) -> Value {
    match source {
        Source::Device { name, serial, hand } => json!({
            "kind": "device",
            "name": name,
            "serial": serial,
            "simulated": hand.is_some(),
            "hand": hand.as_ref().map(|_| hand::reach()),
        }),
        Source::Replay => json!({ "kind": "replay" }),
    }
}

/// Starts the server's thread; returns the fingerprint of its certificate.
fn spawn(
    listener: TcpListener,
    router: axum::Router,
    pending: Pending,
    lan: Option<IpAddr>,
) -> Result<Option<String>, PanelError> {
    let system = |error: &dyn std::fmt::Display| PanelError::System(error.to_string());
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()
        .map_err(|e| system(&e))?;
    #[cfg(feature = "lan")]
    let identity = lan.map(crate::tls::Identity::new).transpose()?;
    #[cfg(feature = "lan")]
    let certificate = identity
        .as_ref()
        .map(|identity| identity.fingerprint.clone());
    #[cfg(not(feature = "lan"))]
    let certificate = match lan {
        Some(_) => return Err(PanelError::NoTls),
        None => None,
    };
    thread::Builder::new()
        .name("server".to_owned())
        .spawn(move || {
            let served = runtime.block_on(async {
                #[cfg(feature = "lan")]
                if let Some(identity) = identity {
                    return crate::tls::serve(listener, router, identity, pending).await;
                }
                server::serve(listener, router, pending).await
            });
            if let Err(error) = served {
                eprintln!("warning: the panel's page is no longer served: {error}");
            }
        })
        .map_err(|e| system(&e))?;
    Ok(certificate)
}
