//! The slider-driven mechanism, related to the five-bar: two sliders on one guide carry a
//! platform with two degrees of freedom (Tu 2005; its figure is lost and is reconstructed
//! here).
//!
//! ```text
//!            P
//!        ●───┼───●        platform 5, width l5, P at its middle; it only translates
//!       ╱         ╲
//!   l3 ╱           ╲ l7   limbs, each a parallelogram: links 3, 4 and 6, 7
//!     ╱ α3       α7 ╲
//! ───■───────────────■─── guide, the x axis
//!    x2              x8   sliders 2 and 8, driven
//! ```
//!
//! xP = x2 + l3 cos α3 + l5/2 = x8 + l7 cos α7 − l5/2, yP = l3 sin α3 = l7 sin α7.
//!
//! The parallelograms keep the platform parallel to the guide. One of their constraints is
//! redundant, so a planar Grübler count gives one degree of freedom; there are two.
//! With l5 = 0 and single bars this is PRRRP.

mod error;
mod geometry;
mod motion;
mod position;
mod transfer;
mod workspace;

pub use error::{GeometryError, Limb, PoseError};
pub use geometry::Geometry;
pub use motion::{Accelerations, Velocities};
pub use position::{Pose, WorkingMode};
pub use transfer::ErrorTransfer;
pub use workspace::Travel;
