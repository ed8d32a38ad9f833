//! Who may connect: it moves a machine.

use axum::http::{HeaderMap, StatusCode, Uri, header};
use std::net::IpAddr;
use subtle::ConstantTimeEq as _;

/// What a request must show. Away from the loopback address, a token.
#[derive(Clone, Debug)]
pub struct Guard {
    token: Option<String>,
}

/// What is to be done with a request that may come in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Admission {
    /// It is served.
    Serve,
    /// It has shown the token for the first time: it is given this cookie and sent to `/`.
    Welcome {
        /// The value of `Set-Cookie`.
        cookie: String,
    },
}

impl Guard {
    /// No token: for the loopback address, which only this machine reaches.
    pub fn of_loopback() -> Self {
        Self { token: None }
    }

    /// A token of 128 random bits, to be shown as `?token=` by who comes first.
    ///
    /// # Errors
    /// The system has no random numbers.
    pub fn with_new_token() -> Result<Self, getrandom::Error> {
        let token = format!("{:016x}{:016x}", getrandom::u64()?, getrandom::u64()?);
        Ok(Self { token: Some(token) })
    }

    /// The token, where there is one.
    pub fn token(&self) -> Option<&str> {
        self.token.as_deref()
    }

    /// Whether a request may be served.
    ///
    /// A page of another site that reaches for this server gives itself away by its
    /// `Origin`; one that has its own name lead here (DNS rebinding), by its `Host`. The
    /// token comes once in the address that was printed and from then on in a cookie, so
    /// that it stands in no history and in no address that is passed on.
    ///
    /// # Errors
    /// The status to answer with, and why.
    pub(super) fn admit(
        &self,
        uri: &Uri,
        headers: &HeaderMap,
    ) -> Result<Admission, (StatusCode, &'static str)> {
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
        let Some(token) = &self.token else {
            return Ok(Admission::Serve);
        };
        let name = cookie_name(host);
        let cookies = headers.get_all(header::COOKIE).iter();
        let mut cookies = cookies.flat_map(|line| line.to_str().unwrap_or("").split("; "));
        if cookies.any(|cookie| is_value(cookie, &name, token)) {
            return Ok(Admission::Serve);
        }
        let mut shown = uri.query().unwrap_or("").split('&');
        if uri.path() == "/" && shown.any(|pair| is_value(pair, "token", token)) {
            let cookie = format!("{name}={token}; HttpOnly; SameSite=Lax; Path=/");
            return Ok(Admission::Welcome { cookie });
        }
        Err((
            StatusCode::UNAUTHORIZED,
            "refused: open the address with ?token= that `fivebar serve` printed\n",
        ))
    }
}

/// Cookies are shared by the ports of a host; servers at several ports are not.
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

    fn status(guard: &Guard, uri: &str, host: &str, origin: Option<&str>) -> Option<StatusCode> {
        let mut headers = HeaderMap::new();
        headers.insert(header::HOST, HeaderValue::from_str(host).unwrap());
        if let Some(origin) = origin {
            headers.insert(header::ORIGIN, HeaderValue::from_str(origin).unwrap());
        }
        let uri: Uri = uri.parse().unwrap();
        guard.admit(&uri, &headers).err().map(|(status, _)| status)
    }

    #[test]
    fn its_own_pages_are_served_and_foreign_ones_refused() {
        let guard = Guard::of_loopback();
        for host in [
            "127.0.0.1:8080",
            "localhost:8080",
            "[::1]:8080",
            "localhost",
        ] {
            assert_eq!(status(&guard, "/live", host, None), None, "{host}");
            let own = format!("http://{host}");
            assert_eq!(status(&guard, "/live", host, Some(&own)), None, "{host}");
            for foreign in ["http://example.org", "https://localhost", "null", ""] {
                let refusal = status(&guard, "/live", host, Some(foreign));
                assert_eq!(refusal, Some(StatusCode::FORBIDDEN), "{foreign} at {host}");
            }
        }
        for name in [
            "example.org:8080",
            "localhost.example.org",
            "127.0.0.1.nip.io",
            "",
        ] {
            let refusal = status(&guard, "/", name, Some(&format!("http://{name}")));
            assert_eq!(refusal, Some(StatusCode::FORBIDDEN), "{name}");
        }
    }

    #[test]
    fn a_token_is_asked_for_where_there_is_one() {
        let guard = Guard::with_new_token().unwrap();
        let token = guard.token().unwrap();
        assert_eq!(token.len(), 32);
        let host = "192.168.0.7:8080";
        let prefix = token.split_at(31).0;
        for wrong in [
            "/",
            "/?token=",
            &format!("/?token={prefix}"),
            &format!("/?token={token}0"),
            &format!("/?nottoken={token}"),
            &format!("/live?token={token}"),
        ] {
            let refusal = status(&guard, wrong, host, None);
            assert_eq!(refusal, Some(StatusCode::UNAUTHORIZED), "{wrong}");
        }
        assert_eq!(
            status(&guard, &format!("/?a=b&token={token}"), host, None),
            None
        );
    }

    #[test]
    fn the_token_is_changed_into_a_cookie_that_opens_everything_at_this_port() {
        let guard = Guard::with_new_token().unwrap();
        let token = guard.token().unwrap();
        let admit = |uri: &str, host: &str, cookie: &str| {
            let mut headers = HeaderMap::new();
            headers.insert(header::HOST, HeaderValue::from_str(host).unwrap());
            headers.insert(header::COOKIE, HeaderValue::from_str(cookie).unwrap());
            guard.admit(&uri.parse().unwrap(), &headers)
        };
        let (here, there) = ("192.168.0.7:8080", "192.168.0.7:8081");
        let Ok(Admission::Welcome { cookie }) = admit(&format!("/?token={token}"), here, "") else {
            panic!("the token is right");
        };
        let (pair, attributes) = cookie.split_once("; ").unwrap();
        assert!(attributes.contains("HttpOnly") && attributes.contains("SameSite=Lax"));
        let among_others = format!("a=b; {pair}");
        assert_eq!(admit("/live", here, &among_others), Ok(Admission::Serve));
        assert!(
            admit("/live", there, pair).is_err(),
            "another server's cookie"
        );
        assert!(admit("/live", here, &pair[..pair.len() - 1]).is_err());
    }
}
