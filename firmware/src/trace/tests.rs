//! Round trips, and everything that can happen to a file on its way.

use super::checksum::SmallTable;
use super::layout::{CHUNK_BYTES, HEADER_BYTES};
use super::*;
use core::convert::Infallible;
use proptest::prelude::*;

/// A file in memory that can seek.
struct File<'a>(&'a [u8], usize);

impl embedded_io::ErrorType for File<'_> {
    type Error = Infallible;
}

impl embedded_io::Read for File<'_> {
    fn read(&mut self, buf: &mut [u8]) -> Result<usize, Infallible> {
        let rest = self.0.get(self.1..).unwrap_or_default();
        let count = rest.len().min(buf.len());
        buf[..count].copy_from_slice(&rest[..count]);
        self.1 += count;
        Ok(count)
    }
}

impl embedded_io::Seek for File<'_> {
    fn seek(&mut self, pos: embedded_io::SeekFrom) -> Result<u64, Infallible> {
        self.1 = match pos {
            embedded_io::SeekFrom::Start(at) => at as usize,
            embedded_io::SeekFrom::End(back) => self.0.len().saturating_add_signed(back as isize),
            embedded_io::SeekFrom::Current(on) => self.1.saturating_add_signed(on as isize),
        };
        Ok(self.1 as u64)
    }
}

/// Collects every clock: levels and sample.
#[derive(Default, PartialEq, Debug)]
struct Clocks(Vec<(bool, bool, u16)>);

impl StretchSink for Clocks {
    type Error = Infallible;
    fn stretch(&mut self, sync: Sync, samples: Samples<'_>) -> Result<(), Infallible> {
        self.0.extend((0..samples.len()).map(|i| (sync.hsync, sync.vsync, samples.get(i).unwrap())));
        Ok(())
    }
}

#[derive(Clone, Debug)]
enum Run {
    Literal(Vec<u16>),
    Repeat(u16, u32),
}

type Stretches = Vec<(bool, bool, Run)>;

fn header(bus_bits: u8) -> Header {
    Header { bus_bits, vsync_active: true, pclk_hz: 27_648_000 }
}

fn write(bus_bits: u8, profile: &str, stretches: &Stretches) -> (Vec<u8>, Clocks, Totals) {
    let mut buffer = ChunkBuffer::new();
    let mut writer: Writer<'_, _, SmallTable> =
        Writer::new(VecSink(Vec::new()), header(bus_bits), profile, &mut buffer).unwrap();
    let mut clocks = Clocks::default();
    for (hsync, vsync, run) in stretches {
        let sync = Sync { hsync: *hsync, vsync: *vsync };
        let mut put = |samples: Samples<'_>| {
            writer.stretch(sync, samples).unwrap();
            clocks.stretch(sync, samples).unwrap();
        };
        match run {
            Run::Literal(words) if bus_bits == 8 => {
                put(Samples::Bytes(&words.iter().map(|&word| word as u8).collect::<Vec<_>>()));
            }
            Run::Literal(words) => put(Samples::Words(words)),
            Run::Repeat(value, clocks) => put(Samples::Repeat { value: *value, clocks: *clocks }),
        }
    }
    let (file, totals) = writer.finish().unwrap();
    (file.0, clocks, totals)
}

struct VecSink(Vec<u8>);

impl embedded_io::ErrorType for VecSink {
    type Error = Infallible;
}

impl embedded_io::Write for VecSink {
    fn write(&mut self, buf: &[u8]) -> Result<usize, Infallible> {
        self.0.extend_from_slice(buf);
        Ok(buf.len())
    }
    fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

/// Profile, clocks and totals of a file.
fn read(file: &[u8]) -> Result<(String, Clocks, Totals), Error<Infallible>> {
    let mut buffer = ChunkBuffer::new();
    let mut reader: Reader<'_, _> = Reader::new(File(file, 0), &mut buffer)?;
    let (mut profile, mut clocks, mut totals) = (String::new(), Clocks::default(), Totals::default());
    while let Some(item) = reader.next_item()? {
        match item {
            Item::Profile(part) => profile.push_str(part),
            Item::Stretch(sync, samples) => clocks.stretch(sync, samples).unwrap(),
            Item::End(end) => totals = end,
        }
    }
    assert_eq!(reader.position(), file.len() as u64);
    Ok((profile, clocks, totals))
}

fn stretches(max: u16) -> impl Strategy<Value = Stretches> {
    let run = prop_oneof![
        proptest::collection::vec(0..=max, 0..200).prop_map(Run::Literal),
        (proptest::collection::vec(0..=max, 1..40), 30..100_usize, any::<bool>()).prop_map(
            |(mut data, run, end)| {
                // A run inside, or at the end.
                let at = if end { data.len() } else { data.len() / 2 };
                data.splice(at..at, core::iter::repeat_n(7, run));
                Run::Literal(data)
            }
        ),
        (0..=max, 0..9000_u32).prop_map(|(value, clocks)| Run::Repeat(value, clocks)),
        proptest::collection::vec(0..=max, 3000..6000).prop_map(Run::Literal),
    ];
    proptest::collection::vec((any::<bool>(), any::<bool>(), run), 0..20)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn what_is_written_is_read(
        (bits, stretches) in prop_oneof![
            stretches(0xFF).prop_map(|s| (8, s)),
            stretches(0xFFF).prop_map(|s| (12, s)),
        ],
        profile in ".{0,3000}",
    ) {
        let (file, written, totals) = write(bits, &profile, &stretches);
        let (text, clocks, read_totals) = read(&file).unwrap();
        prop_assert_eq!(text, profile);
        prop_assert!(clocks == written);
        prop_assert_eq!(read_totals, totals);
        prop_assert_eq!(totals.clocks, clocks.0.len() as u64);
    }

    #[test]
    fn every_mark_can_be_jumped_to(stretches in stretches(0xFF)) {
        let (file, written, totals) = write(8, "", &stretches);
        let edges: Vec<usize> = (0..written.0.len())
            .filter(|&i| i == 0 || written.0[i].1 && !written.0[i - 1].1)
            .collect();
        prop_assert_eq!(edges.len() as u64, totals.marks);
        let mut buffer = ChunkBuffer::new();
        let mut reader: Reader<'_, _> = Reader::new(File(&file, 0), &mut buffer).unwrap();
        for (number, &clock) in edges.iter().enumerate().rev() {
            prop_assert_eq!(reader.seek_mark(number as u64).unwrap().clock, clock as u64);
            let mut clocks = Clocks::default();
            reader.play(&mut clocks).unwrap();
            prop_assert!(clocks.0 == written.0[clock..]);
        }
        let past = reader.seek_mark(totals.marks);
        let refused = matches!(past, Err(Error::File { problem: Problem::NoMark { .. }, .. }));
        prop_assert!(refused);
        reader.rewind().unwrap();
        let mut clocks = Clocks::default();
        reader.play(&mut clocks).unwrap();
        prop_assert!(clocks == written);
    }

    #[test]
    fn noise_is_an_error(noise in proptest::collection::vec(any::<u8>(), 0..300), valid_head in any::<bool>()) {
        let mut file = if valid_head { header(8).to_bytes::<SmallTable>().to_vec() } else { Vec::new() };
        file.extend(noise);
        prop_assert!(read(&file).is_err());
    }
}

/// Small, with every kind of chunk and record.
fn small() -> (Vec<u8>, Clocks) {
    let frame: Stretches = Vec::from([
        (true, true, Run::Repeat(0, 5000)),
        (false, false, Run::Literal((0..40).collect())),
        (true, false, Run::Repeat(3, 10)),
        (false, false, Run::Literal(Vec::from([1, 2, 3]))),
    ]);
    let (file, clocks, totals) = write(10, "[bus]\nbits = 10\n", &[frame.clone(), frame].concat());
    assert_eq!(totals.marks, 2);
    assert!(file.len() < CHUNK_BYTES);
    (file, clocks)
}

#[test]
fn every_truncation_is_an_error_and_delivers_a_true_beginning() {
    let (file, whole) = small();
    for length in 0..file.len() {
        let cut = &file[..length];
        let mut buffer = ChunkBuffer::new();
        let mut clocks = Clocks::default();
        let result = match Reader::<'_, _, SmallTable>::new(File(cut, 0), &mut buffer) {
            Ok(mut reader) => reader.play(&mut clocks),
            Err(error) => Err(PlayError::Read(error)),
        };
        let truncated = matches!(
            result,
            Err(PlayError::Read(Error::File { problem: Problem::Truncated, offset })) if offset <= length as u64
        );
        assert!(truncated, "{length}: {result:?}");
        assert!(whole.0.starts_with(&clocks.0));
        let mut reader = match Reader::<'_, _, SmallTable>::new(File(cut, 0), &mut buffer) {
            Ok(reader) => reader,
            Err(_) => continue,
        };
        assert!(reader.seek_mark(1).is_err(), "{length}");
    }
}

#[test]
fn every_flipped_bit_is_an_error() {
    let (file, whole) = small();
    for bit in 0..file.len() * 8 {
        let mut flipped = file.clone();
        flipped[bit / 8] ^= 1 << (bit % 8);
        assert!(read(&flipped).is_err(), "bit {bit}");
        let mut buffer = ChunkBuffer::new();
        if let Ok(mut reader) = Reader::<'_, _, SmallTable>::new(File(&flipped, 0), &mut buffer) {
            // A jump may pass by the damage, but then what follows is the frame or an error.
            let mut clocks = Clocks::default();
            if reader.seek_mark(1).is_ok() {
                let _ = reader.play(&mut clocks);
                assert!(whole.0[whole.0.len() / 2..].starts_with(&clocks.0));
            }
        }
    }
}

#[test]
fn a_missing_or_doubled_chunk_is_noticed() {
    let data: Stretches = Vec::from([(false, false, Run::Literal((0..20_000).map(|i| i % 251).collect()))]);
    let (file, _, _) = write(8, "", &data);
    let (first, second) = (HEADER_BYTES, HEADER_BYTES + CHUNK_BYTES);
    let missing = [&file[..first], &file[second..]].concat();
    let doubled = [&file[..second], &file[first..]].concat();
    for file in [missing, doubled] {
        let result = read(&file);
        assert!(matches!(result, Err(Error::File { problem: Problem::Clock { .. }, .. })), "{result:?}");
    }
}

/// A chunk with a true checksum, whatever its content.
fn chunk(code: u8, flags: u8, payload: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::from([code, flags]);
    bytes.extend((payload.len() as u16).to_le_bytes());
    bytes.extend(payload);
    let crc = <SmallTable as checksum::Checksum>::crc32(&bytes);
    bytes.extend(crc.to_le_bytes());
    bytes
}

#[test]
fn unknown_chunks_are_skipped_or_refused_as_they_say() {
    let end = chunk(b'E', 0, &Totals::default().to_bytes());
    let head = header(8).to_bytes::<SmallTable>();
    assert!(read(&[&head[..], &chunk(b'x', layout::FLAG_SKIPPABLE, b"later"), &end].concat()).is_ok());
    let refused = read(&[&head[..], &chunk(b'x', 0, b"later"), &end].concat());
    assert_eq!(refused, Err(Problem::UnknownChunk { code: b'x' }.at(16)));
}

#[test]
fn hostile_chunks_with_true_checksums_are_refused() {
    let head = header(10).to_bytes::<SmallTable>();
    let data = |records: &[u8]| chunk(b'D', 0, &[&[0; 8], records].concat());
    let index = |before: u64, first: u64, marks: usize| {
        let mut payload = Vec::new();
        payload.extend(before.to_le_bytes());
        payload.extend(first.to_le_bytes());
        payload.resize(16 + 16 * marks, 0);
        chunk(b'I', 0, &payload)
    };
    let cases: [(Vec<u8>, Problem); 10] = [
        (chunk(b'D', 0, &[0; 7]), Problem::Record),
        (data(&[0, 0x30, 0, 0]), Problem::Record),
        (data(&[9, 0x00, 0, 0]), Problem::Record),
        (data(&[0, 0x00, 0xFF, 0x07]), Problem::Sample { value: 0x7FF }),
        (data(&[0, 0x10, 0, 0, 0]), Problem::Record),
        (chunk(b'P', 0, &[0xFF]), Problem::Profile),
        (index(0, 0, 0), Problem::Index),
        (index(16, 0, 1), Problem::Index),
        (index(0, 1, 1), Problem::Index),
        (chunk(b'E', 0, &[0; 23]), Problem::Index),
    ];
    for (bytes, problem) in cases {
        assert_eq!(read(&[&head[..], &bytes].concat()), Err(problem.at(16)));
    }
    // Profile text without end.
    let text = [b'#'; layout::PAYLOAD_BYTES];
    let endless: Vec<u8> = head.iter().copied().chain((0..40).flat_map(|_| chunk(b'P', 0, &text))).collect();
    assert!(matches!(read(&endless), Err(Error::File { problem: Problem::Profile, .. })));
    // An index chain that goes round.
    let end = chunk(b'E', 0, &Totals { clocks: 0, marks: 9, last_index: 16 }.to_bytes());
    let ring = [&head[..], &index(16, 5, 4), &end].concat();
    let mut buffer = ChunkBuffer::new();
    let mut reader = Reader::<'_, _, SmallTable>::new(File(&ring, 0), &mut buffer).unwrap();
    assert_eq!(reader.seek_mark(3).unwrap_err(), Problem::Index.at(16));
}

#[test]
fn blanking_takes_a_few_bytes() {
    let line: Stretches = Vec::from([
        (true, false, Run::Repeat(0, 1 << 30)),
        (true, false, Run::Literal(Vec::from([0; 50_000]))),
    ]);
    let (mut buffer, mut buffer2) = (ChunkBuffer::new(), ChunkBuffer::new());
    let mut writer: Writer<'_, _> = Writer::new(VecSink(Vec::new()), header(8), "", &mut buffer).unwrap();
    for (hsync, vsync, run) in &line {
        let sync = Sync { hsync: *hsync, vsync: *vsync };
        match run {
            Run::Repeat(value, clocks) => {
                writer.stretch(sync, Samples::Repeat { value: *value, clocks: *clocks }).unwrap();
            }
            Run::Literal(words) => writer.stretch(sync, Samples::Words(words)).unwrap(),
        }
    }
    let (file, totals) = writer.finish().unwrap();
    assert_eq!(totals.clocks, (1 << 30) + 50_000);
    assert!(file.0.len() < 200, "{} bytes", file.0.len());
    let mut reader: Reader<'_, _> = Reader::new(File(&file.0, 0), &mut buffer2).unwrap();
    let mut clocks = 0;
    while let Some(item) = reader.next_item().unwrap() {
        if let Item::Stretch(_, samples) = item {
            clocks += samples.len() as u64;
        }
    }
    assert_eq!(clocks, totals.clocks);
}

#[test]
fn samples_wider_than_the_bus_are_refused_where_they_stand() {
    let mut buffer = ChunkBuffer::new();
    let mut writer: Writer<'_, _> = Writer::new(VecSink(Vec::new()), header(8), "", &mut buffer).unwrap();
    let sync = Sync::default();
    writer.stretch(sync, Samples::Repeat { value: 1, clocks: 100 }).unwrap();
    let error = writer.stretch(sync, Samples::Words(&[1, 2, 256])).unwrap_err();
    assert_eq!(error, WriteError::Sample { clock: 102, value: 256, bus_bits: 8 });
}
