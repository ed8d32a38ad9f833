//! Critical sections: how long code keeps an interrupt of higher priority waiting.
//!
//! A section begins where BASEPRI or PRIMASK is raised and ends where it is restored. Sections
//! are scopes of the source, so they lie within each other like brackets: each write that raises
//! a mask opens one, and each that restores a mask closes the latest. A function must close what
//! it opens. Where a compiler merges the ends of several sections, a place in the code is there
//! once for each number of open ones.

use std::collections::{BTreeMap, BTreeSet};

use crate::graph::{Edge, Graph, Node};
use crate::instruction::Mask;
use crate::longest::{Bound, Longest, LoopError};
use crate::program::{Costs, Program};
use crate::timing::{MEASURES, Measure};
use crate::{Defect, Fault};

/// Sections within each other, at most.
const DEEPEST: u32 = 4;

/// A critical section.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Section {
    /// Name of the function where it begins.
    pub function: String,
    /// Address of the instruction that raises the mask.
    pub address: u32,
    /// The longest path from there to the end, by each of [`Measure::ALL`].
    pub longest: [u64; MEASURES],
}

/// A function's instructions, each with the number of sections that are open before it.
struct Places {
    /// Node of the function's graph, and open sections.
    places: Vec<(usize, u32)>,
    index: BTreeMap<(usize, u32), usize>,
}

/// The number of sections that are open behind a node.
fn after(node: &Node, open: u32) -> Result<u32, Fault> {
    match node.instruction.mask {
        Mask::Raise if open == DEEPEST => Err(Fault::SectionEnd),
        Mask::Raise => Ok(open + 1),
        // A handler's end restores what it found, with no section open.
        Mask::Restore => Ok(open.saturating_sub(1)),
        Mask::Open if open == 0 => Ok(0),
        Mask::Open => Err(Fault::SectionEnd),
        Mask::Keep => Ok(open),
    }
}

impl Places {
    /// All places that can be reached, and where a section has no end that can be known.
    fn of(graph: &Graph) -> (Self, Vec<(u32, Fault)>) {
        let mut it = Self {
            places: Vec::new(),
            index: BTreeMap::new(),
        };
        let mut faults = Vec::new();
        if !graph.nodes.is_empty() {
            it.place((0, 0));
        }
        let mut next = 0;
        while let Some(&(node, open)) = it.places.get(next) {
            next += 1;
            let node = &graph.nodes[node];
            match after(node, open) {
                Err(fault) => faults.push((node.address, fault)),
                Ok(open) if node.leaves && open > 0 => {
                    faults.push((node.address, Fault::SectionEnd));
                }
                Ok(open) => node.next.iter().for_each(|edge| {
                    it.place((edge.to, open));
                }),
            }
        }
        (it, faults)
    }

    fn place(&mut self, place: (usize, u32)) -> usize {
        *self.index.entry(place).or_insert_with(|| {
            self.places.push(place);
            self.places.len() - 1
        })
    }

    /// The section that begins at a place with none open, as a graph of its own.
    fn section(&self, graph: &Graph, start: (usize, u32)) -> Graph {
        let mut index = BTreeMap::from([(start, 0)]);
        let mut order = vec![start];
        let mut nodes: Vec<Node> = Vec::new();
        while let Some(&(node, open)) = order.get(nodes.len()) {
            let mut copy = graph.nodes[node].clone();
            let edges = core::mem::take(&mut copy.next);
            if let Ok(open @ 1..) = after(&copy, open) {
                for Edge { to, taken } in edges {
                    let to = *index.entry((to, open)).or_insert_with(|| {
                        order.push((to, open));
                        order.len() - 1
                    });
                    copy.next.push(Edge { to, taken });
                }
            }
            nodes.push(copy);
        }
        Graph { nodes }
    }
}

impl Program<'_> {
    /// The critical sections in all functions that the one at `address` reaches, and what keeps
    /// one from being bounded.
    pub fn sections(&mut self, address: u32) -> (Vec<Section>, Vec<Defect>) {
        let (mut sections, mut defects) = (Vec::new(), Vec::new());
        for address in self.reached(address) {
            self.sections_in(address, &mut sections, &mut defects);
        }
        defects.sort();
        defects.dedup();
        (sections, defects)
    }

    fn sections_in(
        &mut self,
        address: u32,
        sections: &mut Vec<Section>,
        defects: &mut Vec<Defect>,
    ) {
        let Some(function) = self.image().function(address).cloned() else {
            return;
        };
        if self.stated().ends(&function.name) {
            return;
        }
        let (graph, _) = self.graph(&function);
        let (places, faults) = Places::of(&graph);
        let defect = |(address, fault)| Defect {
            function: function.name.clone(),
            address,
            fault,
        };
        defects.extend(faults.into_iter().map(defect));
        let headers = self.headers(&graph);
        let begins = |&&(node, open): &&(usize, u32)| {
            open == 0 && graph.nodes[node].instruction.mask == Mask::Raise
        };
        for &start in places.places.iter().filter(begins) {
            let section = places.section(&graph, start);
            let within: BTreeSet<u32> = section.nodes.iter().map(|node| node.address).collect();
            // What cannot be followed was noted for the function.
            let own = self.bounds(address).defects.clone();
            let inside = own.into_iter().filter(|defect| {
                within.contains(&defect.address) && !matches!(defect.fault, Fault::Loop)
            });
            defects.extend(inside);
            let calls: BTreeSet<u32> = section
                .nodes
                .iter()
                .flat_map(|node| node.calls.iter().copied())
                .collect();
            for call in calls {
                defects.extend(self.defects(call));
            }
            let bound = |address: u32| -> Option<Bound> {
                let number = headers.iter().position(|it| *it == address)? + 1;
                self.stated().bound(&function.name, number)
            };
            let mut longest = [0; MEASURES];
            for (longest, measure) in longest.iter_mut().zip(Measure::ALL) {
                let costs = Costs::new(&section, self.image().core, measure, self.known());
                let mut search = Longest::new(&section, &costs, &bound);
                let paths = search.paths();
                for error in search.errors {
                    defects.push(defect(match error {
                        LoopError::Unbounded(address) => (address, Fault::Loop),
                        LoopError::SeveralEntries(address) => (address, Fault::LoopEntries),
                    }));
                }
                *longest = paths.into_iter().flatten().max().unwrap_or(0);
            }
            sections.push(Section {
                function: function.name.clone(),
                address: graph.nodes[start.0].address,
                longest,
            });
        }
    }
}
