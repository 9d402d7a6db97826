//! A section of changes: its times, how the signals stand at its beginning, and the chains of those that are wanted.

use std::io::{Read, Seek};

use super::bytes::Bytes;
use super::error::{FstError, FstProblem};
use super::header::{Place, block, body, wide};
use super::packed::Packing;

/// A section, unpacked as far as it is wanted.
#[derive(Debug)]
pub(super) struct Section {
    pub(super) begin: u64,
    pub(super) times: Vec<u64>,
    /// A character a bit of all signals, in the order of their handles.
    pub(super) frame: Vec<u8>,
    /// For each wanted handle: its changes.
    pub(super) chains: Vec<Vec<u8>>,
}

/// Where the changes of a handle are.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Chain {
    None,
    /// From here to there.
    Own(u64, u64),
    /// Those of an earlier handle.
    Alias(usize),
}

pub(super) fn read<R: Read + Seek>(
    file: &mut R,
    place: Place,
    signals: usize,
    wanted: &[usize],
) -> Result<Section, FstError> {
    let Place { offset, length, alias2 } = place;
    let wrong = |problem| block(offset, problem);
    let odd = |what| block(offset, FstProblem::Wrong(what));
    // Behind the type: length, begin, end, memory; at the end three sizes of the table of times.
    let (start, end) = (offset + 1, offset + 1 + length);
    if length < 8 * 4 + 8 * 4 + 4 {
        return Err(wrong(FstProblem::Short));
    }
    let head = body(file, offset, start + 8, 8, "head")?;
    let begin = wide(&head, 0).unwrap_or(0);
    let tail = body(file, offset, end - 24, 24, "sizes")?;
    let sizes = [0, 8, 16].map(|at| wide(&tail, at).unwrap_or(u64::MAX));
    let [time_size, time_packed, time_count] = sizes;
    let data = start + 32;
    let times_at = (end - 24).checked_sub(time_packed).filter(|&at| at >= data + 8);
    let times_at = times_at.ok_or_else(|| odd("table of times"))?;
    let packed = body(file, offset, times_at, time_packed, "table of times")?;
    let times = times(&packed, time_size, time_count).map_err(wrong)?;
    let index_size = wide(&body(file, offset, times_at - 8, 8, "index")?, 0).unwrap_or(u64::MAX);
    let index_at = (times_at - 8).checked_sub(index_size).filter(|&at| at >= data);
    let index_at = index_at.ok_or_else(|| odd("index"))?;
    let index = body(file, offset, index_at, index_size, "index")?;
    // The frame, and behind it the chains.
    let numbers = body(file, offset, data, (index_at - data).min(30), "frame")?;
    let mut bytes = Bytes(&numbers);
    let mut number = || bytes.number().map_err(wrong);
    let (frame_size, frame_packed, _) = (number()?, number()?, number()?);
    let frame_at = data + (numbers.len() - bytes.0.len()) as u64;
    let chains_at = frame_at.checked_add(frame_packed).filter(|&at| at < index_at);
    let chains_at = chains_at.ok_or_else(|| odd("frame"))?;
    let frame = body(file, offset, frame_at, frame_packed, "frame")?;
    let frame = match frame_size == frame_packed {
        true => frame,
        false => Packing::Zlib.unpack(&frame, frame_size, "frame").map_err(wrong)?,
    };
    let numbers = body(file, offset, chains_at, (index_at - chains_at).min(11), "chains")?;
    let mut bytes = Bytes(&numbers);
    let handles = bytes.number().map_err(wrong)?;
    if handles > signals as u64 {
        return Err(odd("number of signals"));
    }
    let base = chains_at + (numbers.len() - bytes.0.len()) as u64;
    let packing = match bytes.byte().map_err(wrong)? {
        b'4' => Packing::Lz4,
        b'F' => Packing::FastLz,
        _ => Packing::Zlib,
    };
    let room = index_at - base;
    let index = match alias2 {
        true => index_of_the_second_kind(&index, signals, room),
        false => index_of_the_first_kind(&index, signals, room),
    };
    let index = index.map_err(wrong)?;
    let mut chains = Vec::with_capacity(wanted.len());
    for &handle in wanted {
        let mut chain = index.get(handle).copied().unwrap_or(Chain::None);
        if let Chain::Alias(of) = chain {
            chain = index.get(of).copied().unwrap_or(Chain::None);
        }
        chains.push(match chain {
            Chain::Own(from, to) => {
                let bytes = body(file, offset, base + from, to - from, "chain")?;
                let mut packed = Bytes(&bytes);
                match packed.number().map_err(wrong)? {
                    0 => packed.0.to_vec(),
                    size => packing.unpack(packed.0, size, "chain").map_err(wrong)?,
                }
            }
            _ => Vec::new(),
        });
    }
    Ok(Section { begin, times, frame, chains })
}

fn times(packed: &[u8], size: u64, count: u64) -> Result<Vec<u64>, FstProblem> {
    let unpacked = match packed.len() as u64 == size {
        true => packed.to_vec(),
        false => Packing::Zlib.unpack(packed, size, "table of times")?,
    };
    if count > unpacked.len() as u64 {
        return Err(FstProblem::Wrong("table of times"));
    }
    let mut bytes = Bytes(&unpacked);
    let (mut time, mut times) = (0_u64, Vec::with_capacity(count as usize));
    for _ in 0..count {
        time = time.checked_add(bytes.number()?).ok_or(FstProblem::Wrong("table of times"))?;
        times.push(time);
    }
    Ok(times)
}

/// Chains whose ends are where the next one begins.
struct Index {
    chains: Vec<Chain>,
    open: Option<(usize, u64)>,
    signals: usize,
    room: u64,
}

impl Index {
    fn new(signals: usize, room: u64) -> Self {
        Self { chains: Vec::new(), open: None, signals, room }
    }

    fn push(&mut self, chain: Chain) -> Result<(), FstProblem> {
        self.chains.push(chain);
        if self.chains.len() > self.signals { Err(FstProblem::Wrong("index")) } else { Ok(()) }
    }

    /// The next chain begins `ahead` bytes behind where the last one did.
    fn begin(&mut self, ahead: u64) -> Result<(), FstProblem> {
        let at = self.open.map_or(0, |(_, at)| at).checked_add(ahead).filter(|&at| at <= self.room);
        let at = at.ok_or(FstProblem::Wrong("index"))?;
        self.end(at);
        self.open = Some((self.chains.len(), at));
        self.push(Chain::None)
    }

    fn end(&mut self, to: u64) {
        if let Some((handle, from)) = self.open
            && let Some(chain) = self.chains.get_mut(handle)
        {
            *chain = Chain::Own(from, to);
        }
    }

    fn skip(&mut self, handles: u64) -> Result<(), FstProblem> {
        if handles > (self.signals - self.chains.len()) as u64 {
            return Err(FstProblem::Wrong("index"));
        }
        self.chains.resize(self.chains.len() + handles as usize, Chain::None);
        Ok(())
    }

    fn finish(mut self) -> Vec<Chain> {
        self.end(self.room);
        self.chains
    }
}

fn index_of_the_second_kind(bytes: &[u8], signals: usize, room: u64) -> Result<Vec<Chain>, FstProblem> {
    let (mut bytes, mut index, mut alias) = (Bytes(bytes), Index::new(signals, room), 0);
    while let Some(first) = bytes.0.first() {
        if first & 1 == 0 {
            let handles = bytes.number()? >> 1;
            index.skip(handles)?;
            continue;
        }
        match bytes.signed()? >> 1 {
            ahead @ 1.. => index.begin(ahead.unsigned_abs())?,
            0 => index.push(Chain::Alias(alias))?,
            of => {
                alias = usize::try_from(of.unsigned_abs() - 1).unwrap_or(usize::MAX);
                index.push(Chain::Alias(alias))?;
            }
        }
    }
    Ok(index.finish())
}

fn index_of_the_first_kind(bytes: &[u8], signals: usize, room: u64) -> Result<Vec<Chain>, FstProblem> {
    let (mut bytes, mut index) = (Bytes(bytes), Index::new(signals, room));
    while !bytes.is_empty() {
        match bytes.number()? {
            0 => {
                let of = bytes.number()?.checked_sub(1).and_then(|of| usize::try_from(of).ok());
                index.push(Chain::Alias(of.unwrap_or(usize::MAX)))?;
            }
            ahead if ahead & 1 == 1 => index.begin(ahead >> 1)?,
            handles => index.skip(handles >> 1)?,
        }
    }
    Ok(index.finish())
}
