//! From pointers that may be null to a status and a result.

use crate::status::Status;
use core::mem::MaybeUninit;

/// What a pointer points to, unless it is null.
pub(crate) fn given<T>(pointer: Option<T>) -> Result<T, Status> {
    pointer.ok_or(Status::NullPointer)
}

/// Writes what `make` gives through the pointer, or nothing.
pub(crate) fn answer<T: Into<U>, U>(
    out: Option<&mut MaybeUninit<U>>,
    make: impl FnOnce() -> Result<T, Status>,
) -> Status {
    store(out, make, |made, out| {
        out.write(made.into());
    })
}

/// As [`answer`], with how it is written.
pub(crate) fn store<T, U>(
    out: Option<&mut MaybeUninit<U>>,
    make: impl FnOnce() -> Result<T, Status>,
    write: impl FnOnce(T, &mut MaybeUninit<U>),
) -> Status {
    match given(out).and_then(|out| Ok((make()?, out))) {
        Ok((made, out)) => {
            write(made, out);
            Status::Ok
        }
        Err(status) => status,
    }
}
