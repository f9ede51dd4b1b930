//! TLS for other computers of a network: a certificate of this run alone.

use crate::panel::PanelError;
use crate::pending::{Peer, Pending};
use axum::Router;
use axum_server::tls_rustls::{RustlsAcceptor, RustlsConfig};
use rcgen::CertifiedKey;
use sha2::{Digest, Sha256};
use std::fmt::Write;
use std::net::{IpAddr, TcpListener};

/// A key, and its certificate.
pub(crate) struct Identity {
    certificate: Vec<u8>,
    key: Vec<u8>,
    /// SHA-256 of the certificate, as browsers show it.
    pub(crate) fingerprint: String,
}

impl Identity {
    /// Makes the identity of the computer with this address.
    ///
    /// # Errors
    /// No key can be made.
    pub(crate) fn new(address: IpAddr) -> Result<Self, PanelError> {
        let names = [
            address.to_string(),
            "localhost".to_owned(),
            "127.0.0.1".to_owned(),
        ];
        let CertifiedKey { cert, signing_key } = rcgen::generate_simple_self_signed(names)
            .map_err(|error| PanelError::System(format!("no certificate: {error}")))?;
        let certificate = cert.der().to_vec();
        let digest = Sha256::digest(&certificate);
        let fingerprint = digest.iter().fold(String::new(), |mut text, byte| {
            let colon = if text.is_empty() { "" } else { ":" };
            // Writing to a string does not fail.
            let _ = write!(text, "{colon}{byte:02X}");
            text
        });
        Ok(Self {
            certificate,
            key: signing_key.serialize_der(),
            fingerprint,
        })
    }
}

/// Serves until the program ends.
pub(crate) async fn serve(
    listener: TcpListener,
    router: Router,
    identity: Identity,
    pending: Pending,
) -> std::io::Result<()> {
    // Only fails if another one was installed before, which is as good.
    let _ = rustls::crypto::ring::default_provider().install_default();
    listener.set_nonblocking(true)?;
    let config = RustlsConfig::from_der(vec![identity.certificate], identity.key).await?;
    axum_server::from_tcp(listener)?
        .acceptor(RustlsAcceptor::new(config).acceptor(pending))
        .serve(router.into_make_service_with_connect_info::<Peer>())
        .await
}
