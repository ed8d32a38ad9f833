//! The sizes of the firmware images, and the functions and texts in them.

use object::{Object, ObjectSection, ObjectSymbol, SectionFlags, SymbolKind, elf};
use std::ops::Range;

use fivebar_sim::link::Emulator;

/// Flash and static memory of the production image [bytes].
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize)]
struct Size {
    flash: u64,
    /// Static data in the main RAM, and in the core-coupled memory.
    static_ram: u64,
    static_ccm: u64,
    /// What is left of both, without the stack's space.
    free_static: u64,
}

/// As last committed.
const COMMITTED: &str = include_str!("../data/image_size.json");
/// The most that the image may take [bytes].
const BUDGET: Size = Size {
    flash: 256 * 1024,
    static_ram: 64 * 1024,
    static_ccm: 64 * 1024,
    // At least.
    free_static: 90 * 1024,
};
/// The main RAM and the core-coupled memory.
const RAM: Range<u64> = 0x2000_0000..0x2002_0000;
const CCM: Range<u64> = 0x1000_0000..0x1001_0000;
/// The share by which another compiler's image may differ from the committed one.
const TOLERANCE: f64 = 0.1;

fn image(name: &str) -> Vec<u8> {
    let path = Emulator::built_image(name);
    std::fs::read(&path).unwrap_or_else(|error| {
        panic!("{}: {error}; run scripts/firmware.sh", path.display());
    })
}

fn size(image: &[u8]) -> Size {
    let file = object::File::parse(image).expect("an ELF image");
    let mut size = Size {
        flash: 0,
        static_ram: 0,
        static_ccm: 0,
        free_static: 0,
    };
    // Where the static data begin: in the RAM above the stack. The images without one begin with them.
    let stack = file.symbols().find(|it| it.name() == Ok("_stack_start"));
    let [mut ram, mut ccm] = [stack.map_or(RAM.start, |it| it.address()), CCM.start];
    for section in file.sections() {
        let SectionFlags::Elf { sh_flags } = section.flags() else {
            panic!("an ELF image has ELF sections");
        };
        if sh_flags & u64::from(elf::SHF_ALLOC) == 0 {
            continue;
        }
        let stored = section.file_range().map_or(0, |(_, bytes)| bytes);
        size.flash += stored;
        let end = section.address() + section.size();
        if RAM.contains(&section.address()) {
            size.static_ram += section.size();
            ram = ram.max(end);
        } else if CCM.contains(&section.address()) {
            size.static_ccm += section.size();
            ccm = ccm.max(end);
        }
    }
    size.free_static = RAM.end - ram + (CCM.end - ccm);
    size
}

#[test]
fn the_production_image_is_as_small_as_committed_and_within_budget() {
    let now = size(&image("stm32f405"));
    let committed: Size = serde_json::from_str(COMMITTED).expect("the committed sizes");
    println!("{now:?}");
    assert!(now.flash <= BUDGET.flash, "{now:?}");
    assert!(now.static_ram <= BUDGET.static_ram, "{now:?}");
    assert!(now.static_ccm <= BUDGET.static_ccm, "{now:?}");
    assert!(now.free_static >= BUDGET.free_static, "{now:?}");
    let pairs = [
        (now.flash, committed.flash),
        (now.static_ram, committed.static_ram),
        (now.static_ccm, committed.static_ccm),
        (now.free_static, committed.free_static),
    ];
    for (now, then) in pairs {
        let (now, then) = (now as f64, then as f64);
        assert!(
            (now - then).abs() <= TOLERANCE * then,
            "{now} bytes, committed {then}; if that is right, write it into tests/data/image_size.json"
        );
    }
}

/// Nothing that is loaded or cleared at the start lies in the core-coupled memory, which the emulated board does not
/// have, and no memory of the DMA, which does not reach it.
#[test]
fn the_core_coupled_memory_holds_what_is_written_before_it_is_read() {
    let image = image("stm32f405");
    let file = object::File::parse(&*image).expect("an ELF image");
    let inside = file.symbols().filter(|it| CCM.contains(&it.address()));
    let names: Vec<_> = inside.filter_map(|it| it.name().ok()).collect();
    let log = |name: &&str| name.contains("LOG_WORDS") || name.starts_with('$');
    assert!(names.iter().any(log) && names.iter().all(log), "{names:?}");
    let mut sections = file
        .sections()
        .filter(|it| CCM.contains(&it.address()) && it.size() > 0);
    assert!(sections.all(|it| it.file_range().is_none_or(|(_, bytes)| bytes == 0)));
}

/// A stack that grows too large leaves the RAM; it does not overwrite variables.
#[test]
fn the_stack_lies_below_everything_else_in_ram() {
    for name in ["stm32f405", "qemu"] {
        let image = image(name);
        let file = object::File::parse(&*image).expect("an ELF image");
        let address = |name| {
            let symbol = file.symbols().find(|symbol| symbol.name() == Ok(name));
            symbol.expect("the linker script defines it").address()
        };
        let (end, start) = (address("_stack_end"), address("_stack_start"));
        assert_eq!(end, 0x2000_0000, "{name}: the RAM's beginning");
        assert!(start >= end + 16 * 1024, "{name}: {start:#x}");
        let in_ram = |address| RAM.contains(&address);
        let variables = file.sections().filter(|it| in_ram(it.address()));
        let lowest = variables.map(|section| section.address()).min();
        assert!(lowest >= Some(start), "{name}: {lowest:x?}");
    }
}

/// Functions of the tick's image that are not the project's own.
fn foreign_functions(image: &[u8]) -> Vec<String> {
    /// The start-up code, copies and fills of memory, the mapping of an array (which computes
    /// nothing itself), and the log's default timestamp, which the tick never calls.
    const KNOWN: [&str; 10] = [
        "Reset",
        "main",
        "cortex_m_rt_main",
        "HardFault",
        "DefaultPreInit",
        "__pre_init",
        "__aeabi_mem",
        "compiler_builtins3mem",
        "core5array",
        "__defmt_default_timestamp",
    ];
    let file = object::File::parse(image).expect("an ELF image");
    // Interrupts without a handler of their own are other names of one default handler.
    let unhandled = file
        .symbols()
        .find(|symbol| symbol.name() == Ok("DefaultHandler_"))
        .map(|symbol| symbol.address());
    file.symbols()
        .filter(|symbol| symbol.kind() == SymbolKind::Text)
        .filter(|symbol| Some(symbol.address()) != unhandled)
        .filter_map(|symbol| symbol.name().ok())
        .filter(|name| !name.starts_with('$') && !name.contains("fivebar_"))
        .filter(|name| !KNOWN.iter().any(|known| name.contains(known)))
        .map(str::to_owned)
        .collect()
}

/// The image links only if the tick cannot panic and does not allocate; see
/// `firmware/src/bin/tick.rs`.
#[test]
fn the_tick_calls_no_library_arithmetic() {
    let image = image("tick");
    let file = object::File::parse(&*image).expect("an ELF image");
    let symbols = || file.symbols().filter_map(|symbol| symbol.name().ok());
    assert!(symbols().any(|name| name.contains("Controller")));
    assert!(size(&image).flash > 4096, "the tick is in the image");
    let foreign = foreign_functions(&image);
    assert!(foreign.is_empty(), "{foreign:?}");
}

/// The same search finds such functions where they exist: the benchmark calls `libm`.
#[test]
fn library_arithmetic_is_found_where_it_is() {
    let foreign = foreign_functions(&image("instructions"));
    assert!(foreign.iter().any(|name| name == "__aeabi_dmul"));
    assert!(
        foreign.iter().any(|name| name.contains("sinf")),
        "{foreign:?}"
    );
}

/// The log's texts in an image. A line is sent as a number; its text and the names that it can
/// show are symbols of the section `.defmt`, which is not flashed.
fn log_texts(image: &[u8]) -> Vec<String> {
    let file = object::File::parse(image).expect("an ELF image");
    let section = file.section_by_name(".defmt").map(|it| it.index());
    file.symbols()
        .filter(|symbol| section.is_some() && symbol.section_index() == section)
        .filter_map(|symbol| symbol.name().ok())
        .filter(|name| name.contains(r#""tag":"defmt_"#))
        .map(str::to_owned)
        .collect()
}

/// `scripts/firmware.sh` sets the log's level; without one, defmt leaves out all but errors.
#[test]
fn the_production_image_logs_transitions_faults_and_cycles() {
    let texts = log_texts(&image("stm32f405"));
    for text in [
        "tick {=u32}: {} to {}",
        "Stopped|Homing|Armed|Running|Stopping|Fault",
        "tick {=u32}: fault {=u8}, {}",
        "|EmergencyStop|Envelope|CommandTimeout|",
        "the tick: {=u32} cycles, at most {=u32}",
        "started after a reset: {}",
    ] {
        assert!(texts.iter().any(|name| name.contains(text)), "{texts:#?}");
    }
}

/// The idle task logs; the tick spends no instruction on it.
#[test]
fn the_tick_logs_nothing() {
    let texts = log_texts(&image("tick"));
    assert!(
        !texts.iter().any(|name| name.contains("fivebar")),
        "{texts:#?}"
    );
}
