//! A linked image as functions: where each begins and ends, which of its bytes are code, whose address is taken.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use anyhow::{Context, Result, bail};
use object::{Object, ObjectSection, ObjectSymbol, SectionFlags, SectionKind, SymbolKind, elf};

/// A function of the image.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Function {
    /// As the source has it.
    pub(super) name: String,
    /// First byte, and one past the last.
    pub(super) place: Range<u32>,
}

/// A linked image.
#[derive(Debug)]
pub(super) struct Program {
    /// By their first byte.
    functions: BTreeMap<u32, Function>,
    /// Where code begins (`true`) and where data within code does, by the ELF's mapping symbols.
    mapping: BTreeMap<u32, bool>,
    /// Contents of what is loaded.
    sections: Vec<(u32, Vec<u8>)>,
    /// Vectors: the initial stack pointer, then code.
    pub(super) vectors: Vec<u32>,
    /// Memory of the stack.
    pub(super) stack: Range<u32>,
    /// What the compiler says of functions' frames, if it was told to (`-Z emit-stack-sizes`).
    pub(super) said: BTreeMap<u32, u32>,
}

impl Program {
    /// Reads an ELF file for Thumb.
    ///
    /// # Errors
    /// If it is none, or has no symbols, no vectors, or no `_stack_start` and `_stack_end`.
    pub(super) fn parse(bytes: &[u8]) -> Result<Self> {
        let file = object::File::parse(bytes).context("the image is no ELF file")?;
        let mut sections = Vec::new();
        let mut code: Vec<Range<u32>> = Vec::new();
        for section in file.sections() {
            let SectionFlags::Elf { sh_flags } = section.flags() else { continue };
            if sh_flags as u32 & elf::SHF_ALLOC == 0 || section.kind() == SectionKind::UninitializedData {
                continue;
            }
            let start = section.address() as u32;
            if sh_flags as u32 & elf::SHF_EXECINSTR != 0 {
                code.push(start..start + section.size() as u32);
            }
            sections.push((start, section.data()?.to_vec()));
        }
        let (mut starts, mut mapping) = (BTreeMap::<u32, (String, u32)>::new(), BTreeMap::new());
        for symbol in file.symbols() {
            let (Ok(name), address) = (symbol.name(), symbol.address() as u32) else { continue };
            let kind = name.split('.').next();
            if matches!(kind, Some("$t" | "$d")) {
                mapping.insert(address, kind == Some("$t"));
            } else if symbol.kind() == SymbolKind::Text && code.iter().any(|code| code.contains(&address)) {
                let (address, size) = (address & !1, symbol.size() as u32);
                let known = starts.entry(address).or_insert_with(|| (String::new(), 0));
                known.1 = known.1.max(size);
                // Of several names, one of Rust says most.
                if known.0.is_empty() || name.starts_with("_R") || name.starts_with("_ZN") {
                    known.0 = format!("{:#}", rustc_demangle::demangle(name));
                }
            }
        }
        let bounds: Vec<u32> = starts.keys().copied().collect();
        let end = |start: u32, size: u32| {
            // Assembly often gives no size: then up to what follows.
            let section = code.iter().find(|code| code.contains(&start)).map_or(start, |code| code.end);
            let next = bounds.iter().copied().find(|&next| next > start).unwrap_or(section).min(section);
            if size == 0 { next } else { start + size }
        };
        let functions = starts
            .into_iter()
            .map(|(start, (name, size))| (start, Function { name, place: start..end(start, size) }))
            .collect();
        let symbol = |name: &str| {
            let found = file.symbols().find(|symbol| symbol.name() == Ok(name));
            found.map(|symbol| symbol.address() as u32).with_context(|| format!("the image has no {name}"))
        };
        let table = file.section_by_name(".vector_table").context("the image has no vector table")?;
        let vectors: Vec<u32> =
            table.data()?.as_chunks::<4>().0.iter().map(|word| u32::from_le_bytes(*word)).collect();
        let stack = symbol("_stack_end")?..symbol("_stack_start")?;
        if vectors.first() != Some(&stack.end) {
            bail!("the stack starts at {:#x?}, and `_stack_start` is {:#x}", vectors.first(), stack.end);
        }
        let said = match file.section_by_name(".stack_sizes") {
            Some(section) => stack_sizes(section.data()?),
            None => BTreeMap::new(),
        };
        Ok(Self { functions, mapping, sections, vectors, stack, said })
    }

    /// All functions, by address.
    pub(super) fn functions(&self) -> impl Iterator<Item = &Function> {
        self.functions.values()
    }

    /// The function that begins here.
    pub(super) fn function_at(&self, address: u32) -> Option<&Function> {
        self.functions.get(&(address & !1))
    }

    /// The function that this address lies in.
    pub(super) fn function_around(&self, address: u32) -> Option<&Function> {
        let (_, function) = self.functions.range(..=address).next_back()?;
        function.place.contains(&address).then_some(function)
    }

    /// The stretches of a function that are code, each with its address.
    pub(super) fn code(&self, function: &Function) -> Vec<(u32, &[u8])> {
        let place = &function.place;
        let before = self.mapping.range(..=place.start).next_back().is_none_or(|(_, &code)| code);
        let mut stretches = Vec::new();
        let (mut start, mut is_code) = (place.start, before);
        let changes = self.mapping.range(place.start + 1..place.end.max(place.start + 1));
        for (&at, &code) in changes.chain([(&place.end, &false)]) {
            if is_code && at > start {
                stretches.extend(self.bytes(start..at).map(|bytes| (start, bytes)));
            }
            (start, is_code) = (at, code);
        }
        stretches
    }

    fn bytes(&self, place: Range<u32>) -> Option<&[u8]> {
        let (start, bytes) = self
            .sections
            .iter()
            .find(|(start, bytes)| (*start..*start + bytes.len() as u32).contains(&place.start))?;
        bytes.get((place.start - start) as usize..(place.end - start) as usize)
    }

    /// Functions whose address stands somewhere as a word, in constants, initial values or between code: what a call by
    /// address can reach. The vectors are not counted; code makes no addresses out of halves, see [`super::code`].
    pub(super) fn taken(&self) -> BTreeSet<u32> {
        let mut taken = BTreeSet::new();
        for (start, bytes) in &self.sections {
            let words = bytes.as_chunks::<4>().0.iter().map(|word| u32::from_le_bytes(*word));
            for (index, word) in words.enumerate() {
                let at = start + 4 * index as u32;
                let in_code = self.function_around(at).is_some()
                    && self.mapping.range(..=at).next_back().is_some_and(|(_, &code)| code);
                if word & 1 == 1 && !in_code && self.functions.contains_key(&(word & !1)) {
                    taken.insert(word & !1);
                }
            }
        }
        taken
    }
}

/// LLVM's `.stack_sizes`: an address and a ULEB128 for each function.
fn stack_sizes(mut bytes: &[u8]) -> BTreeMap<u32, u32> {
    let mut sizes = BTreeMap::new();
    while let Some((address, rest)) = bytes.split_first_chunk::<4>() {
        let length = rest.iter().position(|byte| byte & 0x80 == 0).map_or(rest.len(), |last| last + 1);
        let (size, rest) = rest.split_at(length);
        let bits = size.iter().rev().fold(0_u32, |bits, byte| bits << 7 | u32::from(byte & 0x7F));
        sizes.insert(u32::from_le_bytes(*address) & !1, bits);
        bytes = rest;
    }
    sizes
}

#[cfg(test)]
impl Program {
    /// Functions of these half-words, one after the other from 0x100 on; the vectors are as given.
    pub(super) fn of(functions: &[(&str, &[u16])], vectors: &[u32]) -> Self {
        let (mut at, mut all, mut bytes) = (0x100, BTreeMap::new(), Vec::new());
        for &(name, code) in functions {
            let end = at + 2 * code.len() as u32;
            all.insert(at, Function { name: name.to_owned(), place: at..end });
            bytes.extend(code.iter().flat_map(|half| half.to_le_bytes()));
            at = end;
        }
        let mapping = [(0x100, true)].into();
        let (sections, vectors) = (vec![(0x100, bytes)], vectors.to_vec());
        let (stack, said) = (0x2000_0000..0x2000_1000, BTreeMap::new());
        Self { functions: all, mapping, sections, vectors, stack, said }
    }
}
