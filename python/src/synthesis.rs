//! Lengths for a wanted work area: `fivebar design` as searches that any thread or machine does.

use crate::pool::on_all_cores;
use crate::{batch, error};
use fivebar_design::synthesis::{Candidate, Found, Study as Described};
use fivebar_files::design_spec;
use fivebar_files::job::read as read_job;
use fivebar_report::pages::synthesis_files;
use fivebar_report::study::synthesis::{answer, known_searches, searches_text};
use numpy::{IntoPyArray, PyArray1, PyReadonlyArrayDyn};
use pyo3::exceptions::{PyIndexError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use std::cell::RefCell;
use std::path::Path;

/// A study, which other processes make again from its texts.
#[pyclass(frozen, module = "fivebar._native")]
pub(crate) struct Study {
    study: Described,
    file: String,
    text: String,
    drawing: Option<String>,
    seed: u64,
}

/// The result of a search as JSON, and its candidates if they are wanted: rows of l1…l4, base, size, x, y, score.
type Searched<'py> = (String, Option<Bound<'py, PyArray1<f64>>>);

#[pymethods]
impl Study {
    /// Drawings are looked for in `folder`, unless the text of the drawing is given.
    #[new]
    fn new(
        py: Python<'_>,
        file: String,
        text: String,
        folder: &str,
        seed: u64,
        drawing: Option<String>,
    ) -> PyResult<Self> {
        let read = RefCell::new(drawing);
        let specification = design_spec::parse_with(&file, &text, &|name| {
            let mut read = read.borrow_mut();
            if read.is_none() {
                let text = read_job(&Path::new(folder).join(name));
                *read = Some(text.map_err(|error| error.to_string())?);
            }
            Ok(read.clone().unwrap_or_default())
        });
        let specification = specification.map_err(|refusal| error::study(py, refusal))?;
        Ok(Self {
            study: Described::new(&specification, seed),
            file,
            text,
            drawing: read.into_inner(),
            seed,
        })
    }

    fn __getnewargs__(&self) -> (&str, &str, &str, u64, Option<&str>) {
        let drawing = self.drawing.as_deref();
        (&self.file, &self.text, "", self.seed, drawing)
    }

    /// The number of searches.
    #[getter]
    fn searches(&self) -> usize {
        self.study.searches()
    }

    /// The least 1/κ that all candidates of a search have.
    fn required_dexterity(&self, index: usize) -> f64 {
        self.study.required_dexterity(index)
    }

    /// Does one search on so many threads, which live for this call only.
    fn search<'py>(
        &self,
        py: Python<'py>,
        index: usize,
        threads: usize,
        record: bool,
    ) -> PyResult<Searched<'py>> {
        if index >= self.study.searches() {
            return Err(PyIndexError::new_err("no such search"));
        }
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool.map_err(|refusal| PyRuntimeError::new_err(refusal.to_string()))?;
        let mut rows = Vec::new();
        let found = py.detach(|| {
            pool.install(|| {
                self.study.search(index, &mut |candidates| {
                    if record {
                        rows.extend(candidates.iter().flat_map(row));
                    }
                })
            })
        });
        Ok((json(&found)?, record.then(|| rows.into_pyarray(py))))
    }

    /// The least 1/κ of arms with their areas: rows of l1…l4, base, size, x, y.
    fn dexterities<'py>(
        &self,
        py: Python<'py>,
        rows: PyReadonlyArrayDyn<'_, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let arms = batch::rows::<f64, 8>(&rows)?.iter();
        let arms: Vec<_> = arms
            .map(|&[l1, l2, l3, l4, base, size, x, y]| ([l1, l2, l3, l4, base], size, [x, y]))
            .collect();
        let found = on_all_cores(py, || self.study.dexterities(&arms))?;
        Ok(found.into_pyarray(py))
    }

    /// The answer of `fivebar design` from the results of all searches, and the files that it would write, by name.
    fn finish(
        &self,
        py: Python<'_>,
        found: Vec<String>,
    ) -> PyResult<(String, Vec<(String, String)>)> {
        let found: Vec<Found> = found
            .iter()
            .map(|text| parsed(text))
            .collect::<PyResult<_>>()?;
        if found.len() != self.study.searches() {
            return Err(PyValueError::new_err(
                "one result for each search is needed",
            ));
        }
        let whole = on_all_cores(py, || self.study.finish(&found))?;
        let whole = whole.map_err(|refusal| error::study(py, refusal))?;
        let stem = Path::new(&self.file).file_stem().unwrap_or_default();
        let files = synthesis_files(&stem.to_string_lossy(), self.study.specification(), &whole);
        let files = files.map_err(|refusal| error::study(py, refusal))?;
        Ok((answer(&whole).to_string(), files))
    }

    /// The file of the searches that are done, as `fivebar design --out` keeps it.
    fn kept(&self, found: Vec<Option<String>>) -> PyResult<String> {
        let found: Vec<Option<Found>> = found
            .iter()
            .map(|text| text.as_deref().map(parsed).transpose())
            .collect::<PyResult<_>>()?;
        searches_text(&self.study, &found).map_err(refused)
    }

    /// The searches of such a file; none if it is of another study.
    fn known(&self, text: &str) -> PyResult<Option<Vec<Option<String>>>> {
        let Some(found) = known_searches(&self.study, text) else {
            return Ok(None);
        };
        let texts = found
            .iter()
            .map(|found| found.as_ref().map(json).transpose());
        texts.collect::<PyResult<_>>().map(Some)
    }
}

fn row(candidate: &Candidate) -> [f64; 9] {
    let [l1, l2, l3, l4, base] = candidate.lengths;
    let [x, y] = candidate.place;
    [l1, l2, l3, l4, base, candidate.size, x, y, candidate.score]
}

fn json(found: &Found) -> PyResult<String> {
    serde_json::to_string(found).map_err(refused)
}

fn parsed(text: &str) -> PyResult<Found> {
    serde_json::from_str(text).map_err(refused)
}

fn refused(error: serde_json::Error) -> PyErr {
    PyRuntimeError::new_err(error.to_string())
}
