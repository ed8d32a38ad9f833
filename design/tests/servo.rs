//! The servo loop's margins against its poles, and the tuning.

use fivebar_design::servo::{CURRENTS, Gains, Servo, ServoDrive, TARGET_MODULUS, tune};
use nalgebra::Matrix2;
use proptest::prelude::*;

const PERIOD: f64 = 1e-4;

fn drive(stiffness: Option<f64>) -> ServoDrive {
    let rotor_inertia = 6.4e-5;
    // A damping ratio of 1 % between rotor and 1 g·m².
    let inertia = 1.0 / (1.0 / rotor_inertia + 1.0 / 1e-3);
    ServoDrive {
        torque_per_current: 0.1872,
        resistance: 2.3,
        inductance: 0.24e-3,
        rotor_inertia,
        viscous_friction: 1.5e-3,
        stiffness,
        damping: stiffness.map_or(0.0, |k: f64| 0.02 * (k * inertia).sqrt()),
        encoder_at_joint: false,
        encoder_latency: 0.0,
        count: 4.8e-5,
        peak_torque: 0.75,
    }
}

fn gains(bandwidth: f64) -> Gains {
    Gains {
        bandwidth,
        damping: 1.0,
        integral_rate: 0.2 * bandwidth,
        observer_bandwidth: 8.0 * bandwidth,
        current_bandwidth: 3000.0,
        belts: None,
    }
}

fn mass(m1: f64, m4: f64, coupling: f64) -> Matrix2<f64> {
    let m = coupling * (m1 * m4).sqrt();
    Matrix2::new(m1, m, m, m4)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// The loci and the poles are computed by unlike ways: blocks in the frequency domain, and
    /// the matrix of all states.
    #[test]
    fn a_stable_loop_oscillates_at_its_gain_margins_and_not_within(
        stiffness in prop::option::of(200.0..6000.0_f64),
        second in prop::option::of(200.0..6000.0_f64),
        m1 in 5e-4..2e-3_f64,
        m4 in 5e-4..2e-3_f64,
        coupling in -0.6..0.6_f64,
        bandwidth in 50.0..400.0_f64,
        late in 0.0..3.5_f64,
        at_joint in any::<bool>(),
    ) {
        let mut drives = [drive(stiffness), drive(second)];
        drives[0].encoder_latency = late * PERIOD;
        drives[1].encoder_at_joint = at_joint;
        let servo = Servo::new(mass(m1, m4, coupling), drives, PERIOD);
        let gains = gains(bandwidth);
        let radius = |factor: f64| servo.spectral_radius(&servo.law(&gains), factor);
        prop_assume!(radius(1.0) < 1.0 - 1e-6);
        let margins = servo.margins_by_poles(&servo.law(&gains));
        let by_loci = servo.margins(&servo.law(&gains));
        prop_assert!(margins.modulus <= 1.0 + 1e-9);
        for (pole, locus) in [
            (margins.gain_up, by_loci.gain_up),
            (margins.gain_down, by_loci.gain_down),
        ] {
            if (0.02..50.0).contains(&pole) {
                prop_assert!((pole / locus - 1.0).abs() < 0.1, "{margins:?} {by_loci:?}");
            }
        }
        if margins.gain_up < 50.0 {
            let (within, beyond) = (radius(0.99 * margins.gain_up), radius(1.01 * margins.gain_up));
            prop_assert!(within < 1.0 && beyond > 1.0, "{margins:?}: {within}, {beyond}");
            // 1 − x is no farther from −1 than the nearest point.
            prop_assert!(margins.modulus <= 1.0 - 1.0 / margins.gain_up + 1e-6);
        }
        if margins.gain_down > 1e-3 {
            let (within, beyond) =
                (radius(1.01 * margins.gain_down), radius(0.99 * margins.gain_down));
            prop_assert!(within < 1.0 && beyond > 1.0, "{margins:?}: {within}, {beyond}");
        }
    }

    #[test]
    fn a_very_stiff_drive_is_a_rigid_one(m in 5e-4..2e-3_f64, bandwidth in 50.0..300.0_f64) {
        let stiff = Servo::new(mass(m, m, 0.2), [drive(Some(1e6)); 2], PERIOD);
        let rigid = Servo::new(mass(m, m, 0.2), [drive(None); 2], PERIOD);
        let [stiff, rigid] = [stiff, rigid].map(|servo| servo.margins(&servo.law(&gains(bandwidth))));
        prop_assert!((stiff.modulus - rigid.modulus).abs() < 0.01);
        prop_assert!((stiff.delay / rigid.delay - 1.0).abs() < 0.02);
    }
}

/// A latency that the law does not know takes the delay margin away, whole ticks or not.
#[test]
fn an_unknown_delay_of_the_delay_margin_makes_the_loop_oscillate() {
    // Opposite errors would cancel: the law's prediction is that of the declared latency, so the
    // comparison is with the phase e^(−jωd) on the loci themselves.
    let servo = Servo::new(mass(1.2e-3, 1.2e-3, 0.2), [drive(None); 2], PERIOD);
    let gains = gains(250.0);
    let margins = servo.margins(&servo.law(&gains));
    let late = |delay: f64| {
        servo
            .loci(&servo.law(&gains))
            .iter()
            .flat_map(|point| {
                let turn = nalgebra::Complex::from_polar(1.0, -point.omega * delay);
                point.loci.map(|locus| (locus * turn + 1.0).norm())
            })
            .fold(f64::INFINITY, f64::min)
    };
    assert!(late(margins.delay) < 0.02, "{}", late(margins.delay));
    assert!(late(0.5 * margins.delay) > 0.1);
    assert!(margins.phase > 0.5 && margins.phase < 1.6, "{margins:?}");
}

#[test]
fn tuning_keeps_its_margin_on_belts_of_any_stiffness() {
    for stiffness in [
        None,
        Some(5000.0),
        Some(2500.0),
        Some(1250.0),
        Some(700.0),
        Some(300.0),
    ] {
        let poses: Vec<Servo> = [
            (1.2e-3, 1.2e-3, 0.2),
            (8e-4, 1.7e-3, 0.3),
            (8e-4, 8e-4, -0.2),
        ]
        .into_iter()
        .map(|(m1, m4, c)| Servo::new(mass(m1, m4, c), [drive(stiffness); 2], PERIOD))
        .collect();
        let tuning = tune(&poses, &CURRENTS).expect("a tuning");
        println!("{stiffness:?} {tuning:?}");
        assert!(tuning.is_good(), "{stiffness:?}: {tuning:?}");
        assert!(tuning.gains.bandwidth >= 60.0, "{stiffness:?}: {tuning:?}");
        for servo in &poses {
            let margins = servo.margins(&servo.law(&tuning.gains));
            assert!(
                margins.modulus >= TARGET_MODULUS,
                "{stiffness:?}: {margins:?}"
            );
            assert!(servo.spectral_radius(&servo.law(&tuning.gains), 1.0) < 1.0);
        }
    }
}

#[test]
fn coarse_counts_latency_and_slow_ticks_lower_the_bandwidth() {
    let tuned = |change: fn(&mut ServoDrive), period: f64| {
        let mut drive = drive(None);
        change(&mut drive);
        let servo = Servo::new(mass(1.2e-3, 1.2e-3, 0.2), [drive; 2], period);
        tune(&[servo], &CURRENTS).expect("a tuning").gains.bandwidth
    };
    let plain = tuned(|_| (), PERIOD);
    let coarse = tuned(|drive| drive.count *= 100.0, PERIOD);
    let late = tuned(|drive| drive.encoder_latency = 1e-3, PERIOD);
    let slow = tuned(|_| (), 1e-3);
    assert!(coarse < 0.7 * plain, "{coarse} for {plain}");
    assert!(late < 0.8 * plain, "{late} for {plain}");
    assert!(slow < 0.3 * plain, "{slow} for {plain}");
}
