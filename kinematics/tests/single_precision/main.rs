//! `f32` against `f64` from the same angles and points: what is accepted, and how far the
//! answers are apart.
//!
//! ε = 2⁻²⁴ is half the distance of neighbouring numbers at 1.

mod actuated;
mod arms;
mod foot;
mod forward;
mod refusals;
mod tool_beside_c;
