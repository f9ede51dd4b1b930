//! TLS for other computers of a network: a certificate of this run alone.

use crate::panel_error::PanelError;
use crate::pending::{Peer, Pending};
use axum::Router;
use axum_server::tls_rustls::{RustlsAcceptor, RustlsConfig};
use rcgen::{CertificateParams, Error, KeyPair};
use sha2::{Digest, Sha256};
use std::fmt::Write;
use std::net::{IpAddr, TcpListener};
use std::time::{Duration, SystemTime};

const DAY: Duration = Duration::from_hours(24);

/// Time for which it is valid: no panel runs longer.
const VALID: Duration = Duration::from_hours(24 * 365);

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
        let (cert, signing_key) = signed(names)
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

/// A certificate that is valid from yesterday on, as clocks differ.
fn signed(names: [String; 3]) -> Result<(rcgen::Certificate, KeyPair), Error> {
    let now = SystemTime::now();
    let mut parameters = CertificateParams::new(names)?;
    parameters.not_before = (now - DAY).into();
    parameters.not_after = (now + VALID).into();
    let key = KeyPair::generate()?;
    Ok((parameters.self_signed(&key)?, key))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_certificate_is_valid_for_a_year() {
        let identity = Identity::new(IpAddr::from([192, 168, 0, 1])).unwrap();
        // The two times of X.509: a tag, a length of 13, YYMMDDhhmmssZ.
        let years: Vec<u64> = identity
            .certificate
            .windows(15)
            .filter(|bytes| bytes.starts_with(&[0x17, 13]) && bytes.ends_with(b"Z"))
            .map(|bytes| std::str::from_utf8(&bytes[2..4]).unwrap().parse().unwrap())
            .collect();
        let since_1970 = SystemTime::UNIX_EPOCH.elapsed().unwrap().as_secs();
        let year = since_1970 / 31_556_952 + 70 - 100;
        let [first, last] = years[..] else {
            panic!("{years:?}");
        };
        assert!((year - 1..=year + 1).contains(&first), "{years:?} {year}");
        assert!((1..=2).contains(&(last - first)), "{years:?}");
    }
}
