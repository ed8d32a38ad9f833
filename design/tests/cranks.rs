//! The range of the cranks' angles: the search keeps it, and the proof finds what leaves it.

use fivebar_design::Noise;
use fivebar_design::synthesis::{
    Area, CrankRange, Objective, Proof, Specification, Stock, Study, Tolerance, synthesise,
};
use fivebar_kinematics::five_bar::{Geometry, Side, WorkingMode};
use nalgebra::Vector2;
use std::f64::consts::{PI, TAU};

/// The largest rectangle of a symmetric coaxial arm with links of 1 m in all.
fn leg(aspect: f64, dexterity: f64) -> Specification {
    Specification {
        symmetric: true,
        base: [0.0, 0.0],
        link_sum: 1.0,
        area: Area::Rectangle { aspect },
        dexterity,
        sine: 0.0,
        cranks: None,
        stock: Stock::default(),
        payload: None,
        tolerance: Tolerance::default(),
        objective: Objective::Size,
        front: 1,
        starts: 1,
    }
}

/// Random specifications with a range of the cranks, drawn from a seed.
fn with_cranks(noise: &mut Noise, symmetric: bool) -> (Specification, [f64; 2]) {
    let mut between = |low: f64, high: f64| low + (high - low) * noise.uniform();
    let least = between(0.3, 1.2);
    let range = [least, least + between(1.0, 1.9)];
    let aspect = between(0.5, 2.0);
    let specification = Specification {
        symmetric,
        base: [0.0, between(0.0, 0.6)],
        cranks: CrankRange::new(range),
        ..leg(aspect, between(0.2, 0.5))
    };
    (specification, range)
}

/// Searches arms whose cranks have a range, and samples their areas with the kinematics: how many arms were found, were
/// proved, and touch a limit.
fn cranks_are_kept(count: usize, samples: usize) -> [usize; 3] {
    let mode = WorkingMode::new(Side::Right, Side::Left);
    let mut noise = Noise::new(53);
    let (mut found, mut proved, mut touching) = (0, 0, 0);
    for index in 0..count {
        let (specification, [least, greatest]) = with_cranks(&mut noise, index == 0);
        let Ok(answer) = synthesise(&specification, index as u64, &|_| {}) else {
            continue;
        };
        let best = answer.best;
        let Area::Rectangle { aspect } = specification.area else {
            unreachable!()
        };
        let geometry = Geometry::new(best.lengths).unwrap();
        let mut nearest = f64::INFINITY;
        for sample in 0..samples {
            // Half of them on the rim, where the limits are.
            let (mut u, mut v) = (noise.uniform(), noise.uniform());
            match sample % 8 {
                0 => u = 0.0,
                1 => u = 1.0,
                2 => v = 0.0,
                3 => v = 1.0,
                _ => (),
            }
            let c = Vector2::new(
                0.5 * best.lengths[4] + best.place[0] + best.size * (u - 0.5),
                best.place[1] + best.size / aspect * v,
            );
            let pose = geometry.inverse(c, mode).unwrap();
            let dexterity = geometry.jacobian(&pose).unwrap().inverse_condition();
            assert!(
                dexterity > specification.dexterity - 1e-6,
                "{index}: {dexterity}"
            );
            let [theta1, _, _, theta4] = pose.angles();
            for angle in [theta1, PI - theta4] {
                let middle = 0.5 * (least + greatest);
                let off = angle - middle;
                let off = off - (off / TAU).round() * TAU;
                let left = 0.5 * (greatest - least) - off.abs();
                assert!(
                    left >= 0.0,
                    "{index}: a crank at {angle} rad, [{least}, {greatest}]"
                );
                nearest = nearest.min(left);
            }
        }
        found += 1;
        proved += usize::from(answer.proof == Proof::Proved);
        touching += usize::from(nearest < 0.02);
    }
    println!("{found} arms of {count} specifications, {proved} proved, {touching} at a limit");
    [found, proved, touching]
}

#[test]
fn no_crank_leaves_its_range_in_the_area() {
    let [found, proved, touching] = cranks_are_kept(2, 2000);
    assert!(found == 2 && proved == found && touching > 0);
}

#[test]
fn a_crank_that_leaves_its_range_in_a_corner_is_refuted() {
    let arm = [0.1, 0.16, 0.16, 0.1, 0.08];
    assert!(CrankRange::new([0.5, 0.505]).is_none() && CrankRange::new([0.0, 3.2]).is_none());
    let proved = |least: f64, place: [f64; 2]| {
        let specification = Specification {
            cranks: CrankRange::new([least, least + 2.5]),
            ..leg(1.0, 0.1)
        };
        Study::new(&specification, 1).prove(arm, SIDE, place)
    };
    let geometry = Geometry::new(arm).unwrap();
    let mode = WorkingMode::new(Side::Right, Side::Left);
    let least_at = |x: f64, y: f64| {
        let pose = geometry.inverse(Vector2::new(0.04 + x, y), mode);
        let [theta1, _, _, theta4] = pose.unwrap().angles();
        [theta1, PI - theta4]
    };
    // Aside, one crank turns farther than the other one.
    for (x, leg) in [(0.03, 0), (-0.03, 1)] {
        let (left, low) = (x - 0.5 * SIDE, 0.14);
        let rim = (0..=10_000).map(|i| SIDE * f64::from(i) / 10_000.0);
        let rim = rim.flat_map(|t| {
            [
                least_at(left + t, low),
                least_at(left + t, low + SIDE),
                least_at(left, low + t),
                least_at(left + SIDE, low + t),
            ]
        });
        let least = rim.fold([f64::INFINITY; 2], |least, angles| {
            [least[0].min(angles[0]), least[1].min(angles[1])]
        });
        assert!(least[leg] < least[1 - leg] - 0.1, "{least:?}");
        assert_eq!(proved(least[leg] - 1e-6, [x, low]), Proof::Proved);
        assert!(matches!(
            proved(least[leg] + 1e-6, [x, low]),
            Proof::Refuted(_)
        ));
    }
}

/// Of a square [m].
const SIDE: f64 = 0.05;
