//! Random messages of pages: each is read or refused in a short text, and none panics.

use super::received::{Received, receive, text_frame};
use super::wire::message::brief;
use super::wire::numbered::NumberedRequest;
use proptest::prelude::*;

const DOCUMENT: &str = include_str!("../../../../docs/use/live-page.md");

/// Greatest length of the text of a refusal [characters].
const LONGEST: usize = 301;

/// Parts of messages, whole and broken.
const PARTS: [&str; 40] = [
    "{",
    "}",
    "[",
    "]",
    ",",
    ":",
    "\"",
    "\\",
    "\"alive\"",
    "\"control\"",
    "\"run\"",
    "\"request\"",
    "\"arm\"",
    "\"stop\"",
    "\"emergency_stop\"",
    "\"jog\"",
    "\"follow\"",
    "\"jog_joint\"",
    "\"turn\"",
    "\"joint\"",
    "\"theta1\"",
    "\"by\"",
    "\"to\"",
    "\"mode\"",
    "\"left\"",
    "\"load\"",
    "\"name\"",
    "\"text\"",
    "0.1",
    "-0",
    "1e308",
    "1e400",
    "-1e-400",
    "NaN",
    "null",
    "true",
    " ",
    "\"\\u0000\"",
    "\"\\ud800\"",
    "\u{fffd}",
];

/// The examples of the document.
fn examples() -> Vec<String> {
    let (_, rest) = DOCUMENT.split_once("```json\n").unwrap();
    let (examples, _) = rest.split_once("```").unwrap();
    examples.lines().map(str::to_owned).collect()
}

/// Whether the message was read.
fn read(text: &str) -> bool {
    match serde_json::from_str::<NumberedRequest>(text) {
        Ok(request) => {
            // Requests are copied between threads, and shown when something fails.
            assert!(!format!("{:?}", request.clone()).is_empty());
            true
        }
        Err(error) => {
            assert!(brief(error.to_string()).chars().count() <= LONGEST);
            false
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn any_parts_of_messages_are_read_or_refused(
        parts in prop::collection::vec(prop::sample::select(PARTS.to_vec()), 0..40),
    ) {
        read(&parts.concat());
    }

    #[test]
    fn an_example_with_a_part_in_a_random_place_is_read_or_refused(
        example in prop::sample::select(examples()),
        part in prop::sample::select(PARTS.to_vec()),
        place in any::<prop::sample::Index>(),
        replaced in any::<bool>(),
    ) {
        prop_assert!(read(&example));
        let places: Vec<_> = example.char_indices().map(|(at, _)| at).collect();
        let at = *place.get(&places);
        let (before, after) = example.split_at(at);
        let after = if replaced { after.get(1..).unwrap_or("") } else { after };
        read(&format!("{before}{part}{after}"));
    }
}

#[test]
fn a_message_nested_deeply_is_refused() {
    for (open, close) in [("[", "]"), ("{\"jog\":", "}")] {
        let depth = 100_000;
        assert!(!read(&(open.repeat(depth) + "1" + &close.repeat(depth))));
    }
}

#[test]
fn all_that_a_page_sends_is_received() {
    let mut bytes = Vec::new();
    for text in [
        r#""run""#,
        r#"{"request": "emergency_stop"}"#,
        r#"{"request": "stop"}"#,
        "no request",
        r#"{"jog": [0.001, 0.0]}"#,
    ] {
        bytes.extend(text_frame(text.as_bytes()));
    }
    bytes.extend(text_frame(&vec![b'x'; 70_000]));
    let expected = Received {
        requests: 3,
        stops: 2,
        refusals: 1,
        reason: None,
    };
    assert_eq!(receive(&bytes), expected);
    let stops = text_frame(br#"{"request": "stop"}"#).repeat(2000);
    let received = receive(&stops);
    assert_eq!(received.stops, 1000);
    let reason = received.reason.expect("it is disconnected");
    assert!(
        reason.contains("messages or frames in a second"),
        "{reason}"
    );
}

proptest! {
    #[test]
    fn any_frames_of_a_page_leave_no_trace(
        frames in prop::collection::vec(
            (any::<u8>(), any::<u8>(), prop::collection::vec(any::<u8>(), 0..40), any::<bool>()),
            0..30,
        ),
    ) {
        let mut bytes = Vec::new();
        for (first, second, content, whole) in frames {
            if whole {
                bytes.extend(text_frame(&content));
            } else {
                bytes.extend([first, second]);
                bytes.extend(content);
            }
        }
        receive(&bytes);
    }
}
