//! The USB controller as a device: its memory, its registers, and what it does with the packets of a host. As strict as the chip is
//! at its worst: a buffer must be complete before it is made available, because another clock reads it.

/// Bits of a buffer's control.
const AVAILABLE: u32 = 1 << 10;
const STALL: u32 = 1 << 11;
const DATA1: u32 = 1 << 13;
const FULL: u32 = 1 << 15;
const LENGTH: u32 = 0x3ff;
/// An endpoint is on.
const ON: u32 = 1 << 31;
/// Bits of SIE_STATUS that the controller sets, and those of INTS that they raise.
const SUSPENDED: u32 = 1 << 4;
const RESUMED: u32 = 1 << 11;
const SETUP: u32 = 1 << 17;
const BUS_RESET: u32 = 1 << 19;
const RAISED: [(u32, u32); 4] = [
    (BUS_RESET, 1 << 12),
    (SUSPENDED, 1 << 14),
    (RESUMED, 1 << 15),
    (SETUP, 1 << 16),
];
const BUFFER_DONE: u32 = 1 << 4;
/// Of MAIN_CTRL: the controller is on, and its pins are not isolated. Of USB_MUXING: its pins are those of the transceiver. Of
/// USB_PWR: it takes the cable as connected. Of SIE_CTRL: it shows itself to the host, and tells each buffer of endpoint 0.
const MAIN: u32 = 1;
const MUXING: u32 = 0b1001;
const POWER: u32 = 0b1100;
const PULL_UP: u32 = 1 << 16;
const TELLS: u32 = 1 << 29;

/// What a device answers to a token.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Answer {
    /// Nothing: no device has this address.
    None,
    /// Not now.
    Nak,
    /// Never.
    Stall,
    /// A packet was taken.
    Ack,
    /// A packet, and whether its turn is DATA1.
    Data(Vec<u8>, bool),
}

pub(crate) struct Usb {
    memory: Vec<u8>,
    address: u32,
    main: u32,
    control: u32,
    status: u32,
    buffers: u32,
    stall_arm: u32,
    muxing: u32,
    power: u32,
    enabled: u32,
}

impl Default for Usb {
    fn default() -> Self {
        Self {
            memory: vec![0xa5; 4096],
            address: 0,
            // Isolated.
            main: 1 << 2,
            control: 0,
            status: 0,
            buffers: 0,
            stall_arm: 0,
            muxing: 0,
            power: 0,
            enabled: 0,
        }
    }
}

impl Usb {
    /// The bytes at an offset of the memory.
    pub(crate) fn bytes(&mut self, offset: usize, size: usize) -> Option<&mut [u8]> {
        self.memory.get_mut(offset..offset + size)
    }

    fn word(&self, offset: usize) -> u32 {
        let bytes = self.memory[offset..offset + 4].try_into();
        u32::from_le_bytes(bytes.unwrap_or_default())
    }

    fn set_word(&mut self, offset: usize, word: u32) {
        self.memory[offset..offset + 4].copy_from_slice(&word.to_le_bytes());
    }

    /// Whether a write into the memory may be what it is: what makes a buffer available changes nothing else of it, unless the
    /// controller had none there.
    pub(crate) fn may_write(&self, offset: usize, word: u32) -> bool {
        let is_control = (0x80..0x100).contains(&offset);
        let before = self.word(offset & !3);
        !is_control || word & AVAILABLE == 0 || before | AVAILABLE == word
    }

    pub(crate) fn read(&self, offset: u32) -> Option<u32> {
        Some(match offset {
            0x00 => self.address,
            0x40 => self.main,
            0x4c => self.control,
            0x50 => self.status,
            0x58 => self.buffers,
            0x68 => self.stall_arm,
            0x74 => self.muxing,
            0x78 => self.power,
            0x90 => self.enabled,
            0x98 => self.events() & self.enabled,
            _ => return None,
        })
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32) -> Option<()> {
        match offset {
            0x00 => self.address = value,
            0x40 => self.main = value,
            0x4c => self.control = value,
            0x50 => self.status &= !value,
            0x58 => self.buffers &= !value,
            0x68 => self.stall_arm = value,
            0x74 => self.muxing = value,
            0x78 => self.power = value,
            0x90 => self.enabled = value,
            _ => return None,
        }
        Some(())
    }

    fn events(&self) -> u32 {
        let raised = RAISED.iter().filter(|(bit, _)| self.status & bit != 0);
        let events: u32 = raised.map(|(_, event)| event).sum();
        events | if self.buffers == 0 { 0 } else { BUFFER_DONE }
    }

    /// Whether the interrupt is raised.
    pub(crate) fn interrupts(&self) -> bool {
        self.events() & self.enabled != 0
    }

    /// Whether a host sees the device.
    pub(crate) fn is_seen(&self) -> bool {
        self.main == MAIN
            && self.muxing == MUXING
            && self.power == POWER
            && self.control & PULL_UP != 0
    }

    /// The host resets the bus. The address stays until the program changes it.
    pub(crate) fn bus_reset(&mut self) {
        self.status |= BUS_RESET;
    }

    pub(crate) fn suspend(&mut self) {
        self.status |= SUSPENDED;
    }

    fn is_addressed(&self, address: u8) -> bool {
        self.is_seen() && self.address == u32::from(address)
    }

    /// A SETUP packet: it is taken whatever the buffers hold.
    pub(crate) fn setup(&mut self, address: u8, packet: [u8; 8]) -> Answer {
        if !self.is_addressed(address) {
            return Answer::None;
        }
        self.memory[..8].copy_from_slice(&packet);
        self.status |= SETUP;
        self.stall_arm = 0;
        Answer::Ack
    }

    /// The buffer of an endpoint, which is on: its place and the place of its control.
    fn buffer(&self, number: u8, from_host: bool) -> Option<[usize; 2]> {
        let index = 2 * usize::from(number) + usize::from(from_host);
        let place = if number == 0 {
            0x100
        } else {
            let control = self.word(8 * usize::from(number) + 4 * usize::from(from_host));
            (control & ON != 0).then_some((control & 0xffc0) as usize)?
        };
        Some([place, 0x80 + 4 * index])
    }

    fn stalls(&self, number: u8, from_host: bool, control: u32) -> bool {
        let armed = number != 0 || self.stall_arm >> u32::from(from_host) & 1 != 0;
        control & STALL != 0 && armed
    }

    fn done(&mut self, number: u8, from_host: bool) {
        if number != 0 || self.control & TELLS != 0 {
            self.buffers |= 1 << (2 * u32::from(number) + u32::from(from_host));
        }
    }

    /// An IN token: the device is to send.
    pub(crate) fn token_in(&mut self, address: u8, number: u8) -> Answer {
        if !self.is_addressed(address) {
            return Answer::None;
        }
        let Some([place, control_at]) = self.buffer(number, false) else {
            return Answer::None;
        };
        let control = self.word(control_at);
        if self.stalls(number, false, control) {
            return Answer::Stall;
        }
        if control & AVAILABLE == 0 || control & FULL == 0 {
            return Answer::Nak;
        }
        let length = (control & LENGTH) as usize;
        let bytes = self.memory[place..place + length].to_vec();
        self.set_word(control_at, control & !(AVAILABLE | FULL));
        self.done(number, false);
        Answer::Data(bytes, control & DATA1 != 0)
    }

    /// An OUT token with its packet. One out of turn is acknowledged and not taken.
    pub(crate) fn token_out(
        &mut self,
        address: u8,
        number: u8,
        bytes: &[u8],
        data1: bool,
    ) -> Answer {
        if !self.is_addressed(address) {
            return Answer::None;
        }
        let Some([place, control_at]) = self.buffer(number, true) else {
            return Answer::None;
        };
        let control = self.word(control_at);
        if self.stalls(number, true, control) {
            return Answer::Stall;
        }
        if control & AVAILABLE == 0 || control & FULL != 0 {
            return Answer::Nak;
        }
        if (control & DATA1 != 0) != data1 {
            return Answer::Ack;
        }
        self.memory[place..place + bytes.len()].copy_from_slice(bytes);
        let kept = control & !(AVAILABLE | LENGTH);
        self.set_word(control_at, kept | FULL | bytes.len() as u32);
        self.done(number, true);
        Answer::Ack
    }
}
