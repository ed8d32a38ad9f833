//! What the emulator calls while the core runs.

use crate::cpu::{Cpu, Stop};
use crate::peripherals::flash::START;
use crate::unicorn::Handle;
use crate::violation::Violation;
use std::ffi::{c_int, c_void};

/// Addresses below the RAM where nothing is: a fault of the processor, as for a stack that
/// outgrows its place. Other addresses without memory end the run.
const BELOW_RAM: std::ops::Range<u64> = 0x1fff_8000..0x2000_0000;

fn cpu<'a>(data: *mut c_void) -> &'a mut Cpu {
    // SAFETY: the callbacks get the address of the chip's core, and run only while
    // the core runs, when nothing else uses it.
    unsafe { &mut *data.cast::<Cpu>() }
}

pub(crate) extern "C" fn on_block(_: Handle, address: u64, size: u32, data: *mut c_void) {
    let cpu = cpu(data);
    let late = cpu.mcu.now >= cpu.deadline;
    if late && cpu.look() || cpu.waiting && cpu.takeable().is_some() {
        cpu.stop.get_or_insert(Stop::Due);
        cpu.engine.stop();
        return;
    }
    cpu.block = address as u32;
    cpu.block_size = size;
    cpu.idle.path = (cpu.idle.path ^ address).wrapping_mul(0x0100_0000_01b3);
    if cpu.idle.anchor == Some(address as u32) {
        cpu.turn();
    }
    cpu.figures.block(address as u32, size);
    if let Some(trace) = &mut cpu.trace {
        trace.block(address as u32, &cpu.engine);
    }
    // A cycle for every two bytes of code.
    cpu.mcu.now += u64::from(size / 2) * cpu.mcu.core;
}

pub(crate) extern "C" fn on_interrupt(_: Handle, number: u32, data: *mut c_void) {
    let cpu = cpu(data);
    // 8 is the return from an exception; the others are faults of the processor.
    cpu.stop = Some(if number == 8 {
        Stop::Return
    } else {
        Stop::Fault
    });
    cpu.engine.stop();
}

pub(crate) extern "C" fn on_invalid_memory(
    _: Handle,
    kind: c_int,
    address: u64,
    _: c_int,
    value: i64,
    data: *mut c_void,
) -> bool {
    let cpu = cpu(data);
    if BELOW_RAM.contains(&address) {
        cpu.mcu.nvic.cfsr |= 1 << 9 | 1 << 15;
        cpu.mcu.nvic.bfar = address as u32;
        cpu.stop = Some(Stop::Fault);
        return false;
    }
    let (rule, written) = match kind {
        17 | 20 | 22 => ("no memory that can be written", Some(value as u32)),
        18 | 21 | 24 => ("no code", None),
        _ => ("no memory", None),
    };
    cpu.mcu.violation.get_or_insert(Violation {
        register: format!("{address:#010x}"),
        written,
        rule: format!("{rule} at this address"),
    });
    false
}

pub(crate) extern "C" fn on_invalid_instruction(_: Handle, data: *mut c_void) -> bool {
    cpu(data).stop = Some(Stop::Fault);
    false
}

pub(crate) extern "C" fn read_at<const BASE: u32>(
    _: Handle,
    offset: u64,
    size: u32,
    data: *mut c_void,
) -> u64 {
    let cpu = cpu(data);
    cpu.count_access(BASE + offset as u32);
    match cpu.mcu.read(BASE + offset as u32, size) {
        Ok(value) => {
            cpu.idle.disturbed = true;
            value.into()
        }
        Err(violation) => {
            cpu.refuse(violation, BASE + offset as u32, false);
            0
        }
    }
}

pub(crate) extern "C" fn write_at<const BASE: u32>(
    _: Handle,
    offset: u64,
    size: u32,
    value: u64,
    data: *mut c_void,
) {
    let cpu = cpu(data);
    if let Some(trace) = &mut cpu.trace {
        trace.write(BASE + offset as u32, value as u32);
    }
    cpu.count_access(BASE + offset as u32);
    if let Err(violation) = cpu.mcu.write(BASE + offset as u32, size, value as u32) {
        cpu.refuse(violation, BASE + offset as u32, true);
    }
    cpu.touched();
}

pub(crate) extern "C" fn read_sectors(_: Handle, offset: u64, size: u32, data: *mut c_void) -> u64 {
    let cpu = cpu(data);
    match cpu.mcu.flash.load(offset as u32, size) {
        Ok(value) => value.into(),
        Err(violation) => {
            cpu.refuse(violation, START + offset as u32, false);
            0
        }
    }
}

pub(crate) extern "C" fn write_sectors(
    _: Handle,
    offset: u64,
    size: u32,
    value: u64,
    data: *mut c_void,
) {
    let cpu = cpu(data);
    let now = cpu.mcu.now;
    match cpu
        .mcu
        .flash
        .program(offset as u32, size, value as u32, now)
    {
        Ok(operation) => cpu.mcu.begin(operation),
        Err(violation) => {
            cpu.mcu.violation.get_or_insert(violation);
        }
    }
    cpu.touched();
}
