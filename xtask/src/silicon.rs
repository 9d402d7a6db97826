//! The images for silicon, which nothing here can run: built, and checked as files.
//!
//! What the core does first is in the vector table, and what the camera needs is in the map: an image with a wrong one of
//! them does nothing at all on a board, and says so to nobody.

use std::ops::Range;
use std::path::Path;

use anyhow::{Context, Result, bail};
use object::{Object, ObjectSection, ObjectSymbol, SectionFlags, SectionKind, elf};

use crate::boards::{self, Image};
use crate::size::Size;
use crate::snapshot::{self, Findings, Tolerance};
use crate::toolchain::{Toolchain, in_path};

/// The program that flashes.
const PROBE: &str = "probe-rs";

/// What an image of a chip must look like.
struct Chip {
    package: &'static str,
    flash: Range<u64>,
    /// Memory of the stack and of statics.
    stack: Range<u64>,
    statics: Range<u64>,
    /// Memory that the camera's DMA reaches, and the bytes of frames that are to lie in it.
    frames: Range<u64>,
    frame_bytes: u64,
    /// Interrupts that must have a handler of their own.
    handlers: &'static [(&'static str, usize)],
}

/// RM0433 and RM0090: the chapters on memory and on the vectors of NVIC.
const CHIPS: &[Chip] = &[
    Chip {
        package: "stm32h743",
        flash: 0x0800_0000..0x0820_0000,
        stack: 0x2000_0000..0x2002_0000,
        statics: 0x2000_0000..0x2002_0000,
        frames: 0x2400_0000..0x2408_0000,
        frame_bytes: 3 * 320 * 240 * 2,
        handlers: &[("DCMI", 78), ("DMA2_STREAM0", 56), ("USART3", 39)],
    },
    Chip {
        package: "stm32f429",
        flash: 0x0800_0000..0x0820_0000,
        stack: 0x1000_0000..0x1001_0000,
        statics: 0x2000_0000..0x2003_0000,
        frames: 0x2000_0000..0x2003_0000,
        frame_bytes: 320 * 240 * 2,
        handlers: &[("DCMI", 78), ("DMA2_STREAM1", 57), ("USART3", 39)],
    },
];

/// Vectors of the core, before those of interrupts.
const CORE_VECTORS: usize = 16;

/// Builds all images for silicon and checks them. True if nothing is wrong.
pub(crate) fn check(bless: bool) -> Result<bool> {
    let toolchain = Toolchain::find()?;
    let mut good = true;
    for chip in CHIPS {
        for image in boards::build_with(&toolchain, &[chip.package.to_owned()], &[])? {
            let findings = check_image(chip, &image, &toolchain, bless)?;
            let size = Size::of(&image.elf)?;
            let verdict = if findings.failures.is_empty() { "ok" } else { "FAILED" };
            println!("{}: {verdict}, {} bytes of flash, {} of RAM", image.name, size.flash, size.ram);
            for line in findings.failures.iter().chain(&findings.notes) {
                println!("  {line}");
            }
            good &= findings.failures.is_empty();
        }
    }
    Ok(good)
}

fn check_image(chip: &Chip, image: &Image, toolchain: &Toolchain, bless: bool) -> Result<Findings> {
    let bytes = std::fs::read(&image.elf).with_context(|| format!("cannot read {}", image.elf.display()))?;
    let mut findings = Findings { failures: wrong(chip, &bytes)?, ..Findings::default() };
    let size = Size::of(&image.elf)?;
    let sizes = [("flash".to_owned(), size.flash as f64), ("ram".to_owned(), size.ram as f64)];
    let path = boards::folder().join(chip.package).join("snapshots").join(format!("{}.size", image.name));
    if bless {
        snapshot::bless_numbers(&path, &toolchain.version, &sizes)?;
    } else {
        let tolerance = Tolerance { relative: 0.02, absolute: 256.0 };
        let sizes = sizes.into_iter().collect();
        snapshot::compare_numbers(&path, &toolchain.version, &sizes, tolerance, &mut findings)?;
    }
    Ok(findings)
}

/// What is wrong with an image for this chip.
fn wrong(chip: &Chip, bytes: &[u8]) -> Result<Vec<String>> {
    let file = object::File::parse(bytes).context("the image is no ELF file")?;
    let mut wrong = Vec::new();
    let mut expect = |holds: bool, what: String| {
        if !holds {
            wrong.push(what);
        }
    };
    let table = file.section_by_name(".vector_table").context("the image has no vector table")?;
    let vectors: Vec<u32> =
        table.data()?.as_chunks::<4>().0.iter().map(|word| u32::from_le_bytes(*word)).collect();
    let vector = |index: usize| vectors.get(index).copied().unwrap_or(0);
    expect(
        table.address() == chip.flash.start,
        format!(
            "the vector table is at {:#x}, and the core looks at {:#x}",
            table.address(),
            chip.flash.start
        ),
    );
    let stack = u64::from(vector(0));
    expect(
        stack > chip.stack.start && stack <= chip.stack.end && stack.is_multiple_of(8),
        format!("the stack starts at {stack:#x}, which is not in {:#x?}", chip.stack),
    );
    let in_flash = |address: u32| chip.flash.contains(&u64::from(address)) && address & 1 == 1;
    expect(in_flash(vector(1)), format!("the reset vector is {:#x}: not Thumb code in flash", vector(1)));
    let symbol = |name: &str| {
        file.symbols().find(|symbol| symbol.name() == Ok(name)).map(|symbol| symbol.address() as u32 | 1)
    };
    let default = symbol("DefaultHandler_").or_else(|| symbol("DefaultHandler"));
    for &(name, number) in chip.handlers {
        let address = vector(CORE_VECTORS + number);
        expect(
            in_flash(address) && Some(address) == symbol(name) && Some(address) != default,
            format!("interrupt {number} goes to {address:#x}, which is not the handler {name}"),
        );
    }
    expect(
        Some(vector(15)) == symbol("SysTick") && Some(vector(15)) != default,
        format!("SysTick goes to {:#x}, which is not its handler", vector(15)),
    );
    // Start-up clears from one symbol to the other, whatever lies between: a section that is inserted before the second one
    // but stands in other memory makes it run through addresses where nothing is, which is a bus fault before `main`.
    let exact = |name: &str| file.symbols().find(|symbol| symbol.name() == Ok(name)).map(|s| s.address());
    if let (Some(from), Some(to)) = (exact("__sbss"), exact("__ebss")) {
        expect(
            from <= to && from >= chip.statics.start && to <= chip.statics.end,
            format!("start-up clears {from:#x} to {to:#x}, which is not in {:#x?}", chip.statics),
        );
    }
    let frames = file.section_by_name(".frames");
    let (start, size) = frames.as_ref().map_or((0, 0), |section| (section.address(), section.size()));
    expect(
        start >= chip.frames.start && start + size <= chip.frames.end && start.is_multiple_of(16),
        format!("frames are at {start:#x} with {size} bytes, where the DMA does not reach or cannot burst"),
    );
    expect(size == chip.frame_bytes, format!("frames have {size} bytes, not {}", chip.frame_bytes));
    for section in file.sections() {
        let SectionFlags::Elf { sh_flags } = section.flags() else { continue };
        if sh_flags as u32 & elf::SHF_ALLOC == 0 || section.size() == 0 {
            continue;
        }
        let (name, start) = (section.name().unwrap_or("?"), section.address());
        let end = start + section.size();
        let within = |range: &Range<u64>| start >= range.start && end <= range.end;
        let writable = sh_flags as u32 & elf::SHF_WRITE != 0;
        let place =
            if writable { within(&chip.statics) || within(&chip.frames) } else { within(&chip.flash) };
        expect(place, format!("section {name} is at {start:#x} to {end:#x}, outside its memory"));
        let loaded = section.kind() != SectionKind::UninitializedData;
        expect(
            name != ".frames" || !loaded,
            "frames are stored in flash: the section is not NOLOAD".to_owned(),
        );
    }
    Ok(wrong)
}

/// Builds a package's image, flashes it and shows its log, through the runner of the package.
pub(crate) fn flash(package: &str) -> Result<bool> {
    if !CHIPS.iter().any(|chip| chip.package == package) {
        let known: Vec<_> = CHIPS.iter().map(|chip| chip.package).collect();
        bail!("no board is called {package}; there are {}", known.join(", "));
    }
    if in_path(PROBE).is_none() {
        bail!("{PROBE} is not there, which flashes and shows the log: `cargo install probe-rs-tools`");
    }
    let toolchain = Toolchain::find()?;
    let folder = boards::folder().join(package);
    Ok(run_in(&toolchain, &folder)?.success())
}

fn run_in(toolchain: &Toolchain, folder: &Path) -> Result<std::process::ExitStatus> {
    toolchain.cargo("run").arg("--locked").current_dir(folder).status().context("cannot start cargo")
}

#[cfg(test)]
mod tests {
    use super::*;
    use object::write::{Object as Writer, Symbol, SymbolSection};
    use object::{Architecture, BinaryFormat, Endianness, SymbolFlags, SymbolKind, SymbolScope};

    /// Vectors and symbols as they are to be.
    const SYMBOLS: [(&str, u64); 7] = [
        ("DefaultHandler_", 0x0800_0401),
        ("SysTick", 0x0800_0501),
        ("DCMI", 0x0800_0601),
        ("DMA2_STREAM0", 0x0800_0701),
        ("USART3", 0x0800_0801),
        ("__sbss", 0x2000_0000),
        ("__ebss", 0x2000_0200),
    ];

    fn vectors() -> Vec<u32> {
        let mut vectors = vec![0x0800_0401; CORE_VECTORS + 150];
        (vectors[0], vectors[1], vectors[15]) = (0x2002_0000, 0x0800_0201, 0x0800_0501);
        (vectors[16 + 78], vectors[16 + 56], vectors[16 + 39]) = (0x0800_0601, 0x0800_0701, 0x0800_0801);
        vectors
    }

    /// Where a section lies, and what it is.
    #[derive(Clone, Copy)]
    struct Section {
        name: &'static str,
        address: u32,
        size: u64,
        kind: SectionKind,
    }

    /// An image for the H743 with nothing wrong.
    const SECTIONS: [Section; 4] = [
        Section { name: ".vector_table", address: 0x0800_0000, size: 0, kind: SectionKind::ReadOnlyData },
        Section { name: ".text", address: 0x0800_0400, size: 0x600, kind: SectionKind::Text },
        Section {
            name: ".frames",
            address: 0x2400_0000,
            size: 460_800,
            kind: SectionKind::UninitializedData,
        },
        Section { name: ".bss", address: 0x2000_0000, size: 0x200, kind: SectionKind::UninitializedData },
    ];

    /// The bytes of an ELF file of these. The writer makes relocatable files, whose sections are all at 0; the addresses are
    /// put in afterwards.
    fn elf_of(vectors: &[u32], symbols: &[(&str, u64)], sections: &[Section]) -> Vec<u8> {
        let mut writer = Writer::new(BinaryFormat::Elf, Architecture::Arm, Endianness::Little);
        for section in sections {
            let id = writer.add_section(Vec::new(), section.name.as_bytes().to_vec(), section.kind);
            if section.name == ".vector_table" {
                let bytes: Vec<u8> = vectors.iter().flat_map(|vector| vector.to_le_bytes()).collect();
                writer.append_section_data(id, &bytes, 4);
            } else if section.kind == SectionKind::UninitializedData {
                writer.append_section_bss(id, section.size, 4);
            } else {
                writer.append_section_data(id, &vec![0; section.size as usize], 4);
            }
        }
        for &(name, value) in symbols {
            writer.add_symbol(Symbol {
                name: name.as_bytes().to_vec(),
                value,
                size: 2,
                kind: SymbolKind::Text,
                scope: SymbolScope::Linkage,
                weak: false,
                section: SymbolSection::Absolute,
                flags: SymbolFlags::None,
            });
        }
        let mut bytes = writer.write().unwrap();
        let places: Vec<(usize, u32)> = {
            let file = object::File::parse(&*bytes).unwrap();
            let place =
                |section: &Section| (file.section_by_name(section.name).unwrap().index().0, section.address);
            sections.iter().map(place).collect()
        };
        // ELF32: e_shoff at 32, e_shentsize at 46; sh_addr is the fourth word of a header.
        let headers = u32::from_le_bytes(bytes[32..36].try_into().unwrap()) as usize;
        let length = usize::from(u16::from_le_bytes([bytes[46], bytes[47]]));
        for (index, address) in places {
            let at = headers + index * length + 12;
            bytes[at..at + 4].copy_from_slice(&address.to_le_bytes());
        }
        bytes
    }

    fn faults(vectors: &[u32], symbols: &[(&str, u64)], sections: &[Section]) -> String {
        wrong(&CHIPS[0], &elf_of(vectors, symbols, sections)).unwrap().join("\n")
    }

    #[test]
    fn an_image_that_is_right_passes() {
        assert_eq!(faults(&vectors(), &SYMBOLS, &SECTIONS), "");
    }

    #[test]
    fn each_wrong_vector_is_named() {
        let worse = |index: usize, value: u32| {
            let mut vectors = vectors();
            vectors[index] = value;
            faults(&vectors, &SYMBOLS, &SECTIONS)
        };
        assert!(worse(0, 0x2400_0000).contains("the stack starts at 0x24000000"));
        assert!(worse(1, 0x0800_0200).contains("not Thumb code"));
        assert!(worse(16 + 78, 0x0800_0401).contains("not the handler DCMI"));
        assert!(worse(16 + 56, 0).contains("not the handler DMA2_STREAM0"));
        assert!(worse(16 + 39, 0x0800_0401).contains("not the handler USART3"));
        assert!(worse(15, 0x0800_0401).contains("SysTick"));
        // Both ends in memory that is there, and nothing between them.
        let mut symbols = SYMBOLS;
        symbols[6].1 = 0x2407_0800;
        assert!(faults(&vectors(), &symbols, &SECTIONS).contains("start-up clears"));
    }

    #[test]
    fn each_wrong_place_of_a_section_is_named() {
        let worse = |index: usize, change: fn(&mut Section)| {
            let mut sections = SECTIONS;
            change(&mut sections[index]);
            faults(&vectors(), &SYMBOLS, &sections)
        };
        let elsewhere = worse(0, |table| table.address = 0x0802_0000);
        assert!(elsewhere.contains("the vector table is at 0x8020000"), "{elsewhere}");
        let beyond = worse(1, |text| text.address = 0x081F_FF00);
        assert!(beyond.contains("section .text is at 0x81fff00 to 0x8200500, outside"), "{beyond}");
        let coupled = worse(2, |frames| frames.address = 0x2000_1000);
        assert!(coupled.contains("frames are at 0x20001000"), "{coupled}");
        let unaligned = worse(2, |frames| frames.address = 0x2400_0004);
        assert!(unaligned.contains("cannot burst"), "{unaligned}");
        let fewer = worse(2, |frames| frames.size = 307_200);
        assert!(fewer.contains("frames have 307200 bytes, not 460800"), "{fewer}");
        let stored = worse(2, |frames| frames.kind = SectionKind::Data);
        assert!(stored.contains("not NOLOAD"), "{stored}");
        let statics = worse(3, |statics| statics.address = 0x1000_0000);
        assert!(statics.contains("section .bss is at 0x10000000"), "{statics}");
    }

    #[test]
    fn what_is_no_image_is_refused() {
        let whole = elf_of(&vectors(), &SYMBOLS, &SECTIONS);
        assert!(wrong(&CHIPS[0], b"not an ELF file").is_err());
        assert!(wrong(&CHIPS[0], &whole[..100]).is_err(), "cut short");
        let error = wrong(&CHIPS[0], &elf_of(&[], &[], &SECTIONS[1..])).unwrap_err();
        assert!(error.to_string().contains("no vector table"));
    }

    #[test]
    fn a_board_that_is_none_is_told() {
        assert!(flash("stm32h747").unwrap_err().to_string().contains("stm32h743"));
    }
}
