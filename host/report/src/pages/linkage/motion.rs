//! The animation of a linkage: outlines of its links, curves of its points.

use crate::html::{AnimatedBody, AnimatedTrace, Animation, Point};
use fivebar_design::linkage::{
    Element, Group, LinkId, LinkMotion, SolvedSample, Sweep, SweepSample,
};
use fivebar_files::linkage::DrivenLinkage;
use fivebar_kinematics::PlanarVector;
use nalgebra::Vector2;

/// Least duration of the animation [s].
const MIN_DURATION: f64 = 5.0;
/// Half length of a slider, as a share of the picture.
const SLIDER: f64 = 0.04;

/// The animation of a sweep; a short sweep is slowed down.
pub(super) fn animation(driven: &DrivenLinkage, sweep: &Sweep) -> Animation {
    let slowing = (MIN_DURATION / driven.duration).max(1.0);
    let caption = if slowing > 1.0 {
        let slowing = (slowing * 100.0).round() / 100.0;
        format!("{} in motion, {slowing} times slower", driven.name)
    } else {
        format!("{} in motion", driven.name)
    };
    let times: Vec<f64> = sweep.samples.iter().map(|s| s.time * slowing).collect();
    let mut animation = Animation::new(caption, "m", times.clone());
    let size = SLIDER * extent(sweep);
    for element in driven.linkage.elements() {
        for (position, link) in element.links().enumerate() {
            let chain = |solved: &SolvedSample| chain(driven, element, position, link, solved);
            animation.bodies.push(body(sweep, chain));
            if is_slider(&element.group, position) {
                let block = |solved: &SolvedSample| block(&solved.motion.links[link.index()], size);
                animation.bodies.push(body(sweep, block));
            }
        }
    }
    for (name, points) in curves(driven, sweep) {
        let times = times.clone();
        animation.traces.push(AnimatedTrace {
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

/// The curves of all points outside the frame, with gaps where the linkage does not close.
pub(super) fn curves(driven: &DrivenLinkage, sweep: &Sweep) -> Vec<(String, Vec<Point>)> {
    let points = driven.linkage.points().iter().enumerate();
    points
        .filter(|(_, point)| point.link != LinkId::GROUND)
        .map(|(i, point)| {
            let place = |solved: &SolvedSample| pair(solved.motion.points[i].position);
            let places = sweep.samples.iter().map(|sample| {
                let solved = sample.solved.as_ref();
                solved.map_or([f64::NAN; 2], place)
            });
            (point.name.clone(), places.collect())
        })
        .collect()
}

/// One outline at each instant; a gap while the linkage does not close.
fn body(sweep: &Sweep, outline: impl Fn(&SolvedSample) -> Vec<Point>) -> AnimatedBody {
    let solved = |sample: &SweepSample| sample.solved.as_ref().ok().map(&outline);
    let count = sweep
        .samples
        .iter()
        .find_map(solved)
        .map_or(0, |outline| outline.len());
    let nowhere = vec![[f64::NAN; 2]; count];
    let frames = sweep.samples.iter();
    AnimatedBody {
        name: String::new(),
        frames: frames
            .map(|sample| solved(sample).unwrap_or_else(|| nowhere.clone()))
            .collect(),
    }
}

/// Whether a link is drawn as a block.
fn is_slider(group: &Group<f64>, position: usize) -> bool {
    match group {
        Group::Crank { .. } | Group::Rrr { .. } => false,
        Group::Rrp { .. } | Group::Rpr { .. } => position == 1,
        Group::Slider { .. } | Group::Prp { .. } | Group::Rpp { .. } => true,
    }
}

/// A link as the chain of its points from its origin to its far end. The chain of a bar with
/// more than two points is closed.
fn chain(
    driven: &DrivenLinkage,
    element: &Element<f64>,
    position: usize,
    link: LinkId,
    solved: &SolvedSample,
) -> Vec<Point> {
    let motion = &solved.motion;
    let origin = motion.links[link.index()].origin.position;
    let mut chain = vec![origin];
    for (point, moving) in driven.linkage.points().iter().zip(&motion.points) {
        if point.link == link && point.local.is_some() {
            chain.push(moving.position);
        }
    }
    let pin = || Some(motion.points[element.inner_pin()?.index()].position);
    let other = |link: usize| Some(motion.links[link].origin.position);
    chain.extend(match element.group {
        Group::Rrr { .. } => pin(),
        Group::Rrp { .. } if position == 0 => pin(),
        Group::Rpr { .. } if position == 0 => other(link.index() + 1),
        Group::Rpp { .. } if position == 1 => other(link.index() - 1),
        _ => None,
    });
    if chain.len() > 2 && !is_slider(&element.group, position) {
        chain.push(origin);
    }
    chain.into_iter().map(pair).collect()
}

/// A slider as a block about its origin.
fn block(slider: &LinkMotion<f64>, size: f64) -> Vec<Point> {
    let (u, n) = (
        slider.axis * size,
        slider.axis.perpendicular() * (0.5 * size),
    );
    let corners = [u + n, n - u, -u - n, u - n, u + n];
    corners
        .map(|corner| pair(slider.origin.position + corner))
        .into()
}

/// The triangle under a fixed pivot.
fn support(at: Vector2<f64>, size: f64) -> Vec<Point> {
    let [x, y] = pair(at);
    let (half, down) = (0.5 * size, y - size);
    vec![[x, y], [x - half, down], [x + half, down], [x, y]]
}

/// The larger side of the box around all moving points [m].
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

fn pair(vector: Vector2<f64>) -> Point {
    [vector.x, vector.y]
}
