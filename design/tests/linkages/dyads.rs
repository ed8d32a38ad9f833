//! Every dyad on every branch: closure, rates against finite differences, reactions
//! against power.

use fivebar_design::linkage::dyad::{DyadError, DyadMotion, Prp, Rpp, Rpr, Rrp, Rrr, SlideBranch};
use fivebar_design::linkage::{LinkMotion, PointMotion, Wrench, reactions};
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::five_bar::Side;
use fivebar_testkit::Tally;
use nalgebra::Vector2;
use proptest::prelude::*;

/// A carrier whose position and direction are known smooth functions of time.
#[derive(Clone, Copy, Debug)]
struct Carrier {
    position: [[f64; 2]; 3],
    angle: [f64; 3],
}

fn polynomial([c0, c1, c2]: [f64; 3], t: f64) -> [f64; 3] {
    [c0 + c1 * t + c2 * t * t, c1 + 2.0 * c2 * t, 2.0 * c2]
}

impl Carrier {
    fn link(&self, t: f64) -> LinkMotion<f64> {
        let coordinate = |i: usize| {
            let [p, v, a] = self.position;
            polynomial([p[i], v[i], a[i]], t)
        };
        let (x, y) = (coordinate(0), coordinate(1));
        let [theta, omega, alpha] = polynomial(self.angle, t);
        LinkMotion {
            origin: PointMotion {
                position: Vector2::new(x[0], y[0]),
                velocity: Vector2::new(x[1], y[1]),
                acceleration: Vector2::new(x[2], y[2]),
            },
            axis: Vector2::unit(theta),
            omega,
            alpha,
        }
    }

    fn point(&self, t: f64) -> PointMotion<f64> {
        self.link(t).origin
    }
}

fn carrier() -> impl Strategy<Value = Carrier> {
    let pair = || prop::array::uniform2(-1.0..1.0);
    (
        prop::array::uniform3(pair()),
        prop::array::uniform3(-3.0..3.0),
    )
        .prop_map(|(position, angle)| Carrier { position, angle })
}

#[derive(Clone, Copy, Debug)]
enum Dyad {
    Rrr(Rrr<f64>),
    Rrp(Rrp<f64>),
    Rpr(Rpr<f64>),
    Prp(Prp<f64>),
    Rpp(Rpp<f64>),
}

impl Dyad {
    fn motion(&self, carriers: &[Carrier; 2], t: f64) -> Result<DyadMotion<f64>, DyadError> {
        let [c1, c2] = carriers;
        match self {
            Self::Rrr(dyad) => dyad.motion(&c1.point(t), &c2.point(t)),
            Self::Rrp(dyad) => dyad.motion(&c1.point(t), &c2.link(t)),
            Self::Rpr(dyad) => dyad.motion(&c1.point(t), &c2.point(t)),
            Self::Prp(dyad) => dyad.motion(&c1.link(t), &c2.link(t)),
            Self::Rpp(dyad) => dyad.motion(&c1.point(t), &c2.link(t)),
        }
    }

    /// How far the solution is from satisfying the dyad's constraints [m].
    fn closure_error(&self, motion: &DyadMotion<f64>, carriers: &[Carrier; 2]) -> f64 {
        let [link1, link2] = motion.links;
        let p3 = motion.inner_point.position;
        let [g1, g2] = [carriers[0].link(0.0), carriers[1].link(0.0)];
        let beside = |g: &LinkMotion<f64>, p: Vector2<f64>| g.axis.cross_z(p - g.origin.position);
        match self {
            Self::Rrr(dyad) => {
                let [l1, l2] = dyad.lengths;
                let e1 = (p3 - g1.origin.position).norm() - l1;
                e1.abs() + ((p3 - g2.origin.position).norm() - l2).abs()
            }
            Self::Rrp(dyad) => {
                let bar = (p3 - g1.origin.position).norm() - dyad.length;
                bar.abs() + (beside(&g2, p3) - dyad.offset).abs()
            }
            Self::Rpr(dyad) => {
                (beside(&link1, g2.origin.position) - dyad.offset).abs()
                    + (p3 - g2.origin.position).norm()
                    + (link1.origin.position - g1.origin.position).norm()
            }
            Self::Prp(dyad) => {
                let [e1, e2] = dyad.offsets;
                (beside(&g1, p3) - e1).abs() + (beside(&g2, p3) - e2).abs()
            }
            Self::Rpp(dyad) => {
                let turned = link2.axis.cross_z(link1.axis) - dyad.direction.y;
                turned.abs()
                    + beside(&g2, p3).abs()
                    + link1.axis.cross_z(g1.origin.position - p3).abs()
            }
        }
    }
}

fn dyad() -> impl Strategy<Value = Dyad> {
    let length = || 0.2..2.5_f64;
    let offset = || -0.5..0.5_f64;
    let side = || prop::sample::select(Side::BOTH.to_vec());
    let way = || prop::sample::select(SlideBranch::BOTH.to_vec());
    prop_oneof![
        ([length(), length()], side()).prop_map(|(lengths, side)| Dyad::Rrr(Rrr { lengths, side })),
        (length(), offset(), way()).prop_map(|(length, offset, way)| Dyad::Rrp(Rrp {
            length,
            offset,
            branch: way
        })),
        (offset(), way()).prop_map(|(offset, way)| Dyad::Rpr(Rpr {
            offset,
            branch: way
        })),
        [offset(), offset()].prop_map(|offsets| Dyad::Prp(Prp { offsets })),
        (-3.0..3.0_f64).prop_map(|angle| Dyad::Rpp(Rpp {
            direction: Vector2::unit(angle)
        })),
    ]
}

/// What moves in a solved dyad: positions, then their velocities and accelerations.
fn coordinates(motion: &DyadMotion<f64>) -> [Vec<f64>; 3] {
    let mut all = [vec![], vec![], vec![]];
    let mut add = |place: [f64; 3]| {
        for (list, value) in all.iter_mut().zip(place) {
            list.push(value);
        }
    };
    for point in [
        motion.inner_point,
        motion.links[0].origin,
        motion.links[1].origin,
    ] {
        add([point.position.x, point.velocity.x, point.acceleration.x]);
        add([point.position.y, point.velocity.y, point.acceleration.y]);
    }
    for link in motion.links {
        // d(u)/dt = ω n, d²(u)/dt² = α n − ω² u.
        let (u, n) = (link.axis, link.axis.perpendicular());
        let second = n * link.alpha - u * (link.omega * link.omega);
        add([u.x, link.omega * n.x, second.x]);
        add([u.y, link.omega * n.y, second.y]);
    }
    for slide in motion.slides.into_iter().flatten() {
        add([slide.value, slide.rate, slide.acceleration]);
    }
    all
}

/// Counts of each kind of dyad.
#[derive(Default)]
struct Tallies([Tally; 5]);

impl Tallies {
    fn count(&self, dyad: &Dyad, accepted: bool) -> bool {
        let kind = match dyad {
            Dyad::Rrr(_) => 0,
            Dyad::Rrp(_) => 1,
            Dyad::Rpr(_) => 2,
            Dyad::Prp(_) => 3,
            Dyad::Rpp(_) => 4,
        };
        self.0[kind].count(accepted)
    }

    fn assert_accepted(&self, least: [f64; 5]) {
        for (tally, least) in self.0.iter().zip(least) {
            tally.assert_accepted(least);
        }
    }
}

#[test]
fn closes_and_moves_as_its_finite_differences() {
    let (solved, compared) = (Tallies::default(), Tallies::default());
    let config = ProptestConfig::with_cases(6000);
    proptest!(config, |(dyad in dyad(), carriers in [carrier(), carrier()])| {
        let outcome = dyad.motion(&carriers, 0.0);
        if !solved.count(&dyad, outcome.is_ok()) {
            return Ok(());
        }
        let motion = outcome.unwrap();
        // Nearly parallel guides have their joint far away, with a rounding error in proportion.
        let size = 1.0 + motion.inner_point.position.norm();
        prop_assert!(dyad.closure_error(&motion, &carriers) < 1e-12 * size);

        // The error of a central difference, of fourth order, grows as powers of 1/sin μ and,
        // for RPR, of 1/|P2 − P1|.
        let apart = carriers[1].point(0.0).position - carriers[0].point(0.0).position;
        if !compared.count(&dyad, motion.sine.abs() > 0.2 && apart.norm() > 0.3) {
            return Ok(());
        }
        let step = 1e-5;
        let at = |steps: f64| coordinates(&dyad.motion(&carriers, steps * step).unwrap());
        let around = [1.0, 2.0].map(|steps| (at(-steps), at(steps)));
        let now = coordinates(&motion);
        let speed = now[1].iter().fold(1.0_f64, |m, x| m.max(x.abs()));
        let speed = now[2].iter().fold(speed, |m, x| m.max(x.abs().sqrt()));
        for order in 0..2 {
            for (i, &derivative) in now[order + 1].iter().enumerate() {
                let [near, far] = around.each_ref().map(|(before, after)| after[order][i] - before[order][i]);
                let difference = (8.0 * near - far) / (12.0 * step);
                prop_assert!(
                    (difference - derivative).abs() <= 1e-7 * speed.powi(3),
                    "{dyad:?}, coordinate {i}, order {order}: {derivative} for {difference}"
                );
            }
        }
        let largest = now[1].iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        prop_assert!(largest > 1e-6, "nothing moved");
    });
    solved.assert_accepted([0.5, 0.7, 0.9, 1.0, 1.0]);
    compared.assert_accepted([0.9, 0.85, 0.9, 0.75, 0.8]);
}

#[test]
fn reactions_balance_each_link_and_spend_no_power() {
    let solved = Tallies::default();
    let config = ProptestConfig::with_cases(6000);
    let forces = prop::array::uniform2(prop::array::uniform3(-10.0..10.0_f64));
    proptest!(config, |(dyad in dyad(), carriers in [carrier(), carrier()], forces in forces)| {
        let outcome = dyad.motion(&carriers, 0.0);
        let clear = outcome.as_ref().is_ok_and(|motion| motion.sine.abs() > 0.05);
        if !solved.count(&dyad, clear) {
            return Ok(());
        }
        let motion = outcome.unwrap();
        let loads = forces.map(|[x, y, moment]| Wrench { force: Vector2::new(x, y), moment });
        let [r1, r12, r2] = reactions(&motion.joints, &loads).unwrap();

        let scale = [r1, r12, r2].iter().fold(1.0_f64, |m, r| m.max(r.force.norm() + r.moment.abs()));
        for sum in [loads[0] + r1 + -r12, loads[1] + r12 + r2] {
            prop_assert!(sum.force.norm() + sum.moment.abs() <= 1e-11 * scale);
        }
        // Virtual work: ideal joints dissipate no power, so the power of the loads on the links
        // goes through the outer joints into the carriers.
        let [c1, c2] = [carriers[0].link(0.0), carriers[1].link(0.0)];
        let power = loads[0].power(&motion.links[0]) + loads[1].power(&motion.links[1]);
        let passed = r1.power(&c1) + r2.power(&c2);
        let speed = motion.links.iter().fold(1.0_f64, |m, l| m.max(l.omega.abs() + l.origin.velocity.norm()));
        prop_assert!((power + passed).abs() <= 1e-10 * scale * speed, "{power} W in, {passed} W out");
    });
    solved.assert_accepted([0.5, 0.7, 0.88, 0.9, 0.9]);
}

#[test]
fn the_triangle_and_the_vector_loop_give_the_same_pin() {
    let (solved, compared) = (Tally::default(), Tally::default());
    let lengths = [0.2..2.5_f64, 0.2..2.5_f64];
    let end = || [-1.0..1.0_f64, -1.0..1.0_f64];
    proptest!(ProptestConfig::with_cases(3000), |(lengths in lengths, ends in [end(), end()])| {
        let [p1, p2] = ends.map(|[x, y]| Vector2::new(x, y));
        for side in Side::BOTH {
            let dyad = Rrr { lengths, side };
            let pins = (dyad.position(p1, p2), dyad.position_by_vector_loop(p1, p2));
            solved.count(pins.0.is_ok());
            match pins {
                (Ok(a), Ok(b)) => {
                    // Both have a rounding error under the root, amplified where the bars are in
                    // line. The half angle also loses digits where A ± √ and B − C both cancel.
                    let ([l1, l2], d) = (lengths, p2 - p1);
                    let sine = ((a - p1).cross_z(a - p2) / (l1 * l2)).abs();
                    let c = d.norm_squared() + l2 * l2 - l1 * l1;
                    let half_angle = Vector2::new(
                        2.0 * l2 * d.x - c,
                        2.0 * (l2 * d.y + side.sign(l1 * l2 * sine)),
                    );
                    let cancelled = half_angle.norm().min(1.0);
                    let bound = 1e-13 / (sine * d.norm() * cancelled);
                    if compared.count(bound < 1e-6) {
                        prop_assert!((a - b).norm() <= bound, "{a:?} and {b:?}");
                    }
                    prop_assert_eq!(Side::of((p2 - p1).cross_z(a - p1)), side);
                }
                (a, b) => prop_assert_eq!(a.unwrap_err(), b.unwrap_err()),
            }
        }
    });
    solved.assert_accepted(0.5);
    solved.assert_refused(0.3);
    compared.assert_accepted(0.99);
}

#[test]
fn the_other_way_is_the_other_assembly() {
    let solved = Tally::default();
    let (offset, length) = (-0.5..0.5_f64, 0.5..2.0_f64);
    let config = ProptestConfig::with_cases(3000);
    proptest!(config, |(offset in offset, length in length, carriers in [carrier(), carrier()])| {
        let places = SlideBranch::BOTH.map(|way| {
            Dyad::Rrp(Rrp { length, offset, branch: way }).motion(&carriers, 0.0)
        });
        if solved.count(places.iter().all(Result::is_ok)) {
            let [ahead, behind] = places.map(Result::unwrap);
            prop_assert!(ahead.slides[0].unwrap().value > behind.slides[0].unwrap().value);
        }
        let places = SlideBranch::BOTH.map(|way| Dyad::Rpr(Rpr { offset, branch: way }).motion(&carriers, 0.0));
        if solved.count(places.iter().all(Result::is_ok)) {
            let [ahead, behind] = places.map(Result::unwrap);
            prop_assert!(ahead.slides[0].unwrap().value > 0.0);
            prop_assert!(behind.slides[0].unwrap().value < 0.0);
        }
    });
    solved.assert_accepted(0.8);
}
