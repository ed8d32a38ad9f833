//! Sentences that say why a run was refused or ended early.

use super::quantity;
use fivebar_files::scenario::Scenario;
use fivebar_firmware::safety::Fault;
use fivebar_kinematics::five_bar::Joint;
use fivebar_sim::link::TargetError;
use fivebar_sim::simulation::{DemoScaleError, Record, RunError, Verdict, ended_by};

/// Why a run of this scenario was refused or ended early. A refused move is a line of the
/// job's file, with a placement that would work.
pub fn refusal(scenario: &Scenario, error: &RunError) -> String {
    match error {
        RunError::Target(TargetError::Move(error)) => scenario.refused_move(error),
        RunError::ModeChange(refused) => scenario.named(refused.line, &refused.error.to_string()),
        other => other.to_string(),
    }
}

/// Which fault stopped the arm, when, and why; none without a fault.
pub fn stopped_by(scenario: &Scenario, record: &Record) -> Option<String> {
    let sentence = ended_by(record)?;
    let (_, fault) = record.faults.first()?;
    let cause = match (fault, record.begun) {
        (Fault::FollowingError, Some(_)) => falls(scenario),
        (Fault::FollowingError, None) => homing_torques(scenario),
        (Fault::Oscillation, _) => backlash(scenario),
        _ => None,
    };
    Some(sentence + &cause.unwrap_or_default())
}

/// Why the job of a run was not drawn; none if it was.
pub fn not_drawn(scenario: &Scenario, record: &Record, verdict: &Verdict) -> Option<String> {
    stopped_by(scenario, record).or_else(|| verdict.why.clone())
}

/// Which fault stopped the arm, when, and what to do next; none without a fault.
pub fn fault_and_next_step(scenario: &Scenario, record: &Record) -> Option<String> {
    let (_, fault) = record.faults.first()?;
    let mut sentence = stopped_by(scenario, record)?;
    sentence[..1].make_ascii_uppercase();
    Some(format!("{sentence}. {}", next_step(*fault)))
}

/// What to do after a fault.
pub fn next_step(fault: Fault) -> &'static str {
    match fault {
        Fault::EncoderJump => "Check the encoder and its cable, then home again.",
        Fault::EncoderDisagreement => "Check the home switches and their angles, then home again.",
        Fault::FollowingError => {
            "Look for what blocks or drives the joint; else reduce speed and acceleration."
        }
        Fault::OverSpeed => "Reduce the speeds of [motion], or look for what drives the joint.",
        Fault::OverCurrent => "Look for a short circuit or a blocked joint.",
        Fault::OverTemperature => "Let the motor cool; reduce acceleration or payload.",
        Fault::UnderVoltage => "Check the supply; reduce acceleration.",
        Fault::OverVoltage => "Check the supply, and whether it takes the braking energy.",
        Fault::DriverFault => "Read the bridge's fault output; check its supply and its heat.",
        Fault::EmergencyStop => "Go on when the danger is over.",
        Fault::Envelope => "Check joint limits, home switches and payload.",
        Fault::CommandTimeout => {
            "Look whether the host, or the page in control, was closed, disconnected or suspended."
        }
        Fault::QueueUnderrun => "Check what delays the host or the planner.",
        Fault::TickOverrun => "Check what delays the tick.",
        Fault::NotANumber => "Report this as an error of the firmware, with the job.",
        Fault::ClockFailure => "Check the crystal: it must have 8, 12 or 16 MHz and start.",
        Fault::WatchdogReset => "Report this as an error of the firmware, with the job.",
        Fault::SettingsCorrupt => "Store the settings again.",
        Fault::Oscillation => {
            "State the drives' `stiffness` and the arm's masses as they are, and look for backlash in gears and \
             couplings: within it a motor turns alone, too light for its loop. Remove it, put the encoders at the \
             joints (`encoder_side`), or give [control] lower bandwidths (fivebar margins)."
        }
        Fault::IndexNotFound => "Check the encoders' index outputs and their wires.",
        Fault::IndexAmbiguous => {
            "Move a switch, or an encoder's disc, so that the switch closes half a turn of the encoder \
             behind the index pulse."
        }
        Fault::CurrentSensor => {
            "Check the motor's current sensor, its leads and its bridge; the robot file's resistance and \
             torque constant."
        }
        Fault::EncoderStuck => "Check the encoder, its cable and its supply, then home again.",
        Fault::AssemblyMode => {
            "Look in which assembly mode the arm is, and what hindered it; put it into that of home by hand, \
             then home again."
        }
        Fault::LostCounts => {
            "Check the encoders, their cables and the couplings between motors and joints, then the home \
             switches and index outputs; then home again."
        }
        Fault::BrakeFailed => {
            "Support the arm, press the emergency stop, which lets it go, and repair the brakes."
        }
        Fault::Panic | Fault::HardFault => {
            "Report this as an error of the firmware, with the job; then home again."
        }
        Fault::BrownOut => "Check the controller's supply and what else it feeds, then home again.",
        Fault::UnexpectedReset => {
            "Look for what reset the controller: its reset pin or a debugger; then home again."
        }
        Fault::DriveSilent => {
            "Check the drive's supply, the bus, its two terminators and the drives' `node`; with ODrive also \
             that its heartbeat comes every 10 ms."
        }
        Fault::DriveError => {
            "Clear the fault, which clears the drive's error, then arm again. If it comes back, read the drive's error by its \
             own program and remove the cause."
        }
        Fault::BusOff => {
            "Check the bus: its wires, its two terminators and the bit rate, 1 Mbit/s on all."
        }
        Fault::StepsLost => {
            "Look what held the arm, or lower its speed or `torque_share`; check the motors' wires and the encoders. The \
             arm is where the encoders show it: clear the fault and arm again."
        }
    }
}

/// If the simulated arm's drives have backlash: a sentence about it.
fn backlash(scenario: &Scenario) -> Option<String> {
    let gaps = scenario.mismatch.backlash;
    let [gap1, gap4] = gaps.map(|gap| quantity(gap, "rad"));
    gaps.iter().any(|&gap| gap > 0.0).then(|| {
        format!(
            ". Its drives have a backlash of {gap1} at joint 1 and {gap4} at joint 4: within it a motor turns alone, \
             and its loop takes it for the whole arm"
        )
    })
}

/// If the arm falls between homing and the job, while it is unpowered: a sentence about it.
fn falls(scenario: &Scenario) -> Option<String> {
    let home = scenario.robot.home_pose().ok()?;
    let weight = scenario.robot.arm().ok()?.gravity_torque(&home).ok()?;
    let drives = scenario.robot.drives().ok()?;
    let joint = Joint::ALL.into_iter().find(|&joint| {
        let drive = &drives[joint];
        weight[joint].abs() > drive.brake_torque + drive.coulomb_friction
    })?;
    let [needed, brake] = [weight[joint].abs(), drives[joint].brake_torque];
    Some(format!(
        ". Unpowered it falls: at home its weight needs {} at {joint}, but the `brake_torque` of \
         this joint is {}",
        quantity(needed, "N·m"),
        quantity(brake, "N·m")
    ))
}

/// The torques of homing: most arms that cannot be homed are too heavy for them.
fn homing_torques(scenario: &Scenario) -> Option<String> {
    let settings = scenario.robot.settings().ok()?;
    let [torque1, torque4] = settings.axes.map(|axis| {
        let current = f64::from(settings.homing.current);
        let torque = current * f64::from(axis.torque_constant * axis.gear_ratio);
        quantity(torque.abs(), "N·m")
    });
    Some(format!(
        ". Homing uses at most {torque1} at joint 1 and {torque4} at joint 4: the torque that \
         holds the arm at home, and that of 0.3 times the lower `peak_current`"
    ))
}

/// Why an arm cannot draw the demonstration.
pub fn no_demo_scale(error: &DemoScaleError) -> String {
    match error {
        DemoScaleError::TooLarge(scenario, error) => format!(
            "{}, even at a scale of {}",
            match error {
                RunError::Target(TargetError::Move(error)) => {
                    scenario.named(error.tag, &error.to_string())
                }
                other => refusal(scenario, other),
            },
            scenario.scale
        ),
        DemoScaleError::Run(scenario, error) => refusal(scenario, error),
        DemoScaleError::Stopped(scenario, record) => {
            stopped_by(scenario, record).unwrap_or_else(|| error.to_string())
        }
        _ => error.to_string(),
    }
}
