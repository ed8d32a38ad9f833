//! A linkage drawn moving: its links as outlines, its points' curves.

use super::DrivenLinkage;
use crate::report::{Animation, Body, Point, Trace};
use fivebar_kinematics::Vec2;
use fivebar_kinematics::linkage::{Element, Group, LinkId, Solved, Sweep};

/// A sweep takes at least so long to watch [s].
const SHORTEST: f64 = 5.0;
/// Sliders are drawn this long against the whole picture.
const SLIDER: f64 = 0.04;

/// The sweep as a moving picture, slowed down where it would be too quick to see.
pub(super) fn animation(driven: &DrivenLinkage, sweep: &Sweep) -> Animation {
    let slowing = (SHORTEST / driven.duration).max(1.0);
    let caption = if slowing > 1.0 {
        format!("{} in motion, {slowing:.3} times slowed", driven.name)
    } else {
        format!("{} in motion", driven.name)
    };
    let times: Vec<f64> = sweep.samples.iter().map(|s| s.time * slowing).collect();
    let mut animation = Animation::new(caption, "m", times.clone());
    let size = SLIDER * extent(sweep);
    for element in driven.linkage.elements() {
        for (position, link) in element.links().enumerate() {
            let outline = |solved: &Solved| outline(driven, element, position, link, solved, size);
            animation.bodies.push(Body {
                name: String::new(),
                frames: frames(sweep, outline),
            });
        }
    }
    for (name, points) in curves(driven, sweep) {
        let times = times.clone();
        animation.traces.push(Trace {
            name,
            times,
            points,
        });
    }
    for point in driven.linkage.points() {
        if let (LinkId::GROUND, Some(at)) = (point.link, point.local) {
            animation.fixed.push((String::new(), support(at, size)));
        }
    }
    animation
}

/// The curves of all points that are not in the frame, broken where the linkage does not
/// close.
pub(super) fn curves(driven: &DrivenLinkage, sweep: &Sweep) -> Vec<(String, Vec<Point>)> {
    let points = driven.linkage.points().iter().enumerate();
    points
        .filter(|(_, point)| point.link != LinkId::GROUND)
        .map(|(i, point)| {
            let place = |solved: &Solved| pair(solved.motion.points[i].position);
            let places = sweep.samples.iter().map(|sample| {
                let solved = sample.solved.as_ref();
                solved.map_or([f64::NAN; 2], place)
            });
            (point.name.clone(), places.collect())
        })
        .collect()
}

/// The frames of one outline, as many points in each.
fn frames(sweep: &Sweep, outline: impl Fn(&Solved) -> Vec<Point>) -> Vec<Vec<Point>> {
    let solved = |i: usize| sweep.samples[i].solved.as_ref().ok();
    let count = (0..sweep.samples.len())
        .find_map(solved)
        .map_or(0, |solved| outline(solved).len());
    let nowhere = vec![[f64::NAN; 2]; count];
    (0..sweep.samples.len())
        .map(|i| solved(i).map_or_else(|| nowhere.clone(), &outline))
        .collect()
}

/// A bar as the chain of its points, closed if there are more than two; a slider as a box
/// about its origin with whatever is fixed to it.
fn outline(
    driven: &DrivenLinkage,
    element: &Element<f64>,
    position: usize,
    link: LinkId,
    solved: &Solved,
    size: f64,
) -> Vec<Point> {
    let motion = &solved.motion.links[link.index()];
    let origin = motion.origin.position;
    let own = driven.linkage.points().iter().enumerate();
    let mut places: Vec<Vec2<f64>> = own
        .filter(|(_, point)| point.link == link && point.local.is_some())
        .map(|(i, _)| solved.motion.points[i].position)
        .collect();
    let is_slider = match element.group {
        Group::Crank { .. } | Group::Rrr { .. } => false,
        Group::Rrp { .. } | Group::Rpr { .. } => position == 1,
        Group::Slider { .. } | Group::Prp { .. } | Group::Rpp { .. } => true,
    };
    let pin = || Some(solved.motion.points[element.joint()?.index()].position);
    let other = |link: usize| Some(solved.motion.links[link].origin.position);
    let far_end = match element.group {
        Group::Rrr { .. } => pin(),
        Group::Rrp { .. } if position == 0 => pin(),
        Group::Rpr { .. } if position == 0 => other(link.index() + 1),
        Group::Rpp { .. } if position == 1 => other(link.index() - 1),
        _ => None,
    };
    places.extend(far_end);
    let mut outline = vec![origin];
    if is_slider {
        let (u, n) = (motion.axis * size, motion.axis.perp() * (0.5 * size));
        outline = vec![
            origin + u + n,
            origin - u + n,
            origin - u - n,
            origin + u - n,
            origin + u + n,
        ];
        if !places.is_empty() {
            outline.push(origin);
        }
    }
    let closes = !is_slider && places.len() > 1;
    outline.extend(places);
    if closes {
        outline.push(origin);
    }
    outline.into_iter().map(pair).collect()
}

/// The triangle under a fixed pivot.
fn support(at: Vec2<f64>, size: f64) -> Vec<Point> {
    let [x, y] = pair(at);
    let (half, down) = (0.5 * size, y - size);
    vec![[x, y], [x - half, down], [x + half, down], [x, y]]
}

/// The larger side of the box about everything that moves [m].
fn extent(sweep: &Sweep) -> f64 {
    let mut low = [f64::INFINITY; 2];
    let mut high = [f64::NEG_INFINITY; 2];
    for (_, solved) in sweep.solved() {
        for point in &solved.motion.points {
            for (axis, value) in pair(point.position).into_iter().enumerate() {
                low[axis] = low[axis].min(value);
                high[axis] = high[axis].max(value);
            }
        }
    }
    (high[0] - low[0]).max(high[1] - low[1]).max(0.0)
}

fn pair(vector: Vec2<f64>) -> Point {
    [vector.x, vector.y]
}
