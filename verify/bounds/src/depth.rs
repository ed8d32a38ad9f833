//! The depth of the stack in a function: how far below its place at the entry the stack pointer
//! is at each instruction.
//!
//! Each instruction must have one depth, whichever path leads to it. So the stack neither grows in
//! a loop nor by an amount that is computed.

use crate::Fault;
use crate::graph::Graph;
use crate::instruction::Stack;

/// Depths of a function's stack.
#[derive(Clone, Debug, Default)]
pub struct Depths {
    /// The deepest at each node [bytes]: before the instruction or after it. This is the depth at
    /// a call, too.
    pub at: Vec<u32>,
    /// What cannot be followed, by address.
    pub faults: Vec<(u32, Fault)>,
}

/// The depths of the stack in a function.
pub fn depths(graph: &Graph) -> Depths {
    let mut before: Vec<Option<u32>> = vec![None; graph.nodes.len()];
    let mut depths = Depths {
        at: vec![0; graph.nodes.len()],
        faults: Vec::new(),
    };
    let mut open = Vec::new();
    if let Some(first) = before.first_mut() {
        *first = Some(0);
        open.push(0);
    }
    while let Some(index) = open.pop() {
        let node = &graph.nodes[index];
        let Some(depth) = before[index] else { continue };
        let after = match after(depth, node.instruction.stack) {
            Ok(after) => after,
            Err(fault) => {
                depths.faults.push((node.address, fault));
                continue;
            }
        };
        depths.at[index] = depth.max(after);
        if node.leaves && after != 0 {
            depths
                .faults
                .push((node.address, Fault::StackAtReturn(after)));
        }
        for edge in &node.next {
            match before[edge.to] {
                Some(other) if other != after => {
                    let fault = Fault::StackDiffers(other, after);
                    depths.faults.push((graph.nodes[edge.to].address, fault));
                }
                Some(_) => {}
                None => {
                    before[edge.to] = Some(after);
                    open.push(edge.to);
                }
            }
        }
    }
    depths
}

fn after(depth: u32, stack: Stack) -> Result<u32, Fault> {
    match stack {
        Stack::Keep => Ok(depth),
        Stack::Push(bytes) => Ok(depth + bytes),
        Stack::Pop(bytes) => depth.checked_sub(bytes).ok_or(Fault::StackAboveEntry),
        Stack::Restart => Ok(0),
        Stack::Unknown => Err(Fault::UnknownStack),
    }
}
