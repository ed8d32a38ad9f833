//! The longest path through a function.
//!
//! A loop is a set of instructions that can all reach each other. It must have one entry, its
//! header, which is executed at most as often as the stated bound says. The longest path to an
//! instruction of a loop of bound n is the longest path to the header, n − 1 times the longest path
//! round, and the longest path from the header to the instruction. A bound in all is one of the
//! rounds that all entries into a loop take together: so many rounds are added to every path.

use crate::graph::{Edge, Graph};

/// How often a loop goes round.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bound {
    /// So often is its header executed at most, at each entry into the loop.
    EachEntry(u64),
    /// So many rounds does it make at most, over all entries while the function runs.
    InAll(u64),
}

/// What one instruction and one edge between two cost.
pub trait Cost {
    /// Of the instruction of this node, with the functions that it calls.
    fn node(&self, node: usize) -> u64;
    /// Of this edge from one instruction to the next.
    fn edge(&self, edge: Edge) -> u64;
}

/// A loop of which no bound is stated, or one without a single entry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoopError {
    /// Its header is at this address.
    Unbounded(u32),
    /// It can be entered at several instructions, this one among them.
    SeveralEntries(u32),
}

/// The search of the longest paths of a function.
pub struct Longest<'a, C> {
    graph: &'a Graph,
    cost: &'a C,
    /// The bound of the loop whose header is at an address.
    bound: &'a dyn Fn(u32) -> Option<Bound>,
    /// The cost of all rounds that are bounded in all.
    in_all: u64,
    /// What was found about loops.
    pub errors: Vec<LoopError>,
}

impl<'a, C: Cost> Longest<'a, C> {
    /// A search; `bound` gives the bound of the loop whose header is at an address.
    pub fn new(graph: &'a Graph, cost: &'a C, bound: &'a dyn Fn(u32) -> Option<Bound>) -> Self {
        Self {
            graph,
            cost,
            bound,
            in_all: 0,
            errors: Vec::new(),
        }
    }

    /// The cost of the longest path from the function's entry to the end of each instruction.
    pub fn paths(&mut self) -> Vec<Option<u64>> {
        let mut longest = vec![None; self.graph.nodes.len()];
        let all: Vec<usize> = (0..longest.len()).collect();
        self.region(&all, 0, None, &mut longest);
        for path in longest.iter_mut().flatten() {
            *path += self.in_all;
        }
        longest
    }

    /// Fills in the longest paths from `entry` within a set of nodes. In a loop, the edges back to
    /// its `header` are left out.
    fn region(
        &mut self,
        nodes: &[usize],
        entry: usize,
        header: Option<usize>,
        longest: &mut [Option<u64>],
    ) {
        let mut inside = vec![false; self.graph.nodes.len()];
        for &node in nodes {
            inside[node] = true;
        }
        let graph = self.graph;
        let edges = |from: usize| {
            let edges = graph.nodes[from].next.iter().copied();
            edges.filter(|edge| inside[edge.to] && Some(edge.to) != header)
        };
        // What is the longest path to the beginning of each node so far.
        let mut arrival: Vec<Option<u64>> = vec![None; self.graph.nodes.len()];
        arrival[entry] = Some(0);
        for component in components(nodes, &|from| edges(from).map(|edge| edge.to).collect()) {
            let entries: Vec<usize> = component
                .iter()
                .copied()
                .filter(|node| arrival[*node].is_some())
                .collect();
            let Some(&header) = entries.first() else {
                continue;
            };
            let start = arrival[header].unwrap_or(0);
            let is_loop = component.len() > 1 || edges(header).any(|edge| edge.to == header);
            if !is_loop {
                longest[header] = Some(start + self.cost.node(header));
            } else if entries.len() > 1 {
                let address = self.graph.nodes[header].address;
                self.errors.push(LoopError::SeveralEntries(address));
                continue;
            } else {
                self.rounds(&component, header, start, longest);
            }
            for &node in &component {
                let Some(end) = longest[node] else { continue };
                for edge in edges(node).filter(|edge| !component.contains(&edge.to)) {
                    let path = Some(end + self.cost.edge(edge));
                    arrival[edge.to] = arrival[edge.to].max(path);
                }
            }
        }
    }

    /// A loop that is entered at `header` after a path of the cost `start`.
    fn rounds(&mut self, nodes: &[usize], header: usize, start: u64, longest: &mut [Option<u64>]) {
        let address = self.graph.nodes[header].address;
        let bound = (self.bound)(address).unwrap_or_else(|| {
            self.errors.push(LoopError::Unbounded(address));
            Bound::EachEntry(1)
        });
        self.region(nodes, header, Some(header), longest);
        let back = |node: usize| {
            let edges = self.graph.nodes[node]
                .next
                .iter()
                .filter(|edge| edge.to == header);
            let end = longest[node]?;
            edges.map(|edge| end + self.cost.edge(*edge)).max()
        };
        let round = nodes
            .iter()
            .filter_map(|node| back(*node))
            .max()
            .unwrap_or(0);
        let rounds = match bound {
            Bound::EachEntry(times) => times.saturating_sub(1),
            Bound::InAll(times) => {
                self.in_all += times * round;
                0
            }
        };
        let before = start + rounds * round;
        for &node in nodes {
            longest[node] = longest[node].map(|path| before + path);
        }
    }
}

/// Sets of nodes that can all reach each other, each set before those that it reaches: Tarjan's
/// algorithm, with a stack of its own in place of recursion.
fn components(nodes: &[usize], next: &dyn Fn(usize) -> Vec<usize>) -> Vec<Vec<usize>> {
    let size = nodes.iter().max().map_or(0, |most| most + 1);
    let mut number: Vec<Option<usize>> = vec![None; size];
    let mut low = vec![0; size];
    let mut on_stack = vec![false; size];
    let (mut stack, mut found, mut count) = (Vec::new(), Vec::new(), 0);
    for &root in nodes {
        if number[root].is_some() {
            continue;
        }
        let mut calls: Vec<(usize, Vec<usize>)> = Vec::new();
        let mut enter = Some(root);
        loop {
            if let Some(node) = enter.take() {
                (number[node], low[node], on_stack[node]) = (Some(count), count, true);
                count += 1;
                stack.push(node);
                calls.push((node, next(node)));
            }
            let Some((node, open)) = calls.last_mut() else {
                break;
            };
            let node = *node;
            match open.pop() {
                Some(to) => match number[to] {
                    None => enter = Some(to),
                    Some(other) if on_stack[to] => low[node] = low[node].min(other),
                    Some(_) => {}
                },
                None => {
                    calls.pop();
                    if let Some((caller, _)) = calls.last() {
                        low[*caller] = low[*caller].min(low[node]);
                    }
                    if number[node] == Some(low[node]) {
                        let start = stack.iter().rposition(|other| *other == node).unwrap_or(0);
                        let component: Vec<usize> = stack.drain(start..).collect();
                        component.iter().for_each(|node| on_stack[*node] = false);
                        found.push(component);
                    }
                }
            }
        }
    }
    found.reverse();
    found
}
