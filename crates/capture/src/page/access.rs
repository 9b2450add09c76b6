//! Access control: the Host header against DNS rebinding, Origin and Sec-Fetch-Site against other sites, one-time tokens against other machines of the
//! network and other accounts of this one.

use std::net::{Ipv4Addr, Ipv6Addr};
use std::sync::{Mutex, PoisonError};

use axum::http::header::{COOKIE, HOST, ORIGIN};
use axum::http::{HeaderMap, Method, StatusCode};
use rand::TryRng;
use rand::rngs::{SysError, SysRng};

use scaleproof_core::files;

/// Scheme of a request.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scheme {
    Http,
    /// Over TLS.
    Https,
}

impl Scheme {
    /// Returns the beginning of an address.
    fn prefix(self) -> &'static str {
        match self {
            Scheme::Http => "http://",
            Scheme::Https => "https://",
        }
    }
}

/// Checks of a request before anything else.
#[derive(Debug)]
pub struct Access {
    /// True if requests come from this machine only.
    is_local: bool,
    keys: Mutex<Keys>,
    /// Cookies belong to an address, whatever the port: a name for each port keeps two captures on one machine apart.
    cookie_name: String,
}

/// SHA-256 of the secrets, so that comparing them tells nothing by its time.
#[derive(Debug, Default)]
struct Keys {
    /// Tokens that no browser has exchanged yet.
    tokens: Vec<String>,
    /// Cookies that were given for tokens.
    sessions: Vec<String>,
}

impl Access {
    /// Admits whoever brings a token to this port from this machine, once. Returns the token.
    pub fn local(port: u16) -> Result<(Access, String), SysError> {
        let token = secret()?;
        Ok((Access::of(port, true, std::slice::from_ref(&token)), token))
    }

    /// Admits whoever brings one of two tokens to this port, each of them once. Returns the tokens.
    pub fn in_network(port: u16) -> Result<(Access, [String; 2]), SysError> {
        let tokens = [secret()?, secret()?];
        Ok((Access::of(port, false, &tokens), tokens))
    }

    fn of(port: u16, is_local: bool, tokens: &[String]) -> Access {
        let keys = Keys {
            tokens: tokens.iter().map(hash).collect(),
            sessions: Vec::new(),
        };
        Access {
            is_local,
            keys: Mutex::new(keys),
            cookie_name: format!("scaleproof_{port}"),
        }
    }

    /// Refuses names that are no address (a hostile site's name may be made to mean this machine), and what another site's page asks; by
    /// http a page of https is another site, and the reverse.
    pub fn check_site(
        &self,
        method: &Method,
        headers: &HeaderMap,
        scheme: Scheme,
    ) -> Result<(), (StatusCode, &'static str)> {
        let text = |name: &str| headers.get(name).map(|value| value.to_str().unwrap_or("?"));
        let host = text(HOST.as_str()).unwrap_or_default();
        if !self.is_own(host) {
            let sentence = "ask for this page by the address that the terminal shows";
            return Err((StatusCode::MISDIRECTED_REQUEST, sentence));
        }
        let is_other_site = text("sec-fetch-site").is_some_and(|site| !matches!(site, "same-origin" | "none"));
        let is_own_origin = text(ORIGIN.as_str()).map(|origin| origin == format!("{}{host}", scheme.prefix()));
        // Browsers name the origin of whatever changes something.
        let is_foreign = is_own_origin == Some(false) || (is_own_origin.is_none() && method != Method::GET);
        if is_other_site || is_foreign {
            let sentence = "another site's page asked for this: type the address instead";
            return Err((StatusCode::FORBIDDEN, sentence));
        }
        Ok(())
    }

    fn is_own(&self, host: &str) -> bool {
        let name = match host.rsplit_once(':') {
            Some((name, port)) if port.bytes().all(|b| b.is_ascii_digit()) => name,
            _ => host,
        };
        let v4 = name.parse::<Ipv4Addr>();
        let v6 = name.strip_prefix('[').and_then(|rest| rest.strip_suffix(']'));
        let v6 = v6.and_then(|inner| inner.parse::<Ipv6Addr>().ok());
        match self.is_local {
            _ if name == "localhost" => true,
            true => v4.is_ok_and(|ip| ip.is_loopback()) || v6.is_some_and(|ip| ip.is_loopback()),
            false => v4.is_ok() || v6.is_some(),
        }
    }

    /// Identifies the browser, by a hash of the cookie that its token was exchanged for.
    pub fn browser(&self, headers: &HeaderMap) -> Option<String> {
        let lines = headers.get_all(COOKIE).iter().filter_map(|value| value.to_str().ok());
        let cookies = lines
            .flat_map(|line| line.split(';'))
            .filter_map(|pair| pair.trim().split_once('='));
        let own = cookies.filter(|(name, _)| *name == self.cookie_name);
        let keys = self.keys.lock().unwrap_or_else(PoisonError::into_inner);
        own.map(|(_, value)| hash(value))
            .find(|hash| keys.sessions.contains(hash))
    }

    /// Exchanges a token for a cookie, the whole `Set-Cookie` value. A token is good once; what came encrypted is never sent otherwise.
    pub fn join(&self, token: &str, scheme: Scheme) -> Option<String> {
        let mut keys = self.keys.lock().unwrap_or_else(PoisonError::into_inner);
        let token = hash(token);
        let at = keys.tokens.iter().position(|known| *known == token)?;
        let (name, cookie) = (&self.cookie_name, secret().ok()?);
        keys.tokens.remove(at);
        keys.sessions.push(hash(&cookie));
        let secure = if scheme == Scheme::Https { "; Secure" } else { "" };
        Some(format!("{name}={cookie}; Path=/; HttpOnly; SameSite=Strict{secure}"))
    }
}

fn hash(secret: impl AsRef<[u8]>) -> String {
    files::sha256_hex(secret.as_ref())
}

/// Draws 128 bits of the system's randomness, hex.
fn secret() -> Result<String, SysError> {
    let mut bytes = [0; 16];
    SysRng.try_fill_bytes(&mut bytes)?;
    Ok(bytes.iter().map(|b| format!("{b:02x}")).collect())
}
