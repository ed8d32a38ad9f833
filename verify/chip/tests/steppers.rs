//! The image for steppers: the edges of its pulses, against the manuals of the drivers and against where the arm is told to go.

mod bench;

use fivebar_chip::time::{MICROSECOND, MILLISECOND, Time, seconds};
use fivebar_chip::{Chip, HostLine, Image, Options, Outputs, Pin, SampleWindow, Wiring};
use fivebar_files::robot::Robot;
use fivebar_firmware::protocol::{Board, HostCommand};
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::settings::{BeltSettings, HomingMethod};
use fivebar_firmware::{Move, MoveKind, Request, Settings};
use fivebar_kinematics::five_bar::Joint;
use fivebar_sim::link::Client;
use std::cell::{RefCell, RefMut};
use std::f64::consts::TAU;
use std::rc::Rc;
use std::sync::{Arc, OnceLock};
use std::time::Duration;

/// A tick, of so many cycles of 168 MHz; the simulation rounds a cycle's time to a femtosecond.
const TICK: Time = 16_800 * 5_952_381;
/// The unevenness that is allowed.
const JITTER: Time = 100 * MICROSECOND / 1000;

/// Two step drivers, and home switches.
#[derive(Default)]
struct Drivers {
    outputs: Option<Outputs>,
    /// The rising edges of the steps: when, of which joint, forwards.
    edges: Vec<(Time, Joint, bool)>,
    position: [i32; 2],
    /// When each step and direction last changed.
    stepped: [Time; 2],
    turned: [Time; 2],
    /// The shortest pulse, gap between pulses, time from a direction to a step and from a step to a direction.
    shortest: [[Time; 4]; 2],
    stop: bool,
    /// The position beyond which each home switch is pressed.
    home: Option<[i32; 2]>,
}

#[derive(Clone)]
struct Shared(Rc<RefCell<Drivers>>);

impl Shared {
    fn get(&self) -> RefMut<'_, Drivers> {
        self.0.borrow_mut()
    }
}

impl Drivers {
    fn at_home(&self, joint: Joint) -> bool {
        self.home.is_some_and(|home| {
            let (at, edge) = (self.position[joint], home[joint]);
            if edge < 0 { at <= edge } else { at >= edge }
        })
    }

    fn follow(&mut self, now: Time, joint: Joint, before: &Outputs, after: &Outputs) {
        let (old, new) = (before.steps[joint], after.steps[joint]);
        let forwards = after.direction[joint] == Some(true);
        let shorter = |shortest: &mut Time, since: Time| *shortest = (*shortest).min(now - since);
        let [high, low, setup, hold] = &mut self.shortest[joint];
        if before.direction[joint] != after.direction[joint] {
            shorter(hold, self.stepped[joint]);
            self.turned[joint] = now;
        }
        if old == Some(false) && new == Some(true) {
            shorter(low, self.stepped[joint]);
            shorter(setup, self.turned[joint]);
            self.edges.push((now, joint, forwards));
            self.position[joint] += if forwards { 1 } else { -1 };
        }
        if old == Some(true) && new != Some(true) {
            shorter(high, self.stepped[joint]);
        }
        if old != new {
            self.stepped[joint] = now;
        }
    }
}

impl Wiring for Shared {
    fn drive(&mut self, now: Time, outputs: &Outputs) {
        let mut drivers = self.get();
        if let Some(before) = drivers.outputs.replace(*outputs) {
            for joint in Joint::ALL {
                drivers.follow(now, joint, &before, outputs);
            }
        }
    }

    fn level(&mut self, _: Time, pin: Pin) -> Option<bool> {
        match pin {
            // The emergency stop on both break inputs; home switches.
            Pin(1, 12) | Pin(0, 6) => Some(self.get().stop),
            Pin(2, 4) => Some(self.get().at_home(Joint::Joint1)),
            Pin(2, 5) => Some(self.get().at_home(Joint::Joint4)),
            // Fault outputs and the serial line.
            Pin(1, 0 | 1 | 7) => Some(true),
            _ => None,
        }
    }

    fn encoder(&mut self, _: Time, _: Joint, _: Time) -> i32 {
        0
    }

    fn sample(&mut self, _: &SampleWindow, _: &[fivebar_chip::Edges; 2]) -> u16 {
        0
    }
}

/// The image for steppers, which is built with the other one.
fn stepper_image() -> Arc<Image> {
    static IMAGE: OnceLock<Arc<Image>> = OnceLock::new();
    IMAGE
        .get_or_init(|| {
            let path = bench::path().with_file_name("stm32f405_stepper");
            Arc::new(Image::read(&path).expect("an image"))
        })
        .clone()
}

struct Bench {
    client: Client<HostLine>,
    line: HostLine,
    drivers: Shared,
    start: [f32; 2],
    settings: Settings,
}

/// The robot's settings with as many micro-steps as the board makes at this greatest speed of the joints [rad/s]. The
/// fields do not lead the load: where they do, a joint that stops turns back by its lead, and edges say no place.
fn fastest_settings(fastest: f32) -> Settings {
    let robot = Robot::load("benchtop_stepper").expect("a built-in robot");
    let mut settings = robot.settings().expect("settings");
    settings.home_reference.method = HomingMethod::Switch;
    settings.protection.over_speed = 1.02 * fastest;
    settings.belts = [BeltSettings::RIGID; 2];
    for axis in &mut settings.axes {
        axis.max_speed = fastest;
        axis.encoder_counts =
            (TAU as f32 * 199_000.0 / (1.02 * fastest * axis.gear_ratio.abs())) as u32 & !0xf;
    }
    settings
}

impl Bench {
    /// Connected, with these settings.
    fn ready(settings: Settings) -> Self {
        let drivers = Shared(Rc::new(RefCell::new(Drivers {
            shortest: [[Time::MAX; 4]; 2],
            ..Drivers::default()
        })));
        let options = Options {
            drives: fivebar_chip::DriveKind::Steppers,
            ..Options::default()
        };
        let chip = Chip::new(
            stepper_image(),
            options,
            Vec::new(),
            Box::new(drivers.clone()),
        )
        .expect("an emulator");
        let line = HostLine::new(chip);
        let time = |line: &HostLine| Duration::from_micros(line.chip().now() / MICROSECOND);
        let (mut client, identity) =
            Client::open_with_clock(line.clone(), time).expect("the controller answers");
        assert_eq!(identity.board, Board::Stm32f405Stepper);
        let applied = client.write_settings(&settings).expect("a line");
        applied.expect("the settings are applied");
        let start = settings.axes.each_ref().map(|axis| axis.home_angle);
        Self {
            client,
            line,
            drivers,
            start,
            settings,
        }
    }

    /// The same with known angles, and armed.
    fn armed(settings: Settings) -> Self {
        let mut bench = Self::ready(settings);
        let start = bench.start;
        let off = bench.drivers.get().outputs.expect("outputs").sleep;
        assert_eq!(off, [Some(true); 2], "the enables are high without power");
        // Only power keeps an arm without encoders where it is: this arms it.
        bench.request(Request::SetAngles(start));
        bench.run(300 * MILLISECOND);
        let on = bench.drivers.get().outputs.expect("outputs").sleep;
        assert_eq!(on, [Some(false); 2], "the enables are low with power");
        bench
    }

    fn run(&mut self, time: Time) {
        let ran = self.line.chip().run(time);
        if let Err(report) = ran {
            panic!("{report}");
        }
    }

    fn request(&mut self, request: Request) {
        let command = HostCommand::Request(request);
        let answer = self.client.command(command).expect("an answer");
        answer.unwrap_or_else(|error| panic!("{request:?}: {error:?}"));
    }

    fn go(&mut self, to: [f32; 2], speed: f32) {
        let kind = MoveKind::Joint { to, speed };
        let command = HostCommand::Move(Move {
            tag: 1,
            tool: 0,
            kind,
        });
        self.client.call(command).expect("an answer");
    }

    /// Lets the arm come to rest.
    fn finish(&mut self) {
        for _ in 0..400 {
            self.run(5 * MILLISECOND);
            let (status, _) = self.client.status().expect("a status");
            assert_eq!(status.fault, None);
            if status.state == State::Armed {
                return self.run(5 * MILLISECOND);
            }
        }
        panic!("the arm does not come to rest");
    }

    /// The steps from the start to these angles.
    fn steps_to(&self, angles: [f32; 2]) -> [i32; 2] {
        [0, 1].map(|joint| {
            let axis = &self.settings.axes[joint];
            let turn = f64::from(angles[joint] - self.start[joint]) / TAU;
            (turn * f64::from(axis.gear_ratio) * f64::from(axis.encoder_counts)).round() as i32
        })
    }
}

#[test]
fn every_step_comes_once_evenly_and_with_its_direction_up_to_200_000_in_a_second() {
    let mut bench = Bench::armed(fastest_settings(8.0));
    every_step_comes_once(
        &mut bench,
        &[
            (0.01, [-0.02, 0.02]),
            (0.3, [-0.2, 0.2]),
            (1.0, [-0.5, 0.5]),
            (1.0, [-0.02, 0.02]),
            (0.05, [-0.03, 0.01]),
        ],
    );
}

#[test]
fn none_of_a_million_steps_of_each_joint_is_lost_or_doubled() {
    let mut bench = Bench::armed(fastest_settings(1.0));
    // To and fro at each speed, half a second each way, and a million steps at the greatest one.
    let slower = [0.02, 0.07, 0.17, 0.29, 0.41, 0.53, 0.61, 0.72, 0.83, 0.94];
    let mut moves: Vec<(f32, [f32; 2])> = Vec::new();
    for speed in slower.into_iter().chain([1.0; 6]) {
        let to = 0.5 * speed;
        moves.extend([(speed, [-to, to]), (speed, [0.0; 2])]);
    }
    let edges = every_step_comes_once(&mut bench, &moves);
    assert!(edges.iter().all(|&edges| edges > 1_000_000), "{edges:?}");
}

/// Moves both joints to each place by its angles from the start [rad], with this share of the greatest speed, and
/// returns how many edges came to each driver.
fn every_step_comes_once(bench: &mut Bench, moves: &[(f32, [f32; 2])]) -> [usize; 2] {
    let start = bench.start;
    let mut position = [0; 2];
    let mut wanted_edges = [0, 0];
    for &(speed, [by1, by4]) in moves {
        let to = [start[0] + by1, start[1] + by4];
        bench.go(to, speed);
        bench.finish();
        let before = position;
        position = bench.drivers.get().position;
        let wanted = bench.steps_to(to);
        for joint in 0..2 {
            let off = position[joint] - wanted[joint];
            assert!(
                off.abs() <= 1,
                "to {to:?}: {position:?} steps for {wanted:?}"
            );
            // A joint that stops does not turn back.
            wanted_edges[joint] += (position[joint] - before[joint]).unsigned_abs() as usize;
        }
        let sample = bench.client.sample().expect("a line").expect("a sample");
        assert_eq!(
            sample.counts, position,
            "the steps that the board has counted"
        );
    }
    let began = bench.line.chip().tick_began();
    let drivers = bench.drivers.get();
    let mut seen = [false; 21];
    let mut worst = 0;
    let mut found = [0; 2];
    for (joint, found) in Joint::ALL.into_iter().zip(&mut found) {
        let edges: Vec<(u64, Time)> = drivers
            .edges
            .iter()
            .filter(|edge| edge.1 == joint)
            .map(|&(at, ..)| {
                let phase = began % TICK;
                ((at - phase) / TICK, (at - phase) % TICK)
            })
            .collect();
        *found = edges.len();
        for tick in edges.chunk_by(|one, next| one.0 == next.0) {
            let count = tick.len() as u64;
            seen[tick.len()] = true;
            for (k, &(_, at)) in (0..).zip(tick) {
                let even = (2 * k + 1) * TICK / (2 * count);
                worst = worst.max(even.abs_diff(at));
            }
        }
    }
    let speeds = seen.iter().filter(|seen| **seen).count();
    println!(
        "{} edges to {position:?}; {speeds} speeds, at most {:?} steps a tick; off by {} ns at most; \
         shortest high, low, setup, hold {:?} µs",
        drivers.edges.len(),
        seen.iter().rposition(|seen| *seen),
        1e9 * seconds(worst),
        drivers
            .shortest
            .map(|of| of.map(|time| 1e6 * seconds(time))),
    );
    assert!(worst <= JITTER, "{worst} fs");
    assert!(speeds >= 19 && (seen[19] || seen[20]), "{seen:?}");
    for [high, low, setup, hold] in drivers.shortest {
        // DM542: 2.5 µs high and low, within the clock's 6 ns; DIR 5 µs before. DRV8825: 0.65 µs after.
        assert!(high.min(low) >= 2490 * MICROSECOND / 1000, "{high} {low}");
        assert!(setup >= 5 * MICROSECOND && hold >= MICROSECOND);
    }
    assert_eq!(
        found, wanted_edges,
        "edges, and the steps from place to place"
    );
    found
}

#[test]
fn an_emergency_stop_ends_the_pulses_at_once_and_the_power_in_a_tick() {
    let mut bench = Bench::armed(fastest_settings(8.0));
    let [one, four] = bench.start;
    bench.go([one - 0.5, four + 0.5], 1.0);
    bench.run(100 * MILLISECOND);
    let before = bench.drivers.get().edges.len();
    assert!(before > 1000, "it moves: {before} edges");
    bench.drivers.get().stop = true;
    bench.line.chip().pins_changed();
    bench.run(2 * TICK);
    let drivers = bench.drivers.get();
    assert_eq!(drivers.edges.len(), before, "no edge");
    assert_eq!(drivers.outputs.expect("outputs").sleep, [Some(true); 2]);
    drop(drivers);
    let (status, _) = bench.client.status().expect("a status");
    assert_eq!(status.fault, Some(Fault::EmergencyStop));
    bench.run(20 * MILLISECOND);
    assert_eq!(bench.drivers.get().edges.len(), before);
}

#[test]
fn the_arm_homes_to_its_switches_and_goes_where_it_is_told() {
    let robot = Robot::load("benchtop_stepper").expect("a built-in robot");
    let mut bench = Bench::ready(robot.settings().expect("settings"));
    // 0.01 rad from the start.
    let axes = &bench.settings.axes;
    let edge = [0, 1].map(|joint| {
        let angle = if axes[joint].home_forward {
            0.01
        } else {
            -0.01
        };
        bench.start[joint] + angle
    });
    let edge = bench.steps_to(edge);
    bench.drivers.get().home = Some(edge);
    bench.request(Request::Home);
    let homed = |bench: &mut Bench| {
        bench.run(20 * MILLISECOND);
        let (status, _) = bench.client.status().expect("a status");
        assert_eq!(status.fault, None);
        // Only power keeps an arm without encoders where it is: it stays armed.
        status.homed && status.state == State::Armed
    };
    assert!((0..200).any(|_| homed(&mut bench)), "it homes");
    let to = [bench.start[0] - 0.2, bench.start[1] + 0.3];
    bench.go(to, 0.5);
    bench.finish();
    // The switches are at the home angles.
    let wanted = bench.steps_to(to);
    let position = bench.drivers.get().position;
    println!(
        "{position:?} steps for {wanted:?}, {edge:?} of the switches, at {:?}",
        bench.line.chip().now()
    );
    for joint in 0..2 {
        let off = position[joint] - edge[joint] - wanted[joint];
        assert!(off.abs() <= 2, "{position:?} {edge:?} {wanted:?}");
    }
}
