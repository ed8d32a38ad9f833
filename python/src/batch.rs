//! Batches: all rows on all cores, without the interpreter's lock; Ctrl-C stops them.

use crate::status::{OK, Problem};
use numpy::ndarray::{ArrayView, arr0};
use numpy::{
    Element, IntoPyArray, PyArray1, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn,
    PyUntypedArrayMethods, ToPyArray,
};
use pyo3::Borrowed;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyList, PyTuple};
use std::num::NonZero;
use std::thread;

/// Rows between two checks for Ctrl-C: tens of milliseconds of work.
const BLOCK: usize = 1 << 18;
/// Least number of rows for a thread: a millisecond of work.
const WORTH_A_THREAD: usize = 1 << 13;

/// The result of [`solve`] for Python: the fields of the answer and the statuses, flat, or of a single row with its own shape.
pub(crate) type Answer<'py> = (Vec<Bound<'py, PyAny>>, Bound<'py, PyAny>);

/// Pairs of numbers: many in an array with several axes, or one in a tuple, a list or an array with one axis.
pub(crate) enum Pairs<'py> {
    Many(PyReadonlyArrayDyn<'py, f64>),
    One([[f64; 2]; 1]),
}

impl<'py> FromPyObject<'_, 'py> for Pairs<'py> {
    type Error = PyErr;

    fn extract(given: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(array) = given.cast::<PyArrayDyn<f64>>() {
            return match array.shape() {
                [2] => {
                    let array = array.readonly();
                    let pair = array.as_array();
                    Ok(Self::One([[pair[[0]], pair[[1]]]]))
                }
                [_, _, ..] => Ok(Self::Many(array.readonly())),
                _ => Err(PyTypeError::new_err("no pairs")),
            };
        }
        let number = |item: PyResult<Bound<'_, PyAny>>| item.ok()?.extract::<f64>().ok();
        let pair = if let Ok(pair) = given.cast::<PyTuple>()
            && pair.len() == 2
        {
            number(pair.get_item(0)).zip(number(pair.get_item(1)))
        } else if let Ok(pair) = given.cast::<PyList>()
            && pair.len() == 2
        {
            number(pair.get_item(0)).zip(number(pair.get_item(1)))
        } else {
            None
        };
        match pair {
            Some((x, y)) => Ok(Self::One([[x, y]])),
            None => Err(PyTypeError::new_err("no pair of numbers")),
        }
    }
}

/// Signs of sides: many in an array with axes, or one as a number or an array without axes.
pub(crate) enum Signs<'py> {
    Many(PyReadonlyArrayDyn<'py, i8>),
    One([[i8; 1]; 1]),
}

impl<'py> FromPyObject<'_, 'py> for Signs<'py> {
    type Error = PyErr;

    fn extract(given: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        match given.cast::<PyArrayDyn<i8>>() {
            Ok(array) if array.ndim() > 0 => Ok(Self::Many(array.readonly())),
            _ => match given.extract() {
                Ok(sign @ -1..=1) => Ok(Self::One([[sign]])),
                _ => Err(PyTypeError::new_err("no side")),
            },
        }
    }
}

/// An argument with a row for each point or state.
pub(crate) trait Argument<const W: usize> {
    type Number;

    /// Its rows.
    ///
    /// # Errors
    /// The array is not contiguous, or has no whole number of rows. The Python half ensures that neither happens.
    fn rows(&self) -> PyResult<&[[Self::Number; W]]>;

    /// How many it has; none if it is a single row.
    fn count(&self) -> PyResult<Option<usize>>;
}

macro_rules! argument {
    ($kind:ident, $number:ty, $width:literal) => {
        impl Argument<$width> for $kind<'_> {
            type Number = $number;

            fn rows(&self) -> PyResult<&[[$number; $width]]> {
                match self {
                    Self::Many(array) => rows(array),
                    Self::One(row) => Ok(row),
                }
            }

            fn count(&self) -> PyResult<Option<usize>> {
                match self {
                    Self::Many(_) => Ok(Some(self.rows()?.len())),
                    Self::One(_) => Ok(None),
                }
            }
        }
    };
}

argument!(Pairs, f64, 2);
argument!(Signs, i8, 1);

/// The rows of an array, `W` numbers each.
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

/// The number of rows that all arguments have; none if each is a single row.
///
/// # Errors
/// They differ; the Python half then gives all arguments the same shape.
pub(crate) fn common<const N: usize>(
    counts: [PyResult<Option<usize>>; N],
) -> PyResult<Option<usize>> {
    let mut all = None;
    for count in counts {
        let count = count?;
        if *all.get_or_insert(count) != count {
            return Err(PyTypeError::new_err("arguments of unlike shapes"));
        }
    }
    Ok(all.flatten())
}

/// What a field of an answer has for each row.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Field {
    /// A number.
    Number,
    /// The sign of a side; 0 if there is none.
    Sign,
    /// Two numbers.
    Pair,
    /// A table of this shape.
    Table(&'static [usize]),
}

/// A matrix of the driven joints or of x and y, row by row.
pub(crate) const MATRIX: Field = Field::Table(&[2, 2]);

impl Field {
    fn width(self) -> usize {
        match self {
            Self::Number | Self::Sign => 1,
            Self::Pair => 2,
            Self::Table(shape) => shape.iter().product(),
        }
    }

    /// The numbers of many rows, flat.
    fn many(self, py: Python<'_>, numbers: Vec<f64>) -> Bound<'_, PyAny> {
        match self {
            Self::Sign => {
                let signs: Vec<i8> = numbers.into_iter().map(sign).collect();
                signs.into_pyarray(py).into_any()
            }
            _ => numbers.into_pyarray(py).into_any(),
        }
    }

    /// The numbers of one row, in the field's shape.
    fn one<'py>(self, py: Python<'py>, numbers: &[f64]) -> PyResult<Bound<'py, PyAny>> {
        Ok(match self {
            Self::Number => arr0(numbers[0]).to_pyarray(py).into_any(),
            Self::Sign => arr0(sign(numbers[0])).to_pyarray(py).into_any(),
            Self::Pair => PyArray1::from_slice(py, numbers).into_any(),
            Self::Table(shape) => {
                let table = ArrayView::from_shape(shape, numbers);
                let table = table.map_err(|error| PyValueError::new_err(error.to_string()))?;
                table.to_pyarray(py).into_any()
            }
        })
    }
}

/// A sign among the numbers of an answer, where NaN stands for none.
fn sign(number: f64) -> i8 {
    number as i8
}

/// Computes so many rows, or a single one, by `answer(row)`: `K` numbers, which are these fields one after another, or a
/// problem, for which every number is NaN.
///
/// # Errors
/// Ctrl-C.
pub(crate) fn solve<'py, const K: usize>(
    py: Python<'py>,
    count: Option<usize>,
    fields: &[Field],
    answer: impl Fn(usize) -> Result<[f64; K], Problem> + Sync,
) -> PyResult<Answer<'py>> {
    debug_assert_eq!(fields.iter().map(|field| field.width()).sum::<usize>(), K);
    let Some(rows) = count else {
        return solve_one(py, fields, answer(0));
    };
    let mut numbers: Vec<_> = fields
        .iter()
        .map(|field| vec![0.0; field.width() * rows])
        .collect();
    let mut statuses = vec![OK; rows];
    let mut rest = Rows {
        first: 0,
        columns: numbers
            .iter_mut()
            .zip(fields)
            .map(|(numbers, field)| Column {
                numbers,
                width: field.width(),
            })
            .collect(),
        statuses: &mut statuses,
    };
    while !rest.statuses.is_empty() {
        let (block, others) = rest.split_at(BLOCK);
        py.detach(|| block.fill_on_all_cores(&answer));
        py.check_signals()?;
        rest = others;
    }
    let columns = numbers.into_iter().zip(fields);
    let columns = columns.map(|(numbers, field)| field.many(py, numbers));
    Ok((columns.collect(), statuses.into_pyarray(py).into_any()))
}

/// The answer of a single row.
fn solve_one<'py, const K: usize>(
    py: Python<'py>,
    fields: &[Field],
    answer: Result<[f64; K], Problem>,
) -> PyResult<Answer<'py>> {
    let (numbers, status) = checked(answer);
    let mut rest = &numbers[..];
    let mut columns = Vec::with_capacity(fields.len());
    for field in fields {
        let (own, others) = rest.split_at(field.width());
        columns.push(field.one(py, own)?);
        rest = others;
    }
    Ok((columns, arr0(status).to_pyarray(py).into_any()))
}

/// The numbers of a row and its status.
fn checked<const K: usize>(answer: Result<[f64; K], Problem>) -> ([f64; K], u8) {
    match answer {
        Ok(numbers) if numbers.iter().all(|number| number.is_finite()) => (numbers, OK),
        Ok(_) => ([f64::NAN; K], Problem::TooLarge.code()),
        Err(problem) => ([f64::NAN; K], problem.code()),
    }
}

/// Some of the rows of an answer, to be filled.
struct Rows<'a> {
    first: usize,
    columns: Vec<Column<'a>>,
    statuses: &'a mut [u8],
}

/// One field of the answer over some rows.
struct Column<'a> {
    numbers: &'a mut [f64],
    width: usize,
}

impl Column<'_> {
    fn split_at(self, count: usize) -> (Self, Self) {
        let width = self.width;
        let (head, tail) = self.numbers.split_at_mut(count * width);
        let half = |numbers| Column { numbers, width };
        (half(head), half(tail))
    }
}

impl Rows<'_> {
    /// The first `count` rows, or all, and the others.
    fn split_at(self, count: usize) -> (Self, Self) {
        let count = count.min(self.statuses.len());
        let columns = self.columns.into_iter();
        let (heads, tails) = columns.map(|column| column.split_at(count)).unzip();
        let (head, tail) = self.statuses.split_at_mut(count);
        (
            Self {
                first: self.first,
                columns: heads,
                statuses: head,
            },
            Self {
                first: self.first + count,
                columns: tails,
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
            let (numbers, code) = checked(answer(self.first + index));
            *status = code;
            let mut rest = &numbers[..];
            for Column { numbers, width } in &mut self.columns {
                let (own, others) = rest.split_at(*width);
                numbers[index * *width..][..*width].copy_from_slice(own);
                rest = others;
            }
        }
    }
}
