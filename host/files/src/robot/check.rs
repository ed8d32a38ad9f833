//! Checks a robot file and makes a robot of it.

use super::actuator::ActuatorFile;
use super::file::{ControlFile, LinkFile, RobotFile};
use super::home::best_conditioned;
use super::value::{
    LEAST_ACCELERATION, LEAST_INERTIA, LEAST_JERK, LEAST_MASS, LEAST_SPEED, LONGEST, NOT_NEGATIVE,
    POSITIVE, SHORTEST, at_least, finite, increasing, near, not_negative, positive, sized,
};
use super::{
    Actuator, Control, Limits, Protection, Robot, Supply, Tool, ToolLimits, can_torque,
    consistency, drive, hobby_servo, homing, stepper, tolerance, tool_output,
};
use crate::source::{FileError, Key, Refusals, Source};
use fivebar_firmware::settings::LONGEST_STOP;
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::dynamics::{Arm, Link};
use fivebar_kinematics::five_bar::{self, Geometry, GeometryError, Side, WorkingMode};
use fivebar_plant::contact::Contact;
use nalgebra::Vector2;
use std::f64::consts::TAU;

pub(super) fn robot(source: Source<'_>) -> Result<Robot, FileError> {
    let mut file: RobotFile = source.parse()?;
    // Every value is checked before the first refusal ends the reading.
    let mut refusals = Refusals::default();
    refusals.check(name(&source, &file.name));
    let gravity = refusals.noted(finite(&source, Key::Top("gravity"), file.gravity));
    let payload = file.payload.unwrap_or(0.0);
    refusals.check(not_negative(&source, Key::Top("payload"), payload));
    let links = refusals.noted(four_links(&source, file.link));
    let of_links = links.as_ref().map_err(FileError::clone).map(|links| {
        let geometry = refusals.noted(geometry(&source, links, file.base));
        (geometry, inertias(&source, links, &mut refusals))
    });
    let actuators = actuators(&source, file.actuator, &mut refusals);
    let actuators = actuators.map(|all| can_torque::completed(all, &mut file.control));
    let sides = file.working_mode.each_ref().map(|name| side(&source, name));
    let [elbow1, elbow4] = sides.map(|side| refusals.noted(side));
    let tool_output = refusals.noted(tool_output::read(&source, &file.tool_output));
    let tolerance = refusals.noted(tolerance::read(&source, &file.tolerance));
    refusals.check(contact(&source, &file.contact));
    let home = file.home.unwrap_or_default();
    refusals.check(finite(&source, Key::Top("home"), home));
    let drag = Key::In("crossing", "drag");
    refusals.check(not_negative(&source, drag, file.crossing.drag));
    let sections = Sections {
        tool: file.tool,
        limits: file.limits,
        motion: file.motion,
        control: file.control.given(),
        supply: file.supply,
        protection: file.protection,
    };
    sections.check(&source, &mut refusals);
    refusals.done()?;

    let (gravity, actuators) = (gravity?, actuators?);
    let (tool_output, tool_speeds) = tool_output?;
    let (geometry, inertias) = of_links?;
    let (geometry, elbows) = (geometry?, WorkingMode::new(elbow1?, elbow4?));
    let arm = |inertias| {
        let rotor = |a: Actuator| a.rotor_inertia * a.gear_ratio * a.gear_ratio;
        let rotors = actuators.map_or([0.0; 2], |actuators| actuators.map(rotor));
        let payload = file.payload.ok_or_else(|| missing_payload(&source))?;
        let arm = Arm::new(geometry, inertias, payload, gravity, rotors);
        arm.map_err(|error| source.refuse(Key::Top("link"), error))
    };
    let arm = inertias?.map(arm).transpose()?;
    let tool = five_bar::Tool::new(geometry, file.tool.offset.into())
        .map_err(|_| source.refuse(Key::In("tool", "offset"), "must not put the tool on B"))?;
    let home = file
        .home
        .unwrap_or_else(|| default_home(&tool, elbows, &file.limits));
    let mut homing = file.homing;
    if let Some(method) = hobby_servo::completed(&source, actuators.as_ref()) {
        homing.method = method;
    }
    let mut robot = Robot {
        name: file.name,
        geometry,
        gravity,
        arm,
        elbows,
        home,
        actuators,
        tool: file.tool,
        tool_output,
        tool_speeds,
        limits: file.limits,
        motion: file.motion,
        rigid_control: sections.control,
        control: sections.control,
        supply: file.supply,
        protection: file.protection,
        homing,
        tolerance: tolerance?,
        contact: file.contact,
        crossing: file.crossing,
        advanced: file.advanced,
        belts: None,
    };
    close_loops(&mut robot, &file.control);
    consistent(&source, &robot, file.home.is_some())?;
    Ok(robot)
}

/// The joint angles [rad] of the best conditioned pose; zero for an arm without any.
fn default_home(tool: &five_bar::Tool<f64>, elbows: WorkingMode, limits: &Limits) -> [f64; 2] {
    let pose = best_conditioned(tool, elbows, limits, |_| true);
    pose.map_or([0.0; 2], |pose| {
        [pose.u1.polar_angle(), pose.u4.polar_angle()]
    })
}

/// Gives the robot the loops of its file, or such as suit its arm.
fn close_loops(robot: &mut Robot, control: &ControlFile) {
    robot.rigid_control = control.completed(robot);
    robot.belts = control.belts(robot);
    robot.control = match robot.belts {
        Some(_) => control.completed(robot),
        None => robot.rigid_control,
    };
}

/// Whether the values agree with one another.
fn consistent(source: &Source<'_>, robot: &Robot, is_home_given: bool) -> Result<(), FileError> {
    let kinds = robot.actuators.map(|both| both.map(|it| it.kind()));
    if kinds.is_some_and(|[first, second]| first != second) {
        let reason = "must be the same for both joints";
        return Err(source.refuse(Key::Of("actuator", 1, "kind"), reason));
    }
    let mut refusals = Refusals::default();
    refusals.check(homing::check(source, robot));
    if is_home_given {
        refusals.check(home_fits(source, robot));
    }
    stepper::consistent(source, robot, &mut refusals);
    can_torque::consistent(source, robot, &mut refusals);
    hobby_servo::consistent(source, robot, &mut refusals);
    consistency::check(source, robot, &mut refusals);
    refusals.done()
}

fn contact(source: &Source<'_>, contact: &Contact) -> Result<(), FileError> {
    let Some(invalid) = contact.first_invalid() else {
        return Ok(());
    };
    let reason = format!("{}, not {:?}", invalid.must, invalid.value);
    Err(source.refuse(Key::In("contact", invalid.key), reason))
}

fn name(source: &Source<'_>, name: &str) -> Result<(), FileError> {
    let reason = if name.trim().is_empty() {
        "must not be empty"
    } else if name.contains(char::is_control) {
        // XML and tables cannot hold control characters.
        "must be one line of plain characters"
    } else {
        return Ok(());
    };
    Err(source.refuse(Key::Top("name"), reason))
}

fn four_links(source: &Source<'_>, links: Vec<LinkFile>) -> Result<[LinkFile; 4], FileError> {
    links.try_into().map_err(|links: Vec<_>| {
        let count = links.len();
        let reason = format!("must be given four times, not {count}: links 1 to 4");
        source.refuse(Key::Top("link"), reason)
    })
}

fn missing_payload(source: &Source<'_>) -> FileError {
    let reason = "is missing: links with masses need it; write 0.0 for no payload";
    source.refuse(Key::Top("payload"), reason)
}

fn side(source: &Source<'_>, name: &str) -> Result<Side, FileError> {
    match name {
        "left" => Ok(Side::Left),
        "right" => Ok(Side::Right),
        other => Err(source.refuse(
            Key::Top("working_mode"),
            format!("must name two sides, \"left\" or \"right\", not \"{other}\""),
        )),
    }
}

fn geometry(
    source: &Source<'_>,
    links: &[LinkFile; 4],
    base: f64,
) -> Result<Geometry<f64>, FileError> {
    let [l1, l2, l3, l4] = [0, 1, 2, 3].map(|i| links[i].length);
    let link = |index: usize| (Key::Of("link", index, "length"), links[index].length);
    for (key, length) in [(Key::Top("base"), base), link(0), link(1), link(2), link(3)] {
        if length > LONGEST && length.is_finite() {
            let reason = format!("is in metres, {LONGEST:?} at most, not {length:?}");
            return Err(source.refuse(key, reason));
        }
        if length > 0.0 && length < SHORTEST {
            let reason = format!("is in metres, {SHORTEST:?} at least, not {length:?}");
            return Err(source.refuse(key, reason));
        }
    }
    Geometry::new([l1, l2, l3, l4, base]).map_err(|error| match error {
        GeometryError::NotPositive(index @ 0..4) => source.refuse(
            Key::Of("link", index, "length"),
            format!("{POSITIVE} of metres, not {:?}", links[index].length),
        ),
        GeometryError::NotPositive(_) => source.refuse(
            Key::Top("base"),
            format!("{NOT_NEGATIVE}, in metres, not {base:?}"),
        ),
        GeometryError::ToolOffset => source.refuse(Key::In("tool", "offset"), error),
        GeometryError::CannotAssemble => source.refuse(
            Key::Top("base"),
            format!(
                "and the links cannot be assembled: of {l1:?}, {l2:?}, {l3:?}, {l4:?} and {base:?} m \
                 the longest exceeds the sum of the others"
            ),
        ),
        _ => source.refuse(Key::Top("base"), error),
    })
}

/// The links' masses, centres of mass and inertias: of every link, or of none (a robot with
/// lengths only).
fn inertias(
    source: &Source<'_>,
    links: &[LinkFile; 4],
    refusals: &mut Refusals,
) -> Result<Option<[Link<f64>; 4]>, FileError> {
    let bare = |link: &LinkFile| (link.mass, link.com, link.inertia) == (None, None, None);
    if links.iter().all(bare) {
        return Ok(None);
    }
    let mut inertias = [Link {
        mass: 0.0,
        com: Vector2::zeros(),
        inertia: 0.0,
    }; 4];
    for (index, (link, inertia)) in links.iter().zip(&mut inertias).enumerate() {
        let key = |name| Key::Of("link", index, name);
        let missing = |name| {
            source.refuse(
                key(name),
                "is missing: every link needs mass, com and inertia; for kinematics only, leave \
                 them out of all four",
            )
        };
        let mass = refusals.noted(link.mass.ok_or_else(|| missing("mass")))?;
        let com = refusals.noted(link.com.ok_or_else(|| missing("com")))?;
        let moment = refusals.noted(link.inertia.ok_or_else(|| missing("inertia")))?;
        refusals.check(at_least(source, key("mass"), mass, LEAST_MASS));
        refusals.check(near(source, key("com"), com));
        refusals.check(at_least(source, key("inertia"), moment, LEAST_INERTIA));
        *inertia = Link {
            mass,
            com: Vector2::from(com),
            inertia: moment,
        };
    }
    Ok(Some(inertias))
}

fn actuators(
    source: &Source<'_>,
    given: Vec<ActuatorFile>,
    refusals: &mut Refusals,
) -> Result<Option<[Actuator; 2]>, FileError> {
    if given.is_empty() {
        return Ok(None);
    }
    let given: [ActuatorFile; 2] = refusals.noted(given.try_into().map_err(|given: Vec<_>| {
        let reason = format!(
            "must be given twice, not {}: joint 1 and joint 4",
            given.len()
        );
        source.refuse(Key::Top("actuator"), reason)
    }))?;
    let [first, second] = given;
    let actuators = [
        first.read(source, 0, refusals),
        second.read(source, 1, refusals),
    ];
    for (index, a) in actuators.iter().enumerate() {
        if refusals.has_of("actuator", index) {
            continue;
        }
        let key = |name| Key::Of("actuator", index, name);
        if a.gear_ratio == 0.0 || !a.gear_ratio.is_finite() {
            let reason = format!(
                "must be finite and must not be 0 (negative if the motor turns against its joint), \
                 not {:?}",
                a.gear_ratio
            );
            refusals.add(source.refuse(key("gear_ratio"), reason));
        } else {
            refusals.check(sized(source, key("gear_ratio"), a.gear_ratio));
        }
        for (name, value) in [
            ("torque_constant", a.torque_constant),
            ("resistance", a.resistance),
            ("inductance", a.inductance),
            ("encoder_counts", f64::from(a.encoder_counts)),
            ("peak_current", a.peak_current),
            ("continuous_current", a.continuous_current),
            ("thermal_time_constant", a.thermal_time_constant),
            ("current_per_code", a.current_per_code.unwrap_or(1.0)),
        ] {
            refusals.check(positive(source, key(name), value));
        }
        for (name, value) in [
            ("rotor_inertia", a.rotor_inertia),
            ("viscous_friction", a.viscous_friction),
            ("coulomb_friction", a.coulomb_friction),
            ("brake_torque", a.brake_torque),
        ] {
            refusals.check(not_negative(source, key(name), value));
        }
        stepper::check(source, index, a, refusals);
        can_torque::check(source, index, a, refusals);
        hobby_servo::check(source, index, a, refusals);
        refusals.check(drive::check_brake(source, index, a));
        if !refusals.has_of("actuator", index) {
            refusals.check(drive::check(source, index, a));
        }
    }
    Ok(Some(actuators))
}

/// The sections of the file whose values are checked each by itself.
struct Sections {
    tool: Tool,
    limits: Limits,
    motion: ToolLimits,
    control: Control,
    supply: Supply,
    protection: Protection,
}

impl Sections {
    fn check(&self, source: &Source<'_>, refusals: &mut Refusals) {
        let Self {
            tool,
            limits,
            motion,
            control,
            supply,
            protection,
        } = self;
        refusals.check(near(source, Key::In("tool", "offset"), tool.offset));
        for range in limits.angle {
            let key = Key::In("limits", "angle");
            if let Err(error) = increasing(source, key, range) {
                refusals.add(error);
            } else if range.iter().any(|angle| angle.abs() > TAU) {
                let reason = format!("is in radians, within ±2π, not {range:?}");
                refusals.add(source.refuse(key, reason));
            }
        }
        if let Some(range) = supply.range {
            refusals.check(increasing(source, Key::In("supply", "range"), range));
        }
        for (key, of_joints, least) in [
            ("max_speed", limits.max_speed, (LEAST_SPEED, "rad/s")),
            (
                "max_acceleration",
                limits.max_acceleration,
                (LEAST_ACCELERATION, "rad/s²"),
            ),
        ] {
            for value in of_joints {
                refusals.check(at_least(source, Key::In("limits", key), value, least));
            }
        }
        for value in limits.max_torque.unwrap_or([1.0; 2]) {
            refusals.check(positive(source, Key::In("limits", "max_torque"), value));
        }
        for (key, value, least) in [
            ("max_speed", motion.max_speed, (LEAST_SPEED, "m/s")),
            (
                "max_acceleration",
                motion.max_acceleration,
                (LEAST_ACCELERATION, "m/s²"),
            ),
            ("max_jerk", motion.max_jerk, (LEAST_JERK, "m/s³")),
        ] {
            refusals.check(at_least(source, Key::In("motion", key), value, least));
        }
        self.check_stops(source, refusals);
        for (section, key, value) in [
            ("control", "tick_rate", control.tick_rate),
            ("control", "bandwidth", control.bandwidth),
            ("control", "damping", control.damping),
            ("control", "observer_bandwidth", control.observer_bandwidth),
            ("control", "current_bandwidth", control.current_bandwidth),
            ("supply", "voltage", supply.voltage),
            (
                "supply",
                "voltage_per_code",
                supply.voltage_per_code.unwrap_or(1.0),
            ),
            ("protection", "following_error", protection.following_error),
            ("protection", "over_speed", protection.over_speed),
            ("protection", "over_current", protection.over_current),
            ("protection", "command_timeout", protection.command_timeout),
        ] {
            refusals.check(positive(source, Key::In(section, key), value));
        }
        for (section, key, value) in [
            ("motion", "corner_tolerance", motion.corner_tolerance),
            ("control", "integral_rate", control.integral_rate),
        ] {
            refusals.check(not_negative(source, Key::In(section, key), value));
        }
        if !(0.0..1.0).contains(&limits.singularity_margin) {
            let reason = format!("is a sine: in 0…1, not {:?}", limits.singularity_margin);
            refusals.add(source.refuse(Key::In("limits", "singularity_margin"), reason));
        }
    }

    /// The controller's own rules: a stop from full speed takes at most [`LONGEST_STOP`].
    fn check_stops(&self, source: &Source<'_>, refusals: &mut Refusals) {
        let Self { limits, motion, .. } = self;
        let longest = f64::from(LONGEST_STOP);
        let mut gains = vec![(
            ("motion", "max_acceleration"),
            motion.max_acceleration,
            1.5 / longest * motion.max_speed,
            "m/s²",
        )];
        let jerk = 6.0 / (longest * longest) * motion.max_speed;
        gains.push((("motion", "max_jerk"), motion.max_jerk, jerk, "m/s³"));
        for (speed, acceleration) in limits.max_speed.into_iter().zip(limits.max_acceleration) {
            let key = ("limits", "max_acceleration");
            gains.push((key, acceleration, 1.5 / longest * speed, "rad/s²"));
        }
        for ((section, name), value, least, unit) in gains {
            let key = Key::In(section, name);
            let follows = refusals.has(key) || refusals.has(Key::In(section, "max_speed"));
            if value < least && !follows {
                let reason = format!(
                    "is {value:?} {unit}: a stop from max_speed would take more than 10 s; at least \
                     {least:.4} {unit} is needed"
                );
                refusals.add(source.refuse(key, reason));
            }
        }
    }
}

/// Checks that home is a pose in the working mode and within the joint limits.
fn home_fits(source: &Source<'_>, robot: &Robot) -> Result<(), FileError> {
    let [theta1, theta4] = robot.home;
    if !robot.limits.contain(robot.home) {
        let [limits1, limits4] = robot.limits.angle;
        let reason = format!(
            "[{theta1:?}, {theta4:?}] rad is outside the joints' limits {limits1:.4?} and {limits4:.4?} rad"
        );
        return Err(source.refuse(Key::Top("home"), reason));
    }
    robot.home_pose().map(|_| ()).map_err(|_| {
        let reason =
            format!("[{theta1:?}, {theta4:?}] rad: the arm has no pose there in its working mode");
        source.refuse(Key::Top("home"), reason)
    })
}
