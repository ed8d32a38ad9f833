//! Figures of what ran: code, length of the tick, stack.

use crate::image::{CODE, CODE_SIZE, Image};
use crate::trace::TICK;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

/// The variable that names the folder for the figures of every chip.
const FOLDER: &str = "CHIP_FIGURES";
/// The pattern of the stack that was never used, and its size.
const PAINT: [u8; 4] = [0xcc; 4];
const STACK: usize = 16 * 1024;

/// What a chip counts while it runs.
#[derive(Clone, Debug)]
pub struct Figures {
    /// Instructions of a block by the half-word of the flash where it begins; 0: it never ran.
    instructions: Vec<u16>,
    /// Size of that block [bytes].
    sizes: Vec<u16>,
    code: Vec<u8>,
    count: u64,
    tick_began: Option<u64>,
    /// Whether a tick has run since the reset: then the whole stack has been painted.
    ticking: bool,
    ticks: u64,
    in_ticks: u64,
    longest_tick: u64,
    stack: usize,
    pub(crate) stack_is_forced: bool,
}

/// The figures of many chips together.
#[derive(Clone, Debug, Default)]
pub struct Summary {
    /// Which half-words of the flash ran.
    pub ran: Vec<bool>,
    /// Ticks that ran to their end.
    pub ticks: u64,
    /// Instructions in all of them, with the interrupts on top.
    pub in_ticks: u64,
    /// Instructions in the longest one.
    pub longest_tick: u64,
    /// The most stack in use [bytes].
    pub stack: u64,
}

impl Figures {
    pub(crate) fn new(image: &Image) -> Self {
        Self {
            instructions: vec![0; CODE_SIZE / 2],
            sizes: vec![0; CODE_SIZE / 2],
            code: image.code.clone(),
            count: 0,
            tick_began: None,
            ticking: false,
            ticks: 0,
            in_ticks: 0,
            longest_tick: 0,
            stack: 0,
            stack_is_forced: false,
        }
    }

    /// A block of code runs.
    #[inline]
    pub(crate) fn block(&mut self, address: u32, size: u32) {
        let place = address.wrapping_sub(CODE) as usize / 2;
        let Some(&known) = self.instructions.get(place) else {
            return;
        };
        if known != 0 && u32::from(self.sizes[place]) == size {
            self.count += u64::from(known);
        } else {
            self.first_time(place, size);
        }
    }

    #[cold]
    fn first_time(&mut self, place: usize, size: u32) {
        let (mut at, end) = (2 * place, 2 * place + size as usize);
        let mut count = 0;
        while at < end {
            // An instruction of 32 bits begins with 0b11101, 0b11110 or 0b11111.
            let wide = self.code.get(at + 1).is_some_and(|&high| high >= 0xe8);
            at += if wide { 4 } else { 2 };
            count += 1;
        }
        self.instructions[place] = count;
        self.sizes[place] = self.sizes[place].max(size as u16);
        self.count += u64::from(count);
    }

    /// The core starts anew.
    pub(crate) fn restart(&mut self) {
        self.tick_began = None;
        self.ticking = false;
    }

    pub(crate) fn enter(&mut self, exception: u32) {
        if exception == TICK {
            self.tick_began = Some(self.count);
            self.ticking = true;
        }
    }

    pub(crate) fn leave(&mut self, exception: Option<&u32>) {
        if exception == Some(&TICK)
            && let Some(began) = self.tick_began.take()
        {
            let length = self.count - began;
            self.ticks += 1;
            self.in_ticks += length;
            self.longest_tick = self.longest_tick.max(length);
        }
    }

    /// Looks how much of the stack has been used.
    pub(crate) fn look_at_stack(&mut self, ram: &[u8]) {
        let stack = ram.get(..STACK).unwrap_or(&[]);
        let (words, _) = stack.as_chunks::<4>();
        let unused = words.iter().take_while(|&&word| word == PAINT).count();
        if !self.stack_is_forced && self.ticking {
            self.stack = STACK - 4 * unused;
        }
    }

    /// Stores the figures, if the variable `CHIP_FIGURES` names a folder for them.
    pub(crate) fn store(&self) {
        static STORED: AtomicU32 = AtomicU32::new(0);
        let Some(folder) = std::env::var_os(FOLDER).map(PathBuf::from) else {
            return;
        };
        let number = STORED.fetch_add(1, Ordering::Relaxed);
        let head = [
            self.ticks,
            self.in_ticks,
            self.longest_tick,
            self.stack as u64,
        ];
        let mut bytes: Vec<u8> = head
            .iter()
            .flat_map(|figure| figure.to_le_bytes())
            .collect();
        bytes.extend(self.sizes.iter().flat_map(|size| size.to_le_bytes()));
        let name = format!("{}-{number}", std::process::id());
        if let Err(error) = std::fs::write(folder.join(&name), bytes) {
            eprintln!("{name} is not stored: {error}");
        }
    }
}

impl Summary {
    /// The figures in a folder.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn read(folder: &Path) -> std::io::Result<Self> {
        let mut summary = Self {
            ran: vec![false; CODE_SIZE / 2],
            ..Self::default()
        };
        for entry in std::fs::read_dir(folder)? {
            summary.add(&std::fs::read(entry?.path())?);
        }
        Ok(summary)
    }

    fn add(&mut self, bytes: &[u8]) {
        let (head, sizes) = bytes.split_at(bytes.len().min(32));
        let (figures, _) = head.as_chunks::<8>();
        let &[ticks, in_ticks, longest, stack] = figures else {
            return;
        };
        self.ticks += u64::from_le_bytes(ticks);
        self.in_ticks += u64::from_le_bytes(in_ticks);
        self.longest_tick = self.longest_tick.max(u64::from_le_bytes(longest));
        self.stack = self.stack.max(u64::from_le_bytes(stack));
        for (place, size) in sizes.as_chunks::<2>().0.iter().enumerate() {
            let half_words = usize::from(u16::from_le_bytes(*size)) / 2;
            let end = (place + half_words).min(self.ran.len());
            self.ran[place..end].fill(true);
        }
    }

    /// How many bytes of a range of addresses ran.
    pub fn ran_in(&self, range: std::ops::Range<u32>) -> u32 {
        let place = |address: u32| (address.saturating_sub(CODE) / 2) as usize;
        let ran = &self.ran[place(range.start)..place(range.end)];
        2 * ran.iter().filter(|&&ran| ran).count() as u32
    }
}
