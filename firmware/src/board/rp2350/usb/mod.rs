//! A serial line over USB (CDC-ACM): bytes as on the other line, in packets of 64.
//!
//! The interrupt does all of it, below every other one and above the session: each time at most one packet in and one out. A host
//! that takes nothing makes nothing wait: frames for which there is no room are dropped, as on the other line.

pub mod bus;

use crate::protocol::{Frame, MAX_FRAME};
use bus::{Bus, PACKET};
use core::mem::MaybeUninit;
use cortex_m::peripheral::NVIC;
use heapless::Vec;
use heapless::spsc::{Consumer, Producer, Queue};
use rp235x_pac::Interrupt::USBCTRL_IRQ;
use usb_device::bus::UsbBusAllocator;
use usb_device::device::{
    StringDescriptors, UsbDevice, UsbDeviceBuilder, UsbDeviceState, UsbVidPid,
};
use usbd_serial::{CdcAcmClass, USB_CLASS_CDC};

/// The number that V-USB shares among serial lines whose strings tell them apart.
const SHARED: UsbVidPid = UsbVidPid(0x16c0, 0x27dd);
/// Two of the longest frames, and the queue's empty place.
const ROOM: usize = 2 * MAX_FRAME + 1;

/// Bytes on their way to the interrupt.
type Waiting = Queue<u8, ROOM>;

/// Where the controller's driver, the device and what waits are put.
pub struct Places {
    bus: MaybeUninit<UsbBusAllocator<Bus>>,
    device: MaybeUninit<Device>,
    waiting: Waiting,
}

impl Places {
    /// Nothing.
    pub const NONE: Self = Self {
        bus: MaybeUninit::uninit(),
        device: MaybeUninit::uninit(),
        waiting: Waiting::new(),
    };
}

/// The device, for the interrupt.
pub struct Device {
    device: UsbDevice<'static, Bus>,
    class: CdcAcmClass<'static, Bus>,
    waiting: Consumer<'static, u8>,
    /// A packet that waits for its buffer, and whether the last one was a full one: then an empty one ends it.
    packet: Vec<u8, PACKET>,
    was_full: bool,
}

/// The sending half of the idle task.
pub struct Sender {
    waiting: Producer<'static, u8>,
}

/// Both halves. The host sees the device from the first interrupt on.
pub fn new(
    places: &'static mut Places,
    bus: Bus,
    name: &'static str,
) -> (&'static mut Device, Sender) {
    let bus: &'static UsbBusAllocator<Bus> = places.bus.write(UsbBusAllocator::new(bus));
    let class = CdcAcmClass::new(bus, PACKET as u16);
    let strings = StringDescriptors::default()
        .manufacturer("Fivebar")
        .product(name);
    let builder = UsbDeviceBuilder::new(bus, SHARED).device_class(USB_CLASS_CDC);
    // Neither is refused: there is room for one language, and 64 bytes are a size of packets.
    let builder = builder
        .strings(&[strings])
        .unwrap_or_else(|_| unreachable!());
    let builder = builder
        .max_packet_size_0(PACKET as u8)
        .unwrap_or_else(|_| unreachable!());
    let (sends, sent) = places.waiting.split();
    let device = places.device.write(Device {
        device: builder.build(),
        class,
        waiting: sent,
        packet: Vec::new(),
        was_full: false,
    });
    (device, Sender { waiting: sends })
}

impl Device {
    /// Does what the controller asks for, and hands over the bytes of one packet.
    #[inline(always)]
    pub fn serve(&mut self, byte: impl FnMut(u8)) {
        self.device.poll(&mut [&mut self.class]);
        if self.device.state() != UsbDeviceState::Configured {
            return;
        }
        let mut bytes = [0; PACKET];
        if let Ok(length) = self.class.read_packet(&mut bytes) {
            bytes.into_iter().take(length).for_each(byte);
        }
        self.send();
    }

    fn send(&mut self) {
        for _ in self.packet.len()..PACKET {
            match self.waiting.dequeue() {
                Some(byte) => drop(self.packet.push(byte)),
                None => break,
            }
        }
        let ends = self.packet.is_empty();
        if (!ends || self.was_full) && self.class.write_packet(&self.packet).is_ok() {
            self.was_full = self.packet.is_full();
            self.packet.clear();
        }
    }
}

impl Sender {
    /// Takes a frame; drops it if those before have not been sent. The host then asks again.
    pub fn send(&mut self, frame: &Frame) {
        if self.waiting.capacity() - self.waiting.len() < frame.len() {
            return;
        }
        for &byte in frame {
            let _ = self.waiting.enqueue(byte);
        }
        NVIC::pend(USBCTRL_IRQ);
    }
}
