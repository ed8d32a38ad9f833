//! A host at the other end of the USB cable: it finds the device, reads what it says of itself, opens its serial line, and moves
//! bytes both ways. It does one transaction in 60 µs, as a busy host with one device. It is as strict as the strictest hosts: it
//! takes no packet out of turn, and gives up a device that is silent or slow.

use crate::usb::{Answer, Usb};
use std::collections::VecDeque;

/// Cycles of a transaction, of the quiet after a reset of the bus, and of the quiet behind which a device without a host sleeps.
const TRANSACTION: u64 = 9_000;
const RESET: u64 = 1_500_000;
const SLEEP: u64 = 450_000;
/// Cycles in which a device takes its new address: 2 ms.
const NEW_ADDRESS: u64 = 300_000;
/// Transactions of a control transfer at most: 50 ms.
const MOST_TRANSACTIONS: u32 = 833;
/// Tokens in a row without an answer, behind which a device is lost.
const MOST_SILENT: u32 = 3;
/// Bytes of a packet, and bytes that the host asks of the serial line at a time: it sees them when all have come, or behind a packet
/// that is not full.
const PACKET: usize = 64;
const ASKED: usize = 4096;
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
    transactions: u32,
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
    /// Packets that came out of turn, which it did not take.
    pub out_of_turn: u32,
    /// Why it has given the device up.
    pub failure: Option<&'static str>,
    /// Tokens in a row without an answer.
    silent: u32,
    /// It takes nothing from the serial line.
    pub deaf: bool,
    from_host: VecDeque<u8>,
    /// Bytes that have come of those asked for, and those that the host sees.
    asked: Vec<u8>,
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
        self.plugged && self.step == usize::MAX && self.failure.is_none()
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
        if !usb.is_seen() || self.failure.is_some() {
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
            transactions: 0,
        });
    }

    fn fail(&mut self, why: &'static str) {
        self.failure = Some(why);
    }

    /// What the device answers; too many tokens without an answer are a failure.
    fn answered(&mut self, answer: Answer) -> Answer {
        self.silent = if answer == Answer::None {
            self.silent + 1
        } else {
            0
        };
        if self.silent >= MOST_SILENT {
            self.fail("no device answers at the address");
        }
        answer
    }

    /// The next transaction of a control transfer.
    fn go_on(&mut self, usb: &mut Usb, mut transfer: Transfer) {
        transfer.transactions += 1;
        if transfer.transactions > MOST_TRANSACTIONS {
            return self.fail("a control transfer takes more than 50 ms");
        }
        let to_host = transfer.packet[0] & 0x80 != 0;
        let has_data = transfer.packet[6..] != [0, 0];
        let answer = match (transfer.stage, to_host) {
            (Stage::Setup, _) => usb.setup(self.address, transfer.packet),
            (Stage::Data, true) | (Stage::Status, false) => usb.token_in(self.address, 0),
            (Stage::Data, false) => usb.token_out(self.address, 0, &transfer.bytes, true),
            (Stage::Status, true) => usb.token_out(self.address, 0, &[], true),
        };
        match (self.answered(answer), transfer.stage) {
            (Answer::Stall, _) => return self.refuse(),
            (Answer::None | Answer::Nak, _) => {}
            // Out of turn: the host takes it for one that it has, and for what it waits, it waits on.
            (Answer::Data(_, data1), _) if data1 != transfer.data1 => self.out_of_turn += 1,
            (Answer::Data(bytes, _), Stage::Data) => self.take(&mut transfer, &bytes),
            (Answer::Data(bytes, _), _) if !bytes.is_empty() => {
                return self.fail("bytes end a control transfer");
            }
            (Answer::Data(..), _) | (Answer::Ack, Stage::Status) => return self.end(transfer),
            (Answer::Ack, Stage::Setup) if has_data => transfer.stage = Stage::Data,
            (Answer::Ack, _) => transfer.stage = Stage::Status,
        }
        self.transfer = Some(transfer);
    }

    /// Takes a packet of a control transfer. One that is not full ends the bytes before as many as were asked for have come.
    fn take(&mut self, transfer: &mut Transfer, bytes: &[u8]) {
        let length = usize::from(u16::from_le_bytes([transfer.packet[6], transfer.packet[7]]));
        transfer.data1 = !transfer.data1;
        transfer.answer.extend(bytes);
        if bytes.len() > PACKET || transfer.answer.len() > length {
            self.fail("more bytes come than the host asked for");
        }
        if bytes.len() < PACKET || transfer.answer.len() == length {
            transfer.stage = Stage::Status;
        }
    }

    fn refuse(&mut self) {
        self.refused += 1;
        self.step += 1;
    }

    fn end(&mut self, transfer: Transfer) {
        match self.step {
            3 => {
                self.address = ADDRESS;
                self.until_next = NEW_ADDRESS;
            }
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
            let answer = usb.token_in(self.address, to_host);
            if let Answer::Data(bytes, data1) = self.answered(answer) {
                self.take_bytes(&bytes, data1);
            }
            return;
        }
        let count = self.from_host.len().min(PACKET);
        let bytes: Vec<u8> = self.from_host.iter().take(count).copied().collect();
        let answer = usb.token_out(self.address, from_host, &bytes, self.turns[1]);
        if self.answered(answer) == Answer::Ack {
            self.turns[1] = !self.turns[1];
            self.from_host.drain(..count);
        }
    }

    /// Takes a packet of the serial line.
    fn take_bytes(&mut self, bytes: &[u8], data1: bool) {
        if data1 != self.turns[0] {
            self.out_of_turn += 1;
            return;
        }
        self.turns[0] = !data1;
        self.asked.extend(bytes);
        if bytes.len() < PACKET || self.asked.len() >= ASKED {
            self.to_host.extend(self.asked.drain(..));
        }
    }
}
