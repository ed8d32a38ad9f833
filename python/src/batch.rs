//! Batches: all rows on all cores, without the interpreter's lock; Ctrl-C stops them.

use crate::status::{OK, Problem};
use numpy::{Element, IntoPyArray, PyArray1, PyReadonlyArrayDyn};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::num::NonZero;
use std::thread;

/// Rows between two checks for Ctrl-C: tens of milliseconds of work.
const BLOCK: usize = 1 << 18;
/// Least number of rows for a thread: a millisecond of work.
const WORTH_A_THREAD: usize = 1 << 13;

/// The result of [`solve`] for Python: the fields of the answer, each flat, and the statuses.
pub(crate) type Answer<'py> = (Vec<Bound<'py, PyArray1<f64>>>, Bound<'py, PyArray1<u8>>);

/// The rows of an argument, `W` numbers each.
///
/// # Errors
/// The array is not contiguous, or has no whole number of rows. The Python half ensures that
/// neither happens.
pub(crate) fn rows<'a, T: Element, const W: usize>(
    array: &'a PyReadonlyArrayDyn<'_, T>,
) -> PyResult<&'a [[T; W]]> {
    match array.as_slice()?.as_chunks() {
        (rows, []) => Ok(rows),
        _ => Err(PyValueError::new_err("no whole number of rows")),
    }
}

/// The number of rows that all arguments have.
///
/// # Errors
/// They differ.
pub(crate) fn common<const N: usize>(lengths: [usize; N]) -> PyResult<usize> {
    let [first, ..] = lengths[..] else {
        return Ok(0);
    };
    if lengths.iter().all(|&length| length == first) {
        Ok(first)
    } else {
        Err(PyValueError::new_err("arguments of unlike lengths"))
    }
}

/// Computes `rows` rows by `answer(row)`: `K` numbers, which are the fields of these `widths` one
/// after another, or a problem, for which every number is NaN.
///
/// # Errors
/// Ctrl-C.
pub(crate) fn solve<'py, const K: usize>(
    py: Python<'py>,
    rows: usize,
    widths: &[usize],
    answer: impl Fn(usize) -> Result<[f64; K], Problem> + Sync,
) -> PyResult<Answer<'py>> {
    debug_assert_eq!(widths.iter().sum::<usize>(), K);
    let mut fields: Vec<_> = widths.iter().map(|width| vec![0.0; width * rows]).collect();
    let mut statuses = vec![OK; rows];
    let mut rest = Rows {
        first: 0,
        fields: fields
            .iter_mut()
            .zip(widths)
            .map(|(numbers, &width)| Field { numbers, width })
            .collect(),
        statuses: &mut statuses,
    };
    while !rest.statuses.is_empty() {
        let (block, others) = rest.split_at(BLOCK);
        py.detach(|| block.fill_on_all_cores(&answer));
        py.check_signals()?;
        rest = others;
    }
    let fields = fields.into_iter().map(|field| field.into_pyarray(py));
    Ok((fields.collect(), statuses.into_pyarray(py)))
}

/// Some of the rows of an answer, to be filled.
struct Rows<'a> {
    first: usize,
    fields: Vec<Field<'a>>,
    statuses: &'a mut [u8],
}

/// One field of the answer over some rows.
struct Field<'a> {
    numbers: &'a mut [f64],
    width: usize,
}

impl Field<'_> {
    fn split_at(self, count: usize) -> (Self, Self) {
        let width = self.width;
        let (head, tail) = self.numbers.split_at_mut(count * width);
        let half = |numbers| Field { numbers, width };
        (half(head), half(tail))
    }
}

impl Rows<'_> {
    /// The first `count` rows, or all, and the others.
    fn split_at(self, count: usize) -> (Self, Self) {
        let count = count.min(self.statuses.len());
        let fields = self.fields.into_iter();
        let (heads, tails) = fields.map(|field| field.split_at(count)).unzip();
        let (head, tail) = self.statuses.split_at_mut(count);
        (
            Self {
                first: self.first,
                fields: heads,
                statuses: head,
            },
            Self {
                first: self.first + count,
                fields: tails,
                statuses: tail,
            },
        )
    }

    /// Threads live for the call only: a pool of them would not survive the fork by which
    /// Python's `multiprocessing` starts its workers, and the first batch there would hang.
    fn fill_on_all_cores<const K: usize>(
        self,
        answer: &(impl Fn(usize) -> Result<[f64; K], Problem> + Sync),
    ) {
        let rows = self.statuses.len();
        if rows <= WORTH_A_THREAD {
            return self.fill(answer);
        }
        let cores = thread::available_parallelism().map_or(1, NonZero::get);
        let share = rows.div_ceil(cores.min(rows.div_ceil(WORTH_A_THREAD)));
        thread::scope(|scope| {
            let mut rest = self;
            while rest.statuses.len() > share {
                let (piece, others) = rest.split_at(share);
                scope.spawn(move || piece.fill(answer));
                rest = others;
            }
            rest.fill(answer);
        });
    }

    fn fill<const K: usize>(mut self, answer: &impl Fn(usize) -> Result<[f64; K], Problem>) {
        for (index, status) in self.statuses.iter_mut().enumerate() {
            let (numbers, code) = match answer(self.first + index) {
                Ok(numbers) if numbers.iter().all(|number| number.is_finite()) => (numbers, OK),
                Ok(_) => ([f64::NAN; K], Problem::TooLarge.code()),
                Err(problem) => ([f64::NAN; K], problem.code()),
            };
            *status = code;
            let mut rest = &numbers[..];
            for Field { numbers, width } in &mut self.fields {
                let (own, others) = rest.split_at(*width);
                numbers[index * *width..][..*width].copy_from_slice(own);
                rest = others;
            }
        }
    }
}
