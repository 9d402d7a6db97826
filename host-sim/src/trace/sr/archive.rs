//! The archive: opened, and checked before anything in it is inflated.

use std::io::{Read, Seek, SeekFrom};

use zip::{CompressionMethod, ZipArchive};

use super::error::SrError;
use super::metadata::{self, Device};

/// Files that an archive may have: of 4 MiB each, as libsigrok writes them, a tebibyte of samples.
pub(super) const ENTRIES: u64 = 1 << 18;
/// Bytes of metadata that are read.
const METADATA: u64 = 1 << 20;
/// Bytes at the end of a ZIP archive in which its last record begins: itself and its longest comment.
const LAST_RECORD: u64 = 22 + 0xFFFF;

/// A piece of the samples.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    /// Its index in the archive.
    pub(super) index: usize,
    pub(super) name: String,
    /// Inflated bytes, as the archive says.
    pub(super) size: u64,
    /// Bytes in the file.
    pub(super) packed: u64,
}

/// What an archive holds.
#[derive(Clone, Debug)]
pub(super) struct Contents {
    pub(super) device: Device,
    /// In the order of time.
    pub(super) pieces: Vec<Piece>,
}

/// Opens an archive.
pub(super) fn open<R: Read + Seek>(mut file: R) -> Result<ZipArchive<R>, SrError> {
    let entries = count(&mut file)?;
    if entries > ENTRIES {
        return Err(SrError::TooManyEntries(entries));
    }
    file.seek(SeekFrom::Start(0))?;
    let archive = ZipArchive::new(file).map_err(|error| SrError::Archive(error.to_string()))?;
    if archive.len() as u64 > ENTRIES {
        return Err(SrError::TooManyEntries(archive.len() as u64));
    }
    Ok(archive)
}

/// Files that the last record of the archive says there are; 0 if there is no such record, which the archive's reader will say better.
fn count<R: Read + Seek>(file: &mut R) -> Result<u64, SrError> {
    let length = file.seek(SeekFrom::End(0))?;
    let start = length.saturating_sub(LAST_RECORD + 20);
    file.seek(SeekFrom::Start(start))?;
    let mut tail = Vec::new();
    file.take(LAST_RECORD + 20).read_to_end(&mut tail)?;
    let Some(at) = tail.windows(4).rposition(|window| window == b"PK\x05\x06") else { return Ok(0) };
    let number = |bytes: &[u8]| bytes.iter().rev().fold(0_u64, |number, &byte| number << 8 | u64::from(byte));
    let few = tail.get(at + 10..at + 12).map_or(0, number);
    let locator = at
        .checked_sub(20)
        .and_then(|from| tail.get(from..at))
        .filter(|found| found.starts_with(b"PK\x06\x07"));
    let Some(locator) = locator.filter(|_| few == 0xFFFF) else { return Ok(few) };
    file.seek(SeekFrom::Start(locator.get(8..16).map_or(0, number)))?;
    let mut record = Vec::new();
    file.take(40).read_to_end(&mut record)?;
    Ok(record.get(32..40).map_or(few, number))
}

/// Reads version and metadata, and puts the pieces in order.
pub(super) fn contents<R: Read + Seek>(archive: &mut ZipArchive<R>) -> Result<Contents, SrError> {
    let broken = |error: zip::result::ZipError| SrError::Archive(error.to_string());
    if archive.has_duplicate_names() {
        return Err(SrError::Suspicious("…".to_owned(), "is there twice"));
    }
    let mut names = Vec::with_capacity(archive.len());
    for name in archive.file_names() {
        let name = name.map_err(broken)?.into_owned();
        if name.contains(['/', '\\', '\0', ':']) || name == ".." {
            return Err(SrError::Suspicious(shortened(&name), "has a path in its name"));
        }
        names.push(name);
    }
    for (name, others) in [("version", true), ("metadata", false)] {
        if !names.iter().any(|found| found == name) {
            let listed = if others { names.clone() } else { Vec::new() };
            return Err(SrError::NotASession(name, listed));
        }
    }
    if archive.has_overlapping_files().map_err(broken)? {
        return Err(SrError::Suspicious("…".to_owned(), "shares its bytes with another"));
    }
    let version = text(archive, "version", 64)?;
    let version = String::from_utf8_lossy(&version).trim().to_owned();
    if version != "2" {
        return Err(SrError::Version(shortened(&version)));
    }
    let device = metadata::parse(&text(archive, "metadata", METADATA)?)?;
    let pieces = pieces(archive, &names, &device.capturefile)?;
    Ok(Contents { device, pieces })
}

/// `logic-1` alone, or `logic-1-1`, `logic-1-2`, … in the order of their numbers.
fn pieces<R: Read + Seek>(
    archive: &ZipArchive<R>,
    names: &[String],
    stem: &str,
) -> Result<Vec<Piece>, SrError> {
    let mut numbered = Vec::new();
    for (index, name) in names.iter().enumerate() {
        let number = match name.strip_prefix(stem) {
            Some("") => 0,
            // No sign, no leading zero: so that no two names have one number.
            Some(rest) => match rest.strip_prefix('-').map(str::parse::<u64>) {
                Some(Ok(number)) if rest == format!("-{number}") && number > 0 => number,
                _ => continue,
            },
            None => continue,
        };
        let entry = archive.by_index_data(index).map_err(|error| SrError::Archive(error.to_string()))?;
        let packing = |problem| Err(SrError::Packing(shortened(name), problem));
        if entry.encrypted() {
            return packing("encrypted");
        }
        if !matches!(entry.compression(), CompressionMethod::Stored | CompressionMethod::Deflated) {
            return packing("packed in a way that is not read");
        }
        numbered.push((
            number,
            Piece { index, name: name.clone(), size: entry.size(), packed: entry.compressed_size() },
        ));
    }
    numbered.sort_by_key(|(number, _)| *number);
    // One file without a number, or all numbers from 1 on.
    let first = numbered.first().map_or(1, |(number, _)| *number);
    if first == 0 && numbered.len() > 1 {
        return Err(SrError::Suspicious(shortened(stem), "stands beside pieces of the same name"));
    }
    let gap = numbered.iter().zip(first.min(1)..).find(|((number, _), expected)| number != expected);
    if gap.is_some() || numbered.is_empty() {
        let missing = gap.map_or(1, |(_, expected)| expected);
        return Err(SrError::MissingPiece(format!("{}-{missing}", shortened(stem))));
    }
    Ok(numbered.into_iter().map(|(_, piece)| piece).collect())
}

/// A small file of the archive.
fn text<R: Read + Seek>(
    archive: &mut ZipArchive<R>,
    name: &'static str,
    limit: u64,
) -> Result<Vec<u8>, SrError> {
    let file = archive.by_name(name).map_err(|error| SrError::Archive(format!("{name}: {error}")))?;
    let mut text = Vec::new();
    let piece = |offset: usize, error| SrError::Piece { name: name.to_owned(), offset: offset as u64, error };
    let read = file.take(limit + 1).read_to_end(&mut text);
    read.map_err(|error| piece(text.len(), error))?;
    if text.len() as u64 > limit {
        let said = limit;
        return Err(SrError::Size { name: name.to_owned(), said, found: text.len() as u64 });
    }
    Ok(text)
}

fn shortened(text: &str) -> String {
    text.chars().take(48).flat_map(char::escape_default).collect()
}
