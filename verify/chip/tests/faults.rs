//! The faults of `docs/use/faults.md` that a board can meet, raised through its pins and registers
//! while the arm moves: the number, the bridges off within the stated ticks, and nothing that
//! moves until the fault is cleared.

mod bench;

use bench::raised::{
    TICK, at_the_end, is_held_until_cleared, moving, offer, stated, stays_off_until_cleared,
    ticks_until_off, tool_at_start,
};
use bench::{Bench, Driven, used_flash};
use fivebar_chip::Options;
use fivebar_chip::time::MILLISECOND;
use fivebar_firmware::protocol::Reset;
use fivebar_firmware::safety::{Fault, Response, State};
use fivebar_firmware::{Move, MoveKind, Request, Settings};
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::FaultKind;

#[track_caller]
fn powers_off(test: &str, fault: FaultKind) -> Driven {
    let (number, within) = stated(test);
    assert_eq!(number.response(), Response::PowerOff);
    let mut driven = moving();
    driven.arm.get().inject(fault);
    driven.chip().pins_changed();
    let ticks = ticks_until_off(&mut driven, within);
    // The samples of a tick are taken up to a tick after the fault begins.
    assert!(ticks <= within + 1, "{ticks} of {within}");
    driven
}

#[test]
fn a_dead_encoder() {
    let mut driven = powers_off(
        "a_dead_encoder",
        FaultKind::EncoderDead {
            joint: Joint::Joint1,
        },
    );
    stays_off_until_cleared(&mut driven, Fault::EncoderStuck);
}

#[test]
fn a_jumping_encoder() {
    let fault = FaultKind::EncoderJump {
        joint: Joint::Joint4,
        counts: 400,
    };
    let mut driven = powers_off("a_jumping_encoder", fault);
    stays_off_until_cleared(&mut driven, Fault::EncoderJump);
}

#[test]
fn a_switch_stuck_in_motion() {
    for joint in Joint::ALL {
        let fault = FaultKind::SwitchStuck {
            joint,
            pressed: true,
        };
        let mut driven = powers_off("a_switch_stuck_in_motion", fault);
        stays_off_until_cleared(&mut driven, Fault::LostCounts);
    }
}

#[test]
fn a_stalled_motor() {
    let mut driven = powers_off(
        "a_stalled_motor",
        FaultKind::MotorStalled {
            joint: Joint::Joint4,
        },
    );
    stays_off_until_cleared(&mut driven, Fault::FollowingError);
}

#[test]
fn a_disconnected_motor() {
    let fault = FaultKind::MotorDisconnected {
        joint: Joint::Joint1,
    };
    let mut driven = powers_off("a_disconnected_motor", fault);
    stays_off_until_cleared(&mut driven, Fault::CurrentSensor);
}

#[test]
fn a_dead_current_sensor() {
    for joint in Joint::ALL {
        let fault = FaultKind::CurrentDead { joint };
        let mut driven = powers_off("a_dead_current_sensor", fault);
        stays_off_until_cleared(&mut driven, Fault::CurrentSensor);
    }
}

#[test]
fn a_current_sensor_far_off() {
    for joint in Joint::ALL {
        let fault = FaultKind::CurrentOffset {
            joint,
            amperes: 7.0,
        };
        let mut driven = powers_off("a_current_sensor_far_off", fault);
        stays_off_until_cleared(&mut driven, Fault::OverCurrent);
    }
}

#[test]
fn a_sagging_bus() {
    let mut driven = powers_off("a_sagging_bus", FaultKind::BusVoltage { volts: 12.0 });
    stays_off_until_cleared(&mut driven, Fault::UnderVoltage);
}

#[test]
fn a_pumped_up_bus() {
    let mut driven = powers_off("a_pumped_up_bus", FaultKind::BusVoltage { volts: 34.0 });
    stays_off_until_cleared(&mut driven, Fault::OverVoltage);
}

#[test]
fn a_bridge_that_gives_up() {
    for joint in Joint::ALL {
        let fault = FaultKind::DriverFault { joint };
        let mut driven = powers_off("a_bridge_that_gives_up", fault);
        stays_off_until_cleared(&mut driven, Fault::DriverFault);
    }
}

#[test]
fn a_pressed_emergency_stop() {
    let (number, within) = stated("a_pressed_emergency_stop");
    let mut driven = moving();
    driven.arm.get().press_stop(true);
    driven.chip().pins_changed();
    assert!(driven.is_off(), "by the timer, without the program");
    driven.run((within + 1) * TICK);
    assert_eq!(driven.status().fault, Some(number));
    driven.arm.get().press_stop(false);
    stays_off_until_cleared(&mut driven, number);
}

#[test]
fn late_ticks() {
    let (number, _) = stated("late_ticks");
    let mut driven = moving();
    driven.chip().stall(4 * TICK);
    driven.run(6 * TICK);
    assert!(driven.is_off());
    stays_off_until_cleared(&mut driven, number);
}

#[test]
fn a_few_late_ticks() {
    let mut driven = moving();
    let before = driven.status().missed_ticks;
    for _ in 0..4 {
        driven.chip().stall(2 * TICK);
        driven.run(20 * TICK);
    }
    let status = driven.status();
    assert_eq!(status.fault, None);
    assert!(
        status.missed_ticks - before >= 4,
        "{}",
        status.missed_ticks - before
    );
}

#[test]
fn a_silent_host() {
    let (number, within) = stated("a_silent_host");
    let mut driven = moving();
    driven.run((within + 1200) * TICK);
    is_held_until_cleared(&mut driven, number);
}

#[test]
fn a_planner_that_is_late() {
    // The watchdog waits 94 ms at the slowest frequency of its oscillator.
    let options = Options {
        lsi: 17e3,
        ..Options::default()
    };
    let mut driven = at_the_end(options).ready();
    driven.arm();
    // The planner commits a little more of the path than a stop needs, in moves of 20 ms here.
    for tag in 1..=14 {
        let [x, y] = tool_at_start();
        let to = [x - 0.002 * tag as f32, y];
        offer(
            &mut driven,
            Move {
                tag,
                tool: 0,
                kind: MoveKind::Line { to, feed: 0.1 },
            },
        );
    }
    driven.run(60 * MILLISECOND);
    let held_back = driven.chip().hold_back(85 * MILLISECOND);
    held_back.expect("no violation");
    assert_eq!(driven.status().fault, Some(Fault::QueueUnderrun));
    driven.run(200 * MILLISECOND);
    assert_eq!(driven.chip().resets().len(), 1);
    is_held_until_cleared(&mut driven, Fault::QueueUnderrun);
}

/// An armed arm with changed settings.
fn armed_with(change: impl FnOnce(&mut Settings)) -> Driven {
    let mut driven = at_the_end(Options::default()).ready_with(change);
    driven.arm();
    driven
}

#[test]
fn a_joint_that_turns_too_fast() {
    let mut driven = armed_with(|settings| {
        settings.protection.following_error = 0.9;
        // A weak loop drives no current, so the motor's equation sees no contradiction.
        settings.control.bandwidth = 0.5;
        settings.control.integral_rate = 0.0;
        for axis in &mut settings.axes {
            axis.continuous_current = axis.peak_current;
            axis.max_speed = 35.0;
        }
        settings.protection.over_speed = 36.75;
    });
    // The limit, 36.75 rad/s, is 77 counts in a tick.
    driven.arm.get().inject(FaultKind::MotorDisconnected {
        joint: Joint::Joint1,
    });
    let mut counts = 0;
    while !driven.is_off() {
        counts += 1;
        assert!(counts < 95, "{counts}");
        let fault = FaultKind::EncoderJump {
            joint: Joint::Joint1,
            counts,
        };
        driven.arm.get().inject(fault);
        driven.run(TICK);
    }
    assert!(counts > 70, "{counts}");
    stays_off_until_cleared(&mut driven, Fault::OverSpeed);
}

/// Motors of 0.1 A: short moves, which accelerate and brake all the time, take more.
#[test]
fn a_motor_that_gets_too_hot() {
    let mut driven = armed_with(|settings| {
        for axis in &mut settings.axes {
            axis.continuous_current = 0.1;
            axis.thermal_time_constant = 0.5;
        }
    });
    driven.run(40 * MILLISECOND);
    assert!(!driven.is_off(), "{:?}", driven.status().fault);
    let [x, y] = tool_at_start();
    for tag in 1..=6 {
        let to = [x - 0.02 * [0.0, 1.0][tag as usize % 2], y];
        let kind = MoveKind::Line { to, feed: 0.3 };
        offer(&mut driven, Move { tag, tool: 0, kind });
    }
    ticks_until_off(&mut driven, 8000);
    stays_off_until_cleared(&mut driven, Fault::OverTemperature);
}

/// Rotors with two hundred times the inertia are expected, which is too much gain for any loop.
#[test]
fn a_loop_that_oscillates() {
    let mut driven = armed_with(|settings| {
        for axis in &mut settings.axes {
            axis.rotor_inertia *= 200.0;
        }
    });
    let [x, y] = tool_at_start();
    let to = [x - 0.06, y];
    offer(
        &mut driven,
        Move {
            tag: 1,
            tool: 0,
            kind: MoveKind::Line { to, feed: 0.1 },
        },
    );
    ticks_until_off(&mut driven, 5000);
    stays_off_until_cleared(&mut driven, Fault::Oscillation);
}

#[test]
fn switches_at_angles_that_close_no_arm() {
    let bench = Bench::with(Options::default(), Vec::new(), MILLISECOND);
    // Couplers too short to meet when both cranks are turned outwards.
    let mut driven = bench.ready_with(|settings| {
        settings.lengths = [0.10, 0.13, 0.13, 0.10, 0.08];
    });
    driven.request(Request::Home).expect("homing");
    driven.run(10 * MILLISECOND);
    ticks_until_off(&mut driven, 20_000);
    driven.run(2 * TICK);
    stays_off_until_cleared(&mut driven, Fault::EncoderDisagreement);
    assert!(!driven.status().homed);
}

#[test]
fn torques_that_overflow() {
    let mut driven = at_the_end(Options::default()).ready_with(|settings| {
        settings.gravity = [0.0, -3e38];
        settings.payload = 30.0;
    });
    let angles = Joint::ALL.map(|joint| driven.arm.get().plant().angle(joint) as f32);
    driven.request(Request::SetAngles(angles)).expect("angles");
    driven.request(Request::Arm).expect("armed");
    driven.run(3 * MILLISECOND);
    stays_off_until_cleared(&mut driven, Fault::NotANumber);
}

#[test]
fn a_reset_by_the_watchdog_in_motion() {
    let (number, _) = stated("a_reset_by_the_watchdog_in_motion");
    let mut driven = moving();
    driven.chip().hang();
    driven.run(60 * MILLISECOND);
    assert!(driven.is_off());
    assert_eq!(driven.reconnect(), Reset::Watchdog);
    stays_off_until_cleared(&mut driven, number);
}

#[test]
fn settings_that_are_none() {
    let mut driven = Bench::with(Options::default(), used_flash(), 0).connect();
    stays_off_until_cleared(&mut driven, Fault::SettingsCorrupt);
}

/// Homes with this fault, until it ends the search.
fn search(test: &str, fault: FaultKind) {
    let (number, within) = stated(test);
    let bench = at_the_end(Options::default());
    // Faster than usual and in a narrow range, as the document's.
    let mut driven = bench.ready_with(|settings| {
        settings.homing.speed = 3.0;
        settings.homing.back_off = 0.02;
        settings.axes[0].angle_limits = [2.1, 2.3];
    });
    driven.arm.get().inject(fault);
    driven.request(Request::Home).expect("homing");
    driven.run(5 * MILLISECOND);
    assert!(!driven.is_off());
    ticks_until_off(&mut driven, within);
    stays_off_until_cleared(&mut driven, number);
}

#[test]
fn a_switch_stuck_closed() {
    let pressed = true;
    search(
        "a_switch_stuck_closed",
        FaultKind::SwitchStuck {
            joint: Joint::Joint1,
            pressed,
        },
    );
}

#[test]
fn a_switch_stuck_open() {
    let pressed = false;
    search(
        "a_switch_stuck_open",
        FaultKind::SwitchStuck {
            joint: Joint::Joint1,
            pressed,
        },
    );
}

/// A line whose every `nth` byte arrives changed, and one with garbage between the frames.
#[test]
fn corrupt_frames_and_garbage() {
    let mut driven = moving();
    for round in 0..20_u8 {
        driven.chip().send(&[round, 0x5a, 0, 7, round ^ 0xff, 0, 0]);
        driven.status();
    }
    let status = driven.status();
    assert_eq!((status.state, status.fault), (State::Running, None));
}
