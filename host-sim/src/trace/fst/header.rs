//! Blocks, geometry and hierarchy: what stands where, which signals there are.

use std::io::{Read, Seek, SeekFrom};

use super::super::vcd::name_and_range;
use super::super::wiring::Signal;
use super::bytes::Bytes;
use super::error::{FstError, FstProblem};
use super::packed::{LIMIT, Packing};

/// Blocks that are remembered, and scopes within scopes.
const BLOCKS: usize = 1 << 20;
const SCOPES: usize = 256;

/// A section of value changes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// Where the block begins, and its length without its type.
    pub(super) offset: u64,
    pub(super) length: u64,
    /// The index of chains is of the second kind.
    pub(super) alias2: bool,
}

/// What a file says before any change is read.
#[derive(Clone, Debug, Default)]
pub(super) struct Contents {
    pub(super) sections: Vec<Place>,
    /// Bits of each handle; 0 for a text, and nothing for a real number.
    pub(super) widths: Vec<Option<u32>>,
    /// One a variable, with its handle beside it.
    pub(super) signals: Vec<Signal>,
    pub(super) handles: Vec<usize>,
    /// A unit of time is ten to this power of seconds.
    pub(super) exponent: i8,
}

pub(super) fn block(offset: u64, problem: FstProblem) -> FstError {
    FstError::Block { offset, problem }
}

/// The bytes of a block behind its length, from `skip` on.
pub(super) fn body<R: Read + Seek>(
    file: &mut R,
    offset: u64,
    from: u64,
    count: u64,
    what: &'static str,
) -> Result<Vec<u8>, FstError> {
    if count > LIMIT {
        return Err(block(offset, FstProblem::TooLarge(what)));
    }
    file.seek(SeekFrom::Start(from))?;
    let mut bytes = Vec::new();
    file.take(count).read_to_end(&mut bytes)?;
    if bytes.len() as u64 == count { Ok(bytes) } else { Err(block(offset, FstProblem::Short)) }
}

/// A number of eight bytes, the highest first.
pub(super) fn wide(bytes: &[u8], at: usize) -> Option<u64> {
    let found = bytes.get(at..at + 8)?.first_chunk::<8>()?;
    Some(u64::from_be_bytes(*found))
}

pub(super) fn read<R: Read + Seek>(file: &mut R) -> Result<Contents, FstError> {
    let end = file.seek(SeekFrom::End(0))?;
    let mut found = Contents::default();
    let (mut header, mut geometry, mut hierarchy) = (false, false, None);
    let (mut offset, mut blocks) = (0, 0);
    while offset < end {
        let wrong = |problem| block(offset, problem);
        let head = body(file, offset, offset, (end - offset).min(9), "head")?;
        let (Some(&kind), Some(length)) = (head.first(), wide(&head, 1)) else {
            return Err(wrong(FstProblem::Short));
        };
        if kind == 254 {
            return Err(wrong(FstProblem::Wrapped));
        }
        if length == 0 && kind == 255 {
            break;
        }
        if length < 8 || length > end - offset - 1 {
            return Err(wrong(FstProblem::Short));
        }
        match kind {
            0 => {
                let bytes = body(file, offset, offset + 9, length - 8, "header")?;
                let exponent = bytes.get(64).ok_or_else(|| wrong(FstProblem::Short))?;
                found.exponent = exponent.cast_signed();
                header = true;
            }
            1 | 5 | 8 => found.sections.push(Place { offset, length, alias2: kind == 8 }),
            3 => {
                let bytes = body(file, offset, offset + 9, length - 8, "geometry")?;
                found.widths = widths(&bytes).map_err(wrong)?;
                geometry = true;
            }
            4 | 6 | 7 => hierarchy = Some((kind, offset, length)),
            2 | 255 => {}
            kind => return Err(wrong(FstProblem::Kind(kind))),
        }
        offset += 1 + length;
        blocks += 1;
        if blocks > BLOCKS {
            return Err(block(offset, FstProblem::TooLarge("list of blocks")));
        }
    }
    for (there, name) in [(header, "header"), (geometry, "geometry"), (hierarchy.is_some(), "hierarchy")] {
        if !there {
            return Err(block(end, FstProblem::Missing(name)));
        }
    }
    if let Some((kind, offset, length)) = hierarchy {
        let bytes = body(file, offset, offset + 9, length - 8, "hierarchy")?;
        let text = unpacked(kind, &bytes).map_err(|problem| block(offset, problem))?;
        found.variables(&text).map_err(|problem| block(offset, problem))?;
    }
    Ok(found)
}

/// Bits of each handle.
fn widths(bytes: &[u8]) -> Result<Vec<Option<u32>>, FstProblem> {
    let (size, handles) =
        (wide(bytes, 0).ok_or(FstProblem::Short)?, wide(bytes, 8).ok_or(FstProblem::Short)?);
    let packed = bytes.get(16..).unwrap_or_default();
    let unpacked = match packed.len() as u64 == size {
        true => packed.to_vec(),
        false => Packing::Zlib.unpack(packed, size, "geometry")?,
    };
    if handles > unpacked.len() as u64 {
        return Err(FstProblem::Wrong("number of signals"));
    }
    let mut bytes = Bytes(&unpacked);
    let mut widths = Vec::with_capacity(handles as usize);
    for _ in 0..handles {
        widths.push(match bytes.number()? {
            0 => None,
            0xFFFF_FFFF => Some(0),
            width => Some(u32::try_from(width).map_err(|_| FstProblem::Wrong("width"))?),
        });
    }
    Ok(widths)
}

/// The text of a hierarchy block.
fn unpacked(kind: u8, bytes: &[u8]) -> Result<Vec<u8>, FstProblem> {
    let size = wide(bytes, 0).ok_or(FstProblem::Short)?;
    let packed = bytes.get(8..).unwrap_or_default();
    match kind {
        4 => Packing::Gzip.unpack(packed, size, "hierarchy"),
        6 => Packing::Lz4.unpack(packed, size, "hierarchy"),
        _ => {
            let mut packed = Bytes(packed);
            let once = packed.number()?;
            let once = Packing::Lz4.unpack(packed.0, once, "hierarchy")?;
            Packing::Lz4.unpack(&once, size, "hierarchy")
        }
    }
}

impl Contents {
    /// Scopes and variables.
    fn variables(&mut self, text: &[u8]) -> Result<(), FstProblem> {
        let mut bytes = Bytes(text);
        let (mut scopes, mut handles, mut kept): (Vec<String>, usize, u64) = (Vec::new(), 0, 0);
        while !bytes.is_empty() {
            match bytes.byte()? {
                254 => {
                    bytes.byte()?;
                    scopes.push(bytes.text()?);
                    bytes.text()?;
                    if scopes.len() > SCOPES {
                        return Err(FstProblem::Wrong("nesting of scopes"));
                    }
                }
                255 => drop(scopes.pop()),
                252 => {
                    bytes.take(2)?;
                    bytes.text()?;
                    bytes.number()?;
                }
                253 => {}
                _ => {
                    bytes.byte()?;
                    let name = bytes.text()?;
                    bytes.number()?;
                    let alias = bytes.number()?;
                    if alias == 0 {
                        handles += 1;
                    }
                    let handle = if alias == 0 { handles } else { alias as usize };
                    let width = handle.checked_sub(1).and_then(|index| self.widths.get(index));
                    let width = width.ok_or(FstProblem::Wrong("number of signals"))?.unwrap_or(0);
                    let (name, apart) = name.split_once(' ').unwrap_or((&name, ""));
                    let (name, range) = name_and_range(name, apart.trim(), width);
                    let scope = scopes.join(".");
                    kept += (scope.len() + name.len() + size_of::<Signal>()) as u64;
                    if kept > LIMIT {
                        return Err(FstProblem::TooLarge("hierarchy"));
                    }
                    self.signals.push(Signal { scope, name: name.to_owned(), width, range });
                    self.handles.push(handle - 1);
                }
            }
        }
        Ok(())
    }
}
