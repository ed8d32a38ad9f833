//! A stream of the mode Impedance: springs, dampers, walls and guides at the tool.

use crate::rig::{Rig, settings, with};
use fivebar_firmware::controller::{RenderingBounds, Request};
use fivebar_firmware::drives::BrushedDrives;
use fivebar_firmware::motion::{
    Fixture, FixtureShape, Impedance, StreamConfig, StreamMode, StreamPoint, StreamPolicy,
};
use fivebar_firmware::planner::{StreamError, StreamPhase, StreamReason};
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::settings::Settings;
use fivebar_kinematics::five_bar::{Geometry, Side};
use nalgebra::Vector2;

/// The ticks of a millisecond.
const MS: u32 = 10;
const ID: u32 = 6;

/// A spring of so many N/m and damper of so many N·s/m in all directions.
fn soft(k: f32, d: f32) -> Impedance {
    Impedance {
        stiffness: (k, 0.0, k),
        damping: (d, 0.0, d),
    }
}

/// An arm with a wall or guide alone.
fn walled(shape: FixtureShape) -> Felt {
    let mut rig = Rig::armed(&settings());
    let wall = Fixture {
        shape,
        stiffness: 150.0,
        damping: 0.02,
    };
    assert_eq!(rig.planner.set_fixture(1, Some(wall)), Ok(()));
    Felt::over(rig, soft(0.0, 0.05))
}

fn config(impedance: Impedance) -> StreamConfig {
    StreamConfig {
        id: ID,
        mode: StreamMode::Impedance(impedance),
        period: 100,
        delay: 200,
        policy: StreamPolicy::Stop,
    }
}

/// An arm with an impedance, and a hand that pulls with a force.
struct Felt {
    rig: Rig,
    n: u16,
    /// Where the spring ends [m], how fast that moves [m/s], and the host's force [N].
    target: [[f32; 2]; 3],
    /// The hand's force [N].
    hand: [f64; 2],
}

impl Felt {
    fn begin(settings: &Settings, impedance: Impedance) -> Self {
        Self::over(Rig::armed(settings), impedance)
    }

    fn over(mut rig: Rig, impedance: Impedance) -> Self {
        let begun = rig
            .planner
            .begin_stream(&mut rig.controller, &config(impedance));
        assert_eq!(begun, Ok(()));
        assert_eq!(rig.controller.state(), State::Compliant);
        let tool = rig.bench.tool().map(|value| value as f32);
        let (n, hand) = (0, [0.0; 2]);
        let target = [tool, [0.0; 2], [0.0; 2]];
        Self {
            rig,
            n,
            target,
            hand,
        }
    }

    fn point(&mut self) {
        self.n += 1;
        let [position, velocity, force] = self.target.map(Into::into);
        let point = StreamPoint {
            id: ID,
            due: 0,
            position,
            velocity,
            force,
        };
        self.rig.controller.feed_host_timeout();
        self.rig
            .planner
            .take_point(&mut self.rig.controller, self.n, &point);
    }

    fn tick(&mut self) {
        self.rig.bench.push = torques(self.rig.bench.theta, self.hand);
        self.rig.planner.run(&mut self.rig.controller);
        self.rig.tick_alone();
    }

    /// So many milliseconds, with a point every ten of them.
    fn run(&mut self, ms: u32) {
        for ms in 0..ms {
            if ms % 10 == 0 {
                self.point();
            }
            (0..MS).for_each(|_| self.tick());
        }
    }

    /// So many milliseconds without points, with other signs of life.
    fn without_points(&mut self, ms: u32) {
        for _ in 0..ms * MS {
            self.rig.controller.feed_host_timeout();
            self.tick();
        }
    }

    fn tool(&self) -> Vector2<f64> {
        self.rig.bench.tool().into()
    }

    fn speed(&mut self) -> f64 {
        let before = self.tool();
        self.tick();
        (self.tool() - before).norm() / 1e-4
    }

    fn stream(&self) -> (StreamPhase, Option<StreamReason>) {
        let progress = self.rig.planner.stream().unwrap();
        (progress.phase, progress.reason)
    }
}

/// The columns of the tool's Jacobian [m], by differences.
fn jacobian(theta: [f64; 2]) -> [Vector2<f64>; 2] {
    let geometry = Geometry::new([0.10, 0.16, 0.16, 0.10, 0.08]).unwrap();
    [0, 1].map(|joint| {
        let at = |by: f64| {
            let mut moved = theta;
            moved[joint] += by;
            geometry.forward(moved[0], moved[1], Side::Left).unwrap().c
        };
        (at(1e-6) - at(-1e-6)) / 2e-6
    })
}

/// The joints' torques of a force on the tool [N·m].
fn torques(theta: [f64; 2], [x, y]: [f64; 2]) -> [f64; 2] {
    jacobian(theta).map(|column| column.x * x + column.y * y)
}

#[test]
fn a_spring_gives_way_by_the_force_over_its_stiffness() {
    // Softer along one direction.
    let impedance = Impedance {
        stiffness: (120.0, 30.0, 60.0),
        ..soft(0.0, 0.05)
    };
    let mut felt = Felt::begin(&settings(), impedance);
    felt.run(200);
    let from = felt.tool();
    for hand in [[0.6, 0.0], [0.0, -0.4], [-0.4, 0.4]] {
        felt.hand = hand;
        felt.run(1500);
        let moved = felt.tool() - from;
        let force = Vector2::new(
            120.0 * moved.x + 30.0 * moved.y,
            30.0 * moved.x + 60.0 * moved.y,
        );
        // Dry friction, of which 0.3 are left, keeps some of it: 3 mN·m over a lever of a tenth of a metre.
        let error = (force - Vector2::from(hand)).norm();
        assert!(error < 0.06, "{hand:?}: {force} N");
    }
    felt.hand = [0.0; 2];
    felt.run(1500);
    let left = (felt.tool() - from).norm();
    assert!(left < 1e-3, "{left} m");
    assert_eq!(felt.stream(), (StreamPhase::Follows, None));
}

#[test]
fn the_springs_end_leads_the_arm_and_a_force_pushes_it() {
    let mut felt = Felt::begin(&settings(), soft(120.0, 0.05));
    let from = felt.tool();
    felt.run(150);
    // 20 mm at 50 mm/s; between two points the end goes on with its velocity.
    for k in 0..40_u8 {
        felt.target[0][0] = from.x as f32 + 5e-4 * f32::from(k);
        felt.target[1][0] = 0.05;
        felt.run(10);
    }
    felt.target[1][0] = 0.0;
    felt.run(500);
    let moved = felt.tool() - from;
    assert!(
        (moved.x - 0.0195).abs() < 1e-3 && moved.y.abs() < 1e-3,
        "{moved}"
    );
    // Half a newton over 120 N/m.
    felt.target[2] = [0.0, 0.5];
    let before = felt.tool();
    felt.run(1000);
    let moved = felt.tool() - before;
    assert!(
        (moved.y - 0.5 / 120.0).abs() < 1e-3 && moved.x.abs() < 1e-3,
        "{moved}"
    );
}

#[test]
fn springs_rise_in_a_tenth_of_a_second_also_after_a_pause() {
    let mut felt = Felt::begin(&settings(), soft(120.0, 0.05));
    felt.target[0][1] += 0.01;
    felt.point();
    (0..5 * MS).for_each(|_| felt.tick());
    // 1.2 N · 0.05 at once would move the tool faster than this.
    let slow = felt.speed();
    felt.run(100);
    let fast = felt.speed();
    assert!(slow < 0.4 * fast, "{slow} {fast}");
    felt.without_points(60);
    assert_eq!(felt.stream().0, StreamPhase::Starved);
    let damped = felt.speed();
    assert!(damped < 0.02, "{damped}");
    felt.run(600);
    assert_eq!(felt.stream(), (StreamPhase::Follows, None));
    let away = felt.tool().y - f64::from(felt.target[0][1]);
    assert!(away.abs() < 1e-3, "{away}");
}

#[test]
fn a_wall_stops_a_hand_and_a_guide_pulls_onto_its_line() {
    let probe = Felt::begin(&settings(), soft(0.0, 0.0));
    let at = probe.tool();
    let [x, y] = [at.x as f32, at.y as f32];
    // Each wall 5 mm away in the direction of the pull; 0.6 N over 150 N/m are 4 mm.
    let walls = [
        FixtureShape::HalfPlane {
            point: (x, y + 5e-3),
            normal: (0.0, -3.0),
        },
        FixtureShape::Box {
            centre: (x, y - 0.05),
            axis: (0.0, 2.0),
            half: (0.055, 0.1),
        },
        FixtureShape::Inside {
            centre: (x, y - 0.02),
            radius: 0.025,
        },
    ];
    for wall in walls {
        let mut felt = walled(wall);
        felt.hand = [0.0, 0.6];
        felt.run(1500);
        let deep = felt.tool().y - at.y - 5e-3;
        assert!((deep - 4e-3).abs() < 6e-4, "{wall:?}: {deep} m");
        // The other way nothing holds it.
        felt.hand = [0.0, -0.2];
        felt.run(400);
        assert!(felt.tool().y < at.y - 5e-3, "{wall:?}");
    }
    // Along the outside of a circle the tool slides off.
    let (centre, radius) = ((x, y + 0.025), 0.02);
    let mut felt = walled(FixtureShape::Outside { centre, radius });
    felt.hand = [0.0, 0.6];
    for _ in 0..60 {
        felt.run(10);
        let distance = (felt.tool() - Vector2::new(centre.0.into(), centre.1.into())).norm();
        // 0.6 N over 5 mm and the depth δ are at least the energy of the spring, 75 N/m · δ².
        assert!(distance > f64::from(radius) - 0.0115, "{distance} m");
    }
    assert!(felt.tool().y > at.y + 0.02);
    let guides = [
        FixtureShape::Line {
            point: (x, y + 6e-3),
            normal: (0.0, 1.0),
        },
        FixtureShape::Circle {
            centre: (x, y - 0.03),
            radius: 0.036,
        },
    ];
    for guide in guides {
        let mut felt = walled(guide);
        felt.run(1500);
        let off = felt.tool().y - at.y - 6e-3;
        assert!(off.abs() < 6e-4, "{guide:?}: {off} m");
    }
}

#[test]
fn no_spring_drives_the_arm_faster_than_a_quarter_of_a_metre_per_second() {
    for to in [[0.06, 0.0], [-0.06, 0.0], [0.0, 0.05], [0.0, -0.06]] {
        let mut felt = Felt::begin(&settings(), soft(200.0, 0.0));
        felt.run(120);
        felt.target[0][0] += to[0];
        felt.target[0][1] += to[1];
        let mut fastest = 0.0_f64;
        for ms in 0..800 {
            if ms % 10 == 0 {
                felt.point();
            }
            for _ in 0..MS {
                fastest = fastest.max(felt.speed());
            }
            assert_eq!(felt.rig.controller.fault().map(|seen| seen.fault), None);
        }
        assert!(fastest < 0.27 && fastest > 0.15, "{to:?}: {fastest} m/s");
    }
}

#[test]
fn what_is_not_passive_means_nothing_or_pushes_away_is_refused_by_name() {
    let begin = |impedance: Impedance| {
        let mut rig = Rig::armed(&settings());
        rig.planner
            .begin_stream(&mut rig.controller, &config(impedance))
    };
    let Err(StreamError::Stiffness(most)) = begin(soft(2000.0, 0.0)) else {
        panic!("2,000 N/m are refused");
    };
    assert!(100.0 < most && most < 1000.0, "{most} N/m");
    assert_eq!(begin(soft(0.999 * most, 0.0)), Ok(()));
    let refused = begin(soft(1.001 * most, 0.0));
    assert!(matches!(refused, Err(StreamError::Stiffness(_))));
    // Dampers take from it.
    let Err(StreamError::Stiffness(less)) = begin(soft(1.001 * most, 0.05)) else {
        panic!("dampers leave less");
    };
    assert!(less < 0.99 * most);
    let Err(StreamError::Damping(most)) = begin(soft(0.0, 10.0)) else {
        panic!("10 N·s/m are refused");
    };
    assert_eq!(begin(soft(0.0, 0.999 * most)), Ok(()));
    // Walls count, too.
    let wall = |stiffness, radius| Fixture {
        shape: FixtureShape::Inside {
            centre: (0.0, 0.2),
            radius,
        },
        stiffness,
        damping: 0.0,
    };
    let beside = |place, wall| {
        let mut rig = Rig::armed(&settings());
        rig.planner.set_fixture(place, Some(wall))?;
        rig.planner
            .begin_stream(&mut rig.controller, &config(soft(50.0, 0.01)))
    };
    let refused = beside(2, wall(2000.0, 0.05));
    assert!(matches!(refused, Err(StreamError::Stiffness(_))));
    assert_eq!(beside(2, wall(50.0, 0.05)), Ok(()));
    for (place, stiffness, radius) in [
        (3, 50.0, 0.05),
        (2, 50.0, 0.0),
        (2, -1.0, 0.05),
        (1, f32::NAN, 0.05),
        (0, 50.0, f32::INFINITY),
    ] {
        let refused = beside(place, wall(stiffness, radius));
        assert_eq!(refused, Err(StreamError::Fixture(place)));
    }
    for stiffness in [
        (-1.0, 0.0, 50.0),
        (50.0, 60.0, 50.0),
        (f32::INFINITY, 0.0, 1.0),
        (0.0, f32::NAN, 0.0),
    ] {
        let impedance = Impedance {
            stiffness,
            ..soft(0.0, 0.01)
        };
        assert_eq!(begin(impedance), Err(StreamError::Matrix), "{stiffness:?}");
        let impedance = Impedance {
            damping: stiffness,
            ..soft(10.0, 0.0)
        };
        assert_eq!(begin(impedance), Err(StreamError::Matrix), "{stiffness:?}");
    }
}

/// The greatest stiffness in all directions where the joints are [N/m].
fn greatest(theta: [f64; 2]) -> f64 {
    let bounds = RenderingBounds::new::<BrushedDrives>(&settings().check().unwrap());
    let columns = jacobian(theta).map(|column| column.map(|x| x as f32));
    bounds.greatest_stiffness(columns)[0].into()
}

#[test]
fn where_the_arm_has_more_lever_the_springs_become_softer() {
    let smooth = with(|settings| {
        settings
            .axes
            .iter_mut()
            .for_each(|axis| axis.coulomb_friction = 0.0);
    });
    let mut rig = Rig::armed(&smooth);
    let (stiffest, damping) = (greatest(rig.bench.theta), 0.15);
    let stiff = config(soft(1e4, damping));
    let Err(StreamError::Stiffness(most)) = rig.planner.begin_stream(&mut rig.controller, &stiff)
    else {
        panic!("10,000 N/m are refused");
    };
    let mut felt = Felt::over(rig, soft(0.999 * most, damping));
    felt.run(150);
    // 20 mm along y.
    for _ in 0..50 {
        felt.target[0][1] += 4e-4;
        felt.run(10);
    }
    felt.run(500);
    let passive = greatest(felt.rig.bench.theta);
    assert!(passive < 0.94 * stiffest, "{passive} {stiffest}");
    let mut pulled = |force| {
        felt.hand = [force, 0.0];
        felt.run(4000);
        felt.tool().x
    };
    let (right, left) = (pulled(0.2), pulled(-0.2));
    let stiffness = 0.4 / (right - left);
    let expected = f64::from(most) * passive / stiffest;
    assert!(
        (stiffness / expected - 1.0).abs() < 0.02,
        "{stiffness} {expected} {most}"
    );
}

#[test]
fn arms_without_viscous_friction_are_refused_every_stiffness() {
    let dry = with(|settings| {
        settings
            .axes
            .iter_mut()
            .for_each(|axis| axis.viscous_friction = 0.0);
    });
    let mut rig = Rig::armed(&dry);
    let begun = rig
        .planner
        .begin_stream(&mut rig.controller, &config(soft(1.0, 0.0)));
    assert!(
        matches!(begun, Err(StreamError::Stiffness(most)) if most < 1e-3),
        "{begun:?}"
    );
}

#[test]
fn points_with_numbers_that_are_none_are_refused_and_the_third_ends_the_stream() {
    let mut felt = Felt::begin(&settings(), soft(100.0, 0.02));
    felt.run(50);
    for place in 0..3 {
        let target = felt.target;
        felt.target[place][1] = [f32::NAN, f32::INFINITY, f32::NAN][place];
        felt.point();
        felt.target = target;
        felt.tick();
    }
    assert_eq!(
        felt.stream(),
        (StreamPhase::Ends, Some(StreamReason::Number))
    );
    felt.without_points(300);
    assert_eq!(felt.rig.controller.state(), State::Armed);
}

#[test]
fn silence_a_stop_and_the_end_damp_the_arm_and_hold_it_and_an_emergency_stop_switches_off() {
    for end in 0..3 {
        let mut felt = Felt::begin(&settings(), soft(120.0, 0.02));
        felt.target[0][1] += 0.02;
        felt.run(140);
        assert!(felt.speed() > 0.02);
        match end {
            0 => {}
            1 => felt.rig.planner.end_stream(StreamReason::Asked),
            _ => felt.rig.controller.request(Request::Stop).unwrap(),
        }
        felt.without_points(60);
        let slow = felt.speed();
        assert!(slow < 0.02, "{end}: {slow} m/s");
        felt.without_points(200);
        assert_eq!(felt.rig.controller.state(), State::Armed);
        let reason = [
            StreamReason::Silent,
            StreamReason::Asked,
            StreamReason::Stopped,
        ][end];
        assert_eq!(felt.stream(), (StreamPhase::Ended, Some(reason)));
        let held = felt.tool();
        felt.hand = [0.0, 0.3];
        felt.without_points(300);
        assert!((felt.tool() - held).norm() < 1e-3);
    }
    let mut felt = Felt::begin(&settings(), soft(120.0, 0.02));
    felt.target[0][1] += 0.02;
    felt.run(140);
    felt.rig.bench.overlay.emergency_stop = true;
    let command = felt.rig.tick_alone();
    assert_eq!(command.enable, [false; 2]);
    let fault = felt.rig.controller.fault().map(|snapshot| snapshot.fault);
    assert_eq!(fault, Some(Fault::EmergencyStop));
}
