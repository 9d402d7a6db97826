//! The images for silicon, which nothing here can run: built, and checked as files.
//!
//! What the core does first is in the vector table, and what the camera needs is in the map: an image with a wrong one of
//! them does nothing at all on a board, and says so to nobody.

use std::ops::Range;
use std::path::Path;

use anyhow::{Context, Result, anyhow, bail};
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
    let toolchain = Toolchain::find()
        .map_err(|missing| anyhow!("{missing:?} is missing for Cortex-M: see `cargo xtask setup`"))?;
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
    let toolchain = Toolchain::find()
        .map_err(|missing| anyhow!("{missing:?} is missing for Cortex-M: see `cargo xtask setup`"))?;
    let folder = boards::folder().join(package);
    Ok(run_in(&toolchain, &folder)?.success())
}

fn run_in(toolchain: &Toolchain, folder: &Path) -> Result<std::process::ExitStatus> {
    toolchain.cargo("run").arg("--locked").current_dir(folder).status().context("cannot start cargo")
}

#[cfg(test)]
mod tests {
    use super::*;
    use object::write::{Object as Writer, StandardSegment, Symbol, SymbolSection};
    use object::{Architecture, BinaryFormat, Endianness, SymbolFlags, SymbolKind, SymbolScope};

    /// An object file with vectors and symbols; relocatable, so that its sections are all at 0.
    fn image(vectors: &[u32], symbols: &[(&str, u64)]) -> Vec<u8> {
        let mut writer = Writer::new(BinaryFormat::Elf, Architecture::Arm, Endianness::Little);
        let segment = writer.segment_name(StandardSegment::Text).to_vec();
        let table = writer.add_section(segment, b".vector_table".to_vec(), SectionKind::ReadOnlyData);
        let bytes: Vec<u8> = vectors.iter().flat_map(|vector| vector.to_le_bytes()).collect();
        writer.append_section_data(table, &bytes, 4);
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
        writer.write().unwrap()
    }

    #[test]
    fn each_fault_of_an_image_is_named() {
        let chip = &CHIPS[0];
        let mut vectors = vec![0x0800_0401; CORE_VECTORS + 150];
        (vectors[0], vectors[1], vectors[15]) = (0x2002_0000, 0x0800_0201, 0x0800_0501);
        (vectors[16 + 78], vectors[16 + 56]) = (0x0800_0601, 0x0800_0701);
        let symbols = [
            ("DefaultHandler_", 0x0800_0401),
            ("SysTick", 0x0800_0501),
            ("DCMI", 0x0800_0601),
            ("DMA2_STREAM0", 0x0800_0701),
        ];
        let found = |vectors: &[u32], symbols: &[(&str, u64)]| wrong(chip, &image(vectors, symbols)).unwrap();
        // An object file is at 0 and has no frames; the rest is right.
        let base = found(&vectors, &symbols);
        assert!(
            base.iter().all(|line| line.contains("frames")
                || line.contains("vector table")
                || line.contains("section")),
            "{base:?}"
        );
        let worse = |index: usize, value: u32| {
            let mut vectors = vectors.clone();
            vectors[index] = value;
            let lines = found(&vectors, &symbols);
            lines.into_iter().filter(|line| !base.contains(line)).collect::<Vec<_>>().join("\n")
        };
        assert!(worse(0, 0x2400_0000).contains("the stack starts at 0x24000000"));
        assert!(worse(1, 0x0800_0200).contains("not Thumb code"));
        assert!(worse(16 + 78, 0x0800_0401).contains("not the handler DCMI"));
        assert!(worse(16 + 56, 0).contains("not the handler DMA2_STREAM0"));
        assert!(worse(15, 0x0800_0401).contains("SysTick"));
        // Both ends in memory that is there, and nothing between them.
        let clearing = |from, to| {
            let symbols = [&symbols[..], &[("__sbss", from), ("__ebss", to)]].concat();
            found(&vectors, &symbols).iter().any(|line| line.contains("start-up clears"))
        };
        assert!(clearing(0x2000_0050, 0x2407_0800) && !clearing(0x2000_0050, 0x2000_02B0));
    }

    #[test]
    fn a_board_that_is_none_is_told() {
        assert!(flash("stm32h747").unwrap_err().to_string().contains("stm32h743"));
    }
}
