//! Time and stack of a function with all those that it calls.

use std::collections::{BTreeMap, BTreeSet};

use crate::cores::Core;
use crate::depth::depths;
use crate::graph::{Callees, Edge, Graph};
use crate::image::Image;
use crate::instruction::Stack;
use crate::longest::{Bound, Cost, Longest, LoopError};
use crate::stated::Stated;
use crate::timing::{MEASURES, Measure};
use crate::{Defect, Fault};

/// A function's bounds.
#[derive(Clone, Debug, Default)]
pub struct Bounds {
    /// The longest path by each of [`Measure::ALL`].
    pub longest: [u64; MEASURES],
    /// The deepest stack, without that of its caller [bytes].
    pub stack: u32,
    /// Whether it can return.
    pub returns: bool,
    /// Whether it or what it calls uses the FPU.
    pub float: bool,
    /// The functions that it calls itself.
    pub calls: BTreeSet<u32>,
    /// What in it cannot be bounded.
    pub defects: Vec<Defect>,
}

/// An image with the bounds of its functions, each computed when it is first asked for.
pub struct Program<'a> {
    image: &'a Image,
    stated: &'a Stated,
    known: BTreeMap<u32, Bounds>,
    /// Functions whose callees are being looked at.
    open: Vec<u32>,
}

/// The cost of a function's instructions.
pub(crate) struct Costs<'a> {
    graph: &'a Graph,
    core: Core,
    measure: Measure,
    known: &'a BTreeMap<u32, Bounds>,
}

impl<'a> Costs<'a> {
    pub(crate) fn new(
        graph: &'a Graph,
        core: Core,
        measure: Measure,
        known: &'a BTreeMap<u32, Bounds>,
    ) -> Self {
        Self {
            graph,
            core,
            measure,
            known,
        }
    }

    /// The longest of the functions that a node calls.
    fn called(&self, node: usize) -> u64 {
        let measure = Measure::ALL
            .iter()
            .position(|it| *it == self.measure)
            .unwrap_or(0);
        let bounds = self.graph.nodes[node]
            .calls
            .iter()
            .filter_map(|call| self.known.get(call));
        bounds
            .map(|bounds| bounds.longest[measure])
            .max()
            .unwrap_or(0)
    }
}

impl Cost for Costs<'_> {
    fn node(&self, node: usize) -> u64 {
        let it = &self.graph.nodes[node];
        // The last call of a function is counted where it leaves.
        let called = if it.leaves { 0 } else { self.called(node) };
        self.measure.node(self.core, it) + called
    }

    fn edge(&self, edge: Edge) -> u64 {
        self.measure.edge(self.core, edge)
    }
}

impl<'a> Program<'a> {
    /// The functions of an image, with what people stated of them.
    pub fn new(image: &'a Image, stated: &'a Stated) -> Self {
        Self {
            image,
            stated,
            known: BTreeMap::new(),
            open: Vec::new(),
        }
    }

    pub(crate) fn image(&self) -> &'a Image {
        self.image
    }

    pub(crate) fn stated(&self) -> &'a Stated {
        self.stated
    }

    pub(crate) fn known(&self) -> &BTreeMap<u32, Bounds> {
        &self.known
    }

    /// The bounds of the function at `address`.
    pub fn bounds(&mut self, address: u32) -> &Bounds {
        if !self.known.contains_key(&address) {
            let mut bounds = self.examine(address);
            // A call of itself was met while the function was examined.
            if let Some(met) = self.known.remove(&address) {
                bounds.defects.extend(met.defects);
            }
            self.known.insert(address, bounds);
        }
        &self.known[&address]
    }

    /// A function's longest path: the instructions' addresses, and what each costs with the
    /// functions that it calls. A loop is gone through once.
    pub fn longest_path(&mut self, address: u32, measure: Measure) -> Vec<(u32, u64)> {
        self.bounds(address);
        let Some(function) = self.image.function(address).cloned() else {
            return Vec::new();
        };
        let (graph, _) = self.graph(&function);
        let costs = Costs::new(&graph, self.image.core, measure, &self.known);
        let once = |_| Some(Bound::EachEntry(1));
        let paths = Longest::new(&graph, &costs, &once).paths();
        let with_last = |node: usize| {
            let left = if graph.nodes[node].leaves {
                costs.called(node)
            } else {
                0
            };
            paths[node].map(|path| path + left)
        };
        let mut path = Vec::new();
        let mut end = (0..graph.nodes.len()).max_by_key(|node| with_last(*node));
        let mut last = end.and_then(with_last).unwrap_or(0);
        while let Some(node) = end {
            let before = |from: &usize| {
                let edge = graph.nodes[*from]
                    .next
                    .iter()
                    .find(|edge| edge.to == node)?;
                let sum = paths[*from]? + costs.edge(*edge) + costs.node(node);
                (Some(sum) == paths[node]).then_some(*from)
            };
            end = (0..graph.nodes.len()).find_map(|from| before(&from));
            let so_far = end.and_then(|from| paths[from]).unwrap_or(0);
            path.push((graph.nodes[node].address, last - so_far));
            last = so_far;
        }
        path.reverse();
        path
    }

    /// The chain of calls that takes the most stack: each function's name and its share [bytes].
    pub fn deepest(&mut self, address: u32) -> Vec<(String, u32)> {
        let mut chain = Vec::new();
        let mut next = Some(address);
        while let Some(function) = next.and_then(|it| self.image.function(it).cloned()) {
            let all = self.bounds(function.address).stack;
            let (graph, _) = self.graph(&function);
            let depths = depths(&graph).at;
            let calls = graph
                .nodes
                .iter()
                .zip(depths)
                .flat_map(|(node, depth)| node.calls.iter().map(move |call| (*call, depth)));
            let deepest = |(call, depth): (u32, u32)| {
                let below = self.known.get(&call)?.stack;
                (below > 0 && depth + below == all).then_some((call, depth))
            };
            let call = calls.into_iter().find_map(deepest);
            chain.push((function.name, call.map_or(all, |(_, depth)| depth)));
            next = call.map(|(call, _)| call);
        }
        chain
    }

    /// All functions that the one at `address` reaches, with itself.
    pub fn reached(&mut self, address: u32) -> BTreeSet<u32> {
        let mut reached = BTreeSet::new();
        let mut open = vec![address];
        while let Some(address) = open.pop() {
            if reached.insert(address) {
                open.extend(self.bounds(address).calls.iter().copied());
            }
        }
        reached
    }

    /// What in the function and in those that it reaches cannot be bounded.
    pub fn defects(&mut self, address: u32) -> Vec<Defect> {
        let reached = self.reached(address);
        let defects = reached
            .iter()
            .flat_map(|address| self.bounds(*address).defects.clone());
        let mut defects: Vec<Defect> = defects.collect();
        defects.sort();
        defects.dedup();
        defects
    }

    fn examine(&mut self, address: u32) -> Bounds {
        let Some(function) = self.image.function(address).cloned() else {
            // The call was noted where it is.
            return Bounds {
                returns: true,
                ..Bounds::default()
            };
        };
        let defect = |(address, fault)| Defect {
            function: function.name.clone(),
            address,
            fault,
        };
        if self.open.contains(&address) {
            let defects = vec![defect((address, Fault::Recursion))];
            return Bounds {
                returns: true,
                defects,
                ..Bounds::default()
            };
        }
        self.open.push(address);
        let (graph, mut defects) = self.graph(&function);
        self.open.pop();
        let depths = depths(&graph);
        defects.extend(depths.faults.iter().copied().map(defect));
        // Only the start and a handler that ends the program may leave the stack that was in use.
        if function.name != "Reset" && !self.stated.ends(&function.name) {
            let restarts = graph
                .nodes
                .iter()
                .filter(|node| node.instruction.stack == Stack::Restart);
            defects.extend(restarts.map(|node| defect((node.address, Fault::UnknownStack))));
        }

        let mut bounds = Bounds {
            returns: graph.returns(&|call| self.known.get(&call).is_none_or(|it| it.returns)),
            calls: graph
                .nodes
                .iter()
                .flat_map(|node| node.calls.iter().copied())
                .collect(),
            ..Bounds::default()
        };
        for (node, depth) in graph.nodes.iter().zip(&depths.at) {
            let called = || node.calls.iter().filter_map(|call| self.known.get(call));
            let deepest = called().map(|bounds| bounds.stack).max().unwrap_or(0);
            bounds.float |= node.instruction.float || called().any(|it| it.float);
            bounds.stack = bounds.stack.max(depth + deepest);
        }
        let headers = self.headers(&graph);
        let number = |address: u32| headers.iter().position(|it| *it == address).unwrap_or(0) + 1;
        let bound = |address| self.stated.bound(&function.name, number(address));
        for (index, measure) in Measure::ALL.into_iter().enumerate() {
            let costs = Costs::new(&graph, self.image.core, measure, &self.known);
            let mut search = Longest::new(&graph, &costs, &bound);
            let paths = search.paths();
            for error in search.errors {
                defects.push(defect(match error {
                    LoopError::Unbounded(address) => (address, Fault::Loop),
                    LoopError::SeveralEntries(address) => (address, Fault::LoopEntries),
                }));
            }
            let ends = paths.iter().enumerate().filter_map(|(node, path)| {
                let left = if graph.nodes[node].leaves {
                    costs.called(node)
                } else {
                    0
                };
                path.map(|path| path + left)
            });
            bounds.longest[index] = ends.max().unwrap_or(0);
        }
        // What ends the program takes the time that is left, and none from what calls it.
        if self.stated.ends(&function.name) {
            defects.retain(|defect| defect.fault.concerns_stack());
            bounds.longest = [0; MEASURES];
        }
        defects.sort();
        defects.dedup();
        bounds.defects = defects;
        bounds
    }

    /// The graph of a function, once all that it calls are known: whether these return decides
    /// what follows a call.
    pub(crate) fn graph(&mut self, function: &crate::image::Function) -> (Graph, Vec<Defect>) {
        loop {
            let known = &self.known;
            let callees = Callees {
                returns: &|call| known.get(&call).is_none_or(|bounds| bounds.returns),
                targets: &|name| self.stated.targets(self.image, name),
            };
            let (graph, defects) = Graph::new(self.image, function, &callees);
            let calls = graph
                .nodes
                .iter()
                .flat_map(|node| node.calls.iter().copied());
            let unknown: BTreeSet<u32> = calls
                .filter(|call| !self.known.contains_key(call))
                .collect();
            if unknown.is_empty() {
                return (graph, defects);
            }
            for call in unknown {
                self.bounds(call);
            }
        }
    }

    /// The addresses at which the loops of the function at `address` are entered.
    pub fn loop_headers(&mut self, address: u32) -> Vec<u32> {
        let Some(function) = self.image.function(address).cloned() else {
            return Vec::new();
        };
        let (graph, _) = self.graph(&function);
        self.headers(&graph)
    }

    /// The addresses of the loops' headers in a function.
    pub(crate) fn headers(&self, graph: &Graph) -> Vec<u32> {
        struct Nothing;
        impl Cost for Nothing {
            fn node(&self, _: usize) -> u64 {
                0
            }
            fn edge(&self, _: Edge) -> u64 {
                0
            }
        }
        let mut search = Longest::new(graph, &Nothing, &|_| None);
        search.paths();
        let mut headers: Vec<u32> = search
            .errors
            .into_iter()
            .filter_map(|error| match error {
                LoopError::Unbounded(address) => Some(address),
                LoopError::SeveralEntries(_) => None,
            })
            .collect();
        headers.sort_unstable();
        headers.dedup();
        headers
    }
}
