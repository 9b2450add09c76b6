//! Who may ask the page for something.

use axum::http::{HeaderMap, Method};
use scaleproof_capture::page::access::{Access, Scheme};

fn headers(pairs: &[(&'static str, &str)]) -> HeaderMap {
    pairs
        .iter()
        .map(|(name, value)| (name.parse().unwrap(), value.parse().unwrap()))
        .collect()
}

#[test]
fn only_addresses_of_this_machine_are_answered_and_under_lan_any_address_but_no_name() {
    let (lan, _) = Access::in_network(8710).unwrap();
    let (local, _) = Access::local(8710).unwrap();
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
        let answers = [&local, &lan].map(|access| access.check_site(&Method::GET, &headers, Scheme::Http).is_ok());
        assert_eq!(answers, [locally, in_lan], "{host}");
    }
}

#[test]
fn what_another_site_asks_is_refused() {
    let (access, _) = Access::local(8710).unwrap();
    let host = ("host", "127.0.0.1:8710");
    let own = ("origin", "http://127.0.0.1:8710");
    let came = |scheme: Scheme, method: Method, pairs: &[(&'static str, &str)]| {
        access.check_site(&method, &headers(pairs), scheme).is_ok()
    };
    let allowed = |method: Method, pairs: &[(&'static str, &str)]| came(Scheme::Http, method, pairs);
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
    // What came over TLS, a page of TLS asked for.
    assert!(!came(Scheme::Https, Method::POST, &[host, own]));
    let own = ("origin", "https://127.0.0.1:8710");
    assert!(came(Scheme::Https, Method::POST, &[host, own]));
}

#[test]
fn a_token_is_good_once_and_its_cookie_lasts() {
    let (access, tokens) = Access::in_network(8710).unwrap();
    let (other, _) = Access::in_network(8711).unwrap();
    assert!(access.join("guess", Scheme::Http).is_none());
    let cookie = access.join(&tokens[0], Scheme::Http).unwrap();
    assert!(access.join(&tokens[0], Scheme::Http).is_none());
    assert!(cookie.ends_with("; HttpOnly; SameSite=Strict"));
    let encrypted = access.join(&tokens[1], Scheme::Https).unwrap();
    assert!(encrypted.ends_with("; HttpOnly; SameSite=Strict; Secure"));
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

/// Other accounts of this machine reach the port, too.
#[test]
fn nobody_on_this_machine_is_known_without_the_token() {
    let (access, token) = Access::local(8710).unwrap();
    assert!(access.browser(&headers(&[])).is_none());
    assert!(access.browser(&headers(&[("cookie", "scaleproof_8710=")])).is_none());
    let cookie = access.join(&token, Scheme::Http).unwrap();
    let pair = cookie.split(';').next().unwrap();
    assert!(access.browser(&headers(&[("cookie", pair)])).is_some());
    assert!(access.join(&token, Scheme::Http).is_none(), "it is good once");
}
