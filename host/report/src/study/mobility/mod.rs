//! The analysis of mobility by screw theory, and the analysis as JSON.

mod answer;

pub use answer::answer;

use fivebar_design::mobility::{
    GraphAnalysis, Mobility, ParallelAnalysis, analyse_graph, analyse_parallel,
};
use fivebar_files::mobility::{Mechanism, MobilityCase};

/// The result of the analysis.
pub enum MobilityAnalysis {
    /// For a platform on limbs.
    Parallel(ParallelAnalysis),
    /// For a graph.
    Graph(GraphAnalysis),
}

impl MobilityAnalysis {
    /// The part that all mechanisms have.
    pub fn mobility(&self) -> &Mobility {
        match self {
            Self::Parallel(analysis) => &analysis.mobility,
            Self::Graph(analysis) => &analysis.mobility,
        }
    }
}

/// Analyses the mechanism.
pub fn analyse(case: &MobilityCase) -> MobilityAnalysis {
    match &case.mechanism {
        Mechanism::Parallel(parallel) => MobilityAnalysis::Parallel(analyse_parallel(parallel)),
        Mechanism::Graph(graph) => MobilityAnalysis::Graph(analyse_graph(graph)),
    }
}
