//! Mistakes put into the linked images, and what the checker finds.

use std::path::Path;

use fivebar_bounds::image::Image;
use fivebar_bounds::instruction::{Flow, Mask, Stack};
use fivebar_bounds::program::Program;
use fivebar_bounds::stated::Stated;
use fivebar_bounds::timing::Measure;
use fivebar_bounds::{Fault, narrow, wide};

/// Images: where they are built, what people state of them, and the function that holds the tick of each.
pub(crate) struct Images {
    pub(crate) target: &'static str,
    pub(crate) script: &'static str,
    pub(crate) stated: &'static str,
    pub(crate) ticks: &'static [(&'static str, &'static str)],
}

impl Images {
    pub(crate) fn image(&self, name: &str) -> Image {
        let built = option_env!("CARGO_TARGET_DIR")
            .unwrap_or(concat!(env!("CARGO_MANIFEST_DIR"), "/../../target"));
        let path = Path::new(built)
            .join("firmware")
            .join(self.target)
            .join("firmware")
            .join(name);
        let file = std::fs::read(&path)
            .unwrap_or_else(|error| panic!("{}: {error}; run {}", path.display(), self.script));
        Image::read(&file).expect("an image")
    }

    pub(crate) fn faults(&self, image: &Image, function: &str) -> Vec<Fault> {
        let stated = Stated::read(self.stated).expect("statements");
        let address = image.named(function).expect("the function").address;
        let defects = Program::new(image, &stated).defects(address);
        defects.into_iter().map(|defect| defect.fault).collect()
    }

    /// Some instructions of 16 bits on the longest path of a function that do nothing of interest. None of them is the header
    /// of a loop: what is said of that loop covers every jump to its header, so also a seeded one.
    fn places(&self, image: &Image, function: &str) -> Vec<u32> {
        let stated = Stated::read(self.stated).expect("statements");
        let address = image.named(function).expect("the function").address;
        let mut program = Program::new(image, &stated);
        let path = program.longest_path(address, Measure::Instructions);
        assert!(path.len() > 100, "{function}: {} instructions", path.len());
        let headers = program.loop_headers(address);
        let is_plain = |place: u32| {
            let half = image.half(place).expect("code");
            let instruction = narrow::decode(place, half);
            half >> 11 < 0b11101
                && instruction.flow == Flow::Next
                && instruction.stack == Stack::Keep
        };
        let plain = path
            .iter()
            .map(|(place, _)| *place)
            .filter(|place| is_plain(*place) && !headers.contains(place));
        let places: Vec<u32> = plain.step_by(8).collect();
        assert!(places.len() >= 5, "{function}: {places:x?}");
        places
    }

    #[track_caller]
    pub(crate) fn every_seed_is_found(&self, code: u16, fault: Fault) {
        for &(name, function) in self.ticks {
            let image = self.image(name);
            assert_eq!(self.faults(&image, function), [], "{name}");
            for place in self.places(&image, function) {
                let seeded = image.clone().patched(place, &[code]);
                let found = self.faults(&seeded, function);
                assert!(found.contains(&fault), "{name}, {place:#x}: {found:?}");
            }
        }
    }

    /// The longest critical section of the main program [cycles where the code waits], and the faults.
    pub(crate) fn blocking(&self, image: &Image, main: &str) -> (u64, Vec<Fault>) {
        let stated = Stated::read(self.stated).expect("statements");
        let main = image.named(main).expect("the main program").address;
        let (sections, defects) = Program::new(image, &stated).sections(main);
        let longest = sections.iter().map(|section| section.longest[2]).max();
        let faults = defects.into_iter().map(|defect| defect.fault);
        (longest.unwrap_or(0), faults.collect())
    }

    /// The addresses of the instructions in a function that raise a mask, or restore one.
    pub(crate) fn masking(image: &Image, function: &str, mask: Mask) -> Vec<u32> {
        let function = image.named(function).expect("the function");
        let places = (function.address..function.end).step_by(2);
        let is_meant = |place: &u32| {
            let halves = [image.half(*place), image.half(place + 2)];
            let [Some(high), Some(low)] = halves else {
                return false;
            };
            high >> 4 == 0xf38
                && low & 0xff00 == 0x8800
                && wide::decode(*place, high, low).mask == mask
        };
        places.filter(is_meant).collect()
    }

    /// Each end of a critical section of the main program taken away.
    pub(crate) fn every_lost_end_is_found(&self, name: &str, main: &str, limit: u64) {
        let image = self.image(name);
        let (longest, faults) = self.blocking(&image, main);
        assert!(faults.is_empty() && longest > 100, "{longest}: {faults:?}");
        let ends = Self::masking(&image, main, Mask::Restore);
        assert!(ends.len() >= 5, "{ends:x?}");
        for place in ends {
            // Two NOPs in place of its end: it goes on, into others and into the loop of the main program.
            let seeded = image.clone().patched(place, &[0xbf00, 0xbf00]);
            let (now, faults) = self.blocking(&seeded, main);
            assert!(now > limit || !faults.is_empty(), "{place:#x}: {now}");
        }
    }

    /// A loop and an indirect call at the beginning of each.
    pub(crate) fn every_seed_in_a_section_is_found(&self, name: &str, main: &str) {
        let image = self.image(name);
        for place in Self::masking(&image, main, Mask::Raise) {
            // Behind MSR comes ISB, a wide instruction.
            for (code, fault) in [(0xd1fe, Fault::Loop), (0x4798, Fault::IndirectCall)] {
                let seeded = image.clone().patched(place + 4, &[code, 0xbf00]);
                let (_, faults) = self.blocking(&seeded, main);
                assert!(faults.contains(&fault), "{place:#x}: {faults:?}");
            }
        }
    }
}
