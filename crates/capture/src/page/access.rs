//! Who may ask: the Host header against DNS rebinding, Origin and Sec-Fetch-Site against other sites, one-time tokens in the local network.

use std::net::{Ipv4Addr, Ipv6Addr};
use std::sync::Mutex;

use axum::http::header::{COOKIE, HOST, ORIGIN};
use axum::http::{HeaderMap, Method, StatusCode};
use rand::TryRng;
use rand::rngs::{SysError, SysRng};

use scaleproof_core::files;

/// What the page's server asks of a request before anything else.
#[derive(Debug)]
pub(super) struct Access {
    /// `None`: this machine only, and no token.
    keys: Option<Mutex<Keys>>,
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
    /// Everybody on this machine.
    pub(super) fn local() -> Access {
        Access {
            keys: None,
            cookie_name: String::new(),
        }
    }

    /// Whoever brings one of two tokens to this port, each of them once. Returns the tokens.
    pub(super) fn by_token(port: u16) -> Result<(Access, [String; 2]), SysError> {
        let tokens = [secret()?, secret()?];
        let keys = Keys {
            tokens: tokens.iter().map(|token| files::sha256_hex(token.as_bytes())).collect(),
            sessions: Vec::new(),
        };
        Ok((
            Access {
                keys: Some(Mutex::new(keys)),
                cookie_name: format!("scaleproof_{port}"),
            },
            tokens,
        ))
    }

    /// Refuses names that are no address (a hostile site's name may be made to mean this machine), and what another site's page asks.
    pub(super) fn check_site(&self, method: &Method, headers: &HeaderMap) -> Result<(), (StatusCode, &'static str)> {
        let text = |name: &str| headers.get(name).map(|value| value.to_str().unwrap_or("?"));
        let host = text(HOST.as_str()).unwrap_or_default();
        if !self.is_own(host) {
            return Err((
                StatusCode::MISDIRECTED_REQUEST,
                "ask for this page by the address that the terminal shows",
            ));
        }
        let is_other_site = text("sec-fetch-site").is_some_and(|site| !matches!(site, "same-origin" | "none"));
        let is_own_origin = text(ORIGIN.as_str()).map(|origin| origin == format!("http://{host}"));
        // Browsers name the origin of whatever changes something.
        let is_foreign = is_own_origin == Some(false) || (is_own_origin.is_none() && method != Method::GET);
        if is_other_site || is_foreign {
            Err((
                StatusCode::FORBIDDEN,
                "another site's page asked for this: type the address instead",
            ))
        } else {
            Ok(())
        }
    }

    fn is_own(&self, host: &str) -> bool {
        let name = match host.rsplit_once(':') {
            Some((name, port)) if port.bytes().all(|b| b.is_ascii_digit()) => name,
            _ => host,
        };
        let v4 = name.parse::<Ipv4Addr>();
        let v6 = name.strip_prefix('[').and_then(|rest| rest.strip_suffix(']'));
        let v6 = v6.and_then(|inner| inner.parse::<Ipv6Addr>().ok());
        match self.keys {
            _ if name == "localhost" => true,
            None => v4.is_ok_and(|ip| ip.is_loopback()) || v6.is_some_and(|ip| ip.is_loopback()),
            Some(_) => v4.is_ok() || v6.is_some(),
        }
    }

    /// Which browser asks, by a hash of the cookie that its token was exchanged for; all on this machine are one where none is needed.
    pub(super) fn browser(&self, headers: &HeaderMap) -> Option<String> {
        let Some(keys) = &self.keys else {
            return Some(String::new());
        };
        let cookies = headers.get_all(COOKIE).iter().filter_map(|value| value.to_str().ok());
        let pairs = cookies
            .flat_map(|line| line.split(';'))
            .filter_map(|pair| pair.trim().split_once('='));
        let mut hashes = pairs
            .filter(|(name, _)| *name == self.cookie_name)
            .map(|(_, value)| files::sha256_hex(value.as_bytes()));
        let keys = keys.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        hashes.find(|hash| keys.sessions.contains(hash))
    }

    /// Exchanges a token for a cookie, the whole `Set-Cookie` value. A token is good once.
    pub(super) fn join(&self, token: &str) -> Option<String> {
        let mut keys = self
            .keys
            .as_ref()?
            .lock()
            .unwrap_or_else(|poisoned| poisoned.into_inner());
        let hash = files::sha256_hex(token.as_bytes());
        let at = keys.tokens.iter().position(|known| *known == hash)?;
        let cookie = secret().ok()?;
        keys.tokens.remove(at);
        keys.sessions.push(files::sha256_hex(cookie.as_bytes()));
        Some(format!(
            "{}={cookie}; Path=/; HttpOnly; SameSite=Strict",
            self.cookie_name
        ))
    }
}

/// 128 bits of the system's randomness, hex.
fn secret() -> Result<String, SysError> {
    let mut bytes = [0; 16];
    SysRng.try_fill_bytes(&mut bytes)?;
    Ok(bytes.iter().map(|b| format!("{b:02x}")).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn headers(pairs: &[(&'static str, &str)]) -> HeaderMap {
        pairs
            .iter()
            .map(|(name, value)| (name.parse().unwrap(), value.parse().unwrap()))
            .collect()
    }

    #[test]
    fn only_addresses_of_this_machine_are_answered_and_under_lan_any_address_but_no_name() {
        let (lan, _) = Access::by_token(8710).unwrap();
        let cases = [
            ("127.0.0.1:8710", true, true),
            ("localhost:9", true, true),
            ("[::1]:8710", true, true),
            ("192.168.1.7:8710", false, true),
            ("evil.example:8710", false, false),
            ("127.0.0.1.evil.example", false, false),
            ("localhost.evil.example:80", false, false),
            ("", false, false),
            (":8710", false, false),
        ];
        for (host, locally, in_lan) in cases {
            let headers = headers(&[("host", host)]);
            let answers = [
                Access::local(),
                Access {
                    keys: Some(Mutex::default()),
                    cookie_name: String::new(),
                },
            ]
            .map(|access| access.check_site(&Method::GET, &headers).is_ok());
            assert_eq!(answers, [locally, in_lan], "{host}");
            assert_eq!(lan.check_site(&Method::GET, &headers).is_ok(), in_lan);
        }
    }

    #[test]
    fn what_another_site_asks_is_refused() {
        let access = Access::local();
        let host = ("host", "127.0.0.1:8710");
        let own = ("origin", "http://127.0.0.1:8710");
        let allowed =
            |method: Method, pairs: &[(&'static str, &str)]| access.check_site(&method, &headers(pairs)).is_ok();
        assert!(allowed(Method::POST, &[host, own, ("sec-fetch-site", "same-origin")]));
        assert!(allowed(Method::GET, &[host, ("sec-fetch-site", "none")]));
        assert!(!allowed(Method::GET, &[host, ("sec-fetch-site", "cross-site")]));
        assert!(
            !allowed(Method::GET, &[host, ("sec-fetch-site", "same-site")]),
            "another port of this machine"
        );
        assert!(!allowed(Method::POST, &[host]), "no browser leaves the origin out");
        for origin in [
            "null",
            "http://127.0.0.1:9999",
            "https://127.0.0.1:8710",
            "http://evil.example",
        ] {
            assert!(!allowed(Method::POST, &[host, ("origin", origin)]), "{origin}");
        }
    }

    #[test]
    fn a_token_is_good_once_and_its_cookie_lasts() {
        let (access, tokens) = Access::by_token(8710).unwrap();
        let (other, _) = Access::by_token(8711).unwrap();
        assert!(access.join("guess").is_none());
        let cookie = access.join(&tokens[0]).unwrap();
        assert!(access.join(&tokens[0]).is_none());
        assert!(cookie.ends_with("; HttpOnly; SameSite=Strict"));
        let pair = cookie.split(';').next().unwrap();
        let knows = |access: &Access, cookie: String| access.browser(&headers(&[("cookie", &cookie)])).is_some();
        assert!(knows(&access, format!("a=b; {pair}")));
        assert!(
            knows(&access, format!("scaleproof_8711=0; {pair}")),
            "beside another capture's"
        );
        assert!(!knows(&access, format!("{pair}0")));
        assert!(!knows(&access, format!("scaleproof_8710={}", tokens[1])));
        assert!(!knows(&other, pair.to_owned()));
    }
}
