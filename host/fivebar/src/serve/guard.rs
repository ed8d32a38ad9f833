//! Decides which web requests are served, because the page moves a machine.

use axum::http::{HeaderMap, StatusCode, Uri, header};
use std::net::IpAddr;
use subtle::ConstantTimeEq as _;

/// The access rules of the server. Every request needs a token, on the loopback address too:
/// other users of this computer reach it.
#[derive(Clone, Debug)]
pub struct Guard {
    token: String,
}

/// How to answer a request that is allowed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Admission {
    /// Serve it.
    Serve,
    /// It brings the token in its address: set this cookie and redirect it to `/`.
    SetCookie {
        /// The value of `Set-Cookie`.
        cookie: String,
    },
}

impl Guard {
    /// A token of 128 random bits, which the first request brings as `?token=`.
    ///
    /// # Errors
    /// The system gives no random numbers.
    pub fn with_new_token() -> Result<Self, getrandom::Error> {
        let token = format!("{:016x}{:016x}", getrandom::u64()?, getrandom::u64()?);
        Ok(Self { token })
    }

    /// The token.
    pub fn token(&self) -> &str {
        &self.token
    }

    /// Whether a request may be served.
    ///
    /// The header `Origin` shows a page of another site, and `Host` shows a foreign name
    /// that was made to lead to this server (DNS rebinding). The token comes once in the
    /// printed address and afterwards in a cookie, so that no browser history and no copied
    /// address contains it.
    ///
    /// A request with two such headers is refused: whoever checks it before this server might
    /// look at the other one.
    ///
    /// # Errors
    /// The status and the reason to answer with.
    pub(super) fn authorize(
        &self,
        uri: &Uri,
        headers: &HeaderMap,
    ) -> Result<Admission, (StatusCode, &'static str)> {
        for name in [header::HOST, header::ORIGIN] {
            if headers.get_all(name).iter().count() > 1 {
                return Err((
                    StatusCode::BAD_REQUEST,
                    "refused: this request has two headers Host or Origin\n",
                ));
            }
        }
        let text = |name| headers.get(name).map(|value| value.to_str().unwrap_or(""));
        let host = text(header::HOST).unwrap_or("");
        if !is_address_or_localhost(host) {
            return Err((
                StatusCode::FORBIDDEN,
                "refused: reach this page by its address or as localhost, not by another name\n",
            ));
        }
        if let Some(origin) = text(header::ORIGIN)
            && origin.strip_prefix("http://") != Some(host)
        {
            return Err((
                StatusCode::FORBIDDEN,
                "refused: this request comes from a page of another origin\n",
            ));
        }
        let token = &self.token;
        let name = cookie_name(host);
        let cookies = headers.get_all(header::COOKIE).iter();
        let mut cookies = cookies.flat_map(|line| line.to_str().unwrap_or("").split("; "));
        if cookies.any(|cookie| is_value(cookie, &name, token)) {
            return Ok(Admission::Serve);
        }
        let mut shown = uri.query().unwrap_or("").split('&');
        if uri.path() == "/" && shown.any(|pair| is_value(pair, "token", token)) {
            let cookie = format!("{name}={token}; HttpOnly; SameSite=Lax; Path=/");
            return Ok(Admission::SetCookie { cookie });
        }
        Err((
            StatusCode::UNAUTHORIZED,
            "refused: open the address with ?token= that `fivebar serve` printed\n",
        ))
    }
}

/// A name for each port: browsers send the cookies of a host to all its ports, but each
/// server has its own token.
fn cookie_name(host: &str) -> String {
    let port = host.rsplit(':').next().filter(|port| is_number(port));
    format!("fivebar{}", port.unwrap_or("80"))
}

/// Whether `pair` is `name=value`, found in a time that does not tell how much of the
/// value is right.
fn is_value(pair: &str, name: &str, value: &str) -> bool {
    let shown = pair
        .strip_prefix(name)
        .and_then(|rest| rest.strip_prefix('='));
    shown.is_some_and(|shown| shown.as_bytes().ct_eq(value.as_bytes()).into())
}

fn is_address_or_localhost(host: &str) -> bool {
    let port = |text: &str| text.is_empty() || text.strip_prefix(':').is_some_and(is_number);
    if let Some(rest) = host.strip_prefix("localhost") {
        return port(rest);
    }
    if let Some((address, rest)) = host.strip_prefix('[').and_then(|h| h.split_once(']')) {
        return port(rest) && address.parse::<IpAddr>().is_ok_and(|ip| ip.is_ipv6());
    }
    let (address, rest) = host.split_at(host.find(':').unwrap_or(host.len()));
    port(rest) && address.parse::<IpAddr>().is_ok()
}

fn is_number(text: &str) -> bool {
    text.parse::<u16>().is_ok()
}

#[cfg(test)]
mod tests {
    use super::{Admission, Guard};
    use axum::http::{HeaderMap, HeaderValue, StatusCode, Uri, header};

    fn headers(pairs: &[(header::HeaderName, &str)]) -> HeaderMap {
        let mut headers = HeaderMap::new();
        for (name, value) in pairs {
            headers.append(name, HeaderValue::from_str(value).unwrap());
        }
        headers
    }

    fn refusal(guard: &Guard, uri: &str, headers: &HeaderMap) -> Option<StatusCode> {
        let uri: Uri = uri.parse().unwrap();
        let refusal = guard.authorize(&uri, headers).err();
        refusal.map(|(status, _)| status)
    }

    /// The refusal of a request from an address that has the token's cookie.
    fn known(guard: &Guard, host: &str, origin: Option<&str>) -> Option<StatusCode> {
        let cookie = format!("{}={}", super::cookie_name(host), guard.token());
        let mut pairs = vec![(header::HOST, host), (header::COOKIE, &cookie)];
        pairs.extend(origin.map(|origin| (header::ORIGIN, origin)));
        refusal(guard, "/live", &headers(&pairs))
    }

    #[test]
    fn a_request_with_two_hosts_or_origins_is_refused() {
        let guard = Guard::with_new_token().unwrap();
        let host = "127.0.0.1:8080";
        let cookie = format!("fivebar8080={}", guard.token());
        let one = [(header::HOST, host), (header::COOKIE, &cookie)];
        assert_eq!(refusal(&guard, "/", &headers(&one)), None);
        for second in [
            (header::HOST, host),
            (header::HOST, "example.org"),
            (header::HOST, ""),
        ] {
            let two = headers(&[one[0].clone(), one[1].clone(), second]);
            assert_eq!(refusal(&guard, "/", &two), Some(StatusCode::BAD_REQUEST));
        }
        let own = "http://127.0.0.1:8080";
        let mut origins = headers(&one);
        for origin in [own, "http://example.org"] {
            origins.append(header::ORIGIN, HeaderValue::from_str(origin).unwrap());
        }
        assert_eq!(
            refusal(&guard, "/", &origins),
            Some(StatusCode::BAD_REQUEST)
        );
    }

    #[test]
    fn own_pages_are_served_and_pages_of_other_origins_are_refused() {
        let guard = Guard::with_new_token().unwrap();
        for host in [
            "127.0.0.1:8080",
            "localhost:8080",
            "[::1]:8080",
            "localhost",
        ] {
            assert_eq!(known(&guard, host, None), None, "{host}");
            let own = format!("http://{host}");
            assert_eq!(known(&guard, host, Some(&own)), None, "{host}");
            for foreign in ["http://example.org", "https://localhost", "null", ""] {
                let refusal = known(&guard, host, Some(foreign));
                assert_eq!(refusal, Some(StatusCode::FORBIDDEN), "{foreign} at {host}");
            }
        }
        for name in [
            "example.org:8080",
            "localhost.example.org",
            "127.0.0.1.nip.io",
            "localhost:http",
            "127.0.0.1:80800",
            "[::1]:http",
            "[127.0.0.1]:8080",
            "[example.org]",
            "",
        ] {
            let refusal = known(&guard, name, Some(&format!("http://{name}")));
            assert_eq!(refusal, Some(StatusCode::FORBIDDEN), "{name}");
        }
    }

    #[test]
    fn requests_without_the_right_token_are_refused() {
        let guard = Guard::with_new_token().unwrap();
        let token = guard.token();
        assert_eq!(token.len(), 32);
        let host = |host: &str| headers(&[(header::HOST, host)]);
        let [host, own] = [host("192.168.0.7:8080"), host("127.0.0.1:8080")];
        let prefix = token.split_at(31).0;
        for wrong in [
            "/",
            "/?token=",
            &format!("/?token={prefix}"),
            &format!("/?token={token}0"),
            &format!("/?nottoken={token}"),
            &format!("/live?token={token}"),
        ] {
            for host in [&host, &own] {
                let refusal = refusal(&guard, wrong, host);
                assert_eq!(refusal, Some(StatusCode::UNAUTHORIZED), "{wrong}");
            }
        }
        assert_eq!(
            refusal(&guard, &format!("/?a=b&token={token}"), &host),
            None
        );
    }

    #[test]
    fn the_token_becomes_a_cookie_that_is_valid_for_this_port_only() {
        let guard = Guard::with_new_token().unwrap();
        let token = guard.token();
        let authorize = |uri: &str, host: &str, cookie: &str| {
            let mut headers = HeaderMap::new();
            headers.insert(header::HOST, HeaderValue::from_str(host).unwrap());
            headers.insert(header::COOKIE, HeaderValue::from_str(cookie).unwrap());
            guard.authorize(&uri.parse().unwrap(), &headers)
        };
        let (here, there) = ("192.168.0.7:8080", "192.168.0.7:8081");
        let Ok(Admission::SetCookie { cookie }) = authorize(&format!("/?token={token}"), here, "")
        else {
            panic!("the token is right");
        };
        let (pair, attributes) = cookie.split_once("; ").unwrap();
        assert!(attributes.contains("HttpOnly") && attributes.contains("SameSite=Lax"));
        let among_others = format!("a=b; {pair}");
        assert_eq!(
            authorize("/live", here, &among_others),
            Ok(Admission::Serve)
        );
        assert!(
            authorize("/live", there, pair).is_err(),
            "another server's cookie"
        );
        assert!(authorize("/live", here, &pair[..pair.len() - 1]).is_err());
    }
}
