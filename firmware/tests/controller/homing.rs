//! Homing finds the joint angles or ends in a fault.

use crate::rig::{Bench, Rig, START, settings};
use fivebar_firmware::controller::{Request, RequestError};
use fivebar_firmware::safety::{Fault, State};
use std::f64::consts::TAU;

const COUNT: f64 = TAU / (8.0 * 8192.0);

/// Runs until homing has ended; returns its ticks.
fn home(rig: &mut Rig) -> u32 {
    home_with(rig, |_, _| ())
}

/// The same; `disturb` may change the bench before each tick.
fn home_with(rig: &mut Rig, mut disturb: impl FnMut(u32, &mut Bench)) -> u32 {
    rig.controller.request(Request::Home).unwrap();
    for ticks in 0..60_000 {
        if rig.controller.state() != State::Homing {
            return ticks;
        }
        disturb(ticks, &mut rig.bench);
        let command = rig.tick();
        // The current is limited: the voltage is at most that of this current plus the
        // back-EMF.
        for duty in command.drives.duty {
            assert!(duty.abs() < (1.2 * 2.3 + 0.3) / 24.0 * 2.5, "{duty}");
        }
    }
    panic!("still homing");
}

#[test]
fn finds_both_switches_from_any_encoder_origin() {
    for extra in [
        [0, 0],
        [123_456, -98_765],
        [i32::MAX - 20_000, i32::MIN + 20_000],
    ] {
        let mut rig = Rig::new(&settings());
        rig.bench.extra_counts = extra;
        rig.controller = fivebar_firmware::Controller::new(&settings().check().unwrap());
        rig.run(1);
        home(&mut rig);
        let status = rig.controller.status();
        assert_eq!(status.state, State::Stopped, "{:?}", rig.controller.fault());
        assert!(status.homed);
        rig.run(2000);
        let status = rig.controller.status();
        for (angle, theta) in status.angle.into_iter().zip(rig.bench.theta) {
            // The tick in which the switch closes, creeping at 0.09 rad/s: a fifth of a count.
            let off = (f64::from(angle) - theta).abs();
            assert!(off < 1.5 * COUNT, "{off} rad");
        }
    }
}

#[test]
fn begins_by_backing_off_where_a_switch_is_closed_already() {
    let mut rig = Rig::new(&settings());
    rig.bench.theta = [2.80, 0.34];
    rig.controller = fivebar_firmware::Controller::new(&settings().check().unwrap());
    rig.run(1);
    home(&mut rig);
    assert!(rig.controller.status().homed);
    let off = f64::from(rig.controller.status().angle[0]) - rig.bench.theta[0];
    assert!(off.abs() < 1.5 * COUNT, "{off} rad");
}

/// If a joint took a disturbance for its switch, it would back off from its present angle and
/// find the next disturbance instead of the switch.
#[test]
fn a_home_switch_that_reads_wrongly_for_a_few_ticks_changes_nothing() {
    let undisturbed = {
        let mut rig = Rig::new(&settings());
        let ticks = home(&mut rig);
        (ticks, rig.controller.status().angle)
    };
    for (length, every) in [(1, 50), (7, 97)] {
        let mut rig = Rig::new(&settings());
        let ticks = home_with(&mut rig, |tick, bench| {
            let flips = tick % every < length;
            bench.stuck = None;
            let read = bench.sense().home;
            // No disturbance within the debounce time around a real change of the switch.
            let near = [0, 1].map(|joint| {
                let home = f64::from(settings().axes[joint].home_angle);
                (bench.theta[joint] - home).abs() < 2e-3
            });
            if flips && near == [false; 2] {
                bench.stuck = Some(read.map(|closed| !closed));
            }
        });
        let status = rig.controller.status();
        assert!(status.homed, "{:?}", rig.controller.fault());
        assert_eq!((ticks, status.angle), undisturbed, "{length} ticks");
    }
}

/// The contact opens again twice while it closes.
#[test]
fn a_bouncing_switch_gives_the_home_angle_within_its_bounces() {
    let mut rig = Rig::new(&settings());
    let mut closed_for = [0; 2];
    home_with(&mut rig, |_, bench| {
        bench.stuck = None;
        let read = bench.sense().home;
        for joint in 0..2 {
            closed_for[joint] = if read[joint] {
                closed_for[joint] + 1
            } else {
                0
            };
        }
        let bouncing = closed_for.map(|ticks| (3..5).contains(&ticks) || ticks == 10);
        bench.stuck = Some([0, 1].map(|joint| read[joint] && !bouncing[joint]));
    });
    assert!(rig.controller.status().homed);
    rig.run(2000);
    let status = rig.controller.status();
    for (angle, theta) in status.angle.into_iter().zip(rig.bench.theta) {
        // Eleven ticks at 0.09 rad/s are 0.1 mrad: the counts are those after the last gap.
        let off = (f64::from(angle) - theta).abs();
        assert!(off < 1.5 * COUNT + 1e-4, "{off} rad");
    }
}

#[test]
fn a_switch_that_stays_closed_ends_in_an_envelope_fault() {
    // The search allows 0.2 rad, and what the range has behind the home angle.
    for behind in [0.0, 0.2, 0.6] {
        let mut settings = settings();
        for axis in &mut settings.axes {
            let [low, high] = &mut axis.angle_limits;
            match axis.home_forward {
                true => *high = axis.home_angle + behind,
                false => *low = axis.home_angle - behind,
            }
        }
        let mut rig = Rig::new(&settings);
        rig.bench.stuck = Some([true, true]);
        home(&mut rig);
        assert_eq!(rig.controller.status().fault, Some(Fault::Envelope));
        assert!(!rig.controller.status().homed);
        let turned = (rig.bench.theta[0] - f64::from(START[0])).abs();
        assert!(
            turned < 0.3 + f64::from(behind),
            "{turned} rad, {behind} rad"
        );
    }
}

#[test]
fn a_switch_that_never_closes_ends_in_an_envelope_fault() {
    let mut narrow = settings();
    narrow.axes[0].angle_limits = [2.0, 2.4];
    narrow.axes[1].angle_limits = [0.7, 1.1];
    let mut rig = Rig::new(&narrow);
    rig.bench.stuck = Some([false, false]);
    home(&mut rig);
    assert_eq!(rig.controller.status().fault, Some(Fault::Envelope));
}

#[test]
fn a_blocked_joint_ends_in_a_following_error() {
    let mut rig = Rig::new(&settings());
    // More than the limited torque of homing, 0.22 N·m.
    rig.bench.push = [-0.3, 0.0];
    home(&mut rig);
    assert_eq!(rig.controller.status().fault, Some(Fault::FollowingError));
}

#[test]
fn home_angles_that_close_no_arm_are_an_encoder_disagreement() {
    let mut short = settings();
    // With both cranks turned outwards these couplers are too short to meet.
    short.lengths = [0.10, 0.13, 0.13, 0.10, 0.08];
    let mut rig = Rig::new(&short);
    // The switches are at other angles than those of the settings.
    rig.bench.stuck = Some([false, false]);
    rig.controller.request(Request::Home).unwrap();
    let mut switches = [false, true, false, true].into_iter();
    for phase in 0..4 {
        rig.bench.stuck = switches.next().map(|closed| [closed; 2]);
        for _ in 0..if phase == 2 { 9000 } else { 300 } {
            rig.tick();
        }
    }
    assert_eq!(
        rig.controller.status().fault,
        Some(Fault::EncoderDisagreement)
    );
    assert!(!rig.controller.status().homed);
}

#[test]
fn stops_searching_on_request() {
    let mut rig = Rig::new(&settings());
    rig.controller.request(Request::Home).unwrap();
    rig.run(500);
    rig.controller.request(Request::Stop).unwrap();
    let command = rig.run(1);
    assert_eq!(rig.controller.state(), State::Stopped);
    assert_eq!(command.enable, [false; 2]);
    assert!(!rig.controller.status().homed);
}

#[test]
fn arming_is_refused_until_homed_and_where_the_arm_may_not_be() {
    let arm = |rig: &mut Rig| rig.controller.request(Request::Arm);
    let mut rig = Rig::new(&settings());
    assert_eq!(arm(&mut rig), Err(RequestError::NotHomed));
    let mut set = |angles| rig.controller.request(Request::SetAngles(angles));
    assert_eq!(set([f32::NAN, 0.9]), Err(RequestError::OutsideLimits));
    assert_eq!(set([0.5, 0.9]), Err(RequestError::OutsideLimits));
    // B meets D: cos θ1 = 0.04/0.1, θ4 = π − θ1.
    assert_eq!(set([1.160, 1.982]), Err(RequestError::NearSingularity));
    assert_eq!(set(START), Ok(()));
    assert_eq!(arm(&mut rig), Ok(()));
    let mut set = |angles| rig.controller.request(Request::SetAngles(angles));
    assert_eq!(set(START), Err(RequestError::State(State::Armed)));
    // Pushed out of the joint limits while the bridges are off.
    rig.controller.request(Request::Disarm).unwrap();
    rig.bench.theta[0] = 3.61;
    let mut rig2 = Rig::new(&settings());
    rig2.controller
        .request(Request::SetAngles([3.59, 0.9]))
        .unwrap();
    rig2.bench.push = [0.05, 0.0];
    rig2.run(800);
    assert_eq!(
        rig2.controller.request(Request::Arm),
        Err(RequestError::OutsideLimits)
    );
}

#[test]
fn an_arm_reports_its_tool_only_when_it_is_homed() {
    let mut rig = Rig::new(&settings());
    rig.run(10);
    assert_eq!(rig.controller.status().tool, None);
    rig.controller.request(Request::SetAngles(START)).unwrap();
    assert!(rig.controller.status().tool.is_some());
    rig.controller.request(Request::Home).unwrap();
    rig.run(100);
    assert_eq!(rig.controller.status().tool, None);
}
