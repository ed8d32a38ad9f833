//! The memory of freed blocks, which the system gets back.
//!
//! The allocator of glibc keeps freed blocks of up to 32 MB once it has seen some of that size, and with them half of what a
//! long job needed while it was read. With a fixed bound it gives each large block back at once.

/// Blocks from this size on are the system's [bytes].
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const LARGE: libc::c_int = 128 << 10;

/// To be called before threads start.
pub(super) fn give_back_large_blocks() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    #[expect(unsafe_code, reason = "a setting of the C library")]
    // SAFETY: it changes numbers of the allocator, under its lock.
    unsafe {
        libc::mallopt(libc::M_MMAP_THRESHOLD, LARGE);
        libc::mallopt(libc::M_TRIM_THRESHOLD, LARGE);
    }
}
