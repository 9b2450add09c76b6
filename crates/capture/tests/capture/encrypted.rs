//! The page in the local network: encrypted with the certificate whose fingerprint is shown, and never otherwise.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::sync::Arc;
use std::time::Duration;

use scaleproof_capture::page::{Page, PageError};
use scaleproof_core::files::sha256_hex;
use tokio_rustls::rustls::client::danger::{HandshakeSignatureValid, ServerCertVerified, ServerCertVerifier};
use tokio_rustls::rustls::crypto::{CryptoProvider, ring, verify_tls12_signature, verify_tls13_signature};
use tokio_rustls::rustls::pki_types::{CertificateDer, ServerName, UnixTime};
use tokio_rustls::rustls::{
    CertificateError, ClientConfig, ClientConnection, DigitallySignedStruct, Error, SignatureScheme, StreamOwned,
};

/// A client that trusts the one certificate with this fingerprint, as a person does who has compared it.
#[derive(Debug)]
struct Pinned(String, CryptoProvider);

impl ServerCertVerifier for Pinned {
    fn verify_server_cert(
        &self,
        certificate: &CertificateDer,
        _intermediates: &[CertificateDer],
        _name: &ServerName,
        _ocsp: &[u8],
        _now: UnixTime,
    ) -> Result<ServerCertVerified, Error> {
        let shown = self.0.replace(':', "").to_lowercase();
        let is_it = sha256_hex(certificate) == shown;
        let wrong = Error::InvalidCertificate(CertificateError::ApplicationVerificationFailure);
        is_it.then(ServerCertVerified::assertion).ok_or(wrong)
    }

    fn verify_tls12_signature(
        &self,
        message: &[u8],
        certificate: &CertificateDer,
        signed: &DigitallySignedStruct,
    ) -> Result<HandshakeSignatureValid, Error> {
        verify_tls12_signature(message, certificate, signed, &self.1.signature_verification_algorithms)
    }

    fn verify_tls13_signature(
        &self,
        message: &[u8],
        certificate: &CertificateDer,
        signed: &DigitallySignedStruct,
    ) -> Result<HandshakeSignatureValid, Error> {
        verify_tls13_signature(message, certificate, signed, &self.1.signature_verification_algorithms)
    }

    fn supported_verify_schemes(&self) -> Vec<SignatureScheme> {
        self.1.signature_verification_algorithms.supported_schemes()
    }
}

fn connect(host: &str) -> TcpStream {
    let stream = TcpStream::connect(host).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
    stream
}

/// The whole answer to one request, whose `{host}` is the server's.
fn answered(mut stream: impl Read + Write, host: &str, request: &str) -> std::io::Result<String> {
    let request = request.replace("{host}", host) + "\r\nConnection: close\r\n\r\n";
    stream.write_all(request.as_bytes())?;
    let mut answer = String::new();
    match stream.read_to_string(&mut answer) {
        Err(e) if answer.is_empty() => Err(e),
        _ => Ok(answer),
    }
}

fn encrypted(fingerprint: &str, host: &str, request: &str) -> std::io::Result<String> {
    let provider = ring::default_provider();
    let pinned = Pinned(fingerprint.to_owned(), provider.clone());
    let config = ClientConfig::builder_with_provider(Arc::new(provider))
        .with_safe_default_protocol_versions()
        .unwrap()
        .dangerous()
        .with_custom_certificate_verifier(Arc::new(pinned))
        .with_no_client_auth();
    let name = ServerName::from(host.parse::<std::net::SocketAddr>().unwrap().ip());
    let client = ClientConnection::new(Arc::new(config), name).unwrap();
    answered(StreamOwned::new(client, connect(host)), host, request)
}

#[test]
fn in_the_network_the_page_is_encrypted_with_the_certificate_that_is_shown() {
    let folder = std::env::temp_dir().join("scaleproof, never made");
    let page = match Page::open(0, true, &folder, || {}) {
        Err(PageError::NoNetwork(_)) => return,
        page => page.unwrap(),
    };
    let lan = page.lan.as_ref().unwrap();
    let (host, join) = lan.address.strip_prefix("https://").unwrap().split_once('/').unwrap();
    let is_status = |answer: &str, status: u16| answer.starts_with(&format!("HTTP/1.1 {status} "));
    // 32 bytes as browsers write them.
    assert!(lan.fingerprint.len() == 95 && lan.fingerprint.split(':').all(|pair| pair.len() == 2));
    let get = |path: &str| {
        encrypted(
            &lan.fingerprint,
            host,
            &format!("GET {path} HTTP/1.1\r\nHost: {{host}}"),
        )
    };

    assert!(is_status(&get("/").unwrap(), 401));
    let joined = get(&format!("/{join}")).unwrap();
    assert!(is_status(&joined, 303), "{joined}");
    let cookie = joined
        .lines()
        .find_map(|line| line.strip_prefix("set-cookie: "))
        .unwrap();
    assert!(cookie.ends_with("; HttpOnly; SameSite=Strict; Secure"), "{cookie}");
    let cookie = cookie.split(';').next().unwrap();
    let with_cookie = |what: &str, more: &str| {
        let request = format!("{what} HTTP/1.1\r\nHost: {{host}}\r\nCookie: {cookie}\r\nContent-Length: 0{more}");
        encrypted(&lan.fingerprint, host, &request).unwrap()
    };
    assert!(is_status(&with_cookie("GET /", ""), 200));
    assert!(is_status(
        &with_cookie("POST /finish", "\r\nOrigin: https://{host}"),
        202
    ));
    // A page that came unencrypted is another site, as is one without a name.
    for origin in ["", "\r\nOrigin: http://{host}", "\r\nOrigin: https://evil.example"] {
        assert!(is_status(&with_cookie("POST /finish", origin), 403), "{origin}");
        let film = with_cookie("POST /film/1/preview/50", origin);
        assert!(is_status(&film, 403), "{origin}");
    }
    let rebound = encrypted(&lan.fingerprint, host, "GET / HTTP/1.1\r\nHost: evil.example");
    assert!(is_status(&rebound.unwrap(), 421));

    // Another certificate in the way is noticed by its fingerprint.
    let other = lan.fingerprint.chars().rev().collect::<String>();
    assert!(encrypted(&other, host, "GET / HTTP/1.1\r\nHost: {host}").is_err());
    // Unencrypted, other machines get one sentence, whatever they bring.
    for request in [
        format!("GET /{join} HTTP/1.1\r\nHost: {{host}}"),
        format!("GET /state/0 HTTP/1.1\r\nHost: {{host}}\r\nCookie: {cookie}"),
        format!(
            "POST /finish HTTP/1.1\r\nHost: {{host}}\r\nOrigin: http://{{host}}\r\nCookie: {cookie}\r\nContent-Length: 0"
        ),
    ] {
        let answer = answered(connect(host), host, &request).unwrap();
        assert!(
            is_status(&answer, 400) && answer.contains("begins with https://"),
            "{answer}"
        );
    }
    // The browser on this machine needs no encryption; its code is its own.
    let (here, join) = page.address.strip_prefix("http://").unwrap().split_once('/').unwrap();
    let joined = answered(connect(here), here, &format!("GET /{join} HTTP/1.1\r\nHost: {{host}}")).unwrap();
    assert!(is_status(&joined, 303) && !joined.contains("Secure"), "{joined}");
}
