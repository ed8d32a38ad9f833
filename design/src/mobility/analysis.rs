//! Huang's counts, and the freedoms and constraints of limbs and platform.

use super::finite::{finite_mobility, instantaneous_mobility};
use super::frame::ScaledFrame;
use super::loops::Loops;
use super::screw_axis::{Pitch, ScrewAxis, screw_axes};
use super::system::{ScrewSystem, null_space};
use super::{Freedom, Joint, MechanismGraph, ParallelMechanism, Screw};
use nalgebra::DVector;

/// The figures that parallel mechanisms and general graphs have in common.
#[derive(Clone, Debug)]
pub struct Mobility {
    /// n: the number of bodies, the ground among them.
    pub bodies: usize,
    /// g: the number of joints.
    pub joints: usize,
    /// Σf: the number of single freedoms.
    pub sum_f: usize,
    /// λ = 6 − rank of all twists: constraints common to every joint.
    pub lambda: usize,
    /// d = 6 − λ: the order of the mechanism.
    pub order: usize,
    /// v: redundant constraints.
    pub redundant: usize,
    /// Equation (7): M = d(n − g − 1) + Σf + v, passive freedoms included.
    pub m_eq7: i64,
    /// The dimension of the platform's motion.
    pub platform_dof: usize,
    /// The platform's pure translations.
    pub pure_translations: usize,
    /// The dimension of the platform's rotations.
    pub rotations: usize,
    /// The spatial Grübler count 6(n − g − 1) + Σf, for comparison.
    pub grubler: i64,
    /// N − rank J of the loop Jacobian at home.
    pub instantaneous: usize,
    /// The dimension of the finite motion through home.
    pub finite: usize,
    /// N − rank J with the actuated joints held; none where no joint is actuated.
    pub with_drives_held: Option<usize>,
    /// The platform's freedoms.
    pub freedoms: Vec<ScrewAxis>,
}

/// One limb of a parallel mechanism.
#[derive(Clone, Debug)]
pub struct LimbAnalysis {
    /// wi: its number of single freedoms.
    pub freedoms: usize,
    /// The rank of its twists.
    pub rank: usize,
    /// qi = 6 − rank: its constraints on the platform.
    pub constraints: Vec<ScrewAxis>,
}

/// The analysis of a platform on limbs.
#[derive(Clone, Debug)]
pub struct ParallelAnalysis {
    /// The figures that any graph has.
    pub mobility: Mobility,
    /// The limbs.
    pub limbs: Vec<LimbAnalysis>,
    /// rank W of the union of the limbs' wrench systems.
    pub wrench_rank: usize,
    /// k = rank W − λ.
    pub k: usize,
    /// ζ = Σ(wi − rank i): passive freedoms inside limbs.
    pub passive: usize,
    /// Equation (9): 6 − Σqi + λ(p − 1) + v.
    pub m_eq9: i64,
    /// The λ common constraints.
    pub common: Vec<ScrewAxis>,
    /// The union W of the limbs' constraints.
    pub platform_constraints: Vec<ScrewAxis>,
}

/// The analysis of a general graph.
#[derive(Clone, Debug)]
pub struct GraphAnalysis {
    /// The figures that any graph has.
    pub mobility: Mobility,
    /// The number of independent loops, g − n + 1.
    pub loops: usize,
    /// rank of the loop Jacobian.
    pub jacobian_rank: usize,
    /// The constraints of the platform: the wrenches reciprocal to its freedoms.
    pub platform_constraints: Vec<ScrewAxis>,
}

/// Analyses a platform on limbs.
pub fn analyse_parallel(mechanism: &ParallelMechanism) -> ParallelAnalysis {
    let graph = mechanism.graph();
    let frame = ScaledFrame::new(&graph);
    let twists = |joints: &[Joint]| -> Vec<Screw> {
        let freedoms = joints.iter().flat_map(|joint| &joint.freedoms);
        freedoms.map(|f| frame.express(&f.twist())).collect()
    };
    let limb_twists: Vec<Vec<Screw>> = mechanism.limbs().iter().map(|l| twists(l)).collect();
    let spans: Vec<ScrewSystem> = limb_twists
        .iter()
        .map(|t| ScrewSystem::span(t.iter().copied()))
        .collect();
    let wrenches: Vec<ScrewSystem> = spans.iter().map(ScrewSystem::reciprocal).collect();
    let union = ScrewSystem::sum(&wrenches);
    let common = ScrewSystem::sum(&spans).reciprocal();

    let p = wrenches.len();
    let lambda = common.rank();
    let k = union.rank() - lambda;
    let sum_q: usize = wrenches.iter().map(ScrewSystem::rank).sum();
    // W holds the common constraints, so Σq ≥ λp + k and v cannot be negative.
    let redundant = sum_q - lambda * p - k;
    let m_eq9 = 6 - to_i64(sum_q) + to_i64(lambda) * (to_i64(p) - 1) + to_i64(redundant);

    ParallelAnalysis {
        mobility: mobility(&graph, &frame, lambda, redundant, &union.reciprocal()),
        limbs: limb_twists
            .iter()
            .zip(&spans)
            .zip(&wrenches)
            .map(|((twists, span), wrench)| LimbAnalysis {
                freedoms: twists.len(),
                rank: span.rank(),
                constraints: screw_axes(wrench, &frame),
            })
            .collect(),
        wrench_rank: union.rank(),
        k,
        passive: limb_twists
            .iter()
            .zip(&spans)
            .map(|(t, s)| t.len() - s.rank())
            .sum(),
        m_eq9,
        common: screw_axes(&common, &frame),
        platform_constraints: screw_axes(&union, &frame),
    }
}

/// Analyses any graph, also one with closed loops inside limbs.
pub fn analyse_graph(graph: &MechanismGraph) -> GraphAnalysis {
    let frame = ScaledFrame::new(graph);
    let expressed = frame.express_graph(graph);
    let loops = Loops::new(&expressed);
    let freedoms = expressed.joints().iter().flat_map(|joint| &joint.freedoms);
    let all = ScrewSystem::span(freedoms.map(Freedom::twist));
    let lambda = 6 - all.rank();

    let home = DVector::zeros(loops.variables());
    let motions = null_space(&loops.jacobian(&home));
    let jacobian_rank = loops.variables() - motions.ncols();
    // Each loop has d conditions; those that are not independent are redundant.
    let redundant = (6 - lambda) * loops.count() - jacobian_rank;
    let platform = ScrewSystem::span_of_motions(loops.platform_twists(&home, &motions));
    GraphAnalysis {
        mobility: mobility(graph, &frame, lambda, redundant, &platform),
        loops: loops.count(),
        jacobian_rank,
        platform_constraints: screw_axes(&platform.reciprocal(), &frame),
    }
}

fn mobility(
    graph: &MechanismGraph,
    frame: &ScaledFrame,
    lambda: usize,
    redundant: usize,
    platform: &ScrewSystem,
) -> Mobility {
    let (bodies, joints) = (graph.bodies(), graph.joints().len());
    let sum_f = graph
        .joints()
        .iter()
        .map(|joint| joint.freedoms.len())
        .sum();
    let order = 6 - lambda;
    let excess = to_i64(bodies) - to_i64(joints) - 1;
    let loops = Loops::new(&frame.express_graph(graph));
    let actuated = graph.joints().iter().any(|joint| joint.actuated);
    let with_drives_held = actuated.then(|| {
        let held = frame.express_graph(&graph.with_drives_held());
        instantaneous_mobility(&Loops::new(&held))
    });
    let freedoms = screw_axes(platform, frame);
    let pure_translations = freedoms
        .iter()
        .filter(|f| f.pitch == Pitch::Infinite)
        .count();
    Mobility {
        bodies,
        joints,
        sum_f,
        lambda,
        order,
        redundant,
        m_eq7: to_i64(order) * excess + to_i64(sum_f) + to_i64(redundant),
        platform_dof: platform.rank(),
        pure_translations,
        rotations: platform.rank() - pure_translations,
        grubler: 6 * excess + to_i64(sum_f),
        instantaneous: instantaneous_mobility(&loops),
        finite: finite_mobility(&loops),
        with_drives_held,
        freedoms,
    }
}

/// Counts are bounded by [`super::MAX_FREEDOMS`].
fn to_i64(count: usize) -> i64 {
    i64::try_from(count).unwrap_or(i64::MAX)
}
