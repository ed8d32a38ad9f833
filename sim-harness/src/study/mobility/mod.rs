//! Mobility by screw theory: what a mechanism can do, and the answer as JSON.

mod answer;

pub use answer::answer;

use crate::input::mobility::{Mechanism, MobilityCase};
use fivebar_design::mobility::{
    GraphAnalysis, Mobility, ParallelAnalysis, analyse_graph, analyse_parallel,
};

/// What the analysis found.
pub enum Finding {
    /// Of a platform on limbs.
    Parallel(ParallelAnalysis),
    /// Of a graph.
    Graph(GraphAnalysis),
}

impl Finding {
    /// What holds for every mechanism.
    pub fn mobility(&self) -> &Mobility {
        match self {
            Self::Parallel(analysis) => &analysis.mobility,
            Self::Graph(analysis) => &analysis.mobility,
        }
    }
}

impl MobilityCase {
    /// Analyses the mechanism.
    pub fn analyse(&self) -> Finding {
        match &self.mechanism {
            Mechanism::Parallel(parallel) => Finding::Parallel(analyse_parallel(parallel)),
            Mechanism::Graph(graph) => Finding::Graph(analyse_graph(graph)),
        }
    }
}
