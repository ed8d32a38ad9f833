//! The time that frames take on the bus: the stated bound against frames that are put together bit by bit.

use fivebar_firmware::drives::can::mit::{Command, Ranges};
use fivebar_firmware::drives::can::{Frame, MOST_LOAD, Protocol, most_load, odrive};
use fivebar_plant::bits_on_bus as bits;
use proptest::prelude::*;

proptest! {
    #[test]
    fn no_frame_takes_longer_than_stated(id in 0_u16..0x800, data in any::<[u8; 8]>(), asks in any::<bool>()) {
        let frame = Frame { id, data: (!asks).then_some(data) };
        prop_assert!(bits(&frame) <= frame.most_bits(), "{} of {}", bits(&frame), frame.most_bits());
    }
}

#[test]
fn the_frames_of_both_protocols_are_nearly_as_long_as_stated_at_their_worst() {
    let still = odrive::set_input(0, 0.0, 0.0, 0.0);
    assert!(bits(&still) > still.most_bits() - 12, "{}", bits(&still));
    let asks = odrive::ask_for_estimates(3);
    // 34 + 13 bits, and some that are stuffed.
    assert!((47..=asks.most_bits()).contains(&bits(&asks)));
    let ranges = Ranges {
        position: 12.5,
        velocity: 30.0,
        torque: 10.0,
    };
    let command = Frame::new(1, Command::default().encode(&ranges));
    assert!((111..=command.most_bits()).contains(&bits(&command)));
}

#[test]
fn both_protocols_have_room_at_1_khz_and_none_at_2_khz() {
    let ranges = Ranges {
        position: 12.5,
        velocity: 30.0,
        torque: 10.0,
    };
    for (protocol, load) in [(Protocol::Odrive, 0.92), (Protocol::Mit(ranges), 0.54)] {
        assert!((most_load(&protocol, 1000.0) - load).abs() < 1e-6);
        assert!(most_load(&protocol, 1000.0) < MOST_LOAD);
        assert!(most_load(&protocol, 2000.0) > MOST_LOAD);
    }
}
