//! The zeros of the current sensors are measured with the bridges off, and refused where they are
//! implausible.

use crate::rig::{Rig, START, settings, with};
use fivebar_firmware::controller::{Excitation, Excited, Request, RequestError};

/// Ticks after which the zeros are measured.
const MEASURED: u32 = 64 + 2048;

/// A rig whose current sensors read these codes at no current.
fn shifted(codes: [u16; 2], ticks: u32) -> Rig {
    let mut rig = Rig::new(&settings());
    for _ in 0..ticks {
        let mut sample = rig.bench.sense();
        sample.drives.current = codes;
        rig.controller.feed_host_timeout();
        rig.controller.tick(&sample);
    }
    rig
}

#[test]
fn a_shifted_zero_reads_no_current_once_it_is_measured() {
    let per_code = settings().axes[0].current_per_code;
    let early = shifted([2058, 2040], MEASURED - 10).controller.status();
    assert!((early.current[0] - 10.0 * per_code).abs() < 1e-5);
    let status = shifted([2058, 2040], MEASURED + 1).controller.status();
    assert!(
        status.current.iter().all(|current| current.abs() < 1e-5),
        "{:?}",
        status.current
    );
}

#[test]
fn an_implausible_zero_hides_no_current() {
    let per_code = settings().axes[0].current_per_code;
    let status = shifted([2048 + 150, 2048 - 150], 2 * MEASURED)
        .controller
        .status();
    let expected = [150.0 * per_code, -150.0 * per_code];
    for (current, expected) in status.current.into_iter().zip(expected) {
        assert!((current - expected).abs() < 1e-4, "{current} A");
    }
}

#[test]
fn the_mean_is_that_of_a_noisy_sensor() {
    let mut rig = Rig::new(&settings());
    for tick in 0..MEASURED {
        let mut sample = rig.bench.sense();
        sample.drives.current = [2050 + (tick % 4) as u16, 2048];
        rig.controller.tick(&sample);
    }
    let mut sample = rig.bench.sense();
    sample.drives.current = [2052, 2048];
    rig.controller.tick(&sample);
    let current = rig.controller.status().current[0] / settings().axes[0].current_per_code;
    assert!((current - 0.5).abs() < 0.01, "{current} codes");
}

#[test]
fn an_implausible_zero_is_refused_until_it_is_plausible_again() {
    let excitation = Excitation {
        joint: 0,
        of: Excited::Voltage,
        offset: 0.1,
        amplitude: 0.0,
        hold: 1,
        ticks: 10,
        current: 1.0,
        travel: 0.1,
    };
    for codes in [[2160, 2048], [2048, 1940], [0, 0], [4095, 2048]] {
        let mut rig = shifted(codes, MEASURED + 1);
        for request in [Request::Home, Request::Excite(excitation)] {
            assert_eq!(
                rig.controller.request(request),
                Err(RequestError::CurrentZero)
            );
        }
        rig.controller.request(Request::SetAngles(START)).unwrap();
        assert_eq!(
            rig.controller.request(Request::Arm),
            Err(RequestError::CurrentZero)
        );
        rig.run(MEASURED);
        assert_eq!(rig.controller.request(Request::Arm), Ok(()), "{codes:?}");
    }
    // Within the tolerance, but then the sensor cannot tell the current that is a fault.
    let mut narrow = with(|s| s.protection.over_current = 7.9);
    narrow.axes = settings().axes;
    let mut rig = Rig::new(&narrow);
    for _ in 0..=MEASURED {
        let mut sample = rig.bench.sense();
        sample.drives.current = [2128, 2048];
        rig.controller.tick(&sample);
    }
    assert_eq!(
        rig.controller.request(Request::Home),
        Err(RequestError::CurrentZero)
    );
}

#[test]
fn a_current_in_an_armed_arm_is_no_zero() {
    let mut rig = Rig::armed(&settings());
    rig.bench.push = [0.05, 0.0];
    rig.run(3 * MEASURED);
    assert!(rig.controller.status().current[0].abs() > 0.1);
    rig.controller.request(Request::Disarm).unwrap();
    rig.bench.push = [0.0; 2];
    rig.run(10);
    rig.controller.request(Request::Arm).unwrap();
}

#[test]
fn codes_from_before_the_bridges_were_on_are_in_no_mean() {
    let mut rig = shifted([2068, 2068], MEASURED - 100);
    rig.controller.request(Request::SetAngles(START)).unwrap();
    rig.controller.request(Request::Arm).unwrap();
    rig.run(20);
    rig.controller.request(Request::Disarm).unwrap();
    rig.run(200);
    let current = rig.controller.status().current;
    assert!(current.iter().all(|it| it.abs() < 1e-5), "{current:?}");
}
