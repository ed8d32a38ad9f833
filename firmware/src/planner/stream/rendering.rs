//! The impedance that a stream asks for, checked: what the arm renders, or why it does not; and how it changes meanwhile.

use super::{Planner, Stream, StreamError};
use crate::controller::{ArmController, Rendering, RenderingBounds};
use crate::drives::Drives;
use crate::motion::{FIXTURES, Fixture, FixtureShape, Impedance};
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::control::{FixtureAxis, Symmetric, VirtualFixture};
use nalgebra::Vector2;
use rtic_core::Mutex;

/// The time in which springs change [s].
const CHANGE: f32 = 0.1;
/// How far an eigenvalue may be below 0 by rounding, as a share of the greatest one.
const ROUNDING: f32 = 1e-5;

impl Planner {
    /// What an arm with its tool [m] and its joints [rad] there renders of an impedance.
    ///
    /// # Errors
    /// What of it is not passive, or means nothing.
    // A call of its own: its stack is not that of other commands.
    #[inline(never)]
    pub(super) fn rendering(
        &self,
        controller: &mut impl Mutex<T = ArmController<impl Drives>>,
        (target, [theta1, theta4]): (Vector2<f32>, [f32; 2]),
        impedance: &Impedance,
    ) -> Result<Rendering, StreamError> {
        let bounds = controller
            .lock(|controller| controller.rendering_loop())
            .bounds();
        let tool = &self.envelope.workspace.tool;
        let links =
            tool.geometry()
                .links(Vector2::unit(theta1), Vector2::unit(theta4), self.assembly);
        let links = links.map_err(|_| StreamError::Moving)?;
        let jacobian = tool.jacobian_of(&links, &links.partial_rates());
        let stiffness = checked(impedance.stiffness)?;
        let damping = checked(impedance.damping)?;
        // Of all springs, and of all dampers.
        let (mut springs, mut dampers) = (stiffness, damping);
        for fixture in self.fixtures.iter().flatten() {
            springs = springs.combined(1.0, &Symmetric::isotropic(fixture.stiffness), 1.0);
            dampers = dampers.combined(1.0, &Symmetric::isotropic(fixture.damping), 1.0);
        }
        let demand = passive(&bounds, &springs, &dampers, jacobian)?;
        Ok(Rendering {
            demand,
            stiffness,
            damping,
            target,
        })
    }

    /// Hands the controller the walls and guides of a stream that begins.
    pub(super) fn store_fixtures(
        &self,
        controller: &mut impl Mutex<T = ArmController<impl Drives>>,
    ) {
        // One in each access, which lasts no longer than a segment's copy.
        for (place, fixture) in self.fixtures.iter().enumerate() {
            let fixture = fixture.as_ref().and_then(rendered);
            controller.lock(|controller| controller.store_fixture(place, fixture.as_ref()));
        }
    }

    /// Changes the impedance of the stream in progress, in 0.1 s.
    ///
    /// # Errors
    /// It has none, or what of it is not passive or means nothing; the springs stay as they are then.
    pub(super) fn set_impedance(
        &mut self,
        controller: &mut impl Mutex<T = ArmController<impl Drives>>,
        impedance: &Impedance,
    ) -> Result<(), StreamError> {
        let renders = |stream: &Stream| stream.config.mode.renders();
        if !self.stream.as_ref().is_some_and(renders) {
            return Err(StreamError::NoImpedance);
        }
        let (from, joints, tick) = controller.lock(|controller| {
            let sample = controller.stream_sample();
            (*controller.rendering(), sample.angle, sample.tick)
        });
        let to = self.rendering(controller, (from.target, joints), impedance)?;
        if let Some(stream) = &mut self.stream {
            stream.change = Some(RenderingChange {
                from,
                to,
                begins: tick,
                ticks: self.tick_rate * CHANGE,
            });
        }
        Ok(())
    }

    /// Changes a wall or a guide of the next stream with an impedance.
    ///
    /// # Errors
    /// It means nothing, there is no such place for one, or a stream has the arm.
    pub fn set_fixture(&mut self, place: u8, fixture: Option<Fixture>) -> Result<(), StreamError> {
        // What springs change to is checked with the walls that are there.
        if self.is_streaming() {
            return Err(StreamError::Moving);
        }
        let refused = StreamError::Fixture(place);
        let slot = self.fixtures.get_mut(usize::from(place)).ok_or(refused)?;
        if fixture
            .as_ref()
            .is_some_and(|fixture| rendered(fixture).is_none())
        {
            return Err(refused);
        }
        *slot = fixture;
        Ok(())
    }

    /// Takes all walls and guides away.
    pub fn clear_fixtures(&mut self) {
        self.fixtures = [None; FIXTURES];
    }
}

/// How springs and dampers change. Both ends are passive, so everything between them is: the damping that is demanded is linear in
/// them.
#[derive(Clone, Copy)]
pub(super) struct RenderingChange {
    from: Rendering,
    to: Rendering,
    begins: u32,
    ticks: f32,
}

impl RenderingChange {
    /// Goes on to this tick. Returns whether it is over.
    pub(super) fn go_on(
        &self,
        controller: &mut impl Mutex<T = ArmController<impl Drives>>,
        tick: u32,
    ) -> bool {
        let done = (tick.wrapping_sub(self.begins) as f32 / self.ticks).min(1.0);
        let mix = |from: &Symmetric<f32>, to: &Symmetric<f32>| from.combined(1.0 - done, to, done);
        let (from, to) = (&self.from, &self.to);
        let next = Rendering {
            stiffness: mix(&from.stiffness, &to.stiffness),
            damping: mix(&from.damping, &to.damping),
            demand: mix(&from.demand, &to.demand),
            target: from.target,
        };
        controller.lock(|controller| controller.change_rendering(&next));
        done >= 1.0
    }
}

/// The damping that springs and dampers demand of the arm, if it has that much.
fn passive(
    bounds: &RenderingBounds,
    springs: &Symmetric<f32>,
    dampers: &Symmetric<f32>,
    jacobian: [Vector2<f32>; 2],
) -> Result<Symmetric<f32>, StreamError> {
    let none = Symmetric::isotropic(0.0);
    let load = |springs, dampers| {
        let demand = bounds.lag.demand(springs, dampers);
        (bounds.joints.load(&demand, jacobian), demand)
    };
    let (all, demand) = load(springs, dampers);
    if all <= 1.0 {
        return Ok(demand);
    }
    let (of_dampers, _) = load(&none, dampers);
    let (of_springs, _) = load(springs, &none);
    let greatest = |of: &Symmetric<f32>| {
        let [_, most] = of.eigenvalues();
        most
    };
    // Two loads together are at most their sum.
    Err(if of_dampers < 1.0 {
        StreamError::Stiffness(greatest(springs) * (1.0 - of_dampers) / of_springs)
    } else {
        StreamError::Damping(greatest(dampers) / of_dampers)
    })
}

/// A matrix that pulls back.
fn checked((xx, xy, yy): (f32, f32, f32)) -> Result<Symmetric<f32>, StreamError> {
    let matrix = Symmetric { xx, xy, yy };
    let [least, most] = matrix.eigenvalues();
    let is_sound = matrix.is_finite() && least >= -ROUNDING * most && most >= 0.0;
    is_sound.then_some(matrix).ok_or(StreamError::Matrix)
}

/// A wall or a guide as the tick needs it; none if it means nothing.
fn rendered(fixture: &Fixture) -> Option<VirtualFixture<f32>> {
    const FREE: [f32; 2] = [f32::NEG_INFINITY, f32::INFINITY];
    let along = |(x, y): (f32, f32)| {
        let direction = Vector2::new(x, y);
        let length = direction.length();
        let unit = direction * (1.0 / length);
        (length > 0.0 && length.is_finite()).then_some(FixtureAxis::Along(unit))
    };
    let radial = |radius: f32| (radius > 0.0 && radius.is_finite()).then_some(FixtureAxis::Radial);
    let (origin, axis, bounds) = match fixture.shape {
        FixtureShape::HalfPlane { point, normal } => {
            (point, along(normal)?, [[0.0, f32::INFINITY], FREE])
        }
        FixtureShape::Line { point, normal } => (point, along(normal)?, [[0.0, 0.0], FREE]),
        FixtureShape::Box {
            centre,
            axis,
            half: (a, b),
        } => {
            let is_open = a > 0.0 && b > 0.0 && (a + b).is_finite();
            (centre, along(axis).filter(|_| is_open)?, [[-a, a], [-b, b]])
        }
        FixtureShape::Inside { centre, radius } => {
            (centre, radial(radius)?, [[f32::NEG_INFINITY, radius], FREE])
        }
        FixtureShape::Outside { centre, radius } => {
            (centre, radial(radius)?, [[radius, f32::INFINITY], FREE])
        }
        FixtureShape::Circle { centre, radius } => {
            (centre, radial(radius)?, [[radius, radius], FREE])
        }
    };
    let (stiffness, damping) = (fixture.stiffness, fixture.damping);
    let (x, y) = origin;
    let is_finite = (x + y + stiffness + damping).is_finite();
    let is_sound = is_finite && stiffness >= 0.0 && damping >= 0.0;
    is_sound.then_some(VirtualFixture {
        origin: Vector2::new(x, y),
        axis,
        bounds,
        stiffness,
        damping,
    })
}
