//! Maps, singularity curves and rectangles against areas, determinants and positions found by
//! other methods.

mod arms;
mod curves;
mod map;
mod reach;
