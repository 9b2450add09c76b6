//! The address of a stream, whose passwords are given to the decoder and to nothing else.

use std::fmt;

/// An address of a camera that streams. What is shown of it has no user, no password and no query.
#[derive(Clone, PartialEq, Eq)]
pub struct StreamAddress(String);

/// Protocol of a stream.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StreamScheme {
    /// JPEG files one after the other, as `multipart/x-mixed-replace`.
    Http,
    /// RFC 2326 and 7826.
    Rtsp,
}

impl StreamAddress {
    /// Returns true if a text is meant for an address, of whatever kind: a word, and `://`.
    pub fn looks_like(text: &str) -> bool {
        let scheme = text.split_once("://").map_or("", |(scheme, _)| scheme);
        !scheme.is_empty() && scheme.chars().all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c))
    }

    /// Creates an address of any text that looks like one; [`StreamAddress::scheme`] checks it.
    pub fn new(text: &str) -> StreamAddress {
        StreamAddress(text.to_owned())
    }

    /// Returns its protocol.
    ///
    /// # Errors
    /// A clause: an address of another kind, without a host, or with blanks.
    pub fn scheme(&self) -> Result<StreamScheme, &'static str> {
        let (scheme, rest) = self.0.split_once("://").unwrap_or(("", &self.0));
        let scheme = match scheme.to_ascii_lowercase().as_str() {
            "http" => StreamScheme::Http,
            "rtsp" => StreamScheme::Rtsp,
            "https" => return Err("cameras serve http://: use that address of it, in a network you trust"),
            _ => return Err("give an address that begins with http:// or rtsp://"),
        };
        let host_and_port = without_user(rest).split(['/', '?', '#']).next().unwrap_or_default();
        // An IPv6 address stands in brackets.
        let (host, port) = match host_and_port.rsplit_once(':') {
            Some((host, port)) if !port.ends_with(']') => (host, Some(port)),
            _ => (host_and_port, None),
        };
        if host.is_empty() {
            return Err("it names no host");
        }
        if port.is_some_and(|port| port.parse::<u16>().is_err()) {
            return Err("its port is no number up to 65535");
        }
        if self.0.chars().any(|c| c.is_whitespace() || c.is_control()) {
            return Err("it has blanks: write them as %20");
        }
        Ok(scheme)
    }

    /// Returns the address with its password: for the decoder alone.
    pub(super) fn secret(&self) -> &str {
        &self.0
    }

    /// Removes user, password and query from a text of the decoder's.
    pub(super) fn without_secrets(&self, said: &str) -> String {
        let mut said = said.replace(&self.0, &self.to_string());
        let rest = self.0.split_once("://").map_or(self.0.as_str(), |(_, rest)| rest);
        let user = rest.rsplit_once('@').map_or("", |(user, _)| user);
        let password = user.split_once(':').map_or("", |(_, password)| password);
        let query = rest.split_once('?').map_or("", |(_, query)| query);
        for secret in [user, password, query] {
            if !secret.is_empty() {
                said = said.replace(secret, "…");
            }
        }
        said
    }
}

/// Returns what follows the user and the password. A password may have any sign in it, so the last `@` counts.
fn without_user(rest: &str) -> &str {
    rest.rsplit_once('@').map_or(rest, |(_, rest)| rest)
}

impl fmt::Display for StreamAddress {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let (scheme, rest) = self.0.split_once("://").unwrap_or(("", &self.0));
        let rest = without_user(rest);
        match rest.split_once('?') {
            Some((path, _)) => write!(f, "{scheme}://{path}?…"),
            None => write!(f, "{scheme}://{rest}"),
        }
    }
}

/// Shows no secrets either.
impl fmt::Debug for StreamAddress {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}
