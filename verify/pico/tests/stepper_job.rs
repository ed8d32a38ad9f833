//! Jobs on the image for steppers: its edges are those of the desktop's loop, and its motors' simulated windings and rotors follow
//! them.

mod bench;

use bench::{Bench, PERIOD, commands, of, play, sample};
use fivebar_files::job::Job;
use fivebar_files::robot::Robot;
use fivebar_files::scenario::Scenario;
use fivebar_firmware::drivers::steps::StepAxis;
use fivebar_firmware::{Move, Request, Settings};
use fivebar_pico::{Arm, HZ, StepperArm, Wires};
use fivebar_plant::{Mismatch, StepperPlant};
use fivebar_sim::drive::{Drive, Homing};
use std::cell::RefCell;
use std::rc::Rc;

/// The steps of each tick in this process, from the first one to the last one.
fn desktop(settings: &Settings, job: &[Move], start: Request) -> [Vec<i32>; 2] {
    let mut axes = [StepAxis::default(), StepAxis::default()];
    let mut before = [0; 2];
    let mut steps = [Vec::new(), Vec::new()];
    play(settings, job, start, |controller| {
        let made = axes.each_mut().map(|axis| axis.begin_once(true));
        let command = controller.tick(&sample(made));
        for joint in 0..2 {
            axes[joint].prepare(command.drives.steps[joint]);
            steps[joint].push(made[joint] - before[joint]);
        }
        before = made;
    });
    steps.map(|steps| trimmed(&steps))
}

fn trimmed(steps: &[i32]) -> Vec<i32> {
    let moves = |steps: &i32| *steps != 0;
    let first = steps.iter().position(moves).expect("it moves");
    let last = steps.iter().rposition(moves).expect("it moves");
    steps[first..=last].to_vec()
}

#[test]
fn a_job_gives_the_steps_of_the_loop_in_this_process_tick_by_tick() {
    gives_the_steps_of_this_process(Bench::of("rp2350_stepper", "benchtop_stepper"));
}

#[test]
fn over_usb_it_gives_the_same_steps() {
    gives_the_steps_of_this_process(Bench::over_usb("rp2350_stepper", "benchtop_stepper"));
}

fn gives_the_steps_of_this_process(mut bench: Bench) {
    let settings = bench.settings;
    let start = Request::SetAngles(settings.axes.each_ref().map(|axis| axis.home_angle));
    bench.request(start).expect("accepted");
    bench.line.chip().run(HZ * 3 / 10).expect("it runs");
    let job = commands(&bench.robot, 0.1);
    bench.draw(&job);
    let wanted = desktop(&settings, &job, start);
    let mut chip = bench.line.chip();
    let wires = chip.wires();
    for (joint, wanted) in wanted.iter().enumerate() {
        let edges = of(&wires.pulses, joint);
        // The ticks of the state machines begin at some cycle: with the right one, no tick differs.
        let counted = |phase: u64| {
            let tick = |at: u64| ((at - phase) / PERIOD) as usize;
            let first = tick(edges[0].from);
            let mut steps = vec![0; tick(edges[edges.len() - 1].from) - first + 1];
            for edge in &edges {
                steps[tick(edge.from) - first] += if edge.forwards { 1 } else { -1 };
            }
            steps
        };
        let phase = (0..PERIOD).find(|&phase| &counted(phase) == wanted);
        println!(
            "joint {joint}: {} edges in {} ticks, phase {phase:?}",
            edges.len(),
            wanted.len()
        );
        assert!(edges.len() > 500, "{}", edges.len());
        assert!(phase.is_some(), "no phase gives the steps of this process");
    }
}

/// The arm, of which the test has an end.
struct Shared(Rc<RefCell<StepperArm>>);

impl Arm for Shared {
    fn advance(&mut self, wires: &mut Wires, brake_is_released: bool) {
        self.0.borrow_mut().advance(wires, brake_is_released);
    }
}

const DRAWING: &str = "G21 G90 F1800\nG1 X10 Y0\nG3 X10 Y10 I0 J5\nG1 X-10 Y-5\nG1 X0 Y0\n";

#[test]
fn the_arm_homes_and_draws_without_losing_a_step() {
    homes_and_draws(Bench::of("rp2350_stepper", "benchtop_stepper"));
}

#[test]
fn over_usb_the_arm_homes_and_draws_without_losing_a_step() {
    homes_and_draws(Bench::over_usb("rp2350_stepper", "benchtop_stepper"));
}

fn homes_and_draws(mut bench: Bench) {
    let (robot, settings): (Robot, Settings) = (bench.robot.clone(), bench.settings);
    // 0.03 rad before its home switches.
    let before = settings
        .axes
        .map(|axis| if axis.home_forward { -0.03 } else { 0.03 });
    let pose = robot.pose_near_home(before).expect("a reachable pose");
    let parameters = robot.plant_parameters().expect("masses");
    let motors = robot.steppers().expect("steppers");
    let plant = StepperPlant::new(&parameters, &motors, &Mismatch::default(), &pose, 7);
    let arm = Rc::new(RefCell::new(StepperArm::new(plant)));
    bench.line.chip().connect(Shared(Rc::clone(&arm)));

    let scenario = Scenario::new("drawing", robot, "drawing.gcode", DRAWING.into());
    let job: Job = scenario.job().expect("a job");
    let moves = scenario.moves(&job).expect("moves");
    let mut drive = Drive::new(&mut bench.client, &|| false);
    drive.store_settings(&settings).expect("stored");
    drive.home(Homing::IfUnknown).expect("homed");
    let mut worst: f64 = 0.0;
    let mut seen = 0;
    let followed = drive.follow(&moves, &settings, &mut |_, status| {
        let Some([x, y]) = status.tool else { return };
        let [true_x, true_y]: [f64; 2] = arm.borrow().plant.tool().into();
        worst = worst.max((f64::from(x) - true_x).hypot(f64::from(y) - true_y));
        seen += 1;
    });
    followed.expect("it draws");
    bench.line.chip().run(HZ / 100).expect("it runs");
    println!(
        "{seen} reports, {:.0} µm at most from the true tool, {:.2} s",
        1e6 * worst,
        bench.line.time().as_secs_f64()
    );
    assert_eq!(arm.borrow().plant.lost_steps(), [0, 0]);
    assert!(seen > 10, "{seen}");
    // The report is up to 10 ms old at 30 mm/s, and a micro-step is about 0.1 mm.
    assert!(worst < 5e-4, "{worst} m");
}
