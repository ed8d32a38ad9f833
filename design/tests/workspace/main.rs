//! Maps, singularity curves and rectangles against areas, determinants and places found
//! otherwise.

mod arms;
mod curves;
mod map;
