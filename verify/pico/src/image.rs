//! The program: the flash that its file describes.

use object::{Object, ObjectSymbol};
use std::fmt;
use std::path::Path;

/// Where the flash is read, and its size [bytes].
pub(crate) const FLASH: u32 = 0x1000_0000;
pub(crate) const FLASH_SIZE: usize = 4 * 1024 * 1024;

/// Why a file is no program for the chip.
#[derive(Debug)]
pub enum ImageError {
    /// The file cannot be read.
    Io(std::io::Error),
    /// It is no ELF file of 32 bits.
    Elf,
    /// A part of it is outside the flash.
    Outside(u32),
}

impl fmt::Display for ImageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io(error) => write!(f, "the image cannot be read: {error}"),
            Self::Elf => f.write_str("the image is no ELF file of 32 bits"),
            Self::Outside(address) => write!(f, "{address:#x} is outside the flash"),
        }
    }
}

impl std::error::Error for ImageError {}

/// A program.
pub struct Image {
    pub(crate) flash: Vec<u8>,
    symbols: Vec<(String, u32)>,
}

impl Image {
    /// Reads an ELF file.
    ///
    /// # Errors
    /// A file that is no program for this chip.
    pub fn read(path: &Path) -> Result<Self, ImageError> {
        let file = std::fs::read(path).map_err(ImageError::Io)?;
        let object::File::Elf32(elf) = object::File::parse(&*file).map_err(|_| ImageError::Elf)?
        else {
            return Err(ImageError::Elf);
        };
        let mut flash = vec![0xff; FLASH_SIZE];
        for segment in elf.elf_program_headers() {
            let little = object::Endianness::Little;
            let (address, size) = (segment.p_paddr.get(little), segment.p_filesz.get(little));
            if segment.p_type.get(little) != object::elf::PT_LOAD || size == 0 {
                continue;
            }
            let from = segment.p_offset.get(little) as usize;
            let bytes = file
                .get(from..from + size as usize)
                .ok_or(ImageError::Elf)?;
            let start = address.checked_sub(FLASH).map(|start| start as usize);
            let place = start.and_then(|start| flash.get_mut(start..start + bytes.len()));
            place
                .ok_or(ImageError::Outside(address))?
                .copy_from_slice(bytes);
        }
        let symbols = elf.symbols().filter_map(|symbol| {
            let name = symbol.name().ok()?;
            Some((name.to_owned(), symbol.address() as u32))
        });
        Ok(Self {
            flash,
            symbols: symbols.collect(),
        })
    }

    /// The address of the one symbol in whose name this is.
    pub fn symbol(&self, part: &str) -> Option<u32> {
        let mut found = self.symbols.iter().filter(|(name, _)| name.contains(part));
        let (_, address) = found.next()?;
        found.next().is_none().then_some(*address)
    }

    /// The flash with the program.
    pub fn flash(&self) -> &[u8] {
        &self.flash
    }
}
