//! Files that are read: robots, linkages, jobs.

mod design_specs;
mod document;
mod drive_faults;
mod drive_keys;
mod dxf_drawings;
mod factors;
mod formats;
mod gcode_codes;
mod gcode_corpus;
mod gcode_crossings;
mod gcode_from_hosts;
mod gcode_jobs;
mod gcode_of_others;
mod homing_keys;
mod hpgl_plots;
mod linkage_files;
mod oversized;
mod parking;
mod placed;
mod refused_keys;
mod robot_faults;
mod robot_files;
mod robot_values;
mod rounded_arcs;
mod svg_jobs;
mod unknown_keys;
