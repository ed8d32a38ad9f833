//! The control-flow graph of one function: a node for each instruction.
//!
//! An instruction of an if-then block has two nodes: one where its condition holds and it is
//! executed, one where it is skipped. All instructions of a block share the condition, so the
//! block's two paths are apart in the graph, until an instruction in it changes the flags. They
//! stay apart over several blocks that follow each other with the same condition or its opposite.

use std::collections::HashMap;

use crate::cores::M33_IN_SRAM;
use crate::image::{Function, Image, SRAM};
use crate::instruction::{Flow, Instruction};
use crate::{Defect, Fault, narrow, wide};

/// One instruction in the graph.
#[derive(Clone, Debug)]
pub struct Node {
    /// Address of the instruction.
    pub address: u32,
    /// The instruction.
    pub instruction: Instruction,
    /// Whether it is executed, and not skipped.
    pub executed: bool,
    /// Where the program goes next in this function.
    pub next: Vec<Edge>,
    /// The functions of which it calls one, or, where it leaves, as one of which the function
    /// goes on.
    pub calls: Vec<u32>,
    /// The function ends here.
    pub leaves: bool,
}

/// An edge from one instruction to another one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    /// Index of the node.
    pub to: usize,
    /// It is a branch that is taken; otherwise the instruction follows in memory.
    pub taken: bool,
}

/// Where in an if-then block an instruction is, or directly behind one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Slot {
    /// Instructions of the block from here on, with this one; 0 at a block behind a block.
    left: u8,
    /// Lowest bit: the sense of this one; see [`Flow::IfThen`].
    senses: u8,
    condition: u8,
    holds: bool,
}

/// The number of the condition that always holds.
const ALWAYS: u8 = 14;

type Place = (u32, Option<Slot>);

/// Whether a condition may hold and may not, behind an instruction in a slot.
fn outcomes(condition: u8, slot: Option<Slot>) -> Vec<bool> {
    match slot {
        _ if condition == ALWAYS => vec![true],
        Some(slot) if slot.condition == condition => vec![slot.holds],
        Some(slot) if slot.condition == condition ^ 1 => vec![!slot.holds],
        _ => vec![true, false],
    }
}

/// A function's instructions; the first node is its entry.
#[derive(Clone, Debug, Default)]
pub struct Graph {
    /// The instructions that can be reached.
    pub nodes: Vec<Node>,
}

/// What is known of the functions of an image before a graph is built.
pub struct Callees<'a> {
    /// Whether a function returns.
    pub returns: &'a dyn Fn(u32) -> bool,
    /// The functions that a call through a register can reach, by the caller's name.
    pub targets: &'a dyn Fn(&str) -> Option<Vec<u32>>,
}

struct Builder<'a> {
    image: &'a Image,
    function: &'a Function,
    callees: &'a Callees<'a>,
    index: HashMap<Place, usize>,
    nodes: Vec<Node>,
    open: Vec<Place>,
    defects: Vec<Defect>,
}

impl Graph {
    /// The graph of a function, and what in it cannot be followed.
    pub fn new(image: &Image, function: &Function, callees: &Callees<'_>) -> (Self, Vec<Defect>) {
        let mut builder = Builder {
            image,
            function,
            callees,
            index: HashMap::new(),
            nodes: Vec::new(),
            open: Vec::new(),
            defects: Vec::new(),
        };
        builder.node((function.address, None));
        while let Some(place) = builder.open.pop() {
            builder.follow(place);
        }
        (
            Self {
                nodes: builder.nodes,
            },
            builder.defects,
        )
    }

    /// Whether the function can return, directly or by the function that it ends with.
    pub fn returns(&self, returns: &dyn Fn(u32) -> bool) -> bool {
        let leaves = |node: &Node| {
            node.leaves && (node.calls.is_empty() || node.calls.iter().any(|call| returns(*call)))
        };
        self.nodes.iter().any(leaves)
    }
}

impl Builder<'_> {
    /// The node of a place; a new one is decoded, and its edges are followed later.
    fn node(&mut self, place: Place) -> usize {
        if let Some(index) = self.index.get(&place) {
            return *index;
        }
        let (address, slot) = place;
        let instruction = self.decode(address);
        let executed =
            slot.is_none_or(|slot| slot.left == 0 || (slot.senses & 1 == 1) == slot.holds);
        self.nodes.push(Node {
            address,
            instruction: if executed {
                instruction
            } else {
                Instruction::plain(instruction.length)
            },
            executed,
            next: Vec::new(),
            calls: Vec::new(),
            leaves: false,
        });
        self.index.insert(place, self.nodes.len() - 1);
        self.open.push(place);
        self.nodes.len() - 1
    }

    fn decode(&self, address: u32) -> Instruction {
        let is_data = self.image.end_of_data(address).is_some();
        let inside = (self.function.address..self.function.end).contains(&address);
        let unknown = Instruction::plain(2).flow(Flow::Unknown);
        let (true, false, Some(half)) = (inside, is_data, self.image.half(address)) else {
            return unknown;
        };
        if half >> 11 < 0b11101 {
            return narrow::decode(address, half);
        }
        self.image
            .half(address + 2)
            .map_or(unknown, |low| wide::decode(address, half, low))
    }

    fn defect(&mut self, address: u32, fault: Fault) {
        self.defects.push(Defect {
            function: self.function.name.clone(),
            address,
            fault,
        });
    }

    /// The places behind an instruction: in an if-then block, the next slot, with the condition as
    /// it was, and with the other one if the instruction may have changed it.
    fn after(&self, (address, slot): Place, instruction: &Instruction) -> Vec<Place> {
        let next = address + instruction.length;
        let calls = matches!(instruction.flow, Flow::Call(_) | Flow::CallRegister);
        let keeps_flags = !instruction.sets_flags && !calls;
        match slot {
            Some(slot) if slot.left > 1 => {
                let slot = Slot {
                    left: slot.left - 1,
                    senses: slot.senses >> 1,
                    ..slot
                };
                let other = Slot {
                    holds: !slot.holds,
                    ..slot
                };
                let both = [(next, Some(slot)), (next, Some(other))];
                both[..if keeps_flags { 1 } else { 2 }].to_vec()
            }
            Some(slot) if keeps_flags && self.is_block(next) => {
                let (left, senses) = (0, 0);
                vec![(
                    next,
                    Some(Slot {
                        left,
                        senses,
                        ..slot
                    }),
                )]
            }
            _ => vec![(next, None)],
        }
    }

    /// Whether an if-then block begins at an address.
    fn is_block(&self, address: u32) -> bool {
        matches!(self.decode(address).flow, Flow::IfThen { .. })
    }

    fn follow(&mut self, place: Place) {
        let (address, slot) = place;
        let index = self.node(place);
        let instruction = self.nodes[index].instruction;
        let mut next = self.after(place, &instruction);
        let mut jumps = Vec::new();
        match instruction.flow {
            Flow::Next => {}
            Flow::Sleep => self.defect(address, Fault::Sleep),
            Flow::Jump(target) => {
                next.clear();
                jumps.push(target);
            }
            Flow::Branch(target) => jumps.push(target),
            Flow::Call(target) => {
                self.call(index, target);
                if !(self.callees.returns)(target) {
                    next.clear();
                }
            }
            Flow::CallRegister => match (self.callees.targets)(&self.function.name) {
                None => self.defect(address, Fault::IndirectCall),
                Some(targets) => self.nodes[index].calls = targets,
            },
            Flow::Trap => next.clear(),
            Flow::Return => {
                next.clear();
                self.nodes[index].leaves = true;
            }
            Flow::Table { entry, base } => {
                next.clear();
                match self.tables(address + instruction.length, entry, base) {
                    Some(targets) => jumps.extend(targets),
                    None => self.defect(address, Fault::JumpTable),
                }
            }
            Flow::Jumps => {
                next.clear();
                // Constants may lie before the table.
                let behind = (address + instruction.length).next_multiple_of(4);
                match self.jumps(self.image.end_of_data(behind).unwrap_or(behind)) {
                    Some(targets) => jumps.extend(targets),
                    None => self.defect(address, Fault::ComputedJump),
                }
            }
            Flow::Computed => {
                next.clear();
                self.defect(address, Fault::ComputedJump);
            }
            Flow::IfThen {
                slots,
                senses,
                condition,
            } => {
                let first = address + instruction.length;
                let begins = |holds| Slot {
                    left: slots,
                    senses,
                    condition,
                    holds,
                };
                let slots = outcomes(condition, slot).into_iter().map(begins);
                next = slots.map(|slot| (first, Some(slot))).collect();
            }
            Flow::Unknown => {
                next.clear();
                self.defect(address, Fault::UnknownInstruction);
            }
        }
        let in_block = slot.is_some_and(|slot| slot.left > 0);
        if in_block && matches!(instruction.flow, Flow::IfThen { .. }) {
            self.defect(address, Fault::UnknownInstruction);
        }
        for place in next {
            let to = self.node(place);
            self.nodes[index].next.push(Edge { to, taken: false });
        }
        for target in jumps {
            self.jump(index, address, target);
        }
    }

    fn call(&mut self, index: usize, target: u32) {
        if self.image.function(target).is_none() {
            let address = self.nodes[index].address;
            self.defect(address, Fault::NoFunction(target));
        }
        if self.image.core == M33_IN_SRAM && target < SRAM {
            let address = self.nodes[index].address;
            self.defect(address, Fault::OutsideSram(target));
        }
        self.nodes[index].calls.push(target);
    }

    /// A jump within the function, or to the beginning of another one, which then returns to the
    /// caller.
    fn jump(&mut self, index: usize, address: u32, target: u32) {
        if (self.function.address..self.function.end).contains(&target) {
            let to = self.node((target, None));
            self.nodes[index].next.push(Edge { to, taken: true });
        } else if !self.nodes[index].calls.is_empty() {
            self.defect(address, Fault::ComputedJump);
        } else {
            self.call(index, target);
            self.nodes[index].leaves = true;
        }
    }

    /// The jumps that follow each other from `start` on, if the function has an instruction that
    /// computes the address `start`: compilers write such a table of jumps in place of one of
    /// short distances. The table is aligned to 4 bytes.
    fn jumps(&self, start: u32) -> Option<Vec<u32>> {
        self.addresses().find(|&(address, _)| address == start)?;
        let jumps = (start..self.function.end).step_by(4).map_while(|place| {
            let instruction = self.decode(place);
            let is_long = instruction.length == 4 && matches!(instruction.flow, Flow::Jump(_));
            is_long.then_some(place)
        });
        let jumps: Vec<u32> = jumps.collect();
        (!jumps.is_empty()).then_some(jumps)
    }

    /// The addresses that the function's instructions ADR compute, each with its register.
    fn addresses(&self) -> impl Iterator<Item = (u32, u32)> {
        let places = (self.function.address..self.function.end).step_by(2);
        places.filter_map(|place| {
            let halves = (self.image.half(place)?, self.image.half(place + 2)?);
            wide::address(place, halves.0, halves.1)
        })
    }

    /// The targets of a table branch before `next`: in the table behind it, or in all tables whose
    /// address some instruction of the function puts into the register `base`.
    fn tables(&self, next: u32, entry: u32, base: Option<u32>) -> Option<Vec<u32>> {
        let Some(base) = base else {
            return self.table(next, next, entry);
        };
        let starts = self.addresses().filter(|&(_, register)| register == base);
        let tables = starts.filter_map(|(start, _)| self.table(start, next, entry));
        let mut targets = tables.flatten().collect::<Vec<u32>>();
        targets.sort_unstable();
        targets.dedup();
        (!targets.is_empty()).then_some(targets)
    }

    /// The targets in the table at `start`; each entry is half the distance from `origin`. The
    /// table ends at the latest before the first entry whose target is no code of this function:
    /// constants or a byte of zero may follow it.
    fn table(&self, start: u32, origin: u32, entry: u32) -> Option<Vec<u32>> {
        let end = self.image.end_of_data(start)?.min(self.function.end);
        let target = |place: u32| {
            let distance = match entry {
                1 => u32::from(self.image.byte(place)?),
                _ => u32::from(self.image.half(place)?),
            };
            let target = origin + 2 * distance;
            // Behind a jump whose table is elsewhere, constants follow after a NOP at most.
            let is_padding =
                target == origin && start != origin && self.image.end_of_data(target + 2).is_some();
            if is_padding {
                return None;
            }
            let is_code = (self.function.address..self.function.end).contains(&target)
                && self.image.end_of_data(target).is_none();
            is_code.then_some(target)
        };
        let places = (start..end).step_by(entry as usize);
        let mut targets: Vec<u32> = places.map_while(target).collect();
        targets.sort_unstable();
        targets.dedup();
        (!targets.is_empty()).then_some(targets)
    }
}
