//! The structure of a linkage, and the equations by which it is solved.

use crate::study::linkage::branch;
use fivebar_design::linkage::{Group, Guide, PointId};
use fivebar_files::linkage::{DrivenLinkage, links_of};
use fivebar_kinematics::PlanarVector;

/// A row for each element: kind, links, carriers, dimensions and branch.
pub(super) fn elements(driven: &DrivenLinkage) -> Vec<Vec<String>> {
    let linkage = &driven.linkage;
    let point = |id: &PointId| linkage.points()[id.index()].name.clone();
    let guide = |guide: &Guide<f64>| {
        let through = &linkage.points()[guide.through.index()];
        let carrier = &linkage.links()[through.link.index()].name;
        let angle = guide.direction.polar_angle().to_degrees();
        format!("guide through {} of {carrier} at {angle:.1}°", through.name)
    };
    let elements = linkage.elements().iter().enumerate();
    elements
        .map(|(index, element)| {
            let (carriers, dimensions) = match &element.group {
                Group::Crank { pivot } => (point(pivot), String::new()),
                Group::Slider { guide: on } => (guide(on), String::new()),
                Group::Rrr { dyad, ends } => (
                    ends.each_ref().map(point).join(", "),
                    format!("l = {} m, {} m", dyad.lengths[0], dyad.lengths[1]),
                ),
                Group::Rrp {
                    dyad,
                    end,
                    guide: on,
                } => (
                    format!("{}, {}", point(end), guide(on)),
                    format!("l = {} m, e = {} m", dyad.length, dyad.offset),
                ),
                Group::Rpr { dyad, ends } => (
                    ends.each_ref().map(point).join(", "),
                    format!("e = {} m", dyad.offset),
                ),
                Group::Prp { dyad, guides } => (
                    guides.each_ref().map(guide).join(", "),
                    format!("e = {} m, {} m", dyad.offsets[0], dyad.offsets[1]),
                ),
                Group::Rpp {
                    dyad,
                    end,
                    guide: on,
                } => (
                    format!("{}, {}", point(end), guide(on)),
                    format!(
                        "slides at {:.1}°",
                        dyad.direction.polar_angle().to_degrees()
                    ),
                ),
            };
            vec![
                (index + 1).to_string(),
                kind(&element.group).into(),
                links_of(linkage, element.links()),
                carriers,
                dimensions,
                branch(&element.group).unwrap_or("–").into(),
            ]
        })
        .collect()
}

/// A row for each mass: of links, in their own frames, and of points.
pub(super) fn masses(driven: &DrivenLinkage) -> Vec<Vec<String>> {
    let links = driven.linkage.links().iter().skip(1).map(|link| {
        let body = &link.inertia;
        vec![
            link.name.clone(),
            format!("{} kg", body.mass),
            format!("({}, {}) m", body.com.x, body.com.y),
            if body.inertia == 0.0 {
                "–".into()
            } else {
                format!("{:e} kg·m²", body.inertia)
            },
        ]
    });
    let points = driven.linkage.points().iter();
    let points = points.filter(|point| point.mass > 0.0).map(|point| {
        vec![
            format!("at {}", point.name),
            format!("{} kg", point.mass),
            "–".into(),
            "–".into(),
        ]
    });
    links.chain(points).collect()
}

/// The usual name of a group.
fn kind(group: &Group<f64>) -> &'static str {
    match group {
        Group::Crank { .. } => "crank (driven)",
        Group::Slider { .. } => "slider (driven)",
        Group::Rrr { .. } => "RRR",
        Group::Rrp { .. } => "RRP",
        Group::Rpr { .. } => "RPR",
        Group::Prp { .. } => "PRP",
        Group::Rpp { .. } => "RPP",
    }
}

/// The solution of each kind of dyad in the linkage.
pub(super) fn equations(driven: &DrivenLinkage) -> Vec<&'static str> {
    let mut equations: Vec<&str> = Vec::new();
    for element in driven.linkage.elements() {
        let text = match element.group {
            Group::Crank { .. } | Group::Slider { .. } => continue,
            Group::Rrr { .. } => {
                "RRR: P3 = P1 + r1 = P2 + r2 with |r1| = l1, |r2| = l2, by the triangle on \
                 d = P2 − P1: P3 = P1 + a d ± h d⊥, a = ½(1 + (l1² − l2²)/d²), \
                 h = √(l1²/d² − a²). With X = r1×r2: ω1 = (Ṗ2−Ṗ1)·r2/X, ω2 = (Ṗ2−Ṗ1)·r1/X; \
                 with E = P̈2 − P̈1 + ω1² r1 − ω2² r2: α1 = E·r2/X, α2 = E·r1/X. X = 0, the \
                 bars in line, is its singularity."
            }
            Group::Rrp { .. } => {
                "RRP: P3 = P1 + r = G + s u with |r| = l, on a guide of direction u, normal n \
                 and angular velocity ω. With w = G − P1: s = −w·u ± √(l² − (w·n)²). With v, a \
                 of the guide's point at P3: ω1 = (v − Ṗ1)·n/(r·u), ṡ = (Ṗ1 − v)·r/(r·u); \
                 accelerations alike with a + 2ωṡ n − P̈1 + ω1² r. r·u = 0, the bar square to \
                 the guide, is its singularity."
            }
            Group::Rpr { .. } => {
                "RPR: d = P2 − P1 = s u + e n, so s = ±√(d² − e²) and u = (s d − e d⊥)/d². \
                 ω = ḋ·n/s, ṡ = ḋ·u + e ω; α = (d̈·n − 2ωṡ + e ω²)/s, s̈ = d̈·u + e α + s ω². \
                 s = 0, the slider level with the pivot, is its singularity."
            }
            Group::Prp { .. } => {
                "PRP: P3 = G1 + s1 u1 = G2 + s2 u2 on two guides: with d = G2 − G1, \
                 s1 = d×u2/(u1×u2), s2 = d×u1/(u1×u2); rates alike with the difference of the \
                 guides' velocities and accelerations at P3. Parallel guides are its \
                 singularity."
            }
            Group::Rpp { .. } => {
                "RPP: P1 = K + s u + t w, with w fixed at an angle to the guide's u: \
                 s = (P1−K)×w/(u×w), t = u×(P1−K)/(u×w); rates alike. Parallel slides are its \
                 singularity."
            }
        };
        if !equations.contains(&text) {
            equations.push(text);
        }
    }
    equations
}
