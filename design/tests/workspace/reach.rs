//! The region that both legs reach: its area by other methods, and its boundary.

use fivebar_design::workspace::{Arc, reach_boundary, reachable_area};
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::five_bar::Geometry;
use fivebar_testkit::{Tally, assert_close, geometry};
use nalgebra::Vector2;
use proptest::prelude::*;

/// ½∮(x dy − y dx) along the boundary arcs: outer ones with the region to their left,
/// inner ones with it to their right.
fn area_within_boundary(geometry: &Geometry<f64>) -> f64 {
    reach_boundary(geometry)
        .map(|arc| {
            let (from, to) = (Vector2::unit(arc.from), Vector2::unit(arc.to));
            let swept = arc.radius * arc.radius * (arc.to - arc.from)
                + arc.radius * arc.centre.cross_z(to - from);
            if arc.outer { 0.5 * swept } else { -0.5 * swept }
        })
        .sum()
}

#[test]
fn the_textbook_lens_has_its_known_area() {
    let geometry = Geometry::new([0.23, 0.23, 0.23, 0.23, 0.275]).unwrap();
    assert_close("area", reachable_area(&geometry), 0.415_580_73, 1e-8);
    // Links of equal length reach down to their pivot: two outer circles, mirrored arcs.
    assert_eq!(reach_boundary(&geometry).count(), 4);
    // By counting: the region is 0.645 m wide and 0.878 m high.
    let cells = 1500;
    let (mut hits, size) = (0_u32, 1.0 / f64::from(cells));
    for i in 0..cells {
        for j in 0..cells {
            let c = Vector2::new(
                0.1375 + (f64::from(i) + 0.5) * size - 0.5,
                (f64::from(j) + 0.5) * size - 0.5,
            );
            hits += u32::from(geometry.reach(c).is_ok());
        }
    }
    let counted = f64::from(hits) * size * size;
    // The boundary is 2.4 m long; whether a cell that it cuts counts is random.
    assert_close("counted", counted, 0.415_580_73, 1e-4);
}

/// The circles that bound the reach of the leg that `arc` does not belong to. Coaxial legs are
/// parted by their radii.
fn other_leg(
    geometry: &Geometry<f64>,
    arc: &Arc<f64>,
) -> impl Iterator<Item = (Vector2<f64>, f64)> {
    let [l1, l2, l3, l4, l5] = geometry.lengths();
    let (pivot, near, far) = if arc.centre.x == 0.0 && geometry.leg1_radii().contains(&arc.radius) {
        (l5, l4, l3)
    } else {
        (0.0, l1, l2)
    };
    let radii = [near + far, (near - far).abs()];
    radii
        .into_iter()
        .map(move |radius| (Vector2::new(pivot, 0.0), radius))
}

proptest! {
    #[test]
    fn the_boundary_encloses_the_area(geometry in geometry()) {
        let area = reachable_area(&geometry);
        prop_assert!(area > 0.0);
        prop_assert!((area_within_boundary(&geometry) - area).abs() < 1e-12);
    }
}

#[test]
fn the_boundary_parts_what_is_reached_from_what_is_not() {
    let tried = Tally::default();
    proptest!(|(geometry in geometry(), at in 0.01..0.99_f64)| {
        prop_assert!(reach_boundary(&geometry).count() > 0);
        for arc in reach_boundary(&geometry) {
            let direction = Vector2::unit(arc.from + at * (arc.to - arc.from));
            // The step is less than the distance to the other leg's circles, which meet the arc at
            // its ends, so only this arc decides.
            let on_arc = arc.centre + direction * arc.radius;
            let spare = other_leg(&geometry, &arc)
                .map(|(pivot, radius)| ((on_arc - pivot).norm() - radius).abs())
                .fold(f64::INFINITY, f64::min);
            let step = (1e-4 * arc.radius).min(0.5 * spare);
            if !tried.count(step > 1e-12) {
                continue;
            }
            let outwards = if arc.outer { step } else { -step };
            let beyond = arc.centre + direction * (arc.radius + outwards);
            let within = arc.centre + direction * (arc.radius - outwards);
            prop_assert!(geometry.reach(beyond).is_err());
            prop_assert!(geometry.reach(within).is_ok());
        }
    });
    tried.assert_accepted(0.99);
}
