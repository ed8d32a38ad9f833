//! The frame layer: a message arrives unchanged, or it is dropped.

use crate::messages::{controller_message, host_message};
use fivebar_firmware::drives::BrushedCommand;
use fivebar_firmware::protocol::{
    ControllerMessage, Decoder, FrameError, HostCommand, HostMessage, MAX_CONTENT, MAX_FRAME,
    Message, Sequence, encode,
};
use proptest::prelude::*;

/// All results of a decoder for these bytes.
fn decode<M: Message>(decoder: &mut Decoder<M>, bytes: &[u8]) -> Vec<Result<M, FrameError>> {
    bytes
        .iter()
        .filter_map(|&byte| decoder.feed(byte))
        .collect()
}

/// The message's frame. Messages are compared by their frames, because NaN does not equal
/// itself.
fn frame<M: Message>(message: &M) -> Vec<u8> {
    encode(message)
        .expect("every message fits a frame")
        .to_vec()
}

fn survives_garbage<M: Message>(garbage: &[u8], message: &M) -> Result<(), TestCaseError> {
    let sent = frame(message);
    let mut decoder = Decoder::<M>::new();
    decode(&mut decoder, garbage);
    let decoded = decode(&mut decoder, &sent);
    let last = decoded.last().and_then(|decoded| decoded.as_ref().ok());
    prop_assert_eq!(last.map(frame), Some(sent));
    Ok(())
}

/// Invalid bytes that resemble frames: random bytes, delimiters, parts of real frames.
fn garbage() -> impl Strategy<Value = Vec<u8>> {
    let segment = prop_oneof![
        prop::collection::vec(any::<u8>(), 0..300),
        prop::collection::vec(prop::sample::select(vec![0u8, 1, 2, 0xfe, 0xff]), 0..20),
        (host_message(), any::<prop::sample::Index>()).prop_map(|(message, cut)| {
            let whole = frame(&message);
            whole[..cut.index(whole.len())].to_vec()
        }),
        (controller_message(), any::<prop::sample::Index>()).prop_map(|(message, cut)| {
            let whole = frame(&message);
            whole[cut.index(whole.len())..].to_vec()
        }),
    ];
    prop::collection::vec(segment, 0..4).prop_map(|segments| segments.concat())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_order_survives_any_prefix_of_garbage(garbage in garbage(), message in host_message()) {
        survives_garbage(&garbage, &message)?;
    }

    #[test]
    fn any_reply_survives_any_prefix_of_garbage(
        garbage in garbage(),
        message in controller_message(),
    ) {
        survives_garbage(&garbage, &message)?;
    }

    #[test]
    fn one_changed_byte_never_makes_another_message(
        message in host_message(),
        at in any::<prop::sample::Index>(),
        change in 1u8..,
    ) {
        let sent = frame(&message);
        let whole = decode(&mut Decoder::<HostMessage>::new(), &sent);
        prop_assert_eq!(whole.iter().flatten().map(frame).collect::<Vec<_>>(), [sent.clone()]);
        let mut changed = sent.clone();
        changed[at.index(sent.len())] ^= change;
        for decoded in decode(&mut Decoder::<HostMessage>::new(), &changed).iter().flatten() {
            prop_assert_eq!(frame(decoded), sent.clone());
        }
    }

    #[test]
    fn a_lost_byte_costs_one_frame_only(
        messages in [host_message(), host_message(), host_message()],
        at in any::<prop::sample::Index>(),
    ) {
        let mut frames = messages.each_ref().map(frame);
        // Delimiters stay unchanged: a frame that lacks one of its two is still complete.
        let lost = 1 + at.index(frames[1].len() - 2);
        frames[1].remove(lost);
        let decoded: Vec<_> = decode(&mut Decoder::<HostMessage>::new(), &frames.concat())
            .iter().flatten().map(frame).collect();
        prop_assert_eq!(decoded, [frames[0].clone(), frames[2].clone()]);
    }
}

fn status_command() -> HostMessage {
    HostMessage {
        sequence: Sequence(7),
        command: HostCommand::Status,
    }
}

#[test]
fn dropped_frames_are_counted_by_their_kind() {
    let mut decoder = Decoder::<HostMessage>::new();
    let mut feed = |bytes: &[u8]| decode(&mut decoder, bytes);
    let whole = frame(&status_command());
    assert_eq!(feed(&whole), [Ok(status_command())]);

    let mut wrong = whole.clone();
    wrong[3] ^= 0x40;
    assert_eq!(feed(&wrong), [Err(FrameError::Checksum)]);
    assert_eq!(feed(&[0, 9, 1, 2, 0]), [Err(FrameError::Stuffing)]);
    assert_eq!(feed(&[0, 2, b'H', 0]), [Err(FrameError::TooShort)]);
    let endless = [&[0u8][..], &[0xff; 400], &[0]].concat();
    assert_eq!(feed(&endless), [Err(FrameError::TooLong)]);
    let echo = frame(&ControllerMessage::<BrushedCommand>::Reply {
        sequence: Sequence(7),
        reply: fivebar_firmware::protocol::Reply::Done,
    });
    assert_eq!(feed(&echo), [Err(FrameError::Sender)]);
    assert_eq!(feed(&[0, 0, 0]), []);
    assert_eq!(feed(&whole), [Ok(status_command())]);

    let counts = decoder.counts();
    assert_eq!((counts.received, counts.corrupt, counts.foreign), (2, 4, 1));
}

/// A frame with any content and a correct checksum.
fn framed(content: &[u8]) -> Vec<u8> {
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISCSI).checksum(content);
    let whole = [content, &crc.to_le_bytes()].concat();
    let mut bytes = vec![0; whole.len() + 4];
    let stuffed = cobs::encode(&whole, &mut bytes[1..]);
    bytes.truncate(1 + stuffed);
    bytes.push(0);
    bytes
}

#[test]
fn undamaged_frames_without_a_message_are_refused() {
    let mut decoder = Decoder::<HostMessage>::new();
    assert_eq!(
        decode(&mut decoder, &framed(b"H\x07\x01")),
        [Ok(status_command())]
    );
    for (content, error) in [
        (&b"H\x07\x63"[..], FrameError::Malformed), // no such command
        (&b"H\x07\x01\x00"[..], FrameError::Malformed), // surplus bytes
        (&b"H\x07"[..], FrameError::Malformed),     // missing bytes
        (&b"X\x07\x07"[..], FrameError::Sender),
        (&b""[..], FrameError::TooShort),
    ] {
        assert_eq!(decode(&mut decoder, &framed(content)), [Err(error)]);
    }
    assert_eq!(decoder.counts().foreign, 4);
}

#[test]
fn a_frame_has_room_for_the_longest_content_and_for_no_more() {
    assert_eq!(framed(&[b'H'; MAX_CONTENT - 4]).len(), MAX_FRAME);
}

#[test]
fn content_of_every_length_up_to_the_bound_is_read() {
    for length in 1..=MAX_CONTENT {
        let content = vec![b'H'; length.saturating_sub(4)];
        let decoded = decode(&mut Decoder::<HostMessage>::new(), &framed(&content));
        assert!(
            matches!(
                decoded[..],
                [Err(FrameError::Malformed | FrameError::TooShort)]
            ),
            "{length}: {decoded:?}"
        );
    }
    let decoded = decode(
        &mut Decoder::<HostMessage>::new(),
        &framed(&[b'H'; MAX_CONTENT - 3]),
    );
    assert_eq!(decoded, [Err(FrameError::TooLong)]);
}
