//! What the page's worker calls and gives, by numbers alone.
//!
//! The worker asks for room for a request, writes it there as UTF-8, and asks for the answer. While a job is drawn,
//! the program calls the worker back with samples.
#![expect(
    unsafe_code,
    reason = "names that another language links to; nothing here dereferences an address"
)]

use std::cell::RefCell;

thread_local! {
    /// The request, then its answer.
    static TEXT: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
}

#[link(wasm_import_module = "page")]
unsafe extern "C" {
    /// Takes this many numbers at this address, rows of [`crate::watched::ROW`].
    safe fn drawn(numbers: *const f32, count: usize);
}

/// The address at which the worker writes a request of this length.
#[unsafe(no_mangle)]
pub extern "C" fn request(length: usize) -> *mut u8 {
    TEXT.with_borrow_mut(|text| {
        text.clear();
        text.resize(length, 0);
        text.as_mut_ptr()
    })
}

/// Answers the request; returns the length of the answer.
#[unsafe(no_mangle)]
pub extern "C" fn answer() -> usize {
    let request = TEXT.take();
    let request = String::from_utf8_lossy(&request);
    let text = crate::request::answer(&request, &mut |rows| {
        drawn(rows.as_ptr(), rows.len());
    });
    let length = text.len();
    TEXT.set(text.into_bytes());
    length
}

/// The address of the answer.
#[unsafe(no_mangle)]
pub extern "C" fn answer_at() -> *const u8 {
    TEXT.with_borrow(Vec::as_ptr)
}
