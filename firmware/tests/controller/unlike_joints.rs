//! Arms whose joints differ: each joint has its own constants.

use crate::rig::{Rig, START, settings, with};
use fivebar_firmware::controller::Request;
use fivebar_firmware::safety::Fault;

#[test]
fn the_current_of_either_motor_is_limited_by_its_own_peak() {
    for joint in [0, 1] {
        let mut rig = Rig::armed(&with(|s| {
            s.homing.current = 0.3;
            s.axes[joint].continuous_current = 0.4;
            s.axes[joint].peak_current = 0.5;
        }));
        rig.bench.push[joint] = 0.3;
        let mut most = 0.0_f32;
        while rig.controller.fault().is_none() {
            rig.tick();
            most = most.max(rig.controller.status().current_demand[joint].abs());
        }
        assert_eq!(rig.controller.fault().unwrap().fault, Fault::FollowingError);
        assert!((most - 0.5).abs() < 1e-4, "joint {joint}: {most} A");
    }
}

#[test]
fn the_zero_of_either_current_sensor_is_compared_with_its_own() {
    for joint in [0, 1] {
        let mut rig = Rig::new(&with(|s| s.axes[joint].current_zero_code = 2200));
        rig.run(2200);
        rig.controller.request(Request::SetAngles(START)).unwrap();
        assert_eq!(rig.controller.request(Request::Arm), Ok(()));
        // The other sensor's zero is no zero of this one.
        let mut rig = Rig::new(&settings());
        for _ in 0..2200 {
            let mut sample = rig.bench.sense();
            sample.drives.current[joint] = 2200;
            rig.controller.tick(&sample);
        }
        rig.controller.request(Request::SetAngles(START)).unwrap();
        assert!(rig.controller.request(Request::Arm).is_err());
    }
}
