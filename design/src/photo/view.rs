//! What a camera makes of the paper: perspective, and a lens that bends straight lines.
//!
//! With w = (pixel − middle)/R, R half the diagonal of the picture, a point q of the paper is seen at
//! ```text
//! w = u (1 + k |u|²),   u = (h₁·q̃, h₂·q̃)/(h₃·q̃),   q̃ = (q, 1)
//! ```
//! h₁…h₃ are the rows of the homography, eight unknowns, and k is the radial distortion of the lens, whose
//! axis is taken to pass through the middle of the picture. Four points with their pixels give the
//! homography for a given k: eight linear equations.

use nalgebra::{Matrix3, SMatrix, SVector, Vector2, Vector3};

/// The distortions k that are taken for a lens. Below −4/27 the picture's corners would show nothing.
pub(super) const LENS: [f64; 2] = [-0.12, 0.2];

/// A view of the paper.
#[derive(Clone, Debug)]
pub(super) struct View {
    /// The middle of the picture, and half its diagonal [pixels].
    middle: Vector2<f64>,
    radius: f64,
    /// From the paper [m] to u, and back.
    to_picture: Matrix3<f64>,
    to_paper: Matrix3<f64>,
    /// The distortion k.
    lens: f64,
}

impl View {
    /// The view in which these four points of the paper [m] have these pixels. None if three of them lie
    /// on a line.
    pub(super) fn through(
        size: [usize; 2],
        pairs: &[(Vector2<f64>, Vector2<f64>); 4],
        lens: f64,
    ) -> Option<Self> {
        let corner = Vector2::from(size.map(|size| size as f64));
        let (middle, radius) = (0.5 * corner, 0.5 * corner.norm());
        // Points in units of their spread about their mean, so that the equations are well scaled and
        // the mean, which is seen, has the divisor 1.
        let mean = 0.25 * pairs.iter().map(|(q, _)| q).sum::<Vector2<f64>>();
        let spread = pairs.iter().map(|(q, _)| (q - mean).norm());
        let spread = spread.fold(f64::MIN_POSITIVE, f64::max);
        let mut matrix = SMatrix::<f64, 8, 8>::zeros();
        let mut wanted = SVector::<f64, 8>::zeros();
        for (index, (place, pixel)) in pairs.iter().enumerate() {
            let q = (place - mean) / spread;
            let u = without_lens((pixel - middle) / radius, lens)?;
            let rows = [
                [q.x, q.y, 1.0, 0.0, 0.0, 0.0, -u.x * q.x, -u.x * q.y],
                [0.0, 0.0, 0.0, q.x, q.y, 1.0, -u.y * q.x, -u.y * q.y],
            ];
            for (row, values) in rows.iter().enumerate() {
                matrix.set_row(2 * index + row, &SMatrix::from_row_slice(values));
                wanted[2 * index + row] = u[row];
            }
        }
        let h = matrix.lu().solve(&wanted)?;
        let scaled = Matrix3::new(h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], 1.0);
        let to_unit = Matrix3::new(1.0, 0.0, -mean.x, 0.0, 1.0, -mean.y, 0.0, 0.0, spread);
        let to_picture = scaled * to_unit / spread;
        Some(Self {
            middle,
            radius,
            to_picture,
            to_paper: to_picture.try_inverse()?,
            lens,
        })
    }

    /// The pixel of a point of the paper [m]; none behind the camera.
    pub(super) fn pixel(&self, place: Vector2<f64>) -> Option<Vector2<f64>> {
        let u = mapped(&self.to_picture, place)?;
        Some(self.middle + self.radius * u * (1.0 + self.lens * u.norm_squared()))
    }

    /// The pixel at which a lens without distortion would show a point of the paper [m].
    pub(super) fn straight_pixel(&self, place: Vector2<f64>) -> Option<Vector2<f64>> {
        Some(self.middle + self.radius * mapped(&self.to_picture, place)?)
    }

    /// The point of the paper at a pixel [m].
    pub(super) fn place(&self, pixel: Vector2<f64>) -> Option<Vector2<f64>> {
        let u = without_lens((pixel - self.middle) / self.radius, self.lens)?;
        mapped(&self.to_paper, u)
    }

    /// The length on the paper that a pixel shows at a point, in the direction in which it is longest [m].
    pub(super) fn pixel_size(&self, place: Vector2<f64>) -> Option<f64> {
        let here = self.pixel(place)?;
        let step = |pixel: Vector2<f64>| Some((self.place(pixel)? - place).norm());
        Some(step(here + Vector2::x())?.max(step(here + Vector2::y())?))
    }
}

/// A point through a homography; none where its divisor is not above 0.
fn mapped(matrix: &Matrix3<f64>, point: Vector2<f64>) -> Option<Vector2<f64>> {
    let mapped: Vector3<f64> = matrix * point.push(1.0);
    (mapped.z > 1e-9).then(|| mapped.xy() / mapped.z)
}

/// u of w = u (1 + k |u|²), by Newton's method on the length. None outside of what the lens shows.
fn without_lens(w: Vector2<f64>, lens: f64) -> Option<Vector2<f64>> {
    let wanted = w.norm();
    let mut length = wanted;
    for _ in 0..20 {
        let slope = 1.0 + 3.0 * lens * length * length;
        if slope <= 1e-3 {
            return None;
        }
        let step = (length * (1.0 + lens * length * length) - wanted) / slope;
        length -= step;
        if step.abs() < 1e-14 {
            break;
        }
    }
    Some(w / (1.0 + lens * length * length))
}

#[cfg(test)]
mod tests {
    use super::View;
    use nalgebra::Vector2;

    #[test]
    fn a_view_returns_its_points_and_its_inverse() {
        let places = [[0.0, 0.1], [0.2, 0.1], [0.21, 0.25], [0.01, 0.24]].map(Vector2::from);
        let pixels = [
            [150.0, 900.0],
            [1500.0, 1000.0],
            [1300.0, 120.0],
            [300.0, 200.0],
        ];
        let pixels = pixels.map(Vector2::from);
        for lens in [-0.1, 0.0, 0.15] {
            let pairs = [0, 1, 2, 3].map(|i| (places[i], pixels[i]));
            let view = View::through([1600, 1200], &pairs, lens).unwrap();
            for (place, pixel) in pairs {
                assert!((view.pixel(place).unwrap() - pixel).norm() < 1e-8);
            }
            let inside = Vector2::new(0.07, 0.16);
            let back = view.place(view.pixel(inside).unwrap()).unwrap();
            assert!((back - inside).norm() < 1e-12, "{back}");
        }
        let line = [[0.0, 0.0], [0.1, 0.1], [0.2, 0.2], [0.0, 0.1]].map(Vector2::from);
        let pairs = [0, 1, 2, 3].map(|i| (line[i], pixels[i]));
        let view = View::through([1600, 1200], &pairs, 0.0);
        assert!(view.is_none_or(|view| view.pixel(Vector2::new(0.05, 0.02)).is_none()));
    }
}
