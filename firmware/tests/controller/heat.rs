//! What the controller knows of the motors' heat before it has measured any current.

use crate::rig::{Rig, WAKING_TICKS, settings, with};
use fivebar_firmware::controller::Request;
use fivebar_firmware::safety::Fault;
use fivebar_firmware::{Controller, Settings};

/// Ticks until the arm is too hot, while 0.53 A hold joint 4 against a push.
fn ticks_until_hot(rig: &mut Rig) -> u32 {
    rig.bench.push = [0.0, 0.1];
    (1..20_000)
        .find(|_| {
            rig.tick();
            rig.controller.status().fault == Some(Fault::OverTemperature)
        })
        .expect("too hot")
}

/// A motor of 0.3 A with a time constant of 0.5 s at joint 4.
fn weak() -> Settings {
    with(|s| {
        s.axes[1].continuous_current = 0.3;
        s.axes[1].thermal_time_constant = 0.5;
    })
}

/// Puts a new controller with these settings in the place of the one in use, as a host does, and arms it.
fn apply(rig: &mut Rig, settings: &Settings) {
    let mut controller = Controller::new(&settings.check().expect("valid"));
    controller.keep_heat(&rig.controller);
    rig.controller = controller;
    rig.bench.push = [0.0; 2];
    rig.bench.omega = [0.0; 2];
    rig.run(1);
    let angles = rig.bench.theta.map(|angle| angle as f32);
    rig.controller.request(Request::SetAngles(angles)).unwrap();
    rig.controller.request(Request::Arm).unwrap();
    rig.run(WAKING_TICKS + 1);
}

#[test]
fn a_motor_counts_as_warm_at_the_start_and_cools_down() {
    let mut warm = Rig::armed(&weak());
    let after_start = ticks_until_hot(&mut warm);
    // Three time constants later it is nearly cold: 0.5 ln(0.28/(0.28 − 0.09)) s = 0.19 s.
    let mut cold = Rig::new(&weak());
    cold.run(15_000);
    cold.controller
        .request(Request::SetAngles(crate::rig::START))
        .unwrap();
    cold.controller.request(Request::Arm).unwrap();
    let when_cold = ticks_until_hot(&mut cold);
    assert!((1000..2000).contains(&after_start), "{after_start} ticks");
    assert!(
        after_start + 50 < when_cold,
        "{after_start} of {when_cold} ticks"
    );
    assert!((1300..2200).contains(&when_cold), "{when_cold} ticks");
}

#[test]
fn a_hot_motor_stays_hot_when_settings_are_applied() {
    let mut rig = Rig::armed(&weak());
    ticks_until_hot(&mut rig);
    rig.controller.request(Request::ClearFault).unwrap();
    apply(
        &mut rig,
        &with(|s| {
            s.axes[1] = weak().axes[1];
            s.motion.max_speed = 0.2;
        }),
    );
    let again = ticks_until_hot(&mut rig);
    assert!(again < 300, "{again} ticks: it was hot a moment ago");
}

#[test]
fn settings_of_another_motor_do_not_cool_a_hot_one() {
    let mut rig = Rig::armed(&weak());
    ticks_until_hot(&mut rig);
    rig.controller.request(Request::ClearFault).unwrap();
    apply(
        &mut rig,
        &with(|s| {
            s.axes[1].continuous_current = 0.31;
            s.axes[1].thermal_time_constant = 0.5;
        }),
    );
    let again = ticks_until_hot(&mut rig);
    assert!(again < 300, "{again} ticks: it was hot a moment ago");
}

#[test]
fn a_motor_that_was_cold_is_as_warm_as_at_a_start_when_its_ratings_change() {
    let mut rig = Rig::new(&settings());
    // Cool until 1.3 A and 12 s would take over a second to trip.
    rig.run(30_000);
    apply(&mut rig, &weak());
    let ticks = ticks_until_hot(&mut rig);
    assert!((1000..1450).contains(&ticks), "{ticks} ticks");
}
