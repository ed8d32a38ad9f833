//! The threads on which studies compute.
//!
//! A child that `fork` made has none of its parent's threads, so that the pool of the library `rayon`, made before the
//! fork, would let it wait for ever. Each process therefore makes a pool of its own.

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};
use std::process;
use std::sync::{Arc, Mutex};

/// The pool, and the process that has its threads.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// Does work on all cores, without the interpreter's lock.
///
/// # Errors
/// The system gives no threads.
pub(crate) fn on_all_cores<R: Send>(
    py: Python<'_>,
    work: impl FnOnce() -> R + Send,
) -> PyResult<R> {
    py.detach(|| Ok(pool()?.install(work)))
        .map_err(|refusal: ThreadPoolBuildError| PyRuntimeError::new_err(refusal.to_string()))
}

/// The pool of this process.
///
/// # Errors
/// The system gives no threads.
pub(crate) fn pool() -> Result<Arc<ThreadPool>, ThreadPoolBuildError> {
    // Another thread may have held the lock when the process was forked: then no one opens it, and this call has a pool
    // for itself.
    let Ok(mut shared) = POOL.try_lock() else {
        return new().map(Arc::new);
    };
    let process = process::id();
    if let Some((owner, pool)) = &*shared
        && *owner == process
    {
        return Ok(pool.clone());
    }
    let pool = Arc::new(new()?);
    // The parent's pool is left as it is: to end it means to wake threads that this process has not.
    std::mem::forget(shared.replace((process, pool.clone())));
    Ok(pool)
}

fn new() -> Result<ThreadPool, ThreadPoolBuildError> {
    ThreadPoolBuilder::new().build()
}
