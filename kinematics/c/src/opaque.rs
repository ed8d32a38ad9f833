//! What C stores and does not read.

use crate::answer::given;
use crate::plain::{Geometry, Tool};
use crate::status::Status;
use core::mem::MaybeUninit;
use fivebar_kinematics::{Scalar, five_bar};

/// A struct of the header that holds a kinematics' type.
pub(crate) trait Opaque: Sized {
    /// What it holds.
    type Inner;

    /// Fails to compile where the struct is smaller than what it holds, or not aligned for it.
    const FITS: () = assert!(
        size_of::<Self>() >= size_of::<Self::Inner>()
            && align_of::<Self>() >= align_of::<Self::Inner>()
    );

    fn store(inner: Self::Inner, out: &mut MaybeUninit<Self>) {
        let () = Self::FITS;
        // SAFETY: by `FITS` the memory is large enough and aligned.
        unsafe { out.as_mut_ptr().cast::<Self::Inner>().write(inner) }
    }

    /// Whether `store` has written this: links have a length, and memory that starts as zeros has none.
    fn is_prepared(inner: &Self::Inner) -> bool;
}

/// What a pointer's struct holds, unless the pointer is null or nothing was stored.
pub(crate) fn prepared<T: Opaque>(pointer: Option<&T>) -> Result<&T::Inner, Status> {
    let () = T::FITS;
    let pointer = core::ptr::from_ref(given(pointer)?);
    // SAFETY: by `FITS` the memory is large enough and aligned; the header demands that `store` wrote it. All zeros are
    // a value too: numbers, and an `Option` that is `None`.
    let inner = unsafe { &*pointer.cast::<T::Inner>() };
    if T::is_prepared(inner) {
        Ok(inner)
    } else {
        Err(Status::NotPrepared)
    }
}

impl<S: Scalar> Opaque for Geometry<S> {
    type Inner = five_bar::Geometry<S>;

    fn is_prepared(inner: &Self::Inner) -> bool {
        inner.l1() > S::ZERO
    }
}

impl<S: Scalar> Opaque for Tool<S> {
    type Inner = five_bar::Tool<S>;

    fn is_prepared(inner: &Self::Inner) -> bool {
        inner.geometry().l1() > S::ZERO
    }
}
