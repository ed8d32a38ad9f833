//! A host at the other end of the USB cable: it finds the device, reads what it says of itself, opens its serial line, and moves
//! bytes both ways. It does one transaction in 60 µs, as a busy host with one device.

use crate::usb::{Answer, Usb};
use std::collections::VecDeque;

/// Cycles of a transaction, of the quiet after a reset of the bus, and of the quiet behind which a device without a host sleeps.
const TRANSACTION: u64 = 9_000;
const RESET: u64 = 1_500_000;
const SLEEP: u64 = 450_000;
/// The address that the device gets.
const ADDRESS: u8 = 5;

/// A control transfer: its packet, and the bytes from the host.
struct Transfer {
    packet: [u8; 8],
    bytes: Vec<u8>,
    stage: Stage,
    answer: Vec<u8>,
    /// The turn of the next packet.
    data1: bool,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Stage {
    Setup,
    Data,
    Status,
}

/// The host, and its end of the cable.
#[derive(Default)]
pub struct UsbHost {
    plugged: bool,
    until_next: u64,
    address: u8,
    /// The transfer that goes on, and which one of the beginning it is.
    transfer: Option<Transfer>,
    step: usize,
    /// The numbers of the serial line's endpoints, to and from the host, and the turns of both.
    line: Option<[u8; 2]>,
    turns: [bool; 2],
    listens: bool,
    /// What the device calls itself.
    pub product: String,
    /// The device's own descriptor, and that of its configuration.
    pub descriptors: [Vec<u8>; 2],
    /// Requests that it refused.
    pub refused: u32,
    /// Packets that came out of turn.
    pub out_of_turn: u32,
    /// It takes nothing from the serial line.
    pub deaf: bool,
    from_host: VecDeque<u8>,
    to_host: VecDeque<u8>,
}

impl UsbHost {
    /// Plugs the cable in, or begins anew: the host resets the bus, and what was on its way is lost.
    pub fn plug(&mut self) {
        *self = Self {
            plugged: true,
            ..Self::default()
        };
    }

    /// Pulls the cable.
    pub fn unplug(&mut self) {
        *self = Self {
            until_next: SLEEP,
            ..Self::default()
        };
    }

    /// The device is gone and comes back, as after a reset of the chip: the host begins anew.
    pub(crate) fn lose_device(&mut self) {
        if self.plugged {
            self.plug();
        }
    }

    /// Whether the serial line is open.
    pub fn is_open(&self) -> bool {
        self.plugged && self.step == usize::MAX
    }

    /// Sends bytes over the serial line.
    pub fn send(&mut self, bytes: &[u8]) {
        self.from_host.extend(bytes);
    }

    /// Takes at most so many bytes of the serial line.
    pub fn receive(&mut self, most: usize) -> Vec<u8> {
        self.to_host.drain(..most.min(self.to_host.len())).collect()
    }

    /// Lets time pass.
    pub(crate) fn advance(&mut self, usb: &mut Usb, cycles: u64) {
        self.until_next = self.until_next.saturating_sub(cycles);
        if self.until_next > 0 {
            return;
        }
        if !self.plugged {
            usb.suspend();
            self.until_next = u64::MAX;
            return;
        }
        self.until_next = TRANSACTION;
        if !usb.is_seen() {
            return;
        }
        match self.transfer.take() {
            Some(transfer) => self.go_on(usb, transfer),
            None if self.is_open() => self.move_bytes(usb),
            None => self.begin(usb),
        }
    }

    /// The next step of the beginning.
    fn begin(&mut self, usb: &mut Usb) {
        let total = self.descriptors[1].get(2).copied().unwrap_or(0);
        let (packet, bytes): ([u8; 8], &[u8]) = match self.step {
            0 | 2 => {
                usb.bus_reset();
                self.until_next = RESET;
                self.step += 1;
                return;
            }
            // A part of the device's descriptor, then its address.
            1 => ([0x80, 6, 0, 1, 0, 0, 8, 0], &[]),
            3 => ([0, 5, ADDRESS, 0, 0, 0, 0, 0], &[]),
            4 => ([0x80, 6, 0, 1, 0, 0, 18, 0], &[]),
            // The descriptor of a faster device, which this is not: refused.
            5 => ([0x80, 6, 0, 6, 0, 0, 10, 0], &[]),
            6 => ([0x80, 6, 0, 2, 0, 0, 9, 0], &[]),
            7 => ([0x80, 6, 0, 2, 0, 0, total, 0], &[]),
            // Its name, in English.
            8 => ([0x80, 6, 2, 3, 9, 4, 255, 0], &[]),
            9 => ([0, 9, 1, 0, 0, 0, 0, 0], &[]),
            // 115,200 symbols a second, one stop bit, no parity, 8 bits; ready.
            10 => ([0x21, 0x20, 0, 0, 0, 0, 7, 0], &[0, 0xc2, 1, 0, 0, 0, 8]),
            11 => ([0x21, 0x22, 3, 0, 0, 0, 0, 0], &[]),
            _ => {
                self.step = usize::MAX;
                return;
            }
        };
        self.transfer = Some(Transfer {
            packet,
            bytes: bytes.to_vec(),
            stage: Stage::Setup,
            answer: Vec::new(),
            data1: true,
        });
    }

    fn go_on(&mut self, usb: &mut Usb, mut transfer: Transfer) {
        let to_host = transfer.packet[0] & 0x80 != 0;
        let length = usize::from(u16::from_le_bytes([transfer.packet[6], transfer.packet[7]]));
        match transfer.stage {
            Stage::Setup => {
                if usb.setup(self.address, transfer.packet) == Answer::Ack {
                    transfer.stage = if length > 0 {
                        Stage::Data
                    } else {
                        Stage::Status
                    };
                }
            }
            Stage::Data if to_host => match usb.token_in(self.address, 0) {
                Answer::Data(bytes, data1) => {
                    self.out_of_turn += u32::from(data1 != transfer.data1);
                    transfer.data1 = !transfer.data1;
                    transfer.answer.extend(&bytes);
                    if bytes.len() < 64 || transfer.answer.len() == length {
                        transfer.stage = Stage::Status;
                    }
                }
                Answer::Stall => return self.refuse(),
                _ => {}
            },
            Stage::Data => match usb.token_out(self.address, 0, &transfer.bytes, true) {
                Answer::Ack => transfer.stage = Stage::Status,
                Answer::Stall => return self.refuse(),
                _ => {}
            },
            Stage::Status if to_host => {
                if usb.token_out(self.address, 0, &[], true) == Answer::Ack {
                    return self.end(transfer);
                }
            }
            Stage::Status => match usb.token_in(self.address, 0) {
                Answer::Data(bytes, data1) => {
                    self.out_of_turn += u32::from(!data1 || !bytes.is_empty());
                    return self.end(transfer);
                }
                Answer::Stall => return self.refuse(),
                _ => {}
            },
        }
        self.transfer = Some(transfer);
    }

    fn refuse(&mut self) {
        self.refused += 1;
        self.step += 1;
    }

    fn end(&mut self, transfer: Transfer) {
        match self.step {
            3 => self.address = ADDRESS,
            4 => self.descriptors[0] = transfer.answer,
            6 => self.descriptors[1] = transfer.answer,
            7 => {
                self.descriptors[1] = transfer.answer;
                self.line = self.find_line();
            }
            8 => {
                let halves = transfer.answer[2..].chunks_exact(2);
                let halves: Vec<u16> = halves
                    .map(|two| u16::from_le_bytes([two[0], two[1]]))
                    .collect();
                self.product = String::from_utf16_lossy(&halves);
            }
            _ => {}
        }
        self.step += 1;
    }

    /// The bulk endpoints of the interface for data of a serial line.
    fn find_line(&self) -> Option<[u8; 2]> {
        let mut rest = &self.descriptors[1][..];
        let mut is_data = false;
        let mut line = [None; 2];
        while let [length, kind, ..] = *rest {
            let (one, others) = rest.split_at_checked(usize::from(length))?;
            match kind {
                4 => is_data = one[5] == 0x0a,
                5 if is_data && one[3] & 3 == 2 => {
                    line[usize::from(one[2] & 0x80 == 0)] = Some(one[2] & 0xf);
                }
                _ => {}
            }
            rest = others;
        }
        let [to_host, from_host] = line;
        Some([to_host?, from_host?])
    }

    /// A transaction of the serial line, in turns one each way.
    fn move_bytes(&mut self, usb: &mut Usb) {
        let Some([to_host, from_host]) = self.line else {
            return;
        };
        self.listens = !self.listens;
        if self.listens || self.from_host.is_empty() {
            if self.deaf {
                return;
            }
            if let Answer::Data(bytes, data1) = usb.token_in(self.address, to_host) {
                if data1 == self.turns[0] {
                    self.turns[0] = !data1;
                    self.to_host.extend(bytes);
                } else {
                    self.out_of_turn += 1;
                }
            }
            return;
        }
        let count = self.from_host.len().min(64);
        let bytes: Vec<u8> = self.from_host.iter().take(count).copied().collect();
        if usb.token_out(self.address, from_host, &bytes, self.turns[1]) == Answer::Ack {
            self.turns[1] = !self.turns[1];
            self.from_host.drain(..count);
        }
    }
}
