//! TLS in the local network: browsers give a page the camera only where it came encrypted.

use std::net::{IpAddr, Ipv4Addr};
use std::sync::Arc;
use std::time::{Duration, SystemTime};

use rcgen::{CertificateParams, DistinguishedName, DnType, ExtendedKeyUsagePurpose, KeyPair, SanType};
use tokio::net::TcpStream;
use tokio_rustls::TlsAcceptor;
use tokio_rustls::rustls::ServerConfig;
use tokio_rustls::rustls::crypto::ring;
use tokio_rustls::rustls::pki_types::PrivatePkcs8KeyDer;

use scaleproof_core::files;

/// First byte of a TLS record with a handshake (RFC 8446, 5.1). No HTTP method begins with it.
const HANDSHAKE: u8 = 22;

const DAY: Duration = Duration::from_hours(24);

/// Self-signed certificate; who opens the page compares its fingerprint.
pub(super) struct Identity {
    pub acceptor: TlsAcceptor,
    /// SHA-256 of the certificate, as browsers show it.
    pub fingerprint: String,
}

/// Makes a key, which stays in memory, and its certificate for this address.
pub(super) fn identity(ip: IpAddr) -> Result<Identity, String> {
    let no_certificate = |e: rcgen::Error| format!("no certificate can be made: {e}");
    let key = KeyPair::generate().map_err(no_certificate)?;
    let certificate = parameters(ip).self_signed(&key).map_err(no_certificate)?;
    let fingerprint = fingerprint(certificate.der());
    let key = PrivatePkcs8KeyDer::from(key.serialize_der());
    let config = ServerConfig::builder_with_provider(Arc::new(ring::default_provider()))
        .with_safe_default_protocol_versions()
        .and_then(|config| {
            config
                .with_no_client_auth()
                .with_single_cert(vec![certificate.der().clone()], key.into())
        });
    let config = config.map_err(|e| format!("TLS cannot be set up: {e}"))?;
    Ok(Identity {
        acceptor: TlsAcceptor::from(Arc::new(config)),
        fingerprint,
    })
}

/// Returns the certificate's fields. It is valid for a month, and since yesterday, as the phone's clock may be another; Apple's devices refuse years.
fn parameters(ip: IpAddr) -> CertificateParams {
    let mut parameters = CertificateParams::default();
    let mut name = DistinguishedName::new();
    name.push(DnType::CommonName, "scaleproof capture");
    parameters.distinguished_name = name;
    parameters.subject_alt_names = vec![SanType::IpAddress(ip), SanType::IpAddress(Ipv4Addr::LOCALHOST.into())];
    parameters.extended_key_usages = vec![ExtendedKeyUsagePurpose::ServerAuth];
    let since_1970 = SystemTime::UNIX_EPOCH.elapsed().unwrap_or_default();
    let now = rcgen::date_time_ymd(1970, 1, 1) + since_1970;
    (parameters.not_before, parameters.not_after) = (now - DAY, now + 30 * DAY);
    parameters
}

fn fingerprint(certificate: &[u8]) -> String {
    let digits = files::sha256_hex(certificate).to_uppercase();
    let pairs: Vec<&str> = (0..digits.len()).step_by(2).map(|i| &digits[i..i + 2]).collect();
    pairs.join(":")
}

/// Returns true if a connection begins with TLS; waits for its first byte.
pub(super) async fn begins_with_handshake(stream: &TcpStream) -> bool {
    let mut first = [0];
    stream.peek(&mut first).await.is_ok_and(|count| count == 1) && first[0] == HANDSHAKE
}
