//! Requests to an arm whose drives are on a CAN bus, tick by tick.

use fivebar_design::servo::BusServo;
use fivebar_files::robot::{BuiltIn, Robot};
use fivebar_files::scenario::Scenario;
use fivebar_firmware::controller::Request;
use fivebar_firmware::drives::can::{BusCommand, BusDrives};
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::{ArmCommand, Status};
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::{CanPlant, FaultKind, Mismatch};
use fivebar_sim::link::{InProcess, Target};
use fivebar_sim::simulation::{Simulate, SimulatedArm, SimulatedDrives};
use nalgebra::Vector2;

const PROTOCOLS: [&str; 2] = [
    "protocol = \"odrive\"",
    "protocol = \"mit\"\nposition_range = 12.5\nvelocity_range = 640.0\ntorque_range = 2.0",
];

/// The arm `leg` with drives of this protocol.
fn leg(protocol: &str) -> Scenario {
    let text = BuiltIn::find("leg").expect("built in").text;
    let text = text.replace("protocol = \"odrive\"", protocol);
    Scenario::demonstration(Robot::parse("leg.toml", &text).unwrap())
}

/// A controller with its arm, tick by tick.
struct Bench {
    target: InProcess<BusDrives>,
    arm: CanPlant,
    status: Option<Status>,
}

impl Bench {
    fn of(scenario: &Scenario) -> Self {
        Self {
            target: InProcess::new(&scenario.robot.settings().unwrap()).unwrap(),
            arm: BusDrives::arm(scenario).unwrap(),
            status: None,
        }
    }

    fn run(&mut self, ticks: u32) {
        for _ in 0..ticks {
            let sample = SimulatedArm::sense(&mut self.arm);
            let (command, status) = self.target.tick(&sample).unwrap();
            SimulatedArm::step(&mut self.arm, &command, 1e-3);
            self.status = Some(status);
        }
    }

    /// Runs until it is in this state.
    fn until(&mut self, state: State) -> Status {
        for _ in 0..20_000 {
            self.run(1);
            if let Some(status) = self.status.filter(|status| status.state == state) {
                return status;
            }
        }
        panic!("{state:?} does not come: {:?}", self.status);
    }

    /// The controller sends nothing for a time, as while it stores settings.
    fn stall(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.arm.step(&[], true, 0, 1e-3);
        }
        self.arm.take_received();
    }

    /// Whether power comes and stays, or the fault with which it goes.
    fn powers(&mut self) -> Result<(), Fault> {
        self.target.request(Request::Home).unwrap();
        self.run(100);
        match self.status.expect("a tick").fault {
            Some(fault) => Err(fault),
            None => Ok(()),
        }
    }

    fn clear(&mut self) {
        self.target.request(Request::ClearFault).unwrap();
        self.run(20);
    }
}

#[test]
fn after_a_trip_of_the_drives_watchdogs_a_clear_lets_the_arm_be_powered_without_a_power_cycle() {
    for protocol in PROTOCOLS {
        let scenario = leg(protocol);
        let mut bench = Bench::of(&scenario);
        bench.run(50);
        bench.stall(500);
        bench.run(50);
        // Nothing is cleared by itself.
        assert_eq!(bench.powers(), Err(Fault::DriveError), "{protocol}");
        bench.clear();
        assert_eq!(bench.powers(), Ok(()), "{protocol}");

        // An error whose cause stays.
        bench.arm.break_drive(Joint::Joint4);
        bench.run(20);
        for _ in 0..3 {
            bench.clear();
            assert_eq!(bench.powers(), Err(Fault::DriveError), "{protocol}");
        }
    }
}

/// A drive may tell its error once more after it was told to clear it: with a heartbeat that it sent before.
#[test]
fn power_comes_at_the_first_request_after_a_clear_in_whatever_tick_this_is() {
    for protocol in PROTOCOLS {
        let scenario = leg(protocol);
        // A heartbeat comes every ten ticks.
        for phase in 0..10 {
            for after in [1, 2, 3, 6] {
                let mut bench = Bench::of(&scenario);
                bench.run(20);
                bench.stall(10);
                bench.run(20 + phase);
                assert_eq!(bench.powers(), Err(Fault::DriveError), "{protocol}");
                bench.target.request(Request::ClearFault).unwrap();
                bench.run(after);
                let what = format!("{protocol}, {after} ticks after a clear, phase {phase}");
                assert_eq!(bench.powers(), Ok(()), "{what}");
            }
        }
    }
}

/// Before a drive's first answer nothing is known of its angle, which may be far from 0.
#[test]
fn drives_that_count_from_elsewhere_than_0_are_no_encoder_jump_at_the_start() {
    let text = BuiltIn::find("leg").expect("built in").text;
    let absolute = [
        ("gear_ratio = 3.0", "gear_ratio = 1.0"),
        ("peak_torque = 0.97", "peak_torque = 2.91"),
        ("continuous_torque = 0.39", "continuous_torque = 1.17"),
        ("torque_constant = 0.0243", "torque_constant = 0.0729"),
        ("max_speed = 600.0", "max_speed = 200.0"),
        ("torque_range = 2.0", "torque_range = 6.0"),
        ("velocity_range = 640.0", "velocity_range = 220.0"),
    ];
    for protocol in PROTOCOLS {
        let text = text.replace("protocol = \"odrive\"", protocol);
        let text = absolute
            .iter()
            .fold(text, |text, (geared, direct)| text.replace(geared, direct));
        let text = format!("{text}\n[homing]\nmethod = \"absolute\"\n");
        let robot = Robot::parse("absolute.toml", &text).unwrap();
        let mut scenario = Scenario::demonstration(robot);
        scenario.fit().unwrap();
        let job = scenario.job().unwrap();
        let (summary, record) = scenario.simulate(&job, &mut |_| ()).unwrap();
        assert_eq!(record.faults, [], "{protocol}");
        assert!(summary.verdict.drawn, "{protocol}: {:?}", summary.verdict);
    }
}

/// The upright arm, homed and armed, or while it homes.
fn upright(protocol: &str, is_homed: bool) -> Bench {
    let text = BuiltIn::find("leg").expect("built in").text;
    let text = text
        .replace("protocol = \"odrive\"", protocol)
        .replace("gravity = [0.0, 9.81]", "gravity = [0.0, -9.81]");
    let robot = Robot::parse("upright.toml", &text).unwrap();
    let mut bench = Bench::of(&Scenario::demonstration(robot));
    bench.run(50);
    bench.target.request(Request::Home).unwrap();
    bench.run(200);
    if is_homed {
        bench.until(State::Stopped);
        bench.target.request(Request::Arm).unwrap();
        bench.run(500);
    }
    let state = bench.status.expect("a tick").state;
    assert_eq!(
        state,
        if is_homed {
            State::Armed
        } else {
            State::Homing
        }
    );
    bench
}

#[test]
fn failed_brakes_of_an_upright_arm_are_found_before_its_drives_lose_their_power() {
    for protocol in PROTOCOLS {
        for is_homed in [false, true] {
            for fail in [&[Joint::Joint1][..], &Joint::ALL] {
                let mut bench = upright(protocol, is_homed);
                for &joint in fail {
                    let kind = FaultKind::BrakeFails { joint };
                    bench.arm.arm_mut().inject(kind);
                }
                if is_homed {
                    bench.target.request(Request::Disarm).unwrap();
                }
                let status = bench.until(State::Fault);
                let what = format!("{protocol}, homed: {is_homed}, {fail:?}");
                assert_eq!(status.fault, Some(Fault::BrakeFailed), "{what}");
                // The drives catch the arm and hold it.
                let held = Joint::ALL.map(|j| bench.arm.angle(j));
                bench.run(2000);
                for j in Joint::ALL {
                    let sunk = (bench.arm.angle(j) - held[j]).abs();
                    assert!(sunk < 0.03, "{what}: joint {j:?} sinks by {sunk} rad");
                }
            }
        }
    }
}

/// Torques of a command times a factor, in the frames of ODrive.
fn times(command: &mut ArmCommand<BusCommand>, factor: f64) {
    for frame in command.drives.frames.iter_mut().flatten() {
        if let (0x0C, Some([.., low, high])) = (frame.id & 0x1F, &mut frame.data) {
            let torque = f64::from(i16::from_le_bytes([*low, *high]));
            [*low, *high] = ((factor * torque) as i16).to_le_bytes();
        }
    }
}

/// How far the joints swing in the end on an arm without gravity and friction, which gets this factor of the told torques at
/// home [rad].
fn swing(robot: &Robot, factor: f64) -> f64 {
    let mut scenario = Scenario::demonstration(robot.clone());
    scenario.mismatch = Mismatch::NONE;
    let mut bench = Bench::of(&scenario);
    bench.run(50);
    bench.target.request(Request::Home).unwrap();
    bench.run(200);
    bench.until(State::Stopped);
    bench.target.request(Request::Arm).unwrap();
    bench.until(State::Armed);
    let mut range = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    for tick in 0..3000 {
        // A push that ends the rest.
        let force = if (500..530).contains(&tick) { 2.0 } else { 0.0 };
        bench.arm.arm_mut().set_tool_force(Vector2::new(force, 0.0));
        let sample = SimulatedArm::sense(&mut bench.arm);
        let (mut command, status) = bench.target.tick(&sample).unwrap();
        times(&mut command, factor);
        SimulatedArm::step(&mut bench.arm, &command, 1e-3);
        if status.fault.is_some() {
            return f64::INFINITY;
        }
        if tick >= 2500 {
            for joint in Joint::ALL {
                let angle = bench.arm.angle(joint);
                let [least, greatest] = range[joint];
                range[joint] = [least.min(angle), greatest.max(angle)];
            }
        }
    }
    range
        .map(|[least, greatest]| greatest - least)
        .into_iter()
        .fold(0.0, f64::max)
}

#[test]
fn an_arm_oscillates_from_its_gain_margin_on() {
    let text = BuiltIn::find("leg").expect("built in").text;
    let text = text
        .replace("gravity = [0.0, 9.81]", "gravity = [0.0, 0.0]")
        .replace("coulomb_friction = 2e-2", "coulomb_friction = 0.0")
        .replace("viscous_friction = 2e-3", "viscous_friction = 0.0");
    let robot = Robot::parse("leg.toml", &text).unwrap();
    let (_, servo) = robot.bus_servos().unwrap().unwrap().servos[0];
    let law = servo.law(&robot.gains());
    let margin = BusServo::margins(&servo.loci(&law)).unwrap().gain_up;
    let [below, above] = [0.9, 1.1].map(|share| swing(&robot, share * margin));
    assert!(
        below < 2e-4 && above > 5e-3,
        "{margin}: {below}, {above} rad"
    );
}
