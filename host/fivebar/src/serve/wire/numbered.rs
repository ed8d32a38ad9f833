//! The number that a page gives a request, so that it knows the answer to it.

use super::message::ClientRequest;
use serde::de::{Deserialize, Deserializer, Error, IntoDeserializer, MapAccess, Visitor};
use serde_json::{Map, Value};
use std::fmt::{self, Formatter};

/// The key of the number beside that of the request.
const KEY: &str = "number";

/// A request as a page sends it.
#[derive(Clone, Debug)]
pub(in crate::serve) struct NumberedRequest {
    /// The page's number for it; none: the page wants no answer.
    pub(in crate::serve) number: Option<u64>,
    pub(in crate::serve) request: ClientRequest,
}

impl<'de> Deserialize<'de> for NumberedRequest {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(Reader)
    }
}

struct Reader;

impl<'de> Visitor<'de> for Reader {
    type Value = NumberedRequest;

    fn expecting(&self, to: &mut Formatter<'_>) -> fmt::Result {
        to.write_str("the name of a request, or an object with a request and its number")
    }

    fn visit_str<E: Error>(self, name: &str) -> Result<NumberedRequest, E> {
        let request = ClientRequest::deserialize(name.into_deserializer())?;
        let number = None;
        Ok(NumberedRequest { number, request })
    }

    fn visit_map<M: MapAccess<'de>>(self, mut map: M) -> Result<NumberedRequest, M::Error> {
        let (mut number, mut request) = (None, None);
        while let Some(key) = map.next_key::<String>()? {
            if key == KEY {
                if number.replace(map.next_value()?).is_some() {
                    return Err(Error::duplicate_field(KEY));
                }
            } else if request.is_some() {
                return Err(Error::custom("one request a message, beside its number"));
            } else {
                let one = Map::from_iter([(key, map.next_value()?)]);
                let read = ClientRequest::deserialize(Value::Object(one));
                request = Some(read.map_err(Error::custom)?);
            }
        }
        let request = request.ok_or_else(|| Error::custom("there is no request"))?;
        Ok(NumberedRequest { number, request })
    }
}

#[cfg(test)]
mod tests {
    use super::{ClientRequest, NumberedRequest};

    fn read(text: &str) -> Result<NumberedRequest, String> {
        serde_json::from_str(text).map_err(|error| error.to_string())
    }

    #[test]
    fn a_request_has_its_number_before_or_behind_it_or_none() {
        for (text, number) in [
            (r#"{"jog": [0.1, 0]}"#, None),
            (r#"{"jog": [0.1, 0], "number": 7}"#, Some(7)),
            (
                r#"{"number": 18446744073709551615, "jog": [0.1, 0]}"#,
                Some(u64::MAX),
            ),
        ] {
            let read = read(text).expect(text);
            assert_eq!(read.number, number);
            assert!(
                matches!(read.request, ClientRequest::Jog([0.1, 0.0])),
                "{text}"
            );
        }
    }

    #[test]
    fn a_request_without_content_has_a_number_beside_null() {
        let named = read(r#""control""#).unwrap();
        assert!(matches!(named.request, ClientRequest::Control) && named.number.is_none());
        let numbered = read(r#"{"control": null, "number": 3}"#).unwrap();
        assert!(matches!(numbered.request, ClientRequest::Control) && numbered.number == Some(3));
    }

    #[test]
    fn two_requests_two_numbers_and_numbers_that_are_none_are_refused() {
        for text in [
            r#"{"jog": [0.1, 0], "run": null}"#,
            r#"{"jog": [0.1, 0], "jog": [0.2, 0]}"#,
            r#"{"jog": [0.1, 0], "number": 7, "number": 8}"#,
            r#"{"jog": [0.1, 0], "number": -1}"#,
            r#"{"jog": [0.1, 0], "number": null}"#,
            r#"{"jog": [0.1, 0], "numbers": 1}"#,
            r#"{"number": 7}"#,
            "{}",
            "7",
        ] {
            assert!(read(text).is_err(), "{text}");
        }
    }
}
