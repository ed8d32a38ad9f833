//! Tests in one process of several crates: robot files, models, analyses, and documents compared
//! with the code.

mod accuracy;
mod accuracy_linkages;
#[path = "../bench/mod.rs"]
mod bench;
mod board_defaults;
mod doors_document;
mod faults_document;
mod faults_in_process;
mod homing_anywhere;
#[path = "../injected_faults/mod.rs"]
mod injected_faults;
mod mobility_cases;
mod plant_and_models;
mod readme_accuracy;
mod reference_vectors;
mod reserve_document;
mod safety_document;
mod seen_faults;
mod servo_loop;
mod tables_document;
mod tool_offsets;
mod tool_strokes;
