//! Flash and RAM of an image, by its sections.

use std::path::Path;

use anyhow::{Context, Result};
use object::{Object, ObjectSection, SectionFlags, elf};

/// Bytes that an image takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Size {
    /// Vectors, code, constants, and the initial values of statics.
    pub(crate) flash: u64,
    /// Statics: `.data`, `.bss`, `.uninit`. The stack has the rest.
    pub(crate) ram: u64,
}

impl Size {
    /// Of a linked program.
    pub(crate) fn of(elf_file: &Path) -> Result<Self> {
        let bytes = std::fs::read(elf_file).with_context(|| format!("cannot read {}", elf_file.display()))?;
        let file = object::File::parse(&*bytes).with_context(|| elf_file.display().to_string())?;
        let mut size = Self::default();
        for section in file.sections() {
            let SectionFlags::Elf { sh_flags } = section.flags() else { continue };
            let flags = sh_flags as u32;
            if flags & elf::SHF_ALLOC == 0 {
                continue;
            }
            let writable = flags & elf::SHF_WRITE != 0;
            let stored = section.kind() != object::SectionKind::UninitializedData;
            size.flash += if stored { section.size() } else { 0 };
            size.ram += if writable { section.size() } else { 0 };
        }
        Ok(size)
    }
}
