//! Springs, dampers, walls and guides that the controller renders at the tool.
//!
//! τ = Jᵀ (f + s D v0 + s (K (x0 − x) − D v + Σ pushes of fixtures)), 0 ≤ s ≤ 1.
//!
//! What is rendered is computed at the measured angles, without prediction, so that its lag is known and the
//! [bound of the stiffness](fivebar_kinematics::control::RenderingLag) is that of the theorem. The bound was checked below the tick at
//! the pose at which the stream began. At a pose with more lever, s is the inverse of the load there, so the bound holds
//! at every pose. Springs that become softer give no energy; where s rises again, what the springs get is charged to the
//! [tank](fivebar_kinematics::control::EnergyTank). After the beginning and after a pause of the points s rises from 0 in [`RISE`].

use super::ArmController;
use crate::drives::{Drives, Stage};
use crate::motion::{FIXTURES, StreamPoint};
use crate::settings::CheckedSettings;
use fivebar_kinematics::control::{
    EnergyTank, FixturePush, JointDamping, RenderingLag, Symmetric, TankState, VirtualFixture,
};
use nalgebra::Vector2;

/// The time in which springs rise [s].
const RISE: f32 = 0.1;

/// What a stream renders, checked.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rendering {
    /// K [N/m].
    pub(crate) stiffness: Symmetric<f32>,
    /// D [N·s/m].
    pub(crate) damping: Symmetric<f32>,
    /// The damping that all of it demands of the arm [N·s/m].
    pub(crate) demand: Symmetric<f32>,
    /// Where the spring ends until the first point [m].
    pub(crate) target: Vector2<f32>,
}

/// What bounds the springs that an arm may render.
#[derive(Clone, Copy, Debug)]
pub struct RenderingBounds {
    pub(crate) lag: RenderingLag<f32>,
    pub(crate) joints: JointDamping<f32>,
}

/// The loop that renders, from which its bounds follow: they are computed when a stream begins, because that takes a while.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RenderingLoop {
    /// [s]
    period: f32,
    /// [rad/s]
    observer_bandwidth: f32,
    /// Of the torques [s].
    lag: f32,
    /// Of each joint's encoder [s].
    latencies: [f32; 2],
    joints: JointDamping<f32>,
}

impl RenderingLoop {
    fn new<D: Drives>(settings: &CheckedSettings) -> Self {
        let axes = settings.axes.each_ref();
        Self {
            period: 1.0 / settings.control.tick_rate,
            observer_bandwidth: settings.control.observer_bandwidth,
            lag: D::lag(settings, Stage::Moves),
            latencies: axes.map(|axis| axis.encoder_latency),
            joints: JointDamping::new(axes.map(|axis| axis.viscous_friction)),
        }
    }

    /// Its bounds.
    pub(crate) fn bounds(&self) -> RenderingBounds {
        let [lag1, lag4] = self.latencies.map(|latency| {
            RenderingLag::new(self.period, self.observer_bandwidth, self.lag, latency)
        });
        RenderingBounds {
            lag: lag1.worse(&lag4),
            joints: self.joints,
        }
    }
}

impl RenderingBounds {
    /// Of an arm with these drives and settings.
    pub fn new<D: Drives>(settings: &CheckedSettings) -> Self {
        RenderingLoop::new::<D>(settings).bounds()
    }

    /// The greatest stiffness along one direction without dampers [N/m], with these columns of the tool's Jacobian [m]: the least
    /// and the greatest one of all directions. A stream with a stiffer spring is refused.
    pub fn greatest_stiffness(&self, jacobian: [Vector2<f32>; 2]) -> [f32; 2] {
        self.lag.greatest_stiffness(&self.joints, jacobian)
    }
}

/// How the springs of a stream act.
#[derive(Clone)]
pub(super) struct Rendered {
    /// Whether it does.
    pub(super) is_on: bool,
    /// With x0 [m].
    what: Rendering,
    fixtures: [Option<VirtualFixture<f32>>; FIXTURES],
    /// v0 [m/s] and f [N].
    velocity: Vector2<f32>,
    force: Vector2<f32>,
    /// How far the spring is stretched in this tick [m].
    away: Vector2<f32>,
    /// How far the springs have risen since points come.
    rise: f32,
    /// What the pose allows of them.
    allowed: f32,
    /// What the limits left of the springs' torques in the tick before.
    left: f32,
    tank: TankState<f32>,
}

/// The torques of a tick. Pairs are of joint 1 and joint 4 [N·m].
#[derive(Clone, Copy)]
pub(super) struct Push {
    /// Of springs.
    pub(super) spring: [f32; 2],
    /// Of dampers.
    pub(super) damper: [f32; 2],
    /// Of what the host gives.
    pub(super) host: [f32; 2],
    /// The share of the braking that the tank asks for.
    pub(super) braking: f32,
}

impl Push {
    pub(super) const NONE: Self = Self {
        spring: [0.0; 2],
        damper: [0.0; 2],
        host: [0.0; 2],
        braking: 0.0,
    };

    /// What is kept of springs and host's forces by the share with which a fast arm is braked: none of them drive it on at its
    /// greatest speed.
    #[inline(always)]
    pub(super) fn kept(&self, [omega1, omega4]: [f32; 2], braked: f32) -> f32 {
        let ([spring1, spring4], [host1, host4]) = (self.spring, self.host);
        let power = (spring1 + host1) * omega1 + (spring4 + host4) * omega4;
        if power > 0.0 { 1.0 - braked } else { 1.0 }
    }
}

/// The tool of a tick.
pub(super) struct ToolState {
    /// θ1, θ4 [rad].
    pub(super) angles: [f32; 2],
    /// x [m].
    pub(super) place: Vector2<f32>,
    /// v [m/s].
    pub(super) velocity: Vector2<f32>,
    /// The columns of its Jacobian [m].
    pub(super) jacobian: [Vector2<f32>; 2],
}

/// The constants of rendering.
#[derive(Clone)]
pub(super) struct Renderer {
    of: RenderingLoop,
    pub(super) tank: EnergyTank<f32>,
    period: f32,
    per_rise: f32,
}

impl Renderer {
    pub(super) fn new<D: Drives>(settings: &CheckedSettings) -> Self {
        let rate = settings.control.tick_rate;
        let lag = D::lag(settings, Stage::Moves);
        Self {
            of: RenderingLoop::new::<D>(settings),
            tank: EnergyTank::new(RenderingLag::gain(1.0 / rate, lag)),
            period: 1.0 / rate,
            per_rise: 1.0 / (RISE * rate),
        }
    }

    /// What springs and dampers do in a tick in which the arm gives way.
    #[inline(always)]
    pub(super) fn render(&self, rendered: &mut Rendered, tool: &ToolState) -> Push {
        let Rendering {
            stiffness,
            damping,
            demand,
            target,
        } = &mut rendered.what;
        *target += rendered.velocity * self.period;
        let away = *target - tool.place;
        rendered.away = away;
        let mut spring = stiffness.apply(away);
        let mut energy = 0.5 * away.dot(&spring);
        let mut damper = -damping.apply(tool.velocity);
        // No loop and no call: the bound of the tick's time counts each.
        let [first, second, third] = &rendered.fixtures;
        let pushes = [
            pushed(first, tool),
            pushed(second, tool),
            pushed(third, tool),
        ];
        let [push1, push2, push3] = pushes;
        spring += push1.spring + push2.spring + push3.spring;
        damper += push1.damper + push2.damper + push3.damper;
        energy += push1.energy + push2.energy + push3.energy;
        let load = self.of.joints.load(demand, tool.jacobian);
        let pose = if load > 1.0 { 1.0 / load } else { 1.0 };
        let risen = rendered.rise + self.per_rise;
        rendered.rise = if risen < 1.0 { risen } else { 1.0 };
        if rendered.allowed > pose {
            rendered.allowed = pose;
        } else if rendered.allowed < pose && rendered.tank.level() >= 0.0 {
            let next = rendered.allowed + self.per_rise;
            let next = if next < pose { next } else { pose };
            rendered
                .tank
                .charge((next - rendered.allowed) * rendered.rise * energy);
            rendered.allowed = next;
        }
        let share = rendered.rise * rendered.allowed;
        let host = rendered.force + damping.apply(rendered.velocity) * share;
        let torques = |force: Vector2<f32>, share: f32| {
            let [by1, by4] = tool.jacobian;
            [share * by1.dot(&force), share * by4.dot(&force)]
        };
        let spring = torques(spring, share);
        Push {
            spring,
            damper: torques(damper, share),
            host: torques(host, 1.0),
            braking: self.tank.settle(
                &mut rendered.tank,
                tool.angles,
                spring.map(|torque| rendered.left * torque),
            ),
        }
    }
}

/// What a wall or a guide does, if there is one.
#[inline(always)]
fn pushed(fixture: &Option<VirtualFixture<f32>>, tool: &ToolState) -> FixturePush<f32> {
    match fixture {
        Some(fixture) => fixture.push(tool.place, tool.velocity),
        None => FixturePush::none(),
    }
}

impl Rendered {
    /// Nothing.
    pub(super) fn none() -> Self {
        let none = Symmetric {
            xx: 0.0,
            xy: 0.0,
            yy: 0.0,
        };
        Self {
            is_on: false,
            what: Rendering {
                stiffness: none,
                damping: none,
                demand: none,
                target: Vector2::zeros(),
            },
            fixtures: [None; FIXTURES],
            velocity: Vector2::zeros(),
            force: Vector2::zeros(),
            away: Vector2::zeros(),
            rise: 0.0,
            allowed: 1.0,
            left: 1.0,
            tank: TankState::at_rest([0.0; 2]),
        }
    }

    /// Begins to render this, with the walls and guides that were stored; none: nothing.
    pub(super) fn begin(&mut self, what: Option<&Rendering>, angles: [f32; 2]) {
        self.is_on = what.is_some();
        if let Some(what) = what {
            self.what = *what;
        }
        (self.velocity, self.force) = (Vector2::zeros(), Vector2::zeros());
        (self.allowed, self.left) = (1.0, 1.0);
        self.pause(angles);
    }

    /// The springs end here from now on, and their end moves so.
    pub(super) fn follow(&mut self, point: &StreamPoint) {
        self.what.target = Vector2::new(point.position.0, point.position.1);
        self.velocity = Vector2::new(point.velocity.0, point.velocity.1);
        self.force = Vector2::new(point.force.0, point.force.1);
    }

    /// A tick in which nothing is rendered.
    #[inline(always)]
    pub(super) fn pause(&mut self, angles: [f32; 2]) {
        self.rise = 0.0;
        self.tank = TankState::at_rest(angles);
    }

    /// What springs, of which the limits left this share, and dampers give from this tick on [N·m].
    #[inline(always)]
    pub(super) fn demand(&mut self, tank: &EnergyTank<f32>, left: f32, torque: [f32; 2]) {
        self.left = left;
        tank.demand(&mut self.tank, torque);
    }
}

impl<D: Drives> ArmController<D> {
    /// The loop by which this arm renders springs.
    pub(crate) fn rendering_loop(&self) -> RenderingLoop {
        self.touch.renderer.of
    }

    /// Stores a wall or a guide of the stream that begins next.
    pub(crate) fn store_fixture(&mut self, place: usize, fixture: Option<&VirtualFixture<f32>>) {
        if let Some(slot) = self.touch.rendered.fixtures.get_mut(place) {
            *slot = fixture.copied();
        }
    }

    /// What this arm renders.
    pub(crate) fn rendering(&self) -> &Rendering {
        &self.touch.rendered.what
    }

    /// Renders this from now on, with the spring's end where it is. What a stiffer spring has more is charged to the tank, which
    /// damps the arm until it has got that back: else a hand could lead the tool out softly, and be pushed back.
    pub(crate) fn change_rendering(&mut self, next: &Rendering) {
        let rendered = &mut self.touch.rendered;
        let more = next.stiffness.combined(1.0, &rendered.what.stiffness, -1.0);
        let energy = 0.5 * rendered.away.dot(&more.apply(rendered.away));
        if energy > 0.0 {
            rendered
                .tank
                .charge(rendered.rise * rendered.allowed * energy);
        }
        let target = rendered.what.target;
        rendered.what = Rendering { target, ..*next };
    }

    /// Takes the energy tank out: a test shows that walls give energy then.
    #[doc(hidden)]
    pub fn take_tank_out(&mut self) {
        self.touch.renderer.tank = EnergyTank::absent();
    }
}
