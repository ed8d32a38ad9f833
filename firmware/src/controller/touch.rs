//! An arm that gives way: a hand leads it, and its motors carry its weight.
//!
//! τ = G(q) + share · friction(ω) + springs of walls(q) + dampers of walls(q, ω) − d M(q) ω. What may last, the first three, is
//! within the torques that the motors bear for ever; what only brakes has all of their torque.
//!
//! | part | why |
//! |---|---|
//! | gravity G | the arm stays where the hand leaves it |
//! | a share of the friction | the hand feels less of it; what is left brakes the arm |
//! | [walls](fivebar_kinematics::control::Walls) | the arm stays within its angles and away from both kinds of singularity |
//! | d > 0 above 0.8 of [`SPEED`] | nobody throws the arm |
//!
//! With an impedance the controller renders [springs](super::impedance), too. Then only dry friction is fed forward, because the rest of
//! it is what the bound of the springs counts on, and the springs and forces that drive the arm on are faded out up to [`SPEED`].
//!
//! A host keeps it so by points, which come each period. Where none comes for [`TIMEOUT`], or the stream ends, the arm is damped,
//! d = [`BRAKING`], with all of its torque, and is held [`DAMPED`] later.

use super::ArmController;
use super::impedance::{Push, Rendered, Renderer, Rendering, ToolState};
use super::model::AxisModel;
use super::setpoint::Setpoint;
use super::tick::TorqueCommand;
use crate::drives::{Drives, Needs, Stage};
use crate::motion::StreamPoint;
use crate::safety::{Event, Fault, Limits, State};
use crate::settings::CheckedSettings;
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::control::{TorqueLimit, WallLimits, Walls};
use fivebar_kinematics::five_bar::WorkingMode;
use nalgebra::Vector2;

/// Silence of the points after which the arm is damped [s].
const TIMEOUT: f32 = 0.02;
/// The time for which it is damped [s]; longer than the rest of the command timeout, so that a silent host is a fault.
const DAMPED: f32 = 0.15;
/// The speed of the tool that a hand cannot pass without force [m/s].
const SPEED: f32 = 0.25;
/// The share of it from which on the arm is damped, more and more.
const FREE_SPEED: f32 = 0.8;
/// The rate at which a damped arm loses its speed [1/s].
const BRAKING: f32 = 200.0;
/// The greatest product of that rate and the loop's delay: a quarter of what makes it swing.
const BRAKING_DELAY: f32 = 0.35;
/// The longest time from a joint's angle to its torque [s] with which an arm gives way to a hand. In simulation a leg on a CAN bus,
/// with 2 ms, left its limits when nobody held it; why is not known.
const LONGEST_DELAY: f32 = 2.25e-3;
/// The share of the friction that is fed forward.
const FRICTION: f32 = 0.7;
/// The bandwidth of the walls as a share of that of the position loop.
const WALL_BANDWIDTH: f32 = 0.33;
/// The walls begin so far before the joints' limits [rad], or by this share of their range.
const WALL_WIDTH: (f32, f32) = (0.05, 0.1);
/// The walls begin at so many times the margin from singularities, and at this sine at most.
const WALL_MARGINS: (f32, f32) = (2.5, 0.6);
/// The time in which walls rise where an arm begins behind one [s].
const RISE: f32 = 0.1;

/// Why an arm does not give way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TouchError {
    /// Its drives give no torque: they follow a motion.
    NoTorque,
    /// Its motors are behind belts.
    Belts,
    /// Its torques act too late.
    LateTorque,
    /// It moves, wakes up or has moves queued.
    Moving,
}

/// What an arm that gives way does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TouchPhase {
    /// It gives way.
    Yields,
    /// No points come: it is damped. A point lets it give way again.
    Damps,
    /// It is damped until it is held.
    Ends,
}

/// How the arm gives way, and for how long it has.
#[derive(Clone)]
pub(super) struct Touch {
    phase: TouchPhase,
    /// The tick in which it began, and that of the last point.
    begun: u32,
    fed_at: u32,
    /// Ticks for which it has been damped.
    damped: u32,
    /// The working mode in which it began.
    mode: WorkingMode,
    walls: Walls<f32>,
    /// What the motors give for ever.
    continuous: TorqueLimit<f32>,
    /// [1/s].
    braking: f32,
    /// Whether its torques act too late.
    is_late: bool,
    timeout: u32,
    longest: u32,
    per_rise: f32,
    pub(super) renderer: Renderer,
    pub(super) rendered: Rendered,
}

impl Touch {
    pub(super) fn new<D: Drives>(settings: &CheckedSettings) -> Self {
        let control = &settings.control;
        let [axis1, axis4] = &settings.axes;
        let late = axis1.encoder_latency.max(axis4.encoder_latency);
        let delay = D::lag(settings, Stage::Moves) + late + 1.5 / control.tick_rate;
        let (width, of_range) = WALL_WIDTH;
        let (margins, most) = WALL_MARGINS;
        let [inertia1, inertia4] = settings.nominal_inertia();
        let (inertia, rate) = (inertia1.min(inertia4), WALL_BANDWIDTH * control.bandwidth);
        let limits = WallLimits {
            angles: settings.axes.map(|axis| {
                let [low, high] = axis.angle_limits;
                let width = width.min(of_range * (high - low));
                [low + width, high - width]
            }),
            sine: (margins * settings.motion.singularity_margin).min(most),
            stiffness: inertia * rate * rate,
            damping: 2.0 * inertia * rate,
        };
        let ticks = |time: f32| (time * control.tick_rate) as u32;
        Self {
            phase: TouchPhase::Ends,
            begun: 0,
            fed_at: 0,
            damped: 0,
            mode: settings.working_mode(),
            walls: Walls::new(settings.tool(), &limits),
            continuous: TorqueLimit(settings.continuous_torque()),
            braking: BRAKING.min(BRAKING_DELAY / delay),
            is_late: delay > LONGEST_DELAY,
            timeout: ticks(TIMEOUT),
            longest: ticks(DAMPED),
            per_rise: 1.0 / (RISE * control.tick_rate),
            renderer: Renderer::new::<D>(settings),
            rendered: Rendered::none(),
        }
    }

    /// Damps the arm, then ends.
    pub(super) fn end(&mut self) {
        if self.phase == TouchPhase::Yields {
            self.damped = 0;
        }
        self.phase = TouchPhase::Ends;
    }

    /// One tick: whether it is to be held.
    #[inline(always)]
    fn advance(&mut self, tick: u32) -> bool {
        match self.phase {
            TouchPhase::Yields if tick.wrapping_sub(self.fed_at) > self.timeout => {
                self.phase = TouchPhase::Damps;
                self.damped = 0;
                false
            }
            TouchPhase::Yields => false,
            TouchPhase::Damps | TouchPhase::Ends => {
                self.damped = self.damped.saturating_add(1);
                self.damped > self.longest
            }
        }
    }

    /// The share of its braking with which the arm is damped, of a tool of this squared speed [m²/s²].
    #[inline(always)]
    fn braked(&self, square: f32) -> f32 {
        if self.phase != TouchPhase::Yields {
            return 1.0;
        }
        const FREE: f32 = FREE_SPEED * FREE_SPEED * SPEED * SPEED;
        let share = (square - FREE) * (1.0 / (SPEED * SPEED - FREE));
        if share > 1.0 {
            1.0
        } else if share > 0.0 {
            share
        } else {
            0.0
        }
    }

    /// What springs and dampers do in this tick.
    #[inline(always)]
    fn render(&mut self, tool: &ToolState) -> Push {
        if !self.rendered.is_on {
            return Push::NONE;
        }
        if self.phase != TouchPhase::Yields {
            self.rendered.pause(tool.angles);
            return Push::NONE;
        }
        self.renderer.render(&mut self.rendered, tool)
    }

    /// The friction that is fed forward, before its share [N·m].
    #[inline(always)]
    fn friction(
        &self,
        axis1: &AxisModel,
        axis4: &AxisModel,
        [omega1, omega4]: [f32; 2],
    ) -> [f32; 2] {
        if self.rendered.is_on {
            [axis1.friction.dry(omega1), axis4.friction.dry(omega4)]
        } else {
            [axis1.friction.torque(omega1), axis4.friction.torque(omega4)]
        }
    }

    /// Tells the tank what springs and dampers give [N·m], and what the limits left of both.
    #[inline(always)]
    fn account(
        &mut self,
        of_spring: f32,
        [spring1, spring4]: [f32; 2],
        of_damper: f32,
        [damper1, damper4]: [f32; 2],
    ) {
        if self.rendered.is_on {
            let torque = [
                of_spring * spring1 + of_damper * damper1,
                of_spring * spring4 + of_damper * damper4,
            ];
            self.rendered.demand(&self.renderer.tank, of_spring, torque);
        }
    }

    /// The shares of the friction and of the walls that act in this tick.
    #[inline(always)]
    fn shares(&self, tick: u32) -> [f32; 2] {
        let risen = tick.wrapping_sub(self.begun) as f32 * self.per_rise;
        let friction = match self.phase {
            TouchPhase::Yields => FRICTION,
            TouchPhase::Damps | TouchPhase::Ends => 0.0,
        };
        [friction, if risen < 1.0 { risen } else { 1.0 }]
    }
}

impl<D: Drives> ArmController<D> {
    /// Whether a held arm can give way.
    ///
    /// # Errors
    /// Why it does not.
    pub(crate) fn check_touch(&self) -> Result<(), TouchError> {
        if D::NEEDS == Needs::Motion {
            return Err(TouchError::NoTorque);
        }
        if self.model.on_belts {
            return Err(TouchError::Belts);
        }
        if self.touch.is_late {
            return Err(TouchError::LateTorque);
        }
        if !self.lets_stream() {
            return Err(TouchError::Moving);
        }
        Ok(())
    }

    /// Lets a held arm give way, and renders springs if it is told which.
    ///
    /// # Errors
    /// Why it does not; nothing has changed then.
    pub(crate) fn begin_touch(&mut self, rendering: Option<&Rendering>) -> Result<(), TouchError> {
        self.check_touch()?;
        let angles = self.angles();
        self.touch.rendered.begin(rendering, angles);
        let Touch {
            phase,
            begun,
            fed_at,
            damped,
            mode,
            ..
        } = &mut self.touch;
        *phase = TouchPhase::Yields;
        (*begun, *fed_at, *damped, *mode) = (self.ticks, self.ticks, 0, self.mode);
        // A pen is lifted: nobody knows where the hand goes.
        self.forget_path();
        self.setpoint_history.restart();
        for joint in &mut self.joints {
            joint.release();
        }
        // Armed accepts this event.
        let _ = self.dispatch(Event::Yield);
        Ok(())
    }

    /// What an arm that gives way does; none if it does not.
    pub(crate) fn touch_phase(&self) -> Option<TouchPhase> {
        (self.state == State::Compliant).then_some(self.touch.phase)
    }

    /// A point has come: the arm gives way. Returns whether it does: not while it ends.
    pub(crate) fn feed_touch(&mut self, point: &StreamPoint) -> bool {
        let touch = &mut self.touch;
        let goes_on = touch.phase != TouchPhase::Ends;
        if goes_on {
            touch.rendered.follow(point);
            touch.phase = TouchPhase::Yields;
            touch.fed_at = self.ticks;
        }
        goes_on
    }

    /// Damps the arm, then holds it.
    pub(crate) fn end_touch(&mut self) {
        self.touch.end();
    }

    /// One tick of an arm that gives way: the torques.
    #[inline(always)]
    pub(super) fn comply(&mut self) -> Result<TorqueCommand, Fault> {
        let ([theta1, theta4], [omega1, omega4]) = self.touched();
        let directions = Vector2::units([theta1, theta4]);
        let links = self.measured(directions)?;
        // It is held here if it ends now.
        self.setpoint = Setpoint::hold(directions);
        self.error = [0.0; 2];
        self.rest.move_on();
        self.at_rest = self.touch.advance(self.ticks);

        let (model, touch) = (&self.model, &mut self.touch);
        let [axis1, axis4] = &model.axes;
        let (tool, omega) = (&model.tool, [omega1, omega4]);
        let pushed = touch
            .walls
            .push(tool, touch.mode, &links, [theta1, theta4], omega);
        self.mode = pushed.mode;
        let [by1, by4] = tool.jacobian_of(&links, &pushed.rates);
        let velocity = by1 * omega1 + by4 * omega4;
        let push = touch.render(&ToolState {
            angles: [theta1, theta4],
            place: links.ab + tool.from_b(&links),
            velocity,
            jacobian: [by1, by4],
        });
        let fast = touch.braked(velocity.length_squared());
        let braked = if fast > push.braking {
            fast
        } else {
            push.braking
        };
        let damping = braked * touch.braking;
        let (alpha1, alpha4) = (-damping * omega1, -damping * omega4);
        // Velocities of zero: the hand feels the arm's own momentum.
        let [gravity1, gravity4] = model.equations.gravity_by(&links, &pushed.rates);
        let [mass11, mass14, mass44] = model.equations.mass_by(&links, &pushed.rates);
        let ([friction, walls], [spring1, spring4]) = (touch.shares(self.ticks), pushed.spring);
        let [dry1, dry4] = touch.friction(axis1, axis4, omega);
        let kept = push.kept(omega, fast);
        let ([own1, own4], [host1, host4]) = (push.spring, push.host);
        let lasting = [
            gravity1 + friction * dry1 + walls * spring1 + kept * (own1 + host1),
            gravity4 + friction * dry4 + walls * spring4 + kept * (own4 + host4),
        ];
        let weak = touch.continuous.factor(lasting);
        let (weakened, [damper1, damper4]) = (weak.unwrap_or(1.0), pushed.damper);
        let ([lasting1, lasting4], [drag1, drag4]) = (lasting, push.damper);
        let (brake1, brake4) = (
            drag1 + mass11 * alpha1 + mass14 * alpha4,
            drag4 + mass14 * alpha1 + mass44 * alpha4,
        );
        let all = [
            weakened * lasting1 + walls * damper1 + brake1,
            weakened * lasting4 + walls * damper4 + brake4,
        ];
        let limited = model.torque_limit.factor(all);
        let factor = limited.unwrap_or(1.0);
        touch.account(
            factor * weakened * kept,
            [own1, own4],
            factor,
            [brake1, brake4],
        );
        Ok(TorqueCommand {
            torque: all.map(|torque| factor * torque),
            limits: Limits::empty().with(Limits::TORQUE, weak.is_some() | limited.is_some()),
        })
    }

    /// The joints [rad], [rad/s] for which torques are computed: when these act, or as measured where springs are rendered.
    #[inline(always)]
    fn touched(&self) -> ([f32; 2], [f32; 2]) {
        if self.touch.rendered.is_on {
            return (self.angles(), self.velocities());
        }
        let [joint1, joint4] = &self.joints;
        let [axis1, axis4] = &self.model.axes;
        let (loop1, loop4) = (&axis1.servo.position_loop, &axis4.servo.position_loop);
        let (theta1, omega1) = loop1.predict(joint1.angle(), joint1.velocity(), 0.0);
        let (theta4, omega4) = loop4.predict(joint4.angle(), joint4.velocity(), 0.0);
        ([theta1, theta4], [omega1, omega4])
    }
}
