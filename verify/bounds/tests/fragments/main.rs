//! Small pieces of machine code whose paths, stacks and critical sections are counted by hand.

mod code;
mod paths;
mod sections;
mod stacks;
