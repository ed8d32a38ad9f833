//! Linear spaces of screws: spans, ranks and reciprocals.

use super::Screw;
use nalgebra::{DMatrix, DVector, Vector6};

/// A pivot counts as zero below this share of the largest, the screws being
/// written about the mechanism's centre, in units of its size, each of unit norm.
pub const RANK_TOLERANCE: f64 = 1e-8;

/// A linear space of screws, kept as an orthonormal basis.
#[derive(Clone, Debug)]
pub struct ScrewSystem {
    basis: DMatrix<f64>,
}

impl ScrewSystem {
    /// The space that the given screws span.
    pub fn span(screws: impl IntoIterator<Item = Screw>) -> Self {
        let columns: Vec<Vector6<f64>> = screws
            .into_iter()
            .map(Screw::to_vector)
            .filter(|column| column.norm() > 0.0)
            .map(|column| column.normalize())
            .collect();
        Self::of_columns(&columns)
    }

    /// The space of the twists that unit motions give a body. A motion that moves the body
    /// only by rounding errors counts as zero.
    pub(super) fn span_of_motions(twists: impl IntoIterator<Item = Screw>) -> Self {
        let moving = |twist: &Screw| twist.to_vector().norm() > RANK_TOLERANCE;
        let columns: Vec<Vector6<f64>> = twists
            .into_iter()
            .filter(moving)
            .map(Screw::to_vector)
            .collect();
        Self::of_columns(&columns)
    }

    fn of_columns(columns: &[Vector6<f64>]) -> Self {
        let basis = if columns.is_empty() {
            DMatrix::zeros(6, 0)
        } else {
            column_space(&DMatrix::from_fn(6, columns.len(), |row, column| {
                columns[column][row]
            }))
        };
        Self { basis }
    }

    /// The number of independent screws.
    pub fn rank(&self) -> usize {
        self.basis.ncols()
    }

    /// The orthonormal basis, one screw a column.
    pub(super) fn basis(&self) -> &DMatrix<f64> {
        &self.basis
    }

    /// The basis as screws.
    pub fn screws(&self) -> impl Iterator<Item = Screw> + '_ {
        self.basis
            .column_iter()
            .map(|column| Screw::from_vector(&Vector6::from_iterator(column.iter().copied())))
    }

    /// All screws reciprocal to every one of these: the wrenches of a limb from its
    /// twists, the freedoms of a platform from its wrenches.
    #[must_use]
    pub fn reciprocal(&self) -> Self {
        // s1·m2 + m1·s2 = 0 is orthogonality to the screw with its halves exchanged.
        let exchanged = DMatrix::from_fn(self.rank(), 6, |row, column| {
            self.basis[((column + 3) % 6, row)]
        });
        Self {
            basis: null_space(&exchanged),
        }
    }

    /// The sum of these spaces.
    pub fn sum<'a>(systems: impl IntoIterator<Item = &'a Self>) -> Self {
        Self::span(systems.into_iter().flat_map(Self::screws))
    }

    /// The largest power of any unit screw of `other` on any of these: zero for
    /// reciprocal systems.
    pub fn power(&self, other: &Self) -> f64 {
        self.screws()
            .flat_map(|a| other.screws().map(move |b| a.reciprocal_product(&b).abs()))
            .fold(0.0, f64::max)
    }
}

/// An orthonormal basis of the whole space, the matrix's column space first, and the rank.
///
/// By QR with pivoting is used, because nalgebra's singular vectors lose half their digits
/// where singular values vanish, as they do here.
fn basis_of_columns(matrix: &DMatrix<f64>) -> (DMatrix<f64>, usize) {
    let rows = matrix.nrows();
    // Columns of zeros make the thin decomposition give the complement too.
    let mut wide = DMatrix::zeros(rows, matrix.ncols().max(rows));
    wide.columns_mut(0, matrix.ncols()).copy_from(matrix);
    let decomposition = wide.col_piv_qr();
    let r = decomposition.r();
    // Pivoting puts the largest first.
    let threshold = r[(0, 0)].abs() * RANK_TOLERANCE;
    let rank = (0..rows).filter(|&i| r[(i, i)].abs() > threshold).count();
    (decomposition.q(), rank)
}

/// The rank of `matrix` by [`RANK_TOLERANCE`].
pub(super) fn rank(matrix: &DMatrix<f64>) -> usize {
    if matrix.is_empty() {
        0
    } else {
        basis_of_columns(matrix).1
    }
}

/// Orthonormal bases of the vectors that `matrix` acts on and of those it takes to zero.
pub(super) fn row_and_null_space(matrix: &DMatrix<f64>) -> (DMatrix<f64>, DMatrix<f64>) {
    let columns = matrix.ncols();
    if matrix.is_empty() {
        let all = DMatrix::identity(columns, columns);
        return (DMatrix::zeros(columns, 0), all);
    }
    let (basis, rank) = basis_of_columns(&matrix.transpose());
    let row_space = basis.columns(0, rank).into_owned();
    (row_space, basis.columns(rank, columns - rank).into_owned())
}

/// An orthonormal basis of the vectors that `matrix` takes to zero.
pub(super) fn null_space(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    row_and_null_space(matrix).1
}

fn column_space(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let (basis, rank) = basis_of_columns(matrix);
    basis.columns(0, rank).into_owned()
}

/// The shortest x for which `matrix` x is nearest to `wanted`; none where the matrix is 0.
pub(super) fn least_norm(matrix: &DMatrix<f64>, wanted: &DVector<f64>) -> Option<DVector<f64>> {
    let (row_space, _) = row_and_null_space(matrix);
    if row_space.ncols() == 0 {
        return None;
    }
    let qr = (matrix * &row_space).qr();
    let within = qr
        .r()
        .solve_upper_triangular(&(qr.q().transpose() * wanted))?;
    Some(row_space * within)
}
