//! The production image makes the tool a spring, with walls and guides.

mod bench;

use bench::{Bench, Driven, arm_at, robot};
use fivebar_chip::Options;
use fivebar_chip::time::MILLISECOND;
use fivebar_firmware::motion::{
    FIXTURES, Fixture, FixtureShape, Impedance, StreamConfig, StreamMode, StreamPoint, StreamPolicy,
};
use fivebar_firmware::protocol::HostCommand;
use fivebar_firmware::safety::State;
use nalgebra::Vector2;

/// Of the spring [N/m] and its damper [N·s/m].
const SPRING: (f32, f32) = (80.0, 0.02);
/// What a hand pulls with [N].
const PULL: f64 = 0.8;

fn armed() -> Driven {
    let [x, y] = robot().best_point().expect("a point");
    let arm = arm_at([x as f32, y as f32], MILLISECOND);
    let mut driven = Bench::of(arm, Options::default(), Vec::new()).ready();
    driven.arm();
    driven
}

fn tool(driven: &mut Driven) -> Vector2<f64> {
    let [x, y] = driven.status().tool.expect("a position").map(f64::from);
    Vector2::new(x, y)
}

fn isotropic(value: f32) -> (f32, f32, f32) {
    (value, 0.0, value)
}

fn config(stiffness: (f32, f32, f32), damping: (f32, f32, f32)) -> StreamConfig {
    StreamConfig {
        id: 7,
        mode: StreamMode::Impedance(Impedance { stiffness, damping }),
        period: 100,
        delay: 200,
        policy: StreamPolicy::Stop,
    }
}

/// Whether the controller does this.
fn does(driven: &mut Driven, command: HostCommand) -> bool {
    let done = driven.client.command(command).expect("an answer");
    done.is_ok()
}

/// Until the arm is held again; the host lives.
fn wait(driven: &mut Driven) {
    for _ in 0..20 {
        driven.run(20 * MILLISECOND);
        driven.status();
    }
}

/// Keeps the spring's end at a place while a hand pulls.
fn spring_at(driven: &mut Driven, first: u16, place: Vector2<f64>, pull: Vector2<f64>) {
    driven.arm.get().pull_tool(pull);
    for n in first..first + 60 {
        let point = StreamPoint {
            id: 7,
            due: 0,
            position: (place.x as f32, place.y as f32),
            velocity: (0.0, 0.0),
            force: (0.0, 0.0),
        };
        driven
            .client
            .send_point(n, &point)
            .expect("a point is sent");
        driven.run(10 * MILLISECOND);
    }
}

#[test]
fn a_spring_gives_way_by_the_force_over_its_stiffness_and_pulls_back() {
    let mut driven = armed();
    let (stiffness, damping) = SPRING;
    let begin = HostCommand::BeginStream(config(isotropic(stiffness), isotropic(damping)));
    assert!(does(&mut driven, begin));
    let home = tool(&mut driven);
    let mut pulled = [Vector2::zeros(); 2];
    for (k, (pull, place)) in [PULL, -PULL].into_iter().zip(&mut pulled).enumerate() {
        spring_at(
            &mut driven,
            1 + 60 * k as u16,
            home,
            Vector2::new(pull, 0.0),
        );
        *place = tool(&mut driven);
        assert_eq!(driven.status().state, State::Compliant);
    }
    // Dry friction, of which a part is compensated, holds both alike.
    let given = 0.5 * (pulled[0] - pulled[1]).x;
    let expected = PULL / f64::from(stiffness);
    assert!(
        (given - expected).abs() < 0.3 * expected,
        "{given} m for {expected} m"
    );
    // Twice as stiff, it gives way half as far; one that is not passive changes nothing.
    let changed = |k: f32| HostCommand::BeginStream(config(isotropic(k), isotropic(damping)));
    assert!(does(&mut driven, changed(2.0 * stiffness)));
    assert!(!does(&mut driven, changed(1e6)));
    for (k, (pull, place)) in [PULL, -PULL].into_iter().zip(&mut pulled).enumerate() {
        let pull = Vector2::new(pull, 0.0);
        spring_at(&mut driven, 130 + 60 * k as u16, home, pull);
        *place = tool(&mut driven);
    }
    let stiffer = 0.5 * (pulled[0] - pulled[1]).x;
    assert!(
        (stiffer - 0.5 * expected).abs() < 0.2 * expected,
        "{stiffer} m for {} m",
        0.5 * expected
    );
    spring_at(&mut driven, 260, home, Vector2::zeros());
    assert!((tool(&mut driven) - home).norm() < 0.5 * expected);
    assert!(does(&mut driven, HostCommand::EndStream));
    wait(&mut driven);
    let status = driven.status();
    assert_eq!((status.state, status.fault), (State::Armed, None));
}

#[test]
fn walls_and_guides_of_each_shape_hold_a_pull_and_wrong_ones_are_refused() {
    let mut driven = armed();
    let home = tool(&mut driven);
    let at = (home.x as f32, home.y as f32);
    let beside = (at.0 - 0.03, at.1);
    let normal = (1.0, 0.0);
    let shapes = [
        FixtureShape::HalfPlane { point: at, normal },
        FixtureShape::Box {
            centre: (at.0 + 0.03, at.1),
            axis: normal,
            half: (0.03, 0.02),
        },
        FixtureShape::Inside {
            centre: (at.0 + 0.03, at.1),
            radius: 0.03,
        },
        FixtureShape::Outside {
            centre: beside,
            radius: 0.03,
        },
        FixtureShape::Line { point: at, normal },
        FixtureShape::Circle {
            centre: beside,
            radius: 0.03,
        },
    ];
    let nothing = isotropic(0.0);
    let in_places = (0..FIXTURES as u8).flat_map(|place| shapes.map(|shape| (place, shape)));
    for (place, shape) in in_places {
        let fixture = Some(Fixture {
            shape,
            stiffness: SPRING.0,
            damping: SPRING.1,
        });
        let set = |fixture| HostCommand::SetFixture { place, fixture };
        assert!(does(&mut driven, set(fixture)));
        assert!(does(
            &mut driven,
            HostCommand::BeginStream(config(nothing, nothing))
        ));
        let before = tool(&mut driven);
        spring_at(&mut driven, 1, before, Vector2::new(-PULL, 0.0));
        // The tool may slide around a circle that it is not inside of.
        let pushed = match shape {
            FixtureShape::Outside { centre, radius } | FixtureShape::Circle { centre, radius } => {
                let (x, y) = centre;
                let away = tool(&mut driven) - Vector2::new(x, y).cast::<f64>();
                away.norm() - f64::from(radius)
            }
            _ => (tool(&mut driven) - home).x,
        };
        let most = 2.0 * PULL / f64::from(SPRING.0);
        assert!(pushed > -most, "{shape:?}: {pushed} m");
        driven.arm.get().pull_tool(Vector2::zeros());
        assert!(does(&mut driven, HostCommand::EndStream));
        wait(&mut driven);
        assert_eq!(driven.status().state, State::Armed, "{shape:?}");
        assert!(does(&mut driven, set(None)));
    }
    let wrong = Fixture {
        shape: FixtureShape::Line {
            point: at,
            normal: (0.0, 0.0),
        },
        stiffness: 10.0,
        damping: 0.0,
    };
    for place in [0, 9] {
        let fixture = Some(wrong);
        assert!(!does(
            &mut driven,
            HostCommand::SetFixture { place, fixture }
        ));
    }
    for (stiffness, damping) in [
        (isotropic(1e6), nothing),
        (isotropic(10.0), isotropic(1e3)),
        ((-10.0, 0.0, 10.0), nothing),
        ((f32::NAN, 0.0, 10.0), nothing),
    ] {
        let begin = HostCommand::BeginStream(config(stiffness, damping));
        assert!(!does(&mut driven, begin), "{stiffness:?} {damping:?}");
    }
}
