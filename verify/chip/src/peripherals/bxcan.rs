//! CAN1, the bxCAN: three mailboxes, two FIFOs, filters of lists, and the errors that take it off the bus.

use crate::register::Register;
use crate::time::{MICROSECOND, NEVER, Time};
use crate::violation::{Access, refuse, refuse_read};
use fivebar_firmware::drives::can::Frame;
use fivebar_plant::BusEvent;
use std::collections::VecDeque;

/// A bit of the bus, and by how much of it the controller's may differ.
const BUS_BIT: Time = MICROSECOND;
const TOLERANCE: f64 = 0.005;
/// Recessive bits before it joins, and before it returns after a bus off.
const JOIN: u64 = 11;
const RETURN: u64 = 128 * 11;
/// How long it takes to enter or to leave a mode [APB1 clocks].
const MODE_CLOCKS: u64 = 8;
/// Frames that a FIFO holds.
const DEPTH: usize = 3;

const INRQ: u32 = 0;
const SLEEP: u32 = 1;
const TXFP: u32 = 2;
const ABOM: u32 = 6;
const TXRQ: u32 = 1;
const RTR: u32 = 1 << 1;
const IDE: u32 = 1 << 2;
/// RQCP, TXOK, ALST, TERR of the first mailbox; those of the others are 8 and 16 bits higher.
const FLAGS: u32 = 0xf;
const RQCP: u32 = 1;
const TXOK: u32 = 1 << 1;
const TERR: u32 = 1 << 3;
const ABRQ: u32 = 1 << 7;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mode {
    Asleep,
    Initialises,
    /// It waits for recessive bits until then.
    Joins(Time),
    OnBus,
    /// Too many errors; with ABOM it returns then.
    Off(Time),
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Stage {
    #[default]
    Empty,
    /// It waits, since so many requests.
    Waits(u64),
    /// It is on its way, and goes back to wait if it fails unless it is to be aborted.
    OnItsWay { asked: u64, aborted: bool },
}

#[derive(Clone, Copy, Debug, Default)]
struct Mailbox {
    /// TIR, TDTR, TDLR, TDHR.
    words: [u32; 4],
    stage: Stage,
    flags: u32,
}

#[derive(Clone, Debug, Default)]
struct Fifo {
    frames: VecDeque<[u32; 4]>,
    full: bool,
    overrun: bool,
}

/// What has happened to the controller on the bus.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CanStatistics {
    /// Frames that have arrived.
    pub sent: u32,
    /// Requests that were taken back.
    pub aborted: u32,
    /// Frames that were hit by errors.
    pub failed: u32,
    /// Frames that passed the filters, and those that did not.
    pub received: u32,
    /// Frames that did not pass the filters.
    pub filtered: u32,
    /// Frames lost because a FIFO was full.
    pub overrun: u32,
}

/// The controller.
#[derive(Clone, Debug)]
pub(crate) struct BxCan {
    mcr: Register,
    ier: Register,
    btr: Register,
    fmr: Register,
    fm1r: Register,
    fs1r: Register,
    ffa1r: Register,
    fa1r: Register,
    banks: [[u32; 2]; 28],
    mailboxes: [Mailbox; 3],
    fifos: [Fifo; 2],
    mode: Mode,
    /// A mode that begins then.
    next: Option<(Time, Mode)>,
    errors: [u32; 2],
    /// Requests to send so far.
    asked: u64,
    /// Period of APB1.
    clock: Time,
    connected: bool,
    /// The mailbox whose frame the bus knows of.
    offered: Option<usize>,
    told: Option<Frame>,
    pub(crate) statistics: CanStatistics,
}

impl BxCan {
    pub(crate) fn new() -> Self {
        Self {
            mcr: Register::new("CAN_MCR", 0x0001_0002, 0x0001_0047, 0),
            ier: Register::new("CAN_IER", 0, 1, 0),
            btr: Register::new("CAN_BTR", 0x0123_0000, 0x037f_03ff, 0),
            fmr: Register::new("CAN_FMR", 0x2a1c_0e01, 0x0000_3f01, 0),
            fm1r: Register::new("CAN_FM1R", 0, 0x0fff_ffff, 0),
            fs1r: Register::new("CAN_FS1R", 0, 0x0fff_ffff, 0),
            ffa1r: Register::new("CAN_FFA1R", 0, 0x0fff_ffff, 0),
            fa1r: Register::new("CAN_FA1R", 0, 0x0fff_ffff, 0),
            banks: [[0; 2]; 28],
            mailboxes: [Mailbox::default(); 3],
            fifos: Default::default(),
            mode: Mode::Asleep,
            next: None,
            errors: [0; 2],
            asked: 0,
            clock: 1,
            connected: false,
            offered: None,
            told: None,
            statistics: CanStatistics::default(),
        }
    }

    /// A reset by RCC. The filters are reset with the rest.
    pub(crate) fn reset(&mut self) {
        let fresh = Self::new();
        *self = Self {
            clock: self.clock,
            told: self.told,
            statistics: self.statistics,
            ..fresh
        };
    }

    pub(crate) fn set_clock(&mut self, bus: Time) {
        self.clock = bus;
    }

    /// Whether both pins are the controller's.
    pub(crate) fn connect(&mut self, connected: bool) {
        self.connected = connected;
    }

    /// The time of a bit as programmed.
    fn bit(&self) -> Time {
        let [first, second] = [self.btr.field(16, 4), self.btr.field(20, 3)];
        let quanta = 1 + (first + 1) + (second + 1);
        self.clock * u64::from(quanta) * u64::from(self.btr.field(0, 10) + 1)
    }

    /// Whether it understands what is on the bus.
    fn understands(&self) -> bool {
        let off = self.bit() as f64 / BUS_BIT as f64 - 1.0;
        self.connected && off.abs() < TOLERANCE
    }

    pub(crate) fn due(&self) -> Time {
        let next = self.next.map_or(NEVER, |(at, _)| at);
        match self.mode {
            Mode::Joins(at) => at.min(next),
            Mode::Off(at) if self.mcr.bit(ABOM) => at.min(next),
            _ => next,
        }
    }

    pub(crate) fn advance(&mut self, now: Time) {
        if let Some((at, mode)) = self.next
            && at <= now
        {
            (self.mode, self.next) = (mode, None);
        }
        match self.mode {
            Mode::Joins(at) if at <= now => {
                self.mode = match self.understands() {
                    true => Mode::OnBus,
                    // It never sees 11 recessive bits.
                    false => Mode::Joins(NEVER),
                };
            }
            Mode::Off(at) if at <= now => {
                self.mode = Mode::OnBus;
                self.errors = [0; 2];
            }
            _ => {}
        }
    }

    /// Follows what has happened on the bus.
    pub(crate) fn follow(&mut self, event: &BusEvent, now: Time) {
        let on_bus = self.mode == Mode::OnBus;
        match *event {
            BusEvent::Received(frame) if on_bus => {
                self.errors[1] = self.errors[1].saturating_sub(1);
                self.receive(&frame);
            }
            BusEvent::Received(_) => {}
            BusEvent::Began => {
                let mailbox = self.offered.map(|offered| &mut self.mailboxes[offered]);
                if let Some(mailbox) = mailbox
                    && let Stage::Waits(asked) = mailbox.stage
                {
                    let aborted = false;
                    mailbox.stage = Stage::OnItsWay { asked, aborted };
                }
            }
            BusEvent::Sent => {
                self.errors[0] = self.errors[0].saturating_sub(1);
                self.statistics.sent += 1;
                self.end(|mailbox| {
                    mailbox.stage = Stage::Empty;
                    mailbox.flags = RQCP | TXOK;
                });
            }
            BusEvent::Failed { acknowledged } => {
                // A passive controller that is alone does not count that nobody acknowledges.
                if acknowledged || self.errors[0] < 128 {
                    self.errors[0] += 8;
                }
                self.statistics.failed += 1;
                self.end(|mailbox| {
                    if let Stage::OnItsWay { asked, aborted } = mailbox.stage {
                        mailbox.flags |= TERR;
                        mailbox.stage = Stage::Waits(asked);
                        if aborted {
                            mailbox.stage = Stage::Empty;
                            mailbox.flags |= RQCP;
                        }
                    }
                });
                if self.errors[0] > 255 {
                    self.mode = Mode::Off(now + RETURN * self.bit());
                }
            }
        }
    }

    /// The frame on its way has ended.
    fn end(&mut self, change: impl Fn(&mut Mailbox)) {
        let on_its_way = |it: &&mut Mailbox| matches!(it.stage, Stage::OnItsWay { .. });
        if let Some(mailbox) = self.mailboxes.iter_mut().find(on_its_way) {
            change(mailbox);
        }
    }

    fn receive(&mut self, frame: &Frame) {
        let remote = frame.data.is_none();
        let wanted = u32::from(frame.id) << 5 | u32::from(remote) << 4;
        let mut numbers = [0; 2];
        for bank in 0..28 {
            let (fifo, active) = (self.ffa1r.bit(bank), self.fa1r.bit(bank));
            for entry in self.banks[bank as usize]
                .iter()
                .flat_map(|word| [word & 0xffff, word >> 16])
            {
                if active && self.fmr.value & 1 == 0 && entry == wanted {
                    return self.store(fifo.into(), numbers[usize::from(fifo)], frame);
                }
                numbers[usize::from(fifo)] += 1;
            }
        }
        self.statistics.filtered += 1;
    }

    fn store(&mut self, fifo: usize, filter: u32, frame: &Frame) {
        self.statistics.received += 1;
        let id = u32::from(frame.id) << 21;
        let [low, high] = match frame.data {
            Some([a, b, c, d, e, f, g, h]) => [
                u32::from_le_bytes([a, b, c, d]),
                u32::from_le_bytes([e, f, g, h]),
            ],
            // Whatever was there.
            None => [0xdead_beef; 2],
        };
        let id = if frame.data.is_none() { id | RTR } else { id };
        let fifo = &mut self.fifos[fifo];
        if fifo.frames.len() == DEPTH {
            fifo.frames.pop_back();
            fifo.overrun = true;
            self.statistics.overrun += 1;
        }
        fifo.frames.push_back([id, filter << 8 | 8, low, high]);
        fifo.full = fifo.frames.len() == DEPTH;
    }

    /// The mailbox that sends next.
    fn sends_next(&self) -> Option<usize> {
        let busy = |it: &Mailbox| matches!(it.stage, Stage::OnItsWay { .. });
        if self.mode != Mode::OnBus || self.mailboxes.iter().any(busy) {
            return None;
        }
        let waiting = self.mailboxes.iter().enumerate();
        let waiting = waiting.filter_map(|(place, it)| match it.stage {
            Stage::Waits(asked) if self.mcr.bit(TXFP) => Some((asked, place)),
            Stage::Waits(_) => Some((u64::from(it.words[0] >> 21), place)),
            _ => None,
        });
        waiting.min().map(|(_, place)| place)
    }

    /// What it offers to the bus, if that has changed.
    pub(crate) fn changed_offer(&mut self) -> Option<Option<Frame>> {
        self.offered = self.sends_next();
        let frame = self.offered.map(|place| {
            let [id, _, low, high] = self.mailboxes[place].words;
            let [[a, b, c, d], [e, f, g, h]] = [low, high].map(u32::to_le_bytes);
            Frame {
                id: (id >> 21) as u16,
                data: (id & RTR == 0).then_some([a, b, c, d, e, f, g, h]),
            }
        });
        (frame != self.told).then(|| {
            self.told = frame;
            frame
        })
    }

    pub(crate) fn interrupt(&self) -> bool {
        self.ier.bit(0) && self.mailboxes.iter().any(|it| it.flags & RQCP != 0)
    }

    pub(crate) fn read(&mut self, offset: u32) -> Access<u32> {
        Ok(match offset {
            0x00 => self.mcr.value,
            0x04 => match self.mode {
                Mode::Asleep => 0xc02,
                Mode::Initialises => 0xc01,
                // INAK stays until it has joined.
                Mode::Joins(_) => 0xc01,
                _ => 0xc00,
            },
            0x08 => self.status(),
            0x0c | 0x10 => {
                let fifo = &self.fifos[((offset - 0x0c) / 4) as usize];
                let held = fifo.frames.len() as u32;
                held | u32::from(fifo.full) << 3 | u32::from(fifo.overrun) << 4
            }
            0x14 => self.ier.value,
            0x18 => {
                let [sent, received] = self.errors;
                let off = matches!(self.mode, Mode::Off(_));
                let most = sent.max(received);
                let flags =
                    u32::from(most >= 96) | u32::from(most > 127) << 1 | u32::from(off) << 2;
                flags | sent.min(255) << 16 | received.min(255) << 24
            }
            0x1c => self.btr.value,
            0x180..0x1b0 => {
                let place = (offset - 0x180) / 16;
                let mailbox = &self.mailboxes[place as usize];
                let waits = mailbox.stage != Stage::Empty;
                match offset / 4 % 4 {
                    0 => mailbox.words[0] & !TXRQ | u32::from(waits),
                    word => mailbox.words[word as usize],
                }
            }
            0x1b0..0x1d0 => {
                let fifo = &self.fifos[((offset - 0x1b0) / 16) as usize];
                let Some(words) = fifo.frames.front() else {
                    return refuse_read("CAN_RxR", "the FIFO is empty");
                };
                words[(offset / 4 % 4) as usize]
            }
            0x200 => self.fmr.value,
            0x204 => self.fm1r.value,
            0x20c => self.fs1r.value,
            0x214 => self.ffa1r.value,
            0x21c => self.fa1r.value,
            0x240..0x320 => {
                let word = ((offset - 0x240) / 4) as usize;
                self.banks[word / 2][word % 2]
            }
            _ => 0,
        })
    }

    /// TSR: the flags of each mailbox, the number of a free one, and which are free.
    fn status(&self) -> u32 {
        let mut status = 0;
        let mut free = None;
        for (place, mailbox) in (0..).zip(&self.mailboxes) {
            status |= mailbox.flags << (8 * place);
            if mailbox.stage == Stage::Empty {
                status |= 1 << (26 + place);
                free.get_or_insert(place);
            }
        }
        status | free.unwrap_or(0) << 24
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, now: Time) -> Access<()> {
        match offset {
            0x00 => self.set_mode(value, now),
            0x08 => {
                self.set_status(value);
                Ok(())
            }
            0x0c | 0x10 => self.release(((offset - 0x0c) / 4) as usize, value),
            0x14 => self.ier.write(value),
            0x1c if self.mode != Mode::Initialises => {
                refuse("CAN_BTR", value, "it is written in initialisation only")
            }
            0x1c => {
                self.btr.write(value)?;
                let jump = self.btr.field(24, 2);
                match jump > self.btr.field(20, 3) {
                    true => refuse(
                        "CAN_BTR",
                        value,
                        "the jump is longer than the second segment",
                    ),
                    false => Ok(()),
                }
            }
            0x180..0x1b0 => self.fill(offset - 0x180, value),
            0x200 => {
                self.fmr.write(value)?;
                let lists = self.fa1r.value & !(self.fm1r.value & !self.fs1r.value);
                match self.fmr.value & 1 == 0 && lists != 0 {
                    true => refuse("CAN_FMR", value, "only lists of 16 bits are simulated"),
                    false => Ok(()),
                }
            }
            0x21c => self.fa1r.write(value),
            0x204 | 0x20c | 0x214 | 0x240..0x320 if self.fmr.value & 1 == 0 => {
                refuse("CAN filter", value, "it changes while filters are in use")
            }
            0x204 => self.fm1r.write(value),
            0x20c => self.fs1r.write(value),
            0x214 => self.ffa1r.write(value),
            0x240..0x320 => {
                let word = ((offset - 0x240) / 4) as usize;
                self.banks[word / 2][word % 2] = value;
                Ok(())
            }
            _ => refuse("CAN", value, format!("offset {offset:#x} is not simulated")),
        }
    }

    fn set_mode(&mut self, value: u32, now: Time) -> Access<()> {
        self.mcr.write(value)?;
        let later = now + MODE_CLOCKS * self.clock;
        let wanted = match (self.mcr.bit(INRQ), self.mcr.bit(SLEEP)) {
            (true, true) => {
                return refuse("CAN_MCR", value, "initialisation and sleep at once");
            }
            (true, false) => Mode::Initialises,
            (false, true) => Mode::Asleep,
            (false, false) if matches!(self.mode, Mode::Asleep | Mode::Initialises) => {
                Mode::Joins(later + JOIN * self.bit())
            }
            (false, false) => return Ok(()),
        };
        self.next = (wanted != self.mode).then_some((later, wanted));
        Ok(())
    }

    fn set_status(&mut self, value: u32) {
        for (place, mailbox) in (0..).zip(&mut self.mailboxes) {
            let bits = value >> (8 * place);
            if bits & RQCP != 0 {
                mailbox.flags = 0;
            }
            mailbox.flags &= !(bits & FLAGS);
            if bits & ABRQ == 0 {
                continue;
            }
            match &mut mailbox.stage {
                Stage::Empty => {}
                Stage::Waits(_) => {
                    mailbox.stage = Stage::Empty;
                    mailbox.flags = RQCP;
                    self.statistics.aborted += 1;
                }
                Stage::OnItsWay { aborted, .. } => *aborted = true,
            }
        }
    }

    fn release(&mut self, fifo: usize, value: u32) -> Access<()> {
        let fifo = &mut self.fifos[fifo];
        if value & !0x38 != 0 {
            return refuse("CAN_RFxR", value, "reserved bits");
        }
        fifo.full &= value & 1 << 3 == 0;
        fifo.overrun &= value & 1 << 4 == 0;
        if value & 1 << 5 != 0 && fifo.frames.pop_front().is_none() {
            return refuse("CAN_RFxR", value, "an empty FIFO is released");
        }
        Ok(())
    }

    fn fill(&mut self, offset: u32, value: u32) -> Access<()> {
        let mailbox = &mut self.mailboxes[(offset / 16) as usize];
        if mailbox.stage != Stage::Empty {
            return refuse("CAN_TxR", value, "the mailbox is not empty");
        }
        let word = (offset / 4 % 4) as usize;
        match word {
            0 if value & IDE != 0 => {
                return refuse("CAN_TIxR", value, "long identifiers are not simulated");
            }
            1 if value & 0xf > 8 || value & !0xf != 0 => {
                return refuse("CAN_TDTxR", value, "not a length alone");
            }
            _ => {}
        }
        mailbox.words[word] = value;
        if word == 0 && value & TXRQ != 0 {
            self.asked += 1;
            mailbox.stage = Stage::Waits(self.asked);
            mailbox.flags = 0;
        }
        Ok(())
    }
}
