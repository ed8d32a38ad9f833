//! Arbitrary bytes into both ends' decoders.
#![no_main]

use fivebar_firmware::protocol::{
    ControllerMessage, Decoder, HostMessage, MAX_CONTENT, Message, encode,
};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    read::<HostMessage>(bytes);
    read::<ControllerMessage>(bytes);
    let framed = framed(bytes);
    read::<HostMessage>(&framed);
    read::<ControllerMessage>(&framed);
});

/// Reads messages, each of which must survive being written and read again.
fn read<M: Message>(bytes: &[u8]) {
    let mut decoder = Decoder::<M>::new();
    let mut ends = 0;
    for message in bytes.iter().filter_map(|&byte| decoder.feed(byte)) {
        ends += 1;
        let Ok(message) = message else { continue };
        let written = encode(&message).expect("what fitted a frame fits one again");
        let mut again = Decoder::<M>::new();
        let read = written.iter().filter_map(|&byte| again.feed(byte)).last();
        // Compared as bytes, so that NaN equals itself.
        let read = read.and_then(Result::ok).as_ref().and_then(encode);
        assert_eq!(read, Some(written));
    }
    let counts = decoder.counts();
    assert_eq!(ends, counts.received + counts.corrupt + counts.foreign);
}

/// A frame around `content`, cut to what a frame may hold, its checksum right.
fn framed(content: &[u8]) -> Vec<u8> {
    let content = &content[..content.len().min(MAX_CONTENT - 4)];
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISCSI).checksum(content);
    let whole = [content, &crc.to_le_bytes()].concat();
    let mut frame = vec![0; 1 + cobs::max_encoding_length(whole.len()) + 1];
    let stuffed = cobs::encode(&whole, &mut frame[1..]);
    frame.truncate(1 + stuffed);
    frame.push(0);
    frame
}
