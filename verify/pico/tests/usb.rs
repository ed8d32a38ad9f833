//! The line over USB: how a host finds it, and what a lost one does to a moving arm.

mod bench;

use bench::{Bench, PERIOD, commands, frame, open, plug};
use fivebar_firmware::Request;
use fivebar_firmware::protocol::{ControllerMessage, Decoder, HostCommand, MAX_FRAME, Reply};
use fivebar_firmware::safety::{Fault, State};
use fivebar_pico::{HZ, HostLine};

fn bench() -> Bench {
    Bench::over_usb("rp2350_stepper", "benchtop_stepper")
}

#[test]
fn a_host_finds_the_device_and_opens_its_line() {
    for (image, robot) in [
        ("rp2350_stepper", "benchtop_stepper"),
        ("rp2350_servo", "classroom_servo"),
    ] {
        let mut bench = Bench::over_usb(image, robot);
        let mut chip = bench.line.chip();
        let host = chip.usb();
        let [device, configuration] = &host.descriptors;
        // A serial line (class 2) with packets of 64 bytes, of V-USB's shared number.
        assert_eq!(device[..8], [18, 1, 0x10, 2, 2, 0, 0, 64]);
        assert_eq!(device[8..12], [0xc0, 0x16, 0xdd, 0x27]);
        let total = u16::from_le_bytes([configuration[2], configuration[3]]);
        assert_eq!(usize::from(total), configuration.len());
        assert_eq!(host.product, image);
        // The descriptor of a faster device alone.
        assert_eq!((host.refused, host.out_of_turn), (1, 0));
        drop(chip);
        assert_eq!(bench.status().fault, None);
        // The settings went over it, too: nothing was said twice.
        assert_eq!(bench.client.repeats(), 0);
    }
}

/// Draws until the arm moves.
fn moving(bench: &mut Bench) {
    let axes = bench.settings.axes;
    let start = Request::SetAngles(axes.each_ref().map(|axis| axis.home_angle));
    bench.request(start).expect("accepted");
    bench.line.chip().run(HZ * 3 / 10).expect("it runs");
    for next in commands(&bench.robot, 0.05) {
        let reply = bench.client.call(HostCommand::Move(next));
        assert!(matches!(reply, Ok(Reply::Taken { .. })), "{reply:?}");
    }
    let end = bench.line.chip().now() + HZ;
    while bench.line.chip().wires().pulses.len() < 50 {
        assert_eq!(bench.status().fault, None);
        assert!(bench.line.chip().now() < end, "the arm moves within 1 s");
    }
}

/// The arm comes to rest without its host, and how long after `from` its last step came [s].
fn comes_to_rest(line: &HostLine, from: u64) -> f64 {
    let mut chip = line.chip();
    chip.run(HZ / 2).expect("it runs");
    let steps = chip.wires().pulses.len();
    chip.run(HZ / 4).expect("it runs");
    assert_eq!(chip.wires().pulses.len(), steps, "it rests");
    let last = chip.wires().pulses.last().expect("it moved").from;
    (last - from) as f64 / HZ as f64
}

#[test]
fn a_cable_that_is_pulled_stops_the_arm_as_a_silent_host_does() {
    let mut bench = bench();
    moving(&mut bench);
    let from = bench.line.chip().now();
    bench.line.chip().usb().unplug();
    let after = comes_to_rest(&bench.line, from);
    println!("the last step came {after:.3} s after the cable was pulled");
    assert!((0.1..0.4).contains(&after), "{after} s");
    plug(&mut bench.line.chip());
    bench.connect_again();
    assert_eq!(bench.status().fault, Some(Fault::CommandTimeout));
    bench.request(Request::ClearFault).expect("cleared");
    assert_eq!(bench.status().fault, None);
}

#[test]
fn a_reset_of_the_bus_in_a_job_brings_the_arm_to_rest_and_the_line_back() {
    let mut bench = bench();
    moving(&mut bench);
    let from = bench.line.chip().now();
    plug(&mut bench.line.chip());
    let after = comes_to_rest(&bench.line, from);
    assert!(after < 0.4, "{after} s");
    let host = bench.line.chip().usb().out_of_turn;
    assert_eq!(host, 0);
    bench.connect_again();
    assert_eq!(bench.status().fault, Some(Fault::CommandTimeout));
    assert_eq!(bench.status().missed_ticks, 0);
}

#[test]
fn the_host_that_began_last_leads_and_an_emergency_stop_comes_over_either_line() {
    let mut bench = bench();
    moving(&mut bench);
    // The serial line: its status is not answered, its emergency stop acts.
    let send = |bench: &Bench, command| {
        bench.line.chip().send(&frame(1, command));
        bench.line.chip().run(20 * PERIOD).expect("it runs");
    };
    send(&bench, HostCommand::Status);
    assert!(bench.line.chip().receive(1000).is_empty());
    assert_eq!(bench.status().fault, None);
    send(&bench, HostCommand::Request(Request::EmergencyStop));
    let status = bench.status();
    assert_eq!(status.fault, Some(Fault::EmergencyStop));
    assert_ne!(status.state, State::Armed);
    // Who says hello there leads, and USB falls silent.
    let serial = bench.line.serial();
    let (mut client, _) = open(&serial);
    assert_eq!(client.status().expect("it answers").0.fault, status.fault);
    bench.line.chip().usb().send(&frame(9, HostCommand::Status));
    bench.line.chip().run(20 * PERIOD).expect("it runs");
    assert!(bench.line.chip().usb().receive(1000).is_empty());
}

#[test]
fn a_host_that_takes_nothing_holds_nothing_up() {
    let mut bench = bench();
    moving(&mut bench);
    bench.line.chip().usb().deaf = true;
    ask(&bench, [1000; 20], HZ / 50);
    bench.line.chip().usb().deaf = false;
    let status = bench.status();
    assert_eq!((status.fault, status.missed_ticks), (None, 0));
}

/// Sends commands with these numbers, one each so many cycles. They are not the session's next ones, which is all that the replies
/// say: short ones.
fn ask(bench: &Bench, numbers: impl IntoIterator<Item = u16>, every: u64) {
    for number in numbers {
        let frame = frame(number, HostCommand::Status);
        bench.line.chip().usb().send(&frame);
        bench.line.chip().run(every).expect("it runs");
    }
}

/// The bytes that come within 20 ticks.
fn received(bench: &Bench) -> Vec<u8> {
    bench.line.chip().run(20 * PERIOD).expect("it runs");
    bench.line.chip().usb().receive(10_000)
}

/// The numbers of the commands that these bytes reply to. None of them is damaged.
fn replied(bytes: &[u8]) -> Vec<u16> {
    let mut decoder = Decoder::<ControllerMessage>::new();
    let messages: Vec<_> = bytes
        .iter()
        .filter_map(|&byte| decoder.feed(byte))
        .collect();
    let number = |message| match message {
        Ok(ControllerMessage::Reply { sequence, .. }) => sequence.0,
        other => panic!("{other:?}"),
    };
    messages.into_iter().map(number).collect()
}

#[test]
fn replies_wait_for_a_host_and_those_without_room_are_dropped_whole() {
    let bench = bench();
    bench.line.chip().usb().deaf = true;
    ask(&bench, 1000..1020, 10 * PERIOD);
    bench.line.chip().usb().deaf = false;
    assert_eq!(replied(&received(&bench)), Vec::from_iter(1000..1020));
    // The room is that of two of the longest frames, a packet waits, and another one is on its way.
    let most = 2 * MAX_FRAME + 2 * 64;
    bench.line.chip().usb().deaf = true;
    ask(&bench, 1000..1100, 10 * PERIOD);
    bench.line.chip().usb().deaf = false;
    let mut bytes = received(&bench);
    let count = bytes.len();
    assert!((2 * MAX_FRAME - 64..=most).contains(&count), "{count}");
    // Whatever was cut is damaged by the next one.
    ask(&bench, [2000], 0);
    bytes.extend(received(&bench));
    let replied = replied(&bytes);
    let (last, first) = replied.split_last().expect("replies");
    assert_eq!(*last, 2000);
    assert_eq!(first, Vec::from_iter((1000..).take(first.len())));
}

#[test]
fn a_full_last_packet_is_ended_by_an_empty_one() {
    let bench = bench();
    // Lengths of a reply: of a number of two bytes, and of one of three.
    let [short, long] = [1000, 20_000].map(|number| {
        ask(&bench, [number], 0);
        received(&bench).len()
    });
    assert_eq!((short, long), (14, 15));
    // The first one goes at once, the others in two packets: 7 of 14 bytes and 2 of 15 are 128.
    let numbers = [1000; 8].into_iter().chain([20_000; 2]);
    bench.line.chip().usb().deaf = true;
    ask(&bench, numbers.clone(), 10 * PERIOD);
    bench.line.chip().usb().deaf = false;
    assert_eq!(replied(&received(&bench)), Vec::from_iter(numbers));
}
