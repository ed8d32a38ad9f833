//! The few functions of the CPU emulator Unicorn that this crate uses.

use std::ffi::{c_int, c_void};
use std::ptr::null_mut;

/// Registers, by the emulator's numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Reg(c_int);

impl Reg {
    pub(crate) const FPSCR: Self = Self(6);
    pub(crate) const LR: Self = Self(10);
    pub(crate) const PC: Self = Self(11);
    pub(crate) const SP: Self = Self(12);
    pub(crate) const CONTROL: Self = Self(117);
    pub(crate) const XPSR: Self = Self(120);
    pub(crate) const PRIMASK: Self = Self(123);
    pub(crate) const BASEPRI: Self = Self(124);
    pub(crate) const FAULTMASK: Self = Self(126);

    /// R0…R12.
    pub(crate) const fn r(n: u32) -> Self {
        Self(66 + n as c_int)
    }

    /// S0…S31.
    pub(crate) const fn s(n: u32) -> Self {
        Self(79 + n as c_int)
    }
}

/// Kinds of hooks.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hook(c_int);

impl Hook {
    pub(crate) const INTERRUPT: Self = Self(1 << 0);
    pub(crate) const BLOCK: Self = Self(1 << 3);
    pub(crate) const INVALID_MEMORY: Self = Self(0b11_1111 << 4);
    pub(crate) const INVALID_INSTRUCTION: Self = Self(1 << 14);
}

/// Access rights of mapped memory.
pub(crate) const READ: u32 = 1;
pub(crate) const WRITE: u32 = 2;
pub(crate) const EXECUTE: u32 = 4;

const ARCH_ARM: c_int = 1;
const MODE_THUMB_MCLASS: c_int = 1 << 4 | 1 << 5;
const CORTEX_M4: c_int = 9;
/// `uc_ctl_set_cpu_model`: writes control 7 with one argument.
const SET_CPU_MODEL: c_int = 7 | 1 << 26 | 1 << 30;

/// The emulator's handle, as its callbacks get it.
pub(crate) type Handle = *mut c_void;
/// Reads `size` bytes at `offset` of a region.
pub(crate) type ReadRegion = extern "C" fn(Handle, u64, u32, *mut c_void) -> u64;
/// Writes `size` bytes at `offset` of a region.
pub(crate) type WriteRegion = extern "C" fn(Handle, u64, u32, u64, *mut c_void);
/// A block of code begins: its address and size.
pub(crate) type OnBlock = extern "C" fn(Handle, u64, u32, *mut c_void);
/// An exception of the processor: its number in the emulator.
pub(crate) type OnInterrupt = extern "C" fn(Handle, u32, *mut c_void);
/// An access that nothing is mapped for: kind, address, size, value.
pub(crate) type OnInvalidMemory =
    extern "C" fn(Handle, c_int, u64, c_int, i64, *mut c_void) -> bool;
/// An instruction that the processor does not have.
pub(crate) type OnInvalidInstruction = extern "C" fn(Handle, *mut c_void) -> bool;

unsafe extern "C" {
    fn uc_open(arch: c_int, mode: c_int, engine: *mut Handle) -> c_int;
    fn uc_close(engine: Handle) -> c_int;
    fn uc_ctl(engine: Handle, control: c_int, ...) -> c_int;
    fn uc_mem_map_ptr(
        engine: Handle,
        address: u64,
        size: usize,
        rights: u32,
        memory: *mut c_void,
    ) -> c_int;
    fn uc_mmio_map(
        engine: Handle,
        address: u64,
        size: usize,
        read: ReadRegion,
        read_data: *mut c_void,
        write: WriteRegion,
        write_data: *mut c_void,
    ) -> c_int;
    fn uc_hook_add(
        engine: Handle,
        hook: *mut usize,
        kind: c_int,
        callback: *mut c_void,
        data: *mut c_void,
        begin: u64,
        end: u64,
        ...
    ) -> c_int;
    fn uc_reg_read(engine: Handle, register: c_int, value: *mut c_void) -> c_int;
    fn uc_reg_write(engine: Handle, register: c_int, value: *const c_void) -> c_int;
    fn uc_emu_start(engine: Handle, begin: u64, until: u64, timeout: u64, count: usize) -> c_int;
    fn uc_emu_stop(engine: Handle) -> c_int;
}

/// An error number of the emulator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EmulatorError(pub i32);

fn check(code: c_int) -> Result<(), EmulatorError> {
    if code == 0 {
        Ok(())
    } else {
        Err(EmulatorError(code))
    }
}

/// An address that no program reaches: the emulator wants one to stop at.
const NOWHERE: u64 = 0xf000_0000;

/// One emulated Cortex-M4F.
pub(crate) struct Engine {
    handle: Handle,
}

// SAFETY: the handle is used by the thread that owns the engine.
unsafe impl Send for Engine {}

impl Engine {
    pub(crate) fn open() -> Result<Self, EmulatorError> {
        let mut handle = null_mut();
        // SAFETY: the pointer is to a place for a handle; the control takes one int.
        unsafe {
            check(uc_open(ARCH_ARM, MODE_THUMB_MCLASS, &raw mut handle))?;
            check(uc_ctl(handle, SET_CPU_MODEL, CORTEX_M4))?;
        }
        Ok(Self { handle })
    }

    /// Maps `memory`, which must live and stay in its place as long as the engine.
    pub(crate) fn map(
        &mut self,
        address: u32,
        memory: &mut [u8],
        rights: u32,
    ) -> Result<(), EmulatorError> {
        // SAFETY: the memory is as long as said and outlives the engine.
        check(unsafe {
            uc_mem_map_ptr(
                self.handle,
                address.into(),
                memory.len(),
                rights,
                memory.as_mut_ptr().cast(),
            )
        })
    }

    pub(crate) fn map_registers(
        &mut self,
        address: u32,
        size: usize,
        read: ReadRegion,
        write: WriteRegion,
        data: *mut c_void,
    ) -> Result<(), EmulatorError> {
        // SAFETY: the callbacks have the emulator's signatures.
        check(unsafe { uc_mmio_map(self.handle, address.into(), size, read, data, write, data) })
    }

    fn hook(
        &mut self,
        kind: Hook,
        callback: *mut c_void,
        data: *mut c_void,
    ) -> Result<(), EmulatorError> {
        let mut hook = 0;
        // SAFETY: begin above end means everywhere; the callers give fitting callbacks.
        check(unsafe { uc_hook_add(self.handle, &raw mut hook, kind.0, callback, data, 1, 0) })
    }

    pub(crate) fn on_block(
        &mut self,
        callback: OnBlock,
        data: *mut c_void,
    ) -> Result<(), EmulatorError> {
        self.hook(Hook::BLOCK, callback as *mut c_void, data)
    }

    pub(crate) fn on_interrupt(
        &mut self,
        callback: OnInterrupt,
        data: *mut c_void,
    ) -> Result<(), EmulatorError> {
        self.hook(Hook::INTERRUPT, callback as *mut c_void, data)
    }

    pub(crate) fn on_invalid_memory(
        &mut self,
        callback: OnInvalidMemory,
        data: *mut c_void,
    ) -> Result<(), EmulatorError> {
        self.hook(Hook::INVALID_MEMORY, callback as *mut c_void, data)
    }

    pub(crate) fn on_invalid_instruction(
        &mut self,
        callback: OnInvalidInstruction,
        data: *mut c_void,
    ) -> Result<(), EmulatorError> {
        self.hook(Hook::INVALID_INSTRUCTION, callback as *mut c_void, data)
    }

    pub(crate) fn get(&self, register: Reg) -> u32 {
        let mut value = 0_u64;
        // SAFETY: no register used here is wider than 64 bits. A failure leaves zero.
        unsafe { uc_reg_read(self.handle, register.0, (&raw mut value).cast()) };
        value as u32
    }

    pub(crate) fn set(&mut self, register: Reg, value: u32) {
        let value = u64::from(value);
        // SAFETY: as above.
        unsafe { uc_reg_write(self.handle, register.0, (&raw const value).cast()) };
    }

    /// The handle, for [`Engine::run`].
    pub(crate) fn handle(&self) -> Handle {
        self.handle
    }

    /// Runs from `address`, in Thumb state, until a hook stops it or it fails. The hooks
    /// use the engine meanwhile, so this borrows nothing.
    pub(crate) fn run(handle: Handle, address: u32) -> Result<(), EmulatorError> {
        // SAFETY: the handle is that of an engine that is open.
        check(unsafe { uc_emu_start(handle, u64::from(address | 1), NOWHERE, 0, 0) })
    }

    /// Ends [`Engine::run`] before the next block; from a hook.
    pub(crate) fn stop(&mut self) {
        // SAFETY: the handle is open.
        unsafe { uc_emu_stop(self.handle) };
    }
}

impl Drop for Engine {
    fn drop(&mut self) {
        // SAFETY: the handle is open and not used again.
        unsafe { uc_close(self.handle) };
    }
}
