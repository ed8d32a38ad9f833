//! Stands in for two functions of the emulator that cost two fifths of a run.
//!
//! Before each write of the program to memory Unicorn 2.0 locks the pages of translated code that the write
//! may change: it allocates a tree of the locks, and frees it behind the write. The locks are for threads that
//! translate at the same time; here one thread does, so nothing has to be locked. The symbols are found here
//! before those of the library. Where a library has no such functions, nothing calls these.
#![allow(unsafe_code, reason = "the symbols of a C library")]

use std::ffi::c_void;
use std::ptr::NonNull;

/// Locks the pages of an engine from a start to an end, there: a handle of the locks, which only the function
/// below gets.
#[unsafe(no_mangle)]
extern "C" fn page_collection_lock_arm(_: *mut c_void, _: u64, _: u64) -> *mut c_void {
    NonNull::dangling().as_ptr()
}

/// Unlocks them.
#[unsafe(no_mangle)]
extern "C" fn page_collection_unlock_arm(_: *mut c_void) {}
