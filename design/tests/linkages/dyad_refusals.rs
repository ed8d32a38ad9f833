//! The errors of each dyad.

use fivebar_design::linkage::dyad::{
    DyadError, Prp, Rpp, Rpr, Rrp, Rrr, Singular, SlideBranch, Unreachable,
};
use fivebar_design::linkage::{LinkMotion, PointMotion};
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::five_bar::Side;
use nalgebra::Vector2;

fn still(x: f64, y: f64) -> PointMotion<f64> {
    PointMotion::fixed(Vector2::new(x, y))
}

fn still_guide(x: f64, y: f64, angle: f64) -> LinkMotion<f64> {
    LinkMotion::ground().guide(&still(x, y), Vector2::unit(angle))
}

#[test]
fn what_cannot_close_says_which_way() {
    let unreachable = |why| Err(DyadError::Unreachable(why));
    let rrr = Rrr {
        lengths: [1.0, 0.4],
        side: Side::Left,
    };
    let origin = still(0.0, 0.0);
    let end = |x| rrr.motion(&origin, &still(x, 0.0));
    assert_eq!(end(1.5), unreachable(Unreachable::EndsTooFar));
    assert_eq!(end(0.5), unreachable(Unreachable::EndsTooNear));
    assert_eq!(end(0.0), unreachable(Unreachable::EndsTooNear));
    assert!(end(1.0).is_ok());

    let rrp = Rrp {
        length: 1.0,
        offset: 0.3,
        branch: SlideBranch::Ahead,
    };
    let guide = |y| rrp.motion(&origin, &still_guide(0.0, y, 0.0));
    assert_eq!(guide(0.8), unreachable(Unreachable::GuideTooFar));
    assert!(guide(0.6).is_ok());
    assert!(guide(-1.2).is_ok(), "the offset is to the left");

    let rpr = Rpr {
        offset: 0.3,
        branch: SlideBranch::Ahead,
    };
    let end = |x| rpr.motion(&origin, &still(x, 0.0));
    assert_eq!(end(0.2), unreachable(Unreachable::InsideOffset));
    assert!(end(0.4).is_ok());
}

#[test]
fn singular_places_are_refused_by_name() {
    let singular = |which| Err(DyadError::Singular(which));
    let origin = still(0.0, 0.0);
    let rrr = |lengths| Rrr {
        lengths,
        side: Side::Left,
    };
    assert_eq!(
        rrr([1.0, 1.0]).motion(&origin, &origin),
        singular(Singular::EndsMeet)
    );
    for stretched_or_folded in [1.5, 0.5] {
        let end = still(stretched_or_folded, 0.0);
        let dyad = rrr([1.0, 0.5]);
        assert!(dyad.position(origin.position, end.position).is_ok());
        assert_eq!(dyad.motion(&origin, &end), singular(Singular::BarsInLine));
    }
    let rrp = Rrp {
        length: 1.0,
        offset: 0.0,
        branch: SlideBranch::Ahead,
    };
    assert_eq!(
        rrp.motion(&origin, &still_guide(0.0, 1.0, 0.0)),
        singular(Singular::BarPerpendicularToGuide)
    );
    let rpr = |offset| Rpr {
        offset,
        branch: SlideBranch::Ahead,
    };
    assert_eq!(
        rpr(0.0).motion(&origin, &origin),
        singular(Singular::EndsMeet)
    );
    assert_eq!(
        rpr(0.5).motion(&origin, &still(0.5, 0.0)),
        singular(Singular::SliderAtPivot)
    );
    let prp = Prp {
        offsets: [0.0, 0.1],
    };
    assert_eq!(
        prp.motion(&still_guide(0.0, 0.0, 0.5), &still_guide(1.0, 0.0, 0.5)),
        singular(Singular::GuidesParallel)
    );
    let rpp = Rpp {
        direction: Vector2::unit(0.0),
    };
    assert_eq!(
        rpp.motion(&origin, &still_guide(1.0, 0.0, 0.5)),
        singular(Singular::GuidesParallel)
    );
}

#[test]
fn numbers_that_are_not_numbers_are_refused() {
    let origin = still(0.0, 0.0);
    let nowhere = still(f64::NAN, 0.0);
    let rrr = Rrr {
        lengths: [1.0, 1.0],
        side: Side::Left,
    };
    assert_eq!(rrr.motion(&origin, &nowhere), Err(DyadError::NotFinite));
    let rpr = Rpr {
        offset: 0.1,
        branch: SlideBranch::Ahead,
    };
    assert_eq!(rpr.motion(&nowhere, &origin), Err(DyadError::NotFinite));
}
