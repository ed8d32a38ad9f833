//! The explanation of a mobility analysis, in the steps of a textbook.

use crate::study::mobility::MobilityAnalysis;
use fivebar_design::mobility::{
    GraphAnalysis, Mobility, ParallelAnalysis, Pitch, RANK_TOLERANCE, ScrewAxis,
};
use fivebar_files::mobility::MobilityCase;
use std::fmt::Write as _;

/// The words for a screw of zero, finite and infinite pitch.
type Kinds = [&'static str; 3];
const CONSTRAINTS: Kinds = ["force", "wrench", "couple"];
const FREEDOMS: Kinds = ["rotation", "screw motion", "translation"];

/// A heading and its sentences.
pub(crate) type Step = (String, Vec<String>);

/// The analysis explained, a step at a time.
pub(crate) fn steps(analysis: &MobilityAnalysis) -> Vec<Step> {
    match analysis {
        MobilityAnalysis::Parallel(analysis) => parallel(analysis),
        MobilityAnalysis::Graph(analysis) => graph(analysis),
    }
}

/// The analysis explained as plain text.
pub fn explain(study: &MobilityCase, analysis: &MobilityAnalysis) -> String {
    let mut text = format!("{}\n", study.name);
    if !study.description.is_empty() {
        let _ = writeln!(text, "{}", study.description);
    }
    for (number, (heading, sentences)) in steps(analysis).into_iter().enumerate() {
        let _ = writeln!(text, "\n{}. {heading}", number + 1);
        for sentence in sentences {
            let _ = writeln!(text, "   {sentence}");
        }
    }
    text
}

fn parallel(analysis: &ParallelAnalysis) -> Vec<Step> {
    let m = &analysis.mobility;
    let p = analysis.limbs.len();
    let q: Vec<usize> = analysis
        .limbs
        .iter()
        .map(|limb| limb.constraints.len())
        .collect();
    let sum_q: usize = q.iter().sum();
    let mut limbs = Vec::new();
    for (index, limb) in analysis.limbs.iter().enumerate() {
        limbs.push(format!(
            "Limb {}: {} joint screws of rank {}, so q = 6 − {} = {}: {}.",
            index + 1,
            limb.freedoms,
            limb.rank,
            limb.rank,
            limb.constraints.len(),
            list(&limb.constraints, CONSTRAINTS, "it has no constraints"),
        ));
    }
    let common = vec![
        format!(
            "The wrenches reciprocal to every joint of the mechanism: λ = {}: {}.",
            m.lambda,
            list(&analysis.common, CONSTRAINTS, "none"),
        ),
        format!("Order of the mechanism: d = 6 − λ = {}.", m.order),
    ];
    let redundant = vec![
        format!(
            "The limbs' constraints together span W of rank {}; besides the common ones that is k = {} − {} = {}.",
            analysis.wrench_rank, analysis.wrench_rank, m.lambda, analysis.k
        ),
        format!(
            "Redundant constraints: v = Σq − λp − k = {sum_q} − {}·{p} − {} = {}.",
            m.lambda, analysis.k, m.redundant
        ),
    ];
    let mut count = vec![
        grubler(m),
        format!(
            "Equation (7): M = d(n − g − 1) + Σf + v = {}·({} − {} − 1) + {} + {} = {}.",
            m.order, m.bodies, m.joints, m.sum_f, m.redundant, m.m_eq7
        ),
        format!(
            "Equation (9): M = 6 − Σq + λ(p − 1) + v = 6 − {sum_q} + {}·({p} − 1) + {} = {}.",
            m.lambda, m.redundant, analysis.m_eq9
        ),
    ];
    count.push(if analysis.passive == 0 {
        "They agree: every limb's screws are independent (ζ = 0).".into()
    } else {
        format!(
            "They differ by ζ = {}, the number of freedoms inside the limbs that do not move the platform.",
            analysis.passive
        )
    });
    vec![
        ("The constraints of each limb".into(), limbs),
        ("The common constraints".into(), common),
        ("The redundant constraints".into(), redundant),
        ("The count".into(), count),
        platform(m, &analysis.platform_constraints),
        finite(m),
    ]
}

fn graph(analysis: &GraphAnalysis) -> Vec<Step> {
    let m = &analysis.mobility;
    let loops = vec![
        format!(
            "{} bodies with the ground and {} joints make {} independent loops.",
            m.bodies, m.joints, analysis.loops
        ),
        format!(
            "All joints share λ = {} common constraints: d = 6 − λ = {}.",
            m.lambda, m.order
        ),
        format!(
            "The loops give {}·{} = {} conditions. Their Jacobian over all {} single freedoms has rank {}, so v = {} conditions are redundant.",
            m.order,
            analysis.loops,
            m.order * analysis.loops,
            m.sum_f,
            analysis.jacobian_rank,
            m.redundant
        ),
    ];
    let count = vec![
        grubler(m),
        format!(
            "Equation (7): M = d(n − g − 1) + Σf + v = {}·({} − {} − 1) + {} + {} = {}.",
            m.order, m.bodies, m.joints, m.sum_f, m.redundant, m.m_eq7
        ),
    ];
    vec![
        ("The loops".into(), loops),
        ("The count".into(), count),
        platform(m, &analysis.platform_constraints),
        finite(m),
    ]
}

fn grubler(m: &Mobility) -> String {
    format!(
        "Grübler's spatial count, which ignores the geometry: 6(n − g − 1) + Σf = 6·({} − {} − 1) + {} = {}.",
        m.bodies, m.joints, m.sum_f, m.grubler
    )
}

fn platform(m: &Mobility, constraints: &[ScrewAxis]) -> Step {
    let sentences = vec![
        format!("Constraints: {}.", list(constraints, CONSTRAINTS, "none")),
        format!(
            "Degrees of freedom: {} ({}, {}): {}.",
            m.platform_dof,
            plural(m.rotations, "rotation"),
            plural(m.pure_translations, "translation"),
            list(&m.freedoms, FREEDOMS, "none")
        ),
    ];
    ("The platform's freedoms in this pose".into(), sentences)
}

fn finite(m: &Mobility) -> Step {
    let mut sentences = vec![format!(
        "The loop Jacobian leaves {} (pivots below {RANK_TOLERANCE:e} times the largest count as zero).",
        plural(m.instantaneous, "freedom")
    )];
    sentences.push(match (m.instantaneous, m.finite) {
        (0, _) => "The mechanism cannot move: it is a structure.".into(),
        (_, 0) => "A finite motion is not possible: this is a shaky structure, mobile to first order only.".into(),
        (inst, real) if inst > real => format!("After a finite motion of half a radian, {real} remain: this pose is singular, and the other freedoms are instantaneous only."),
        (_, real) => format!("After a finite motion of half a radian, all {real} remain: the mobility is finite."),
    });
    if let Some(held) = m.with_drives_held {
        sentences.push(if held == 0 {
            "With the actuated joints held, the mechanism cannot move: the drives hold the platform.".into()
        } else {
            format!(
                "With the actuated joints held, the mechanism keeps {}: the drives do not hold it here.",
                plural(held, "freedom")
            )
        });
    }
    ("Instantaneous and finite mobility".into(), sentences)
}

fn plural(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

fn list(screws: &[ScrewAxis], kinds: Kinds, none: &str) -> String {
    if screws.is_empty() {
        return none.into();
    }
    let words: Vec<String> = screws.iter().map(|s| describe(s, kinds)).collect();
    words.join("; ")
}

fn describe(screw: &ScrewAxis, [zero, finite, infinite]: Kinds) -> String {
    let axis = direction(&screw.direction);
    let through = screw.point.map_or(String::new(), |p| {
        format!(
            " through ({}, {}, {})",
            number(p.x),
            number(p.y),
            number(p.z)
        )
    });
    match screw.pitch {
        Pitch::Zero => format!("a {zero} along {axis}{through}"),
        Pitch::Finite(pitch) => {
            format!(
                "a {finite} along {axis}{through}, pitch {} per rad",
                number(pitch)
            )
        }
        Pitch::Infinite => format!("a {infinite} along {axis}"),
    }
}

fn direction(axis: &nalgebra::Vector3<f64>) -> String {
    for (index, name) in ["x", "y", "z"].into_iter().enumerate() {
        if (axis[index].abs() - 1.0).abs() < 1e-9 {
            return name.into();
        }
    }
    format!(
        "({}, {}, {})",
        number(axis.x),
        number(axis.y),
        number(axis.z)
    )
}

fn number(value: f64) -> String {
    let text = format!("{value:.4}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" {
        "0".into()
    } else {
        text.into()
    }
}
