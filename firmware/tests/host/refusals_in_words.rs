//! Every refusal says what is wrong.

use fivebar_firmware::controller::RequestError;
use fivebar_firmware::safety::{Fault, State};

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
    for (number, text) in texts.iter().enumerate() {
        assert!(text.split(' ').count() > 3, "{text}");
        assert!(!texts[..number].contains(text), "{text}");
    }
}

#[test]
fn an_unknown_fault_names_its_number() {
    let unknown = Fault::try_from(200_u8).expect_err("no such fault");
    assert_eq!(unknown.to_string(), "no fault has the number 200");
}
