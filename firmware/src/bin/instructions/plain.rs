//! The same solutions in their simplest form: circle intersections with `libm`.

use crate::ours::Case;
use nalgebra::Vector2;

/// The position of C from the driven angles; none where links 2 and 3 cannot meet.
#[inline(never)]
pub(crate) fn forward(case: &Case) -> Option<Vector2<f32>> {
    let [l1, l2, l3, l4, base] = case.lengths;
    let [theta1, theta4] = case.driven;
    let (sin1, cos1) = (libm::sinf(theta1), libm::cosf(theta1));
    let (sin4, cos4) = (libm::sinf(theta4), libm::cosf(theta4));
    let b = Vector2::new(l1 * cos1, l1 * sin1);
    let d = Vector2::new(base + l4 * cos4, l4 * sin4);
    let bd = d - b;
    let distance = libm::sqrtf(bd.x * bd.x + bd.y * bd.y);
    let along = (l2 * l2 - l3 * l3 + distance * distance) / (2.0 * distance);
    let height_squared = l2 * l2 - along * along;
    if height_squared < 0.0 {
        return None;
    }
    let height = libm::sqrtf(height_squared);
    Some(Vector2::new(
        b.x + (along * bd.x - height * bd.y) / distance,
        b.y + (along * bd.y + height * bd.x) / distance,
    ))
}

/// The driven angles from the position of C; none where a leg cannot reach it.
#[inline(never)]
pub(crate) fn inverse(case: &Case) -> Option<[f32; 2]> {
    let [l1, l2, l3, l4, base] = case.lengths;
    let theta1 = leg(case.c, l1, l2, 1.0)?;
    let theta4 = leg(case.c - Vector2::new(base, 0.0), l4, l3, -1.0)?;
    Some([theta1, theta4])
}

/// The driven angle of a leg that ends at `r` from its pivot, by the law of cosines.
fn leg(r: Vector2<f32>, driven: f32, distal: f32, elbow: f32) -> Option<f32> {
    let distance_squared = r.x * r.x + r.y * r.y;
    let cosine = (distance_squared + driven * driven - distal * distal)
        / (2.0 * driven * libm::sqrtf(distance_squared));
    if libm::fabsf(cosine) > 1.0 {
        return None;
    }
    Some(libm::atan2f(r.y, r.x) + elbow * libm::acosf(cosine))
}
