//! Every refusal says what is wrong.

use fivebar_firmware::controller::RequestError;
use fivebar_firmware::planner::{MoveError, MoveErrorKind};
use fivebar_firmware::planner::{StreamError, StreamReason};
use fivebar_firmware::protocol::{CommandError, FrameError, Sequence};
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::storage::StorageError;

#[test]
fn every_refused_request_reads_as_a_sentence() {
    let texts = [
        RequestError::State(State::Running),
        RequestError::NotHomed,
        RequestError::OutsideLimits,
        RequestError::NearSingularity,
        RequestError::NotOnBranch,
        RequestError::Moving,
    ]
    .map(|error| error.to_string());
    assert_eq!(texts[0], "it is not possible while Running");
    differ(&texts);
}

#[test]
fn every_end_of_a_stream_reads_as_a_sentence() {
    let begun = [
        StreamError::State(State::Stopped),
        StreamError::Moving,
        StreamError::Rate,
        StreamError::NoTorque,
        StreamError::Belts,
        StreamError::LateTorque,
        StreamError::NoImpedance,
        StreamError::Matrix,
        StreamError::Fixture(2),
        StreamError::Stiffness(250.0),
        StreamError::Damping(0.125),
    ];
    differ(&begun.map(|error| error.to_string()));
    let texts = [
        StreamReason::Asked,
        StreamReason::Stopped,
        StreamReason::Late,
        StreamReason::Number,
        StreamReason::Early,
        StreamReason::Order,
        StreamReason::Full,
        StreamReason::Gap,
        StreamReason::Away(0.25),
        StreamReason::Limit(MoveErrorKind::Overload(4)),
        StreamReason::Silent,
        StreamReason::Force,
    ]
    .map(|reason| reason.to_string());
    differ(&texts);
    assert!(texts[8].contains("0.25"), "{}", texts[8]);
    assert!(texts[9].contains("joint 4"), "{}", texts[9]);
}

#[test]
fn an_unknown_fault_names_its_number() {
    let unknown = Fault::try_from(200_u8).expect_err("no such fault");
    assert_eq!(unknown.to_string(), "no fault has the number 200");
}

/// Each text says something, and something else than the ones before.
fn differ(texts: &[String]) {
    for (number, text) in texts.iter().enumerate() {
        assert!(text.split(' ').count() > 3, "{text}");
        assert!(!texts[..number].contains(text), "{text}");
    }
}

#[test]
fn every_damage_of_a_frame_reads_as_a_sentence() {
    let texts = [
        FrameError::Stuffing,
        FrameError::TooLong,
        FrameError::TooShort,
        FrameError::Checksum,
        FrameError::Sender,
        FrameError::Malformed,
    ]
    .map(|error| error.to_string());
    differ(&texts);
    assert_eq!(texts[3], "the checksum does not fit the content");
}

#[test]
fn every_refused_command_says_what_is_wrong_in_the_words_of_its_cause() {
    let refused_move = MoveError {
        tag: 1,
        kind: MoveErrorKind::Full,
        point: None,
    };
    let texts = [
        CommandError::Version(3),
        CommandError::NoSession,
        CommandError::OutOfSequence(Sequence(41)),
        CommandError::Unsupported,
        CommandError::Request(RequestError::NotHomed),
        CommandError::Move(refused_move),
        CommandError::NoSettings,
        CommandError::NoSection,
        CommandError::Settings,
        CommandError::Storage(StorageError::Blank),
        CommandError::Storage(StorageError::Corrupt),
        CommandError::Storage(StorageError::Flash),
        CommandError::Storage(StorageError::Range),
    ]
    .map(|error| error.to_string());
    differ(&texts);
    assert_eq!(texts[2], "it expects command number 41");
    assert_eq!(texts[4], RequestError::NotHomed.to_string());
    assert_eq!(texts[5], "the queue is full");
    let stored = StorageError::Corrupt.to_string();
    assert_eq!(texts[10], format!("the settings were not stored: {stored}"));
}
