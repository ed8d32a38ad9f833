//! Hands against walls: what a rendered wall gives back is at most what the hand has put in.

use crate::rig::{Rig, settings};
use fivebar_firmware::motion::{
    Fixture, FixtureShape, Impedance, StreamConfig, StreamMode, StreamPoint, StreamPolicy,
};
use fivebar_firmware::planner::StreamError;
use fivebar_firmware::safety::State;
use fivebar_firmware::settings::{AxisSettings, Settings};
use fivebar_kinematics::five_bar::{Geometry, Side};
use nalgebra::Vector2;
use oorandom::Rand64;
use std::fmt::Write as _;

/// Of a tick [s].
const PERIOD: f64 = 1e-4;
/// How much more viscous friction the settings state than the arm has, so that walls are admitted that only the tank keeps passive.
const FRICTION_STATED: f32 = 4.0;
/// Damping ratio of the hand.
const HAND_DAMPING: f64 = 0.02;

/// The shapes that hands meet.
const SHAPES: [&str; 5] = [
    "half plane",
    "box",
    "inside of a circle",
    "outside of a circle",
    "line",
];
/// Less than this is rounding [J].
const ROUNDING: f64 = 1e-6;

/// A random number between two values.
fn within(random: &mut Rand64, low: f64, high: f64) -> f64 {
    low + (high - low) * random.rand_float()
}

/// As evenly in its logarithm.
fn log_within(random: &mut Rand64, low: f64, high: f64) -> f64 {
    within(random, low.ln(), high.ln()).exp()
}

/// A mass that is held by a spring at a place, and grips the tool by another spring.
struct Hand {
    mass: f64,
    /// Of the grip, and of the arm behind the hand [N/m].
    stiffness: f64,
    place: Vector2<f64>,
    velocity: Vector2<f64>,
    home: Vector2<f64>,
}

impl Hand {
    /// The force on the tool [N], and a tick of the hand.
    fn act(&mut self, tool: Vector2<f64>, tool_velocity: Vector2<f64>) -> Vector2<f64> {
        let damping =
            2.0 * HAND_DAMPING * (self.stiffness * self.mass).sqrt() + PERIOD * self.stiffness;
        let force =
            (self.place - tool) * self.stiffness + (self.velocity - tool_velocity) * damping;
        let held = (self.home - self.place) * self.stiffness - self.velocity * damping;
        self.velocity += (held - force) * (PERIOD / self.mass);
        self.place += self.velocity * PERIOD;
        force
    }
}

/// The columns of the tool's Jacobian [m] and the tool [m].
fn tool_of(
    geometry: &Geometry<f64>,
    [theta1, theta4]: [f64; 2],
) -> ([Vector2<f64>; 2], Vector2<f64>) {
    let pose = geometry.forward(theta1, theta4, Side::Left).unwrap();
    let by = |omega1, omega4| {
        geometry
            .forward_velocities(&pose, omega1, omega4)
            .unwrap()
            .c
    };
    ([by(1.0, 0.0), by(0.0, 1.0)], pose.c)
}

/// An arm whose settings state more friction than it has.
fn arm(random: &mut Rand64) -> (Settings, Rig) {
    let real = settings();
    let stated = Settings {
        axes: real.axes.map(|axis| AxisSettings {
            viscous_friction: FRICTION_STATED * axis.viscous_friction,
            ..axis
        }),
        ..real
    };
    let mut rig = Rig::armed(&stated);
    let (viscous, dry) = (within(random, 0.0, 0.5), within(random, 0.72, 1.0));
    rig.bench.change(|settings| {
        for (axis, real) in settings.axes.iter_mut().zip(&real.axes) {
            axis.viscous_friction = viscous as f32 * real.viscous_friction;
            axis.coulomb_friction = dry as f32 * real.coulomb_friction;
        }
    });
    (stated, rig)
}

/// A random wall or guide near the tool, and on its other side the place to which the hand is drawn.
fn wall(random: &mut Rand64, tool: Vector2<f64>) -> (usize, FixtureShape, Vector2<f64>) {
    let angle = within(random, 0.0, std::f64::consts::TAU);
    let normal = Vector2::new(angle.cos(), angle.sin());
    let left = Vector2::new(-normal.y, normal.x);
    let pair = |v: Vector2<f64>| (v.x as f32, v.y as f32);
    let away = within(random, 2e-3, 6e-3);
    let radius = within(random, 0.02, 0.05);
    let face = tool - normal * away;
    let home = face - normal * within(random, 2e-3, 0.02) + left * within(random, -0.01, 0.01);
    let kind = random.rand_range(0..SHAPES.len() as u64) as usize;
    let shape = match kind {
        0 => FixtureShape::HalfPlane {
            point: pair(face),
            normal: pair(normal),
        },
        1 => FixtureShape::Box {
            centre: pair(face + normal * radius),
            axis: pair(normal),
            half: (radius as f32, within(random, 5e-3, 0.05) as f32),
        },
        2 => FixtureShape::Inside {
            centre: pair(face + normal * radius),
            radius: radius as f32,
        },
        3 => FixtureShape::Outside {
            centre: pair(face - normal * radius),
            radius: radius as f32,
        },
        // Without energy at the beginning.
        _ => FixtureShape::Line {
            point: pair(tool),
            normal: pair(normal),
        },
    };
    (kind, shape, home)
}

/// A wall of a share of the stiffest that is admitted: the number of its shape, and the energy that the arm has given to a hand
/// at most in 0.9 s [J].
fn energy_out(seed: u64, with_tank: bool) -> (usize, f64) {
    let mut random = Rand64::new(seed.into());
    let (stated, mut rig) = arm(&mut random);
    let geometry = Geometry::new(stated.lengths.map(f64::from)).unwrap();
    let (_, tool) = tool_of(&geometry, rig.bench.theta);
    let (kind, shape, home) = wall(&mut random, tool);
    let share = within(&mut random, 0.3, 0.99) as f32;
    let mut config = |stiffness: f32| {
        let wall = Fixture {
            shape,
            stiffness,
            damping: 0.0,
        };
        rig.planner.set_fixture(0, Some(wall))?;
        let none = (0.0, 0.0, 0.0);
        let config = StreamConfig {
            id: 1,
            mode: StreamMode::Impedance(Impedance {
                stiffness: none,
                damping: none,
            }),
            period: 100,
            delay: 200,
            policy: StreamPolicy::Stop,
        };
        rig.planner.begin_stream(&mut rig.controller, &config)
    };
    let Err(StreamError::Stiffness(most)) = config(1e6) else {
        panic!("a stiff wall is refused");
    };
    assert_eq!(config(share * most), Ok(()));
    if !with_tank {
        rig.controller.take_tank_out();
    }
    let mut hand = Hand {
        mass: log_within(&mut random, 0.1, 1.0),
        stiffness: log_within(&mut random, 10.0, 1000.0),
        place: tool,
        velocity: Vector2::zeros(),
        home,
    };
    let (mut out, mut most) = (0.0_f64, 0.0_f64);
    let mut n = 0;
    for tick in 0..10_000_u32 {
        if tick % 100 == 0 {
            n += 1;
            let point = StreamPoint {
                id: 1,
                due: 0,
                position: (tool.x as f32, tool.y as f32),
                velocity: (0.0, 0.0),
                force: (0.0, 0.0),
            };
            rig.controller.feed_host_timeout();
            rig.planner.take_point(&mut rig.controller, n, &point);
        }
        let ([by1, by4], before) = tool_of(&geometry, rig.bench.theta);
        let [omega1, omega4] = rig.bench.omega;
        // The springs have risen.
        let force = if tick < 1100 {
            Vector2::zeros()
        } else {
            hand.act(before, by1 * omega1 + by4 * omega4)
        };
        rig.bench.push = [by1.dot(&force), by4.dot(&force)];
        let theta = rig.bench.theta;
        rig.planner.run(&mut rig.controller);
        rig.tick_alone();
        // The push is constant in the joints meanwhile.
        let turned = [rig.bench.theta[0] - theta[0], rig.bench.theta[1] - theta[1]];
        out -= rig.bench.push[0] * turned[0] + rig.bench.push[1] * turned[1];
        most = most.max(out);
        let fault = rig.controller.fault().map(|seen| seen.fault);
        assert_eq!(
            (rig.controller.state(), fault),
            (State::Compliant, None),
            "{seed} {tick}"
        );
    }
    (kind, most)
}

/// Of a shape: walls, those that gave a hand energy, and the greatest energy [J].
#[derive(Clone, Copy, Default)]
struct Count {
    walls: usize,
    active: usize,
    most: f64,
}

fn count(seeds: std::ops::Range<u64>, with_tank: bool) -> [Count; SHAPES.len()] {
    let mut counts = [Count::default(); SHAPES.len()];
    for seed in seeds {
        let (kind, out) = energy_out(seed, with_tank);
        let count = &mut counts[kind];
        count.walls += 1;
        if out > ROUNDING {
            println!("wall {seed}, {}, tank {with_tank}: {out} J", SHAPES[kind]);
            count.active += 1;
        }
        count.most = count.most.max(out);
    }
    counts
}

fn active(counts: &[Count]) -> usize {
    counts.iter().map(|count| count.active).sum()
}

#[test]
fn no_wall_gives_a_hand_energy_and_without_the_tank_some_do() {
    let (with, without) = (count(0..150, true), count(80..90, false));
    assert_eq!(active(&with), 0);
    assert!(active(&without) > 0);
}

/// The same in two threads.
fn count_all(seeds: u64, with_tank: bool) -> [Count; SHAPES.len()] {
    std::thread::scope(|scope| {
        let half = scope.spawn(move || count(0..seeds / 2, with_tank));
        let rest = count(seeds / 2..seeds, with_tank);
        let half = half.join().unwrap();
        std::array::from_fn(|kind| Count {
            walls: half[kind].walls + rest[kind].walls,
            active: half[kind].active + rest[kind].active,
            most: half[kind].most.max(rest[kind].most),
        })
    })
}

/// `FIVEBAR_UPDATE=1` writes the table.
#[test]
#[ignore = "eleven thousand runs take minutes"]
fn whole_table_of_ten_thousand_walls_that_give_a_hand_no_energy() {
    let (with, without) = (count_all(10_000, true), count_all(1_000, false));
    let mut table =
        "shape,walls,that give energy,walls without the tank,that give energy,at most [mJ]\n"
            .to_string();
    for ((shape, with), without) in SHAPES.iter().zip(&with).zip(&without) {
        let (walls, most) = (without.walls, 1e3 * without.most);
        let (all, active) = (with.walls, with.active);
        writeln!(
            table,
            "{shape},{all},{active},{walls},{},{most:.1}",
            without.active
        )
        .unwrap();
    }
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/verify/data/walls.csv");
    if std::env::var_os("FIVEBAR_UPDATE").is_some() {
        std::fs::write(path, &table).unwrap();
    }
    assert_eq!(active(&with), 0, "{table}");
    assert!(active(&without) > 0, "{table}");
    assert_eq!(std::fs::read_to_string(path).unwrap(), table);
}
