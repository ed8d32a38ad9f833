//! What every image of the STM32F405 must do, as one table: pins at power-up, power and brake, each way in which a program
//! ends, stops, faults of drivers and drives, a debugger. `conformance.csv` beside the tests says which image passes what.

#[path = "../bench/mod.rs"]
mod bench;

mod arm;
mod endings;
mod images;
mod order;
mod recorder;
mod stops;
mod table;
