//! Mobility by screw theory (Huang, section 5): the degrees of freedom of a mechanism where
//! Grübler's count fails, and the constraints behind them.
//!
//! A twist $ = (s; r×s) is a revolute joint, (0; s) a prismatic one. The wrenches of a
//! limb are reciprocal to all its joints' twists. With n links, g joints, p limbs:
//!
//! - λ = 6 − rank(all twists): common constraints; d = 6 − λ: the mechanism's order;
//! - qi = 6 − rank(limb i): constraints of limb i; k = rank W − λ, W the union of the
//!   limbs' wrench systems; v = Σqi − λp − k: redundant constraints;
//! - (7) M = d(n − g − 1) + Σf + v; (9) M = 6 − Σqi + λ(p − 1) + v.
//!
//! **Erratum**: (7) and (9) are equal only when each limb's twists are independent; in
//! general (7) − (9) = ζ = Σ(wi − rank i), the passive freedoms.
//!
//! ```text
//! mechanism ─→ frame (centred, scaled) ─→ count    λ, d, q, k, v, ζ, M    (parallel)
//!                                    └──→ loops ─→ M by the loop Jacobian (any graph)
//!                                             └──→ finite: dimension of the finite motion
//! ```

mod analysis;
mod finite;
mod frame;
mod loops;
mod mechanism;
mod screw;
mod screw_axis;
mod system;

pub use analysis::{
    GraphAnalysis, LimbAnalysis, Mobility, ParallelAnalysis, analyse_graph, analyse_parallel,
};
pub use mechanism::{
    Freedom, Joint, MAX_FREEDOMS, MechanismError, MechanismGraph, ParallelMechanism,
};
pub use screw::Screw;
pub use screw_axis::{Pitch, ScrewAxis};
pub use system::{RANK_TOLERANCE, ScrewSystem};
