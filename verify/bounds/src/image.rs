//! A linked image: its code, its functions and its vector table.

use std::collections::BTreeMap;

use crate::cores::{Core, M4_IN_FLASH, M33_IN_SRAM};
use object::{Object, ObjectSection, ObjectSymbol, SectionKind, SymbolKind};

/// The machine code of a program, with the names and the places of its functions.
#[derive(Clone, Debug)]
pub struct Image {
    /// The core that runs it: what begins in the SRAM is for a Cortex-M33 there.
    pub core: Core,
    /// Contents of the sections of code, by address.
    code: Vec<(u32, Vec<u8>)>,
    /// By address.
    functions: BTreeMap<u32, Function>,
    /// Where code (false) and data among the code (true) begin.
    data: BTreeMap<u32, bool>,
    /// Addresses of the exception handlers, by number; 1 is the reset.
    vectors: Vec<(u32, u32)>,
    /// Beginning and end of the space for the stack, where the linker script defines it.
    pub stack: Option<(u32, u32)>,
    /// The compiler.
    pub compiler: String,
}

/// Where the SRAM begins.
pub const SRAM: u32 = 0x2000_0000;

/// A function's place and name.
#[derive(Clone, Debug)]
pub struct Function {
    /// Address of its first instruction.
    pub address: u32,
    /// Address behind it.
    pub end: u32,
    /// Readable name.
    pub name: String,
}

impl Default for Image {
    fn default() -> Self {
        Self {
            core: M4_IN_FLASH,
            code: Vec::new(),
            functions: BTreeMap::new(),
            data: BTreeMap::new(),
            vectors: Vec::new(),
            stack: None,
            compiler: String::new(),
        }
    }
}

impl Image {
    /// Code without an ELF file around it, at `address`, with the functions' names and places
    /// from the beginning of the code: first byte, byte behind it.
    pub fn of_code(address: u32, halfwords: &[u16], functions: &[(&str, u32, u32)]) -> Self {
        let bytes = halfwords.iter().flat_map(|half| half.to_le_bytes());
        let function = |&(name, start, end): &(&str, u32, u32)| {
            let function = Function {
                address: address + start,
                end: address + end,
                name: name.to_owned(),
            };
            (function.address, function)
        };
        Self {
            code: vec![(address, bytes.collect())],
            functions: functions.iter().map(function).collect(),
            ..Self::default()
        }
    }

    /// The same, with data among the code: from and to which byte.
    pub fn with_data(mut self, start: u32, end: u32) -> Self {
        let address = self.code.first().map_or(0, |(address, _)| *address);
        self.data.insert(address + start, true);
        self.data.insert(address + end, false);
        self
    }

    /// The same image with other code at `address`.
    pub fn patched(mut self, address: u32, halfwords: &[u16]) -> Self {
        let bytes = halfwords.iter().flat_map(|half| half.to_le_bytes());
        for (place, byte) in (address..).zip(bytes) {
            for (start, section) in &mut self.code {
                let index = place.checked_sub(*start).map(|index| index as usize);
                if let Some(old) = index.and_then(|index| section.get_mut(index)) {
                    *old = byte;
                }
            }
        }
        self
    }

    /// Reads an ELF file.
    ///
    /// # Errors
    /// If it is none, or has no symbols.
    pub fn read(file: &[u8]) -> Result<Self, String> {
        let file = object::File::parse(file).map_err(|error| error.to_string())?;
        let mut image = Self::default();
        for section in file.sections() {
            let data = section.data().unwrap_or_default();
            if section.kind() == SectionKind::Text {
                image.code.push((section.address() as u32, data.to_vec()));
            }
            match section.name() {
                Ok(".vector_table") => {
                    image.vectors = vectors(data);
                    if section.address() as u32 >= SRAM {
                        image.core = M33_IN_SRAM;
                    }
                }
                Ok(".comment") => image.compiler = compiler(data),
                _ => {}
            }
        }
        for symbol in file.symbols() {
            let name = symbol.name().unwrap_or_default();
            let address = symbol.address() as u32;
            match name {
                "_stack_start" => image.stack.get_or_insert((0, 0)).1 = address,
                "_stack_end" => image.stack.get_or_insert((0, 0)).0 = address,
                _ if name.starts_with("$d") => drop(image.data.insert(address, true)),
                _ if name.starts_with("$t") => drop(image.data.insert(address, false)),
                _ if symbol.kind() == SymbolKind::Text => {
                    let address = address & !1;
                    let end = address + symbol.size() as u32;
                    image.name(address, end, readable(name));
                }
                _ => {}
            }
        }
        if image.functions.is_empty() {
            return Err("the image has no symbols of functions".to_owned());
        }
        image.close_gaps();
        Ok(image)
    }

    /// One function has several names if several have the same code: the default handler's own is
    /// taken, else the first by alphabet.
    fn name(&mut self, address: u32, end: u32, name: String) {
        let function = self.functions.entry(address).or_insert_with(|| Function {
            address,
            end,
            name: name.clone(),
        });
        function.end = function.end.max(end);
        let rank = |name: &str| (!name.starts_with("DefaultHandler"), name.to_owned());
        if rank(&name) < rank(&function.name) {
            function.name = name;
        }
    }

    /// A function that was written in assembly has no size: it ends where the next one begins.
    fn close_gaps(&mut self) {
        let starts: Vec<u32> = self.functions.keys().copied().collect();
        for (index, start) in starts.iter().enumerate() {
            let next = starts.get(index + 1).copied();
            let end = next.unwrap_or_else(|| self.end_of_code(*start));
            if let Some(function) = self.functions.get_mut(start)
                && function.end == function.address
            {
                function.end = end;
            }
        }
    }

    fn end_of_code(&self, address: u32) -> u32 {
        let section = self.section(address);
        section.map_or(address, |(start, bytes)| start + bytes.len() as u32)
    }

    fn section(&self, address: u32) -> Option<&(u32, Vec<u8>)> {
        self.code
            .iter()
            .find(|(start, bytes)| (*start..start + bytes.len() as u32).contains(&address))
    }

    /// The function that begins at `address`.
    pub fn function(&self, address: u32) -> Option<&Function> {
        self.functions.get(&address)
    }

    /// All functions by address.
    pub fn functions(&self) -> impl Iterator<Item = &Function> {
        self.functions.values()
    }

    /// The function of this name.
    pub fn named(&self, name: &str) -> Option<&Function> {
        self.functions().find(|function| function.name == name)
    }

    /// The byte at `address`, if it is code.
    pub fn byte(&self, address: u32) -> Option<u8> {
        let (start, bytes) = self.section(address)?;
        bytes.get((address - start) as usize).copied()
    }

    /// The halfword at `address`, if it is code.
    pub fn half(&self, address: u32) -> Option<u16> {
        Some(u16::from_le_bytes([
            self.byte(address)?,
            self.byte(address + 1)?,
        ]))
    }

    /// The address behind the data that contain `address`, if these are data among code.
    pub fn end_of_data(&self, address: u32) -> Option<u32> {
        let (_, is_data) = self.data.range(..=address).next_back()?;
        if !is_data {
            return None;
        }
        let next = self
            .data
            .range(address + 1..)
            .find(|(_, is_data)| !**is_data);
        Some(next.map_or(u32::MAX, |(next, _)| *next))
    }

    /// The handlers of exceptions and interrupts: number and address; 1 is the reset.
    pub fn vectors(&self) -> &[(u32, u32)] {
        &self.vectors
    }
}

/// The vector table: the first word is the stack's beginning.
fn vectors(table: &[u8]) -> Vec<(u32, u32)> {
    let words = table.chunks_exact(4).map(|word| {
        let bytes = word.try_into().unwrap_or_default();
        u32::from_le_bytes(bytes)
    });
    (0..)
        .zip(words)
        .skip(1)
        .filter(|(_, word)| *word != 0)
        .map(|(n, word)| (n, word & !1))
        .collect()
}

/// What the compiler wrote about itself.
fn compiler(comment: &[u8]) -> String {
    let texts = comment
        .split(|byte| *byte == 0)
        .map(String::from_utf8_lossy);
    texts
        .into_iter()
        .find(|text| text.starts_with("rustc"))
        .unwrap_or_default()
        .into_owned()
}

/// A name without its hash and with readable signs.
fn readable(name: &str) -> String {
    format!("{:#}", rustc_demangle::demangle(name))
}
