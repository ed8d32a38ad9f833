//! The limits that an accepted path keeps, checked at every tick from the set-point that the
//! controller follows. The tool's motion is computed from it in double precision.

use fivebar_firmware::safety::State;
use fivebar_firmware::{Settings, Status};
use fivebar_kinematics::control::FrictionCompensation;
use fivebar_kinematics::dynamics::{Arm, Link};
use fivebar_kinematics::five_bar::{Geometry, Joint, PoseError, Side, Tool};
use nalgebra::Vector2;
use std::f64::consts::TAU;

/// Excess by the rounding of single precision, as a share of a limit.
const ROUNDING: f64 = 2e-3;

/// Error of the tool's acceleration by the rounding of the set-point's, as a share of the
/// greatest joint acceleration times the length of a driven link.
const ACCELERATION_ROUNDING: f64 = 1e-5;

/// Greatest steps of a joint's set-point [rad] and of its speed [rad/s] in a tick, beyond those of its
/// motion: those that two pieces of a host's motion may differ by, seen from a joint.
const STEP: [f64; 2] = [2e-4, 0.2];

/// The arm and its limits.
#[derive(Clone, Debug)]
pub struct Limits {
    settings: Settings,
    tool: Tool<f64>,
    arm: Arm<f64>,
    /// The tool's acceleration [m/s²] in the tick before, and the generation of its path.
    last: Option<(Vector2<f64>, u32)>,
    /// Angles [rad] and speeds [rad/s] of the set-point in the tick before, and the generation.
    joints: Option<([[f64; 2]; 2], u32)>,
}

/// The kind of the move that is followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Followed {
    /// A line or an arc of the tool.
    Path,
    /// A timed move: the tool's limits do not apply, those of the torque do.
    Timed,
    /// A joint move: the tool's limits do not apply, and a leg may be straight.
    Joint,
    /// A dwell, where the move before it has ended.
    Dwell,
}

/// The greatest share of each limit that was reached.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reached {
    /// Of the tool's speed.
    pub speed: f64,
    /// Of the tool's acceleration.
    pub acceleration: f64,
    /// Of the tool's jerk.
    pub jerk: f64,
    /// Of a joint's speed.
    pub joint_speed: f64,
    /// Of a joint's acceleration.
    pub joint_acceleration: f64,
    /// Of a joint's torque, along timed moves.
    pub torque: f64,
    /// The singularity margin over the least sine.
    pub margin: f64,
    /// Ticks along paths that were checked.
    pub ticks: u32,
    /// Those along timed moves.
    pub timed: u32,
}

impl Reached {
    /// The greater shares of both.
    #[must_use]
    pub fn max(self, other: Self) -> Self {
        Self {
            speed: self.speed.max(other.speed),
            acceleration: self.acceleration.max(other.acceleration),
            jerk: self.jerk.max(other.jerk),
            joint_speed: self.joint_speed.max(other.joint_speed),
            joint_acceleration: self.joint_acceleration.max(other.joint_acceleration),
            torque: self.torque.max(other.torque),
            margin: self.margin.max(other.margin),
            ticks: self.ticks.saturating_add(other.ticks),
            timed: self.timed.saturating_add(other.timed),
        }
    }
}

/// The motion of the arm and of its tool at a set-point.
struct ArmMotion {
    /// The sines of the three singularities.
    sines: [f64; 3],
    /// The tool's [m/s].
    velocity: Vector2<f64>,
    /// The tool's [m/s²].
    acceleration: Vector2<f64>,
    /// Of the joints, without friction [N·m].
    torque: [f64; 2],
}

impl Limits {
    /// The limits of these settings, which were checked.
    pub fn new(settings: &Settings) -> Option<Self> {
        let geometry = Geometry::new(settings.lengths.map(f64::from)).ok()?;
        let offset = settings.tool_offset.map(f64::from).into();
        let links = settings.links.map(|link| Link {
            mass: link.mass.into(),
            com: link.com.map(f64::from).into(),
            inertia: link.inertia.into(),
        });
        let rotors = settings.axes.map(|axis| {
            let ratio = f64::from(axis.gear_ratio);
            ratio * ratio * f64::from(axis.rotor_inertia)
        });
        let gravity = settings.gravity.map(f64::from).into();
        let payload = settings.payload.into();
        Some(Self {
            settings: *settings,
            tool: Tool::new(geometry, offset).ok()?,
            arm: Arm::new(geometry, links, payload, gravity, rotors).ok()?,
            last: None,
            joints: None,
        })
    }

    /// Checks the set-point of a tick. `followed` is the kind of the move in progress. The assembly
    /// mode is that which the controller reports: a crossing changes it. The generation of the path
    /// changes when a path is dropped and another may begin elsewhere.
    ///
    /// # Errors
    /// The limit that is exceeded, with both values.
    pub fn check(
        &mut self,
        status: &Status,
        followed: Option<Followed>,
        generation: u32,
        assembly: Side,
    ) -> Result<Reached, String> {
        let before = self.last.take();
        let joints_before = self.joints.take();
        let (Some(joints), State::Running, Some(followed)) =
            (status.joint_reference, status.state, followed)
        else {
            return Ok(Reached::default());
        };
        let motion = &self.settings.motion;
        let mut reached = Reached {
            ticks: 1,
            ..Reached::default()
        };
        let [omega1, omega4] = joints.velocity.map(f64::from);
        let [alpha1, alpha4] = joints.acceleration.map(f64::from);
        for (joint, axis) in self.settings.axes.iter().enumerate() {
            let share = |value: f64, limit: f32| value.abs() / f64::from(limit);
            let speed = share([omega1, omega4][joint], axis.max_speed);
            let acceleration = share([alpha1, alpha4][joint], axis.max_acceleration);
            within("joint speed", speed)?;
            within("joint acceleration", acceleration)?;
            reached.joint_speed = reached.joint_speed.max(speed);
            reached.joint_acceleration = reached.joint_acceleration.max(acceleration);
        }

        let now = [joints.angle, joints.velocity].map(|pair| pair.map(f64::from));
        if let Some((before, _)) = joints_before.filter(|&(_, of)| of == generation) {
            self.goes_on(before, now)?;
        }
        self.joints = Some((now, generation));

        // The status turns the set-point back by the loop's lag.
        let lag = 1.0 / f64::from(self.settings.control.current_bandwidth);
        let ahead = |angle: f32, omega: f64, alpha: f64| {
            f64::from(angle) + lag * (omega - 0.5 * lag * alpha)
        };
        let [angle1, angle4] = joints.angle;
        let theta = [ahead(angle1, omega1, alpha1), ahead(angle4, omega4, alpha4)];
        for (axis, theta) in self.settings.axes.iter().zip(theta) {
            let [low, high] = axis.angle_limits.map(f64::from);
            // The set-point's angles are known up to whole turns.
            let above = (theta - low).rem_euclid(TAU);
            if above > high - low + 1e-4 && above < TAU - 1e-4 {
                return Err(format!("a joint at {theta} rad is outside [{low}, {high}]"));
            }
        }
        let ArmMotion {
            sines,
            velocity,
            acceleration,
            torque,
        } = self
            .motion(assembly, theta, [omega1, omega4], [alpha1, alpha4])
            .map_err(|error| format!("no pose has the set-point: {error}"))?;
        let [leg1, leg4, parallel] = sines.map(f64::abs);
        // Before a path, or without one, an arm may rest with a straight leg while its tool changes.
        let rests = (joints.velocity, joints.acceleration) == ([0.0; 2], [0.0; 2]);
        let least = match followed {
            Followed::Path | Followed::Timed if !rests => leg1.min(leg4).min(parallel),
            Followed::Path | Followed::Timed | Followed::Joint | Followed::Dwell => parallel,
        };
        reached.margin = f64::from(motion.singularity_margin) / least;
        within("singularity margin over the sine", reached.margin)?;
        match followed {
            Followed::Path | Followed::Dwell => {}
            Followed::Joint => return Ok(reached),
            Followed::Timed => {
                (reached.torque, reached.timed) = (self.torque_share(torque, [omega1, omega4]), 1);
                return within("joint torque", reached.torque).map(|()| reached);
            }
        }

        let rounding = self.acceleration_rounding() / least;
        reached.speed = velocity.norm() / f64::from(motion.max_speed);
        within("tool speed", reached.speed)?;
        reached.acceleration =
            (acceleration.norm() - rounding).max(0.0) / f64::from(motion.max_acceleration);
        within("tool acceleration", reached.acceleration)?;
        if let Some((before, _)) = before.filter(|&(_, of)| of == generation) {
            let change = ((acceleration - before).norm() - 2.0 * rounding).max(0.0);
            let jerk = change * f64::from(self.settings.control.tick_rate);
            reached.jerk = jerk / f64::from(motion.max_jerk);
            within("tool jerk", reached.jerk)
                .map_err(|found| format!("{found}: {before:?} then {acceleration:?} m/s²"))?;
        }
        self.last = Some((acceleration, generation));
        Ok(reached)
    }

    /// The error of the tool's acceleration by rounding, of a sine of 1 [m/s²].
    fn acceleration_rounding(&self) -> f64 {
        let longest = self.settings.lengths.iter().fold(0.0_f32, |a, &b| a.max(b));
        let joint = self.settings.axes.map(|axis| axis.max_acceleration);
        ACCELERATION_ROUNDING * f64::from(longest * joint[0].max(joint[1]))
    }

    /// Whether the set-point has moved in a tick as its limits allow.
    fn goes_on(&self, before: [[f64; 2]; 2], now: [[f64; 2]; 2]) -> Result<(), String> {
        let period = 1.0 / f64::from(self.settings.control.tick_rate);
        for (joint, axis) in self.settings.axes.iter().enumerate() {
            let turn = now[0][joint] - before[0][joint];
            let turn = turn - TAU * (turn / TAU).round();
            let faster = now[1][joint] - before[1][joint];
            let beyond = |change: f64, limit: f32, step: f64| {
                change.abs() > f64::from(limit) * (1.0 + ROUNDING) * period + step
            };
            if beyond(turn, axis.max_speed, STEP[0])
                || beyond(faster, axis.max_acceleration, STEP[1])
            {
                return Err(format!("a joint jumps by {turn} rad and {faster} rad/s"));
            }
        }
        Ok(())
    }

    /// The greatest share of a joint's peak torque that this torque [N·m] and friction need.
    fn torque_share(&self, torque: [f64; 2], omega: [f64; 2]) -> f64 {
        let smoothing = f64::from(self.settings.control.friction_smoothing);
        let peak = self.settings.peak_torque();
        let [share1, share4] = Joint::ALL.map(|joint| {
            let axis = &self.settings.axes[joint];
            let [viscous, coulomb] = [axis.viscous_friction, axis.coulomb_friction].map(f64::from);
            let friction = FrictionCompensation::new(viscous, coulomb, smoothing);
            (torque[joint] + friction.torque(omega[joint])).abs() / f64::from(peak[joint])
        });
        share1.max(share4)
    }

    fn motion(
        &self,
        assembly: Side,
        [theta1, theta4]: [f64; 2],
        [omega1, omega4]: [f64; 2],
        [alpha1, alpha4]: [f64; 2],
    ) -> Result<ArmMotion, PoseError> {
        let geometry = self.tool.geometry();
        let pose = geometry.forward(theta1, theta4, assembly)?;
        let velocities = geometry.forward_velocities(&pose, omega1, omega4)?;
        let accelerations = geometry.forward_accelerations(&pose, &velocities, alpha1, alpha4)?;
        let [leg1, leg4] = self.tool.elbow_sines(&pose);
        let none = Vector2::zeros();
        Ok(ArmMotion {
            sines: [leg1, leg4, pose.sin32()],
            velocity: self.tool.velocity(&pose, &velocities),
            acceleration: self.tool.acceleration(&pose, &velocities, &accelerations),
            torque: self
                .arm
                .inverse_dynamics(&pose, &velocities, &accelerations, none)?,
        })
    }
}

fn within(name: &str, share: f64) -> Result<(), String> {
    if share <= 1.0 + ROUNDING {
        Ok(())
    } else {
        Err(format!("{name} reaches {share} of its limit"))
    }
}
