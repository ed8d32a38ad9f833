//! A job on the image for hobby servos with the simulated servos behind its pins: they turn to the pulses that come there, and the
//! tool goes as in the loop in this process.

mod bench;

use bench::{Bench, PERIOD, commands, play};
use fivebar_files::robot::Robot;
use fivebar_firmware::{Request, Settings};
use fivebar_pico::{Arm, HZ, ServoArm, Wires};
use fivebar_plant::{HobbyServoPlant, Mismatch};
use std::cell::RefCell;
use std::rc::Rc;

/// Cycles of a unit of a pulse, half a microsecond.
const UNIT: f64 = 75.0;
/// The speed of the job [m/s].
const FEED: f32 = 0.03;
/// How far the tool may be from where it is in this process at the same time [m]: less than its step for four units.
const TOLERANCE: f64 = 1e-4;

/// The arm at home.
fn plant(robot: &Robot) -> HobbyServoPlant {
    let pose = robot.pose_near_home([0.0; 2]).expect("a reachable pose");
    let parameters = robot.plant_parameters().expect("masses");
    let servos = robot.hobby_servos().expect("servos");
    HobbyServoPlant::new(&parameters, &servos, &Mismatch::default(), &pose, 7)
}

/// The tool after each tick of the same job in this process.
fn desktop(robot: &Robot, settings: &Settings) -> Vec<[f64; 2]> {
    let mut plant = plant(robot);
    let mut tools = Vec::new();
    play(
        settings,
        &commands(robot, FEED),
        Request::Home,
        |controller| {
            let command = controller.tick(&plant.sense());
            plant.step(&command, 1e-4);
            tools.push(plant.tool().into());
        },
    );
    tools
}

/// The arm behind the pins, and its tool every 100 µs.
struct Watched {
    arm: ServoArm,
    tools: Rc<RefCell<Vec<[f64; 2]>>>,
}

impl Arm for Watched {
    fn advance(&mut self, wires: &mut Wires, brake_is_released: bool) {
        self.arm.advance(wires, brake_is_released);
        let tool = self.arm.plant.tool().into();
        self.tools.borrow_mut().push(tool);
    }
}

fn distance([x, y]: [f64; 2], [other_x, other_y]: [f64; 2]) -> f64 {
    (x - other_x).hypot(y - other_y)
}

#[test]
fn the_servos_draw_a_job_from_the_pulses_at_the_pins() {
    let mut bench = Bench::new();
    let settings = bench.settings;
    let pulses = settings.servo_pulses().expect("servos");
    let home = pulses.map(|pulse| (f64::from(pulse.home_width) * HZ as f64).round());
    let tools = Rc::new(RefCell::new(Vec::new()));
    bench.line.chip().connect(Watched {
        arm: ServoArm::new(plant(&bench.robot), home, UNIT),
        tools: Rc::clone(&tools),
    });
    bench.power();
    let job = commands(&bench.robot, FEED);
    bench.draw(&job);
    bench.line.chip().run(1000 * PERIOD).expect("it runs");

    let wanted = desktop(&bench.robot, &settings);
    let tools = tools.borrow();
    // The last motion of both: how far from the end it begins to rest.
    let moves = |tools: &[[f64; 2]]| {
        let end = tools[tools.len() - 1];
        tools.iter().rposition(|&tool| distance(tool, end) > 1e-3)
    };
    let (here, there) = (
        moves(&tools).expect("it moves"),
        moves(&wanted).expect("it moves"),
    );
    let ticks = 15_000;
    let worst = |shift: usize| {
        let pairs = (0..ticks).step_by(10).map(|tick| {
            let at = here + shift - tick;
            distance(tools[at], wanted[there + 300 - tick])
        });
        pairs.fold(0.0, f64::max)
    };
    let best = (0..600)
        .map(|shift| (worst(shift), shift))
        .min_by(|one, other| one.0.total_cmp(&other.0));
    let (worst, shift) = best.expect("shifts");
    let drawn: f64 = tools
        .windows(2)
        .map(|pair| distance(pair[0], pair[1]))
        .sum();
    println!(
        "{:.1} µm at most from this process, shift {shift}; {:.1} mm drawn",
        1e6 * worst,
        1e3 * drawn
    );
    assert!(drawn > 0.03, "{drawn} m");
    assert!(worst < TOLERANCE, "{worst} m");
}
