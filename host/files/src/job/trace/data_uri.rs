//! Pictures as text, because a job is one: a data URI with the bytes in Base64, as browsers write it.

use crate::picture::media_type;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;

/// The bytes of a picture as the text of a job; none of another file.
pub(in crate::job) fn as_text(bytes: &[u8]) -> Option<String> {
    let kind = media_type(bytes)?;
    Some(format!("data:{kind};base64,{}", BASE64.encode(bytes)))
}

/// Whether a text is a picture's.
pub(in crate::job) fn is_picture(text: &str) -> bool {
    encoded(text).is_some()
}

fn encoded(text: &str) -> Option<&str> {
    ["data:image/png;base64,", "data:image/jpeg;base64,"]
        .iter()
        .find_map(|start| text.strip_prefix(start))
}

/// The bytes of a picture's text.
pub(super) fn bytes(text: &str) -> Result<Vec<u8>, String> {
    let encoded = encoded(text).unwrap_or_default().trim_end();
    BASE64
        .decode(encoded)
        .map_err(|error| format!("the picture's text is damaged ({error}): open its file again"))
}
