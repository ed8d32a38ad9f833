//! Springs that a host changes while a hand feels them.

use crate::rig::{Rig, settings};
use fivebar_firmware::motion::{Impedance, StreamConfig, StreamMode, StreamPoint, StreamPolicy};
use fivebar_firmware::planner::StreamError;
use fivebar_firmware::safety::State;
use fivebar_kinematics::five_bar::{Geometry, Side};
use nalgebra::Vector2;

/// Of the hand's grip [N/m], [N·s/m].
const GRIP: (f64, f64) = (400.0, 4.0);

/// A stream with a spring, or a change of it.
fn config(k: f32) -> StreamConfig {
    let spring = Impedance {
        stiffness: (k, 0.0, k),
        damping: (0.0, 0.0, 0.0),
    };
    StreamConfig {
        id: 1,
        mode: StreamMode::Impedance(spring),
        period: 100,
        delay: 200,
        policy: StreamPolicy::Stop,
    }
}

/// An arm with a spring at the place where it rests, and a hand that leads the tool.
struct Gripped {
    rig: Rig,
    geometry: Geometry<f64>,
    rest: Vector2<f64>,
    /// Ticks since the stream began.
    ticks: u32,
    /// The energy that the hand was given [J].
    out: f64,
}

impl Gripped {
    fn begin(k: f32) -> Self {
        let mut rig = Rig::armed(&settings());
        let begun = rig.planner.begin_stream(&mut rig.controller, &config(k));
        assert_eq!(begun, Ok(()));
        let rest = rig.bench.tool().into();
        let geometry = Geometry::new(settings().lengths.map(f64::from)).unwrap();
        Self {
            rig,
            geometry,
            rest,
            ticks: 0,
            out: 0.0,
        }
    }

    fn set(&mut self, k: f32) -> Result<(), StreamError> {
        self.rig
            .planner
            .begin_stream(&mut self.rig.controller, &config(k))
    }

    /// A tick in which the hand is so far out [m]. Gives its force along x [N].
    fn tick(&mut self, away: f64) -> f64 {
        if self.ticks.is_multiple_of(100) {
            let point = StreamPoint {
                id: 1,
                due: 0,
                position: (self.rest.x as f32, self.rest.y as f32),
                velocity: (0.0, 0.0),
                force: (0.0, 0.0),
            };
            self.rig.controller.feed_host_timeout();
            let n = (self.ticks / 100 + 1) as u16;
            self.rig
                .planner
                .take_point(&mut self.rig.controller, n, &point);
        }
        self.ticks += 1;
        let [theta1, theta4] = self.rig.bench.theta;
        let pose = self.geometry.forward(theta1, theta4, Side::Left).unwrap();
        let by = |omega1, omega4| {
            let velocities = self.geometry.forward_velocities(&pose, omega1, omega4);
            velocities.unwrap().c
        };
        let [omega1, omega4] = self.rig.bench.omega;
        let hand = self.rest + Vector2::new(away, 0.0);
        let (stiffness, damping) = GRIP;
        let force = (hand - pose.c) * stiffness - by(omega1, omega4) * damping;
        self.rig.bench.push = [by(1.0, 0.0).dot(&force), by(0.0, 1.0).dot(&force)];
        self.rig.planner.run(&mut self.rig.controller);
        self.rig.tick_alone();
        let [push1, push4] = self.rig.bench.push;
        let [after1, after4] = self.rig.bench.theta;
        self.out -= push1 * (after1 - theta1) + push4 * (after4 - theta4);
        assert_eq!(self.rig.controller.state(), State::Compliant);
        force.x
    }

    fn hold(&mut self, away: f64, ms: u32) -> f64 {
        (0..10 * ms).map(|_| self.tick(away)).last().unwrap()
    }

    /// Leads the tool from one place to another in 0.2 s.
    fn lead(&mut self, from: f64, to: f64) {
        for tick in 0..2_000 {
            let u = f64::from(tick) / 2_000.0;
            self.tick(from + (to - from) * u * u * (3.0 - 2.0 * u));
        }
    }
}

#[test]
fn a_spring_becomes_stiffer_in_a_tenth_of_a_second_without_a_jolt() {
    let mut arm = Gripped::begin(20.0);
    arm.hold(0.0, 150);
    arm.lead(0.0, 0.01);
    let before = arm.hold(0.01, 200);
    assert_eq!(arm.set(60.0), Ok(()));
    let (mut last, mut jolt) = (before, 0.0_f64);
    let mut forces = Vec::new();
    for _ in 0..300 {
        let force = arm.hold(0.01, 1);
        jolt = jolt.max((force - last).abs());
        last = force;
        forces.push(force);
    }
    // 40 N/m more at some 8 mm, less what of the dry friction held the tool.
    let more = last - before;
    assert!((0.2..0.42).contains(&more), "{before} {last}");
    assert!(jolt < 0.05, "{jolt}");
    // Half of it after half of the time, all of it after it, and the arm's own motion.
    let at = |ms: usize| (forces[ms] - before) / more;
    assert!(
        (0.2..0.75).contains(&at(50)) && at(150) > 0.9,
        "{} {}",
        at(50),
        at(150)
    );
}

/// A hand that leads the tool out against a soft spring and back with a stiff one, again and again.
#[test]
fn a_spring_that_changes_gives_a_hand_no_more_than_the_tanks_depth() {
    let pumped = |with_tank: bool| {
        let mut arm = Gripped::begin(20.0);
        if !with_tank {
            arm.rig.controller.take_tank_out();
        }
        arm.hold(0.0, 150);
        let mut most = 0.0_f64;
        for _ in 0..12 {
            arm.lead(0.0, 0.02);
            arm.set(110.0).unwrap();
            arm.hold(0.02, 150);
            arm.lead(0.02, 0.0);
            arm.set(20.0).unwrap();
            arm.hold(0.0, 150);
            most = most.max(arm.out);
        }
        most
    };
    let (with, without) = (pumped(true), pumped(false));
    println!("{with} J, without the tank {without} J");
    assert!(with < 5e-3, "{with} J");
    assert!(without > 3.0 * with.max(5e-3), "{without} J");
}

#[test]
fn changes_that_are_not_passive_or_have_no_stream_are_refused_and_the_spring_stays() {
    let mut rig = Rig::armed(&settings());
    let tip = StreamConfig {
        mode: StreamMode::Tip,
        ..config(20.0)
    };
    let mut begin = |config| rig.planner.begin_stream(&mut rig.controller, &config);
    assert_eq!(begin(tip), Ok(()));
    assert_eq!(begin(config(20.0)), Err(StreamError::NoImpedance));
    let other = StreamConfig {
        id: 2,
        ..config(20.0)
    };
    assert_eq!(begin(other), Err(StreamError::Moving));
    let mut arm = Gripped::begin(20.0);
    arm.hold(0.0, 150);
    arm.lead(0.0, 0.01);
    let before = arm.hold(0.01, 1_000);
    assert!(matches!(arm.set(1e6), Err(StreamError::Stiffness(_))));
    assert_eq!(arm.set(f32::NAN), Err(StreamError::Matrix));
    assert_eq!(
        arm.rig.planner.set_fixture(0, None),
        Err(StreamError::Moving)
    );
    let after = arm.hold(0.01, 300);
    assert!((after - before).abs() < 0.01, "{before} {after}");
}
