//! An excitation keeps its limits, each of them by itself, and ends in a stopped arm.

use crate::rig::{OFF, Rig, START, WAKING_TICKS, settings, with};
use fivebar_firmware::controller::{Excitation, ExcitationEnd, Excited, Request, RequestError};
use fivebar_firmware::safety::{Fault, State};

/// What raises a fault.
type Cause<'a> = &'a dyn Fn(&mut Rig);

/// 1 V on motor 1 for 0.1 s.
const GENTLE: Excitation = Excitation {
    joint: 0,
    of: Excited::Voltage,
    offset: 1.0,
    amplitude: 0.0,
    hold: 1,
    ticks: 1000,
    current: 1.0,
    travel: 1.0,
};

/// Asks for the excitation and runs until the bridges are off again; returns the ticks with the
/// bridges on, the greatest current [A] and the farthest travel [rad].
fn excite(rig: &mut Rig, excitation: Excitation) -> (u32, f64, f64) {
    let start = rig.bench.theta;
    rig.controller.request(Request::Excite(excitation)).unwrap();
    assert_eq!(rig.controller.state(), State::Exciting);
    let (mut current, mut travel) = (0.0_f64, 0.0_f64);
    for ticks in 0..40_000 {
        if rig.tick() == OFF {
            return (ticks, current, travel);
        }
        for amperes in rig.bench.current {
            current = current.max(amperes.abs());
        }
        for (theta, start) in rig.bench.theta.iter().zip(start) {
            travel = travel.max((theta - start).abs());
        }
    }
    panic!("it does not end");
}

#[test]
fn a_voltage_turns_its_own_joint_for_its_time_and_ends_stopped() {
    for (joint, sign) in [(0, 1.0), (1, -1.0)] {
        let mut rig = Rig::new(&settings());
        let before = rig.bench.theta;
        let wanted = Excitation {
            joint: joint as u8,
            offset: sign,
            ..GENTLE
        };
        let (ticks, ..) = excite(&mut rig, wanted);
        assert_eq!(rig.controller.excitation_end(), Some(ExcitationEnd::Time));
        assert_eq!(rig.controller.state(), State::Stopped);
        assert!((1000..6100).contains(&ticks), "{ticks}");
        let turned = [0, 1].map(|joint| rig.bench.theta[joint] - before[joint]);
        assert!(turned[joint] * f64::from(sign) > 0.05, "{turned:?}");
        assert!(
            turned[joint].abs() > 3.0 * turned[1 - joint].abs(),
            "{turned:?}"
        );
        let rests = rig.bench.omega.iter().all(|omega| omega.abs() < 0.15);
        assert!(rests, "{:?} after {ticks}", rig.bench.omega);
        assert!(!rig.controller.status().homed);
        // Another one may follow, and the switches may be searched for.
        rig.controller.request(Request::Excite(wanted)).unwrap();
    }
}

#[test]
fn it_ends_at_its_travel_and_is_braked() {
    let mut rig = Rig::new(&settings());
    let far = Excitation {
        offset: 2.0,
        ticks: 20_000,
        travel: 0.2,
        ..GENTLE
    };
    let (_, _, travel) = excite(&mut rig, far);
    assert_eq!(rig.controller.excitation_end(), Some(ExcitationEnd::Travel));
    assert!((0.2..0.6).contains(&travel), "{travel} rad");
}

#[test]
fn it_ends_at_its_current() {
    let mut rig = Rig::new(&settings());
    // 2.2 V would drive 0.95 A through the winding.
    let strong = Excitation {
        offset: 2.2,
        current: 0.5,
        ..GENTLE
    };
    let (_, current, _) = excite(&mut rig, strong);
    assert_eq!(
        rig.controller.excitation_end(),
        Some(ExcitationEnd::Current)
    );
    // The tick that finds it sees a current one tick old, and its command acts one tick later.
    assert!((0.5..0.95).contains(&current), "{current} A");
}

#[test]
fn a_current_is_kept_by_the_current_loop() {
    let mut rig = Rig::new(&settings());
    let wanted = Excitation {
        of: Excited::Current,
        offset: 0.4,
        ..GENTLE
    };
    rig.controller.request(Request::Excite(wanted)).unwrap();
    rig.run(WAKING_TICKS + 60);
    assert!(
        (rig.bench.current[0] - 0.4).abs() < 0.02,
        "{:?}",
        rig.bench.current
    );
    rig.run(10_000);
    assert_eq!(rig.controller.excitation_end(), Some(ExcitationEnd::Time));
}

#[test]
fn a_sequence_takes_both_values_and_holds_each() {
    let mut rig = Rig::new(&settings());
    let sequence = Excitation {
        offset: 0.5,
        amplitude: 1.0,
        hold: 4,
        ..GENTLE
    };
    rig.controller.request(Request::Excite(sequence)).unwrap();
    rig.run(WAKING_TICKS);
    let volts: Vec<f32> = (0..900).map(|_| rig.tick().drives.duty[0] * 24.0).collect();
    let high = volts.iter().filter(|volts| (*volts - 1.5).abs() < 0.01);
    let low = volts.iter().filter(|volts| (*volts + 0.5).abs() < 0.01);
    let (high, low) = (high.count(), low.count());
    assert_eq!(high + low, 900);
    assert!(high.abs_diff(low) < 150, "{high} and {low}");
    let changes: Vec<usize> = (1..900).filter(|&i| volts[i] != volts[i - 1]).collect();
    assert!(changes.len() > 80, "{}", changes.len());
    assert!(
        changes
            .windows(2)
            .all(|pair| (pair[1] - pair[0]).is_multiple_of(4))
    );
}

/// The whole voltage, to see the bridge's own current limit.
#[test]
fn a_voltage_of_2_ms_may_reach_the_over_current_and_a_longer_one_may_not() {
    let pulse = Excitation {
        offset: 12.0,
        ticks: 20,
        current: 6.0,
        ..GENTLE
    };
    let (_, current, travel) = excite(&mut Rig::new(&settings()), pulse);
    assert!((4.5..5.3).contains(&current), "{current} A");
    assert!(travel < 0.2, "{travel} rad");
    for beyond in [
        Excitation { ticks: 21, ..pulse },
        Excitation {
            current: 6.01,
            ..pulse
        },
        Excitation {
            of: Excited::Current,
            offset: 2.0,
            ..pulse
        },
    ] {
        let request = Request::Excite(beyond);
        let refused = Rig::new(&settings()).controller.request(request);
        assert_eq!(refused, Err(RequestError::Excitation), "{beyond:?}");
    }
}

#[test]
fn values_beyond_their_bounds_are_refused_and_nothing_moves() {
    let beyond: [(&str, Excitation); 12] = [
        ("joint", Excitation { joint: 2, ..GENTLE }),
        (
            "current",
            Excitation {
                current: 1.31,
                ..GENTLE
            },
        ),
        (
            "no current",
            Excitation {
                current: 0.0,
                ..GENTLE
            },
        ),
        (
            "voltage",
            Excitation {
                offset: 4.7,
                ..GENTLE
            },
        ),
        (
            "sum",
            Excitation {
                offset: -3.0,
                amplitude: 1.7,
                ..GENTLE
            },
        ),
        (
            "set current",
            Excitation {
                of: Excited::Current,
                offset: 1.1,
                ..GENTLE
            },
        ),
        (
            "time",
            Excitation {
                ticks: 20_001,
                ..GENTLE
            },
        ),
        ("no time", Excitation { ticks: 0, ..GENTLE }),
        ("hold", Excitation { hold: 0, ..GENTLE }),
        (
            "travel",
            Excitation {
                travel: 2.01,
                ..GENTLE
            },
        ),
        (
            "no travel",
            Excitation {
                travel: 0.0,
                ..GENTLE
            },
        ),
        (
            "NaN",
            Excitation {
                offset: f32::NAN,
                ..GENTLE
            },
        ),
    ];
    for (what, excitation) in beyond {
        let mut rig = Rig::new(&settings());
        let asked = rig.controller.request(Request::Excite(excitation));
        assert_eq!(asked, Err(RequestError::Excitation), "{what}");
        assert_eq!(rig.tick(), OFF, "{what}");
    }
}

#[test]
fn a_homed_arm_and_an_arm_in_any_other_state_is_not_excited() {
    let mut rig = Rig::new(&settings());
    rig.controller.request(Request::SetAngles(START)).unwrap();
    let asked = rig.controller.request(Request::Excite(GENTLE));
    assert_eq!(asked, Err(RequestError::Homed));
    rig.controller.request(Request::Arm).unwrap();
    let asked = rig.controller.request(Request::Excite(GENTLE));
    assert_eq!(asked, Err(RequestError::State(State::Armed)));
}

#[test]
fn a_silent_host_a_stop_and_a_disarm_end_it() {
    let mut rig = Rig::new(&settings());
    let long = Excitation {
        offset: 0.3,
        ticks: 20_000,
        ..GENTLE
    };
    rig.controller.request(Request::Excite(long)).unwrap();
    let ticks = (0..2000).take_while(|_| {
        rig.tick_alone();
        rig.controller.fault().is_none()
    });
    let ticks = ticks.count();
    assert!(ticks <= 1000, "{ticks}");
    assert_eq!(rig.controller.fault().unwrap().fault, Fault::CommandTimeout);
    assert_eq!(rig.tick_alone(), OFF);
    for request in [Request::Stop, Request::Disarm] {
        let mut rig = Rig::new(&settings());
        rig.controller.request(Request::Excite(long)).unwrap();
        rig.run(500);
        rig.controller.request(request).unwrap();
        assert_eq!(rig.tick(), OFF);
        assert_eq!(rig.controller.state(), State::Stopped);
    }
}

#[test]
fn faults_end_it_in_their_tick() {
    let stop = |rig: &mut Rig| rig.bench.overlay.emergency_stop = true;
    let driver = |rig: &mut Rig| rig.bench.overlay.driver_fault = [false, true];
    let sag = |rig: &mut Rig| rig.bench.bus = 12.0;
    let jump = |rig: &mut Rig| rig.bench.extra_counts = [0, 700];
    let faults: [(Fault, Cause<'_>); 4] = [
        (Fault::EmergencyStop, &stop),
        (Fault::DriverFault, &driver),
        (Fault::UnderVoltage, &sag),
        (Fault::EncoderJump, &jump),
    ];
    for (fault, cause) in faults {
        let mut rig = Rig::new(&settings());
        rig.controller.request(Request::Excite(GENTLE)).unwrap();
        rig.run(300);
        cause(&mut rig);
        assert_eq!(rig.tick(), OFF, "{fault:?}");
        assert_eq!(rig.controller.fault().unwrap().fault, fault);
        assert_eq!(rig.controller.fault().unwrap().state, State::Exciting);
    }
}

#[test]
fn a_voltage_beyond_the_bus_is_given_at_the_greatest_duty() {
    for sign in [1.0, -1.0] {
        let mut rig = Rig::new(&with(|s| {
            s.axes.iter_mut().for_each(|axis| axis.resistance = 20.0);
        }));
        let high = Excitation {
            offset: sign * 30.0,
            ..GENTLE
        };
        rig.controller.request(Request::Excite(high)).unwrap();
        rig.run(WAKING_TICKS);
        assert_eq!(rig.tick().drives.duty, [sign * 0.95, 0.0]);
    }
}

#[test]
fn the_travel_of_either_joint_counts_from_where_it_was_at_the_beginning() {
    let mut rig = Rig::new(&settings());
    excite(&mut rig, GENTLE);
    // Joint 1 is away from joint 4 now.
    let rest = Excitation {
        offset: 0.0,
        ticks: 50,
        travel: 0.03,
        ..GENTLE
    };
    excite(&mut rig, rest);
    assert_eq!(rig.controller.excitation_end(), Some(ExcitationEnd::Time));
}
