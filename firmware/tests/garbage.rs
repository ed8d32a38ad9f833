//! Whatever the samples say and whatever is asked: no panic, no duty beyond one, no duty
//! into an unpowered bridge, and power only in the states that have it.

mod rig;

use fivebar_firmware::controller::Request;
use fivebar_firmware::safety::{Response, State};
use fivebar_firmware::{Controller, Move, MoveKind, Planner, Sensed};
use proptest::prelude::*;
use rig::{Bench, START, settings};

#[derive(Clone, Copy, Debug)]
enum Step {
    /// The samples of a real arm.
    Sound,
    /// These samples instead.
    Garbage(Sensed),
    Ask(Request),
    Order(MoveKind),
    Missed(u32),
}

fn number() -> impl Strategy<Value = f32> {
    prop_oneof![
        any::<f32>(),
        -0.3..0.3_f32,
        0.0..4.0_f32,
        Just(f32::NAN),
        Just(f32::INFINITY),
    ]
}

fn pair() -> impl Strategy<Value = [f32; 2]> {
    prop::array::uniform2(number())
}

fn sensed() -> impl Strategy<Value = Sensed> {
    (
        any::<[i32; 2]>(),
        any::<[u16; 2]>(),
        any::<u16>(),
        any::<[bool; 2]>(),
        prop::bool::weighted(0.1),
    )
        .prop_map(
            |(counts, current, bus_voltage, home, emergency_stop)| Sensed {
                counts,
                current,
                bus_voltage,
                home,
                emergency_stop,
                ..Sensed::default()
            },
        )
}

fn request() -> impl Strategy<Value = Request> {
    prop_oneof![
        Just(Request::Arm),
        Just(Request::Disarm),
        Just(Request::Home),
        Just(Request::SetAngles(START)),
        pair().prop_map(Request::SetAngles),
        Just(Request::Stop),
        Just(Request::EmergencyStop),
        Just(Request::ClearFault),
    ]
}

fn order() -> impl Strategy<Value = MoveKind> {
    prop_oneof![
        (pair(), number()).prop_map(|(to, feed)| MoveKind::Line { to, feed }),
        (pair(), pair(), any::<bool>(), number()).prop_map(|(to, center, clockwise, feed)| {
            MoveKind::Arc {
                to,
                center,
                clockwise,
                feed,
            }
        }),
        number().prop_map(|duration| MoveKind::Dwell { duration }),
        (pair(), number()).prop_map(|(to, speed)| MoveKind::Joint { to, speed }),
    ]
}

fn step() -> impl Strategy<Value = Step> {
    prop_oneof![
        10 => Just(Step::Sound),
        1 => sensed().prop_map(Step::Garbage),
        3 => request().prop_map(Step::Ask),
        3 => order().prop_map(Step::Order),
        1 => (0..8_u32).prop_map(Step::Missed),
    ]
}

/// One tick, held against what holds for every tick.
fn tick(controller: &mut Controller, sensed: &Sensed) -> fivebar_firmware::Command {
    let command = controller.tick(sensed);
    let powered = match controller.state() {
        State::Stopped => false,
        State::Homing | State::Armed | State::Running | State::Stopping => true,
        State::Fault => controller.fault().unwrap().fault.response() == Response::ControlledStop,
    };
    for (duty, enable) in command.duty.into_iter().zip(command.enable) {
        assert!(duty.abs() <= 1.0, "{duty} while {:?}", controller.state());
        assert!(enable || duty == 0.0);
        assert!(powered || !enable, "power while {:?}", controller.state());
        assert_eq!(enable, !command.brake);
    }
    let status = controller.status();
    assert_eq!(status.fault.is_some(), status.state == State::Fault);
    command
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn nothing_makes_the_tick_lose_its_head(
        armed in any::<bool>(),
        steps in prop::collection::vec(step(), 1..120),
    ) {
        let mut controller = Controller::new(&settings()).unwrap();
        let mut planner = Planner::new(&settings()).unwrap();
        let mut bench = Bench::new(&settings());
        tick(&mut controller, &bench.sense());
        if armed {
            controller.request(Request::SetAngles(START)).unwrap();
            controller.request(Request::Arm).unwrap();
        }
        for step in steps {
            match step {
                Step::Sound => {
                    for _ in 0..20 {
                        planner.run(&mut controller);
                        let command = tick(&mut controller, &bench.sense());
                        bench.step(&command);
                    }
                }
                Step::Garbage(sensed) => {
                    tick(&mut controller, &sensed);
                }
                Step::Ask(request) => {
                    let _ = controller.request(request);
                }
                Step::Order(kind) => {
                    let _ = planner.push(&mut controller, &Move { tag: 0, kind });
                }
                Step::Missed(missed_ticks) => {
                    let sensed = Sensed {
                        missed_ticks,
                        ..bench.sense()
                    };
                    tick(&mut controller, &sensed);
                }
            }
        }
    }

    #[test]
    fn samples_alone_never_power_a_bridge(samples in prop::collection::vec(sensed(), 1..200)) {
        let mut controller = Controller::new(&settings()).unwrap();
        for sensed in samples {
            let command = tick(&mut controller, &sensed);
            prop_assert_eq!(command.enable, [false; 2]);
        }
    }
}
