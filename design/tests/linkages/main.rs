//! Dyads, linkages of them, and the slider-driven mechanism.

mod chains;
mod dyad_refusals;
mod dyads;
mod slider;
