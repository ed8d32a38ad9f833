//! The USB controller as usb-device wants it: endpoints with one buffer of 64 bytes each, in the controller's own memory.
//!
//! One interrupt alone calls it, so no critical section is needed. Where two registers must change one after the other, a
//! half of the controller that runs from 48 MHz has to see the first one first.

use crate::board::rp2350::resets;
use rp235x_pac::{RESETS, USB, USB_DPRAM};
use usb_device::bus::{PollResult, UsbBus};
use usb_device::endpoint::{EndpointAddress, EndpointType};
use usb_device::{Result, UsbDirection, UsbError};

/// Bytes of a packet at most.
pub const PACKET: usize = 64;
/// Endpoints with a number, that of control among them.
const ENDPOINTS: usize = 3;
/// Endpoints that the controller has.
const NUMBERS: usize = 16;
/// In the controller's memory: the buffer of endpoint 0, and the first one of the others.
const CONTROL_BUFFER: usize = 0x100;
const BUFFERS: usize = 0x180;
/// Of a buffer's control: the packet is the controller's, the endpoint stalls, the packet's turn is DATA1, and there are bytes in it.
const AVAILABLE: u32 = 1 << 10;
const STALL: u32 = 1 << 11;
const DATA1: u32 = 1 << 13;
const FULL: u32 = 1 << 15;
const LENGTH: u32 = 0x3ff;
/// Of an endpoint's control: it is on, and each of its buffers is told.
const ON: u32 = 1 << 31;
const TELLS: u32 = 1 << 29;
/// Bits of BUFF_STATUS: endpoints to the host, and from it.
const TO_HOST: u32 = 0x5555_5555;

/// The controller, with the kind of each endpoint: from the host, to it.
pub struct Bus {
    usb: USB,
    memory: USB_DPRAM,
    kinds: [[Option<EndpointType>; 2]; ENDPOINTS],
}

// SAFETY: it moves into the one interrupt that uses it; the others have no reference to it.
#[allow(unsafe_code)]
unsafe impl Sync for Bus {}

/// A buffer's number: those of a number's two directions follow each other, that to the host first.
fn buffer(address: EndpointAddress) -> usize {
    2 * address.index() + usize::from(address.is_out())
}

/// Lets four clocks of 48 MHz pass.
fn let_it_see() {
    cortex_m::asm::dsb();
    for _ in 0..16 {
        cortex_m::asm::nop();
    }
}

impl Bus {
    /// The controller with its own power supply as if it were connected: Pico 2 measures no cable.
    pub fn new(usb: USB, memory: USB_DPRAM, resets: &RESETS) -> Self {
        resets::reset(resets, resets::USBCTRL);
        // Nothing tells what is in the memory, and a host may ask before the first interrupt.
        (0..2 * NUMBERS).for_each(|buffer| memory.ep_buffer_control(buffer).reset());
        (0..2 * NUMBERS - 2).for_each(|buffer| memory.ep_control(buffer).reset());
        usb.usb_muxing()
            .write(|w| w.to_phy().set_bit().softcon().set_bit());
        usb.usb_pwr().write(|w| {
            w.vbus_detect().set_bit();
            w.vbus_detect_override_en().set_bit()
        });
        // The pins of the transceiver are isolated until this is written.
        usb.main_ctrl()
            .write(|w| w.phy_iso().clear_bit().controller_en().set_bit());
        Self {
            usb,
            memory,
            kinds: [[None; 2]; ENDPOINTS],
        }
    }

    fn control(&self, buffer: usize) -> u32 {
        self.memory.ep_buffer_control(buffer).read().bits()
    }

    /// Gives a buffer to the controller, or takes it.
    fn set_control(&self, buffer: usize, control: u32) {
        let register = self.memory.ep_buffer_control(buffer);
        // SAFETY: lengths are 64 at most.
        #[allow(unsafe_code)]
        unsafe {
            register.write(|w| w.bits(control & !AVAILABLE));
            if control & AVAILABLE != 0 {
                let_it_see();
                register.write(|w| w.bits(control));
            }
        }
    }

    /// The place of a buffer's bytes.
    fn bytes(buffer: usize) -> *mut u8 {
        let offset = match buffer {
            0 | 1 => CONTROL_BUFFER,
            _ => BUFFERS + PACKET * (buffer - 2),
        };
        (USB_DPRAM::PTR as usize + offset) as *mut u8
    }

    /// Reads bytes of the controller's memory: one by one, because it takes no access across words.
    fn copy(from: *const u8, to: &mut [u8]) {
        for (at, byte) in to.iter_mut().take(PACKET).enumerate() {
            // SAFETY: within the controller's memory.
            #[allow(unsafe_code)]
            unsafe {
                *byte = from.add(at).read_volatile();
            }
        }
    }

    fn setup_has_come(&self) -> bool {
        self.usb.sie_status().read().setup_rec().bit_is_set()
    }

    fn read_setup(&self, to: &mut [u8]) -> Result<usize> {
        let to = to.get_mut(..8).ok_or(UsbError::BufferOverflow)?;
        Self::copy(USB_DPRAM::PTR.cast(), to);
        // What is sent next has DATA1; what was received before is old.
        self.set_control(0, 0);
        self.usb
            .sie_status()
            .write(|w| w.setup_rec().clear_bit_by_one());
        self.told(1);
        let has_more = to[0] & 0x80 != 0 || to[6] != 0 || to[7] != 0;
        let available = if has_more { AVAILABLE } else { 0 };
        self.set_control(1, PACKET as u32 | DATA1 | available);
        Ok(to.len())
    }

    /// A buffer's packet is no longer new.
    fn told(&self, buffer: usize) {
        // SAFETY: a bit of 1 clears.
        #[allow(unsafe_code)]
        self.usb
            .buff_status()
            .write(|w| unsafe { w.bits(1 << buffer) });
    }

    /// The next packet has DATA0. A buffer from the host waits for it; one to the host is empty.
    fn first_turn(&self, buffer: usize) {
        let from_host = buffer % 2 == 1;
        let control = if from_host {
            PACKET as u32 | AVAILABLE
        } else {
            DATA1
        };
        self.set_control(buffer, control);
    }

    /// As after a reset of the bus: the endpoints from the host wait for their first packet.
    fn reset_endpoints(&self) {
        self.usb
            .sie_ctrl()
            .modify(|_, w| w.ep0_int_1buf().set_bit());
        self.set_control(0, DATA1);
        self.set_control(1, PACKET as u32 | DATA1);
        for number in 1..ENDPOINTS {
            for (from_host, kind) in self.kinds[number].into_iter().enumerate() {
                let Some(kind) = kind else { continue };
                let buffer = 2 * number + from_host;
                let place = (Self::bytes(buffer) as usize - USB_DPRAM::PTR as usize) as u32;
                let kind = if kind == EndpointType::Interrupt {
                    3
                } else {
                    2
                };
                // SAFETY: the kinds are those of the data sheet, and the place is one of this memory.
                #[allow(unsafe_code)]
                self.memory
                    .ep_control(buffer - 2)
                    .write(|w| unsafe { w.bits(ON | TELLS | kind << 26 | place) });
                self.first_turn(buffer);
            }
        }
    }
}

impl UsbBus for Bus {
    fn alloc_ep(
        &mut self,
        direction: UsbDirection,
        address: Option<EndpointAddress>,
        kind: EndpointType,
        _: u16,
        _: u8,
    ) -> Result<EndpointAddress> {
        let side = usize::from(direction == UsbDirection::Out);
        let free = (1..ENDPOINTS).find(|&number| self.kinds[number][side].is_none());
        let number = address.map(|address| address.index()).or(free);
        let number = number.ok_or(UsbError::EndpointOverflow)?;
        let place = self
            .kinds
            .get_mut(number)
            .ok_or(UsbError::EndpointOverflow)?;
        place[side] = Some(kind);
        Ok(EndpointAddress::from_parts(number, direction))
    }

    fn enable(&mut self) {
        self.usb.inte().write(|w| {
            w.buff_status().set_bit().bus_reset().set_bit();
            w.setup_req().set_bit().dev_suspend().set_bit();
            w.dev_resume_from_host().set_bit()
        });
        self.usb.sie_ctrl().write(|w| w.pullup_en().set_bit());
    }

    fn reset(&self) {
        self.usb
            .sie_status()
            .write(|w| w.bus_reset().clear_bit_by_one());
        // SAFETY: bits of 1 clear.
        #[allow(unsafe_code)]
        self.usb
            .buff_status()
            .write(|w| unsafe { w.bits(u32::MAX) });
        self.reset_endpoints();
        self.usb.addr_endp().reset();
    }

    fn set_device_address(&self, address: u8) {
        // SAFETY: 7 bits.
        #[allow(unsafe_code)]
        self.usb
            .addr_endp()
            .write(|w| unsafe { w.address().bits(address & 0x7f) });
    }

    fn write(&self, address: EndpointAddress, bytes: &[u8]) -> Result<usize> {
        let buffer = buffer(address);
        if bytes.len() > PACKET {
            return Err(UsbError::BufferOverflow);
        }
        let before = self.control(buffer);
        if before & AVAILABLE != 0 {
            return Err(UsbError::WouldBlock);
        }
        for (at, byte) in bytes.iter().take(PACKET).enumerate() {
            // SAFETY: within the buffer.
            #[allow(unsafe_code)]
            unsafe {
                Self::bytes(buffer).add(at).write_volatile(*byte);
            }
        }
        let turn = (before & DATA1) ^ DATA1;
        self.set_control(buffer, bytes.len() as u32 | turn | FULL | AVAILABLE);
        Ok(bytes.len())
    }

    fn read(&self, address: EndpointAddress, to: &mut [u8]) -> Result<usize> {
        if address.index() == 0 && self.setup_has_come() {
            return self.read_setup(to);
        }
        let buffer = buffer(address);
        let control = self.control(buffer);
        if control & FULL == 0 {
            return Err(UsbError::WouldBlock);
        }
        let length = (control & LENGTH) as usize;
        let to = to.get_mut(..length).ok_or(UsbError::BufferOverflow)?;
        Self::copy(Self::bytes(buffer), to);
        self.told(buffer);
        // Of control, another packet follows a full one alone.
        let goes_on = address.index() != 0 || length == PACKET;
        let available = if goes_on { AVAILABLE } else { 0 };
        let turn = (control & DATA1) ^ DATA1;
        self.set_control(buffer, PACKET as u32 | turn | available);
        Ok(length)
    }

    fn set_stalled(&self, address: EndpointAddress, stalled: bool) {
        if address.index() == 0 {
            self.usb.ep_stall_arm().modify(|_, w| {
                if address.is_in() {
                    w.ep0_in().bit(stalled)
                } else {
                    w.ep0_out().bit(stalled)
                }
            });
        }
        if stalled {
            self.set_control(buffer(address), STALL);
        } else if address.index() != 0 {
            self.first_turn(buffer(address));
        } else if self.is_stalled(address) {
            self.set_control(buffer(address), 0);
        }
    }

    fn is_stalled(&self, address: EndpointAddress) -> bool {
        self.control(buffer(address)) & STALL != 0
    }

    fn suspend(&self) {}

    fn resume(&self) {}

    fn poll(&self) -> PollResult {
        let events = self.usb.ints().read();
        if events.bus_reset().bit_is_set() {
            return PollResult::Reset;
        }
        let buffers = self.usb.buff_status().read().bits();
        let setup = events.setup_req().bit_is_set();
        if buffers == 0 && !setup {
            let status = self.usb.sie_status();
            if events.dev_suspend().bit_is_set() {
                status.write(|w| w.suspended().clear_bit_by_one());
                return PollResult::Suspend;
            }
            if events.dev_resume_from_host().bit_is_set() {
                status.write(|w| w.resume().clear_bit_by_one());
                return PollResult::Resume;
            }
            return PollResult::None;
        }
        // What has gone is told once; what has come until it is read.
        // SAFETY: bits of 1 clear.
        #[allow(unsafe_code)]
        self.usb.buff_status().write(|w| unsafe { w.bits(TO_HOST) });
        if setup {
            // An answer to an earlier one that the host no longer wants.
            self.set_control(0, self.control(0) & !AVAILABLE);
        }
        let of = |from_host: u32| {
            (0..ENDPOINTS as u32)
                .map(|number| ((buffers >> (2 * number + from_host) & 1) << number) as u16)
                .fold(0, |all, one| all | one)
        };
        PollResult::Data {
            ep_out: of(1),
            ep_in_complete: of(0),
            ep_setup: u16::from(setup),
        }
    }
}
