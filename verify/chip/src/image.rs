//! The program: its bytes, symbols and source lines.

use gimli::{EndianSlice, LittleEndian};
use object::{Object, ObjectSection, ObjectSymbol};
use std::collections::HashMap;
use std::fmt;
use std::path::Path;

/// Address and size of the part of the flash that holds the program.
pub(crate) const CODE: u32 = 0x0800_0000;
pub(crate) const CODE_SIZE: usize = 512 * 1024;

/// Why a file is no program for the chip.
#[derive(Debug)]
pub enum ImageError {
    /// The file cannot be read.
    Io(std::io::Error),
    /// It is no ELF file.
    Elf(object::Error),
    /// A part of it is outside the program's flash.
    Outside(u64),
}

impl fmt::Display for ImageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io(error) => write!(f, "the image cannot be read: {error}"),
            Self::Elf(error) => write!(f, "the image is no ELF file: {error}"),
            Self::Outside(address) => write!(f, "{address:#x} is outside the program's flash"),
        }
    }
}

impl std::error::Error for ImageError {}

/// A program.
pub struct Image {
    /// The contents of the program's flash.
    pub(crate) code: Vec<u8>,
    /// Bytes of the file that are machine code.
    pub text: std::ops::Range<u32>,
    symbols: HashMap<String, (u32, u32)>,
    /// Functions by address.
    functions: Vec<(u32, u32, String)>,
    file: Vec<u8>,
}

impl Image {
    /// Reads an ELF file.
    ///
    /// # Errors
    /// A file that is no program for this chip.
    pub fn read(path: &Path) -> Result<Self, ImageError> {
        let file = std::fs::read(path).map_err(ImageError::Io)?;
        let elf = object::File::parse(&*file).map_err(ImageError::Elf)?;
        let mut code = vec![0xff; CODE_SIZE];
        // Segments lie at the addresses where they are loaded.
        let object::File::Elf32(header) = &elf else {
            return Err(ImageError::Outside(0));
        };
        for segment in header.elf_program_headers() {
            let little = object::Endianness::Little;
            let (address, size) = (segment.p_paddr.get(little), segment.p_filesz.get(little));
            if segment.p_type.get(little) != object::elf::PT_LOAD || size == 0 {
                continue;
            }
            let start = address.checked_sub(CODE).map(|start| start as usize);
            let from = segment.p_offset.get(little) as usize;
            let bytes = file.get(from..from + size as usize);
            match start.zip(bytes) {
                Some((start, bytes)) if start + bytes.len() <= CODE_SIZE => {
                    code[start..start + bytes.len()].copy_from_slice(bytes);
                }
                _ => return Err(ImageError::Outside(address.into())),
            }
        }
        let mut symbols = HashMap::new();
        let mut functions = Vec::new();
        for symbol in elf.symbols() {
            let Ok(name) = symbol.name() else { continue };
            let place = (symbol.address() as u32, symbol.size() as u32);
            symbols.insert(name.to_owned(), place);
            if symbol.kind() == object::SymbolKind::Text && place.1 > 0 {
                functions.push((place.0 & !1, place.1, name.to_owned()));
            }
        }
        functions.sort();
        let text = elf.section_by_name(".text").map_or(0..0, |text| {
            let start = text.address() as u32;
            start..start + text.size() as u32
        });
        drop(elf);
        Ok(Self {
            code,
            text,
            symbols,
            functions,
            file,
        })
    }

    /// Address and size of the symbol whose name contains `part`; the shortest such name.
    pub fn symbol(&self, part: &str) -> Option<(u32, u32)> {
        let matching = self.symbols.iter().filter(|(name, _)| name.contains(part));
        matching
            .min_by_key(|(name, _)| name.len())
            .map(|(_, &place)| place)
    }

    /// Functions of the program: address, size, name.
    pub fn functions(&self) -> &[(u32, u32, String)] {
        &self.functions
    }

    /// The function at an address.
    pub fn function(&self, address: u32) -> Option<&str> {
        let after = self
            .functions
            .partition_point(|&(start, ..)| start <= address);
        let (start, size, name) = self.functions.get(after.checked_sub(1)?)?;
        (address < start + size).then_some(name)
    }

    /// The source line of an address, as `file:line`.
    pub fn line(&self, address: u32) -> Option<String> {
        let elf = object::File::parse(&*self.file).ok()?;
        let section = |id: gimli::SectionId| {
            let data = elf
                .section_by_name(id.name())
                .and_then(|section| section.data().ok());
            Ok::<_, gimli::Error>(EndianSlice::new(data.unwrap_or(&[]), LittleEndian))
        };
        let dwarf = gimli::Dwarf::load(section).ok()?;
        let context = addr2line::Context::from_dwarf(dwarf).ok()?;
        let place = context.find_location(address.into()).ok()??;
        Some(format!("{}:{}", place.file?, place.line.unwrap_or(0)))
    }
}
