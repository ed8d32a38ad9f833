//! The sender slot of the live page's server.

use super::rig::{Caller, Rig};
use crate::bridge::page_senders::PageSenders;
use crate::bridge::slot::Phase;
use crate::senders::{Endpoints, Senders as _};
use fivebar_firmware::safety::{Fault, State};
use fivebar_sim::controller::Session;
use std::sync::Weak;

/// The slot of a rig with a homed arm, and its sender, which is in control and draws.
fn drawing() -> (PageSenders, Session, Caller) {
    let mut rig = Rig::homed();
    let sender = rig.drawing();
    let desk = rig.desk.clone();
    let (slot, session, notes) = rig.into_parts();
    let endpoints = Endpoints {
        address: None,
        terminal: Some("/dev/pts/7".into()),
        place: "a test".into(),
    };
    let senders = PageSenders {
        slot,
        endpoints: Some(endpoints),
        notes,
        desk,
        console: Weak::new(),
    };
    (senders, session, sender)
}

#[test]
fn a_page_holds_the_path_of_a_sender_which_can_go_on() {
    let (mut senders, mut session, sender) = drawing();
    senders.hold(&mut session).unwrap();
    assert!(matches!(senders.slot.phase, Phase::Holding { .. }));
    sender.say("~");
    while senders.slot.phase != Phase::Ready {
        assert!(senders.serve(&mut session, false).unwrap());
        session.pass_time().unwrap();
    }
}

#[test]
fn after_a_pages_emergency_stop_the_sender_waits_before_it_clears_it() {
    let (mut senders, mut session, sender) = drawing();
    senders.emergency_stop(&mut session).unwrap();
    assert_eq!(session.status.fault, Some(Fault::EmergencyStop));
    assert!(senders.slot.path.queue.is_empty());
    sender.say("$X\n");
    for _ in 0..5 {
        senders.serve(&mut session, false).unwrap();
        session.pass_time().unwrap();
    }
    sender.wait_for("emergency stop is latched: wait ");
    assert_eq!(session.status.state, State::Fault);
}

#[test]
fn a_page_learns_who_is_in_control_and_what_senders_do() {
    let (mut senders, mut session, sender) = drawing();
    let endpoints = senders.endpoints().expect("endpoints");
    assert_eq!(endpoints.terminal.as_deref(), Some("/dev/pts/7"));
    assert!(senders.is_in_control());
    assert!(senders.serve(&mut session, false).unwrap());
    let note = senders.take_note();
    assert_eq!(note.as_deref(), Some("a sender is connected: a test"));
    assert_eq!(senders.take_note(), None);
    sender.hang_up();
    while senders.serve(&mut session, false).unwrap() {
        session.pass_time().unwrap();
    }
    assert!(!senders.is_in_control());
}

#[test]
fn a_sender_is_admitted_when_the_page_says_so() {
    for admits in [false, true] {
        let rig = Rig::homed();
        let sender = rig.call();
        let desk = rig.desk.clone();
        let (slot, mut session, notes) = rig.into_parts();
        let mut senders = PageSenders {
            slot,
            endpoints: None,
            notes,
            desk,
            console: Weak::new(),
        };
        while !sender.is_closed() && !senders.is_in_control() {
            let served = senders.serve(&mut session, admits).unwrap();
            assert_eq!(served, senders.is_in_control());
            session.pass_time().unwrap();
        }
        assert_eq!(senders.is_in_control(), admits);
    }
}
