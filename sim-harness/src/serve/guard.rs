//! Who may connect: it moves a machine.

use axum::http::{HeaderMap, StatusCode, Uri, header};
use std::net::IpAddr;

/// What a request must show. Away from the loopback address, a token.
#[derive(Clone, Debug)]
pub struct Guard {
    token: Option<String>,
}

impl Guard {
    /// No token: for the loopback address, which only this machine reaches.
    pub fn of_loopback() -> Self {
        Self { token: None }
    }

    /// A token of 128 random bits, to be shown as `?token=` by every request.
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
    /// `Origin`; one that has its own name lead here (DNS rebinding), by its `Host`.
    ///
    /// # Errors
    /// The status to answer with, and why.
    pub(super) fn admit(
        &self,
        uri: &Uri,
        headers: &HeaderMap,
    ) -> Result<(), (StatusCode, &'static str)> {
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
            return Ok(());
        };
        let shown = uri.query().unwrap_or("").split('&');
        let mut shown = shown.filter_map(|pair| pair.strip_prefix("token="));
        if shown.any(|shown| same(shown.as_bytes(), token.as_bytes())) {
            Ok(())
        } else {
            Err((
                StatusCode::UNAUTHORIZED,
                "refused: open the address with ?token= that `fivebar serve` printed\n",
            ))
        }
    }
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

/// Equality in a time that does not tell how much of the guess is right.
fn same(shown: &[u8], token: &[u8]) -> bool {
    let differing = shown
        .iter()
        .zip(token)
        .fold(0, |bits, (a, b)| bits | (a ^ b));
    shown.len() == token.len() && differing == 0
}

#[cfg(test)]
mod tests {
    use super::Guard;
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
        let at = |uri: &str| status(&guard, uri, "192.168.0.7:8080", None);
        assert_eq!(at(&format!("/?token={token}")), None);
        assert_eq!(at(&format!("/?mode=x&token={token}")), None);
        let prefix = token.split_at(31).0;
        for wrong in [
            "/",
            "/?token=",
            &format!("/?token={prefix}"),
            &format!("/?token={token}0"),
        ] {
            assert_eq!(at(wrong), Some(StatusCode::UNAUTHORIZED), "{wrong}");
        }
    }
}
