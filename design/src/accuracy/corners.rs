//! The worst case of two errors within bounds: the error is greatest where both are.

/// All signs that two errors can have.
pub(super) const CORNERS: [(f64, f64); 4] = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)];
