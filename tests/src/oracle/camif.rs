//! The block once more, as a person would explain it with the whole recording on the table: cut it into frames, the
//! frames into lines, and take what is asked for. No registers, no FIFO, no time.

/// One pixel clock of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Clock {
    /// Level of HSYNC.
    pub hsync: bool,
    /// Level of VSYNC.
    pub vsync: bool,
    /// The data bus.
    pub data: u16,
}

/// How the recording tells frames and lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sync {
    /// Data counts outside blanking.
    Gated,
    /// Every clock is data; a rising marker ends what came before it.
    Marker,
    /// FF 00 00 XY: frame start, line start, line end, frame end, compared bit by bit under the masks.
    Embedded {
        /// FSC, LSC, LEC, FEC.
        codes: [u8; 4],
        /// Their masks.
        masks: [u8; 4],
    },
}

/// What is taken, in the words of the manual.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wanted {
    /// How frames and lines are told.
    pub sync: Sync,
    /// Blanking (or marker) level of HSYNC.
    pub hsync_level: bool,
    /// Blanking (or marker) level of VSYNC.
    pub vsync_level: bool,
    /// Data wires.
    pub bits: u32,
    /// One frame of this many is taken.
    pub every: usize,
    /// First clock and clocks, first line and lines of the window.
    pub crop: Option<((usize, usize), (usize, usize))>,
    /// Positions of each four clocks that are taken.
    pub bytes_of_four: [bool; 4],
    /// Positions of each two lines that are taken.
    pub lines_of_two: [bool; 2],
    /// The frame is one run of data, padded to a word.
    pub jpeg: bool,
}

/// A frame as lines of samples.
#[derive(Default)]
struct Frame {
    lines: Vec<Vec<u16>>,
    /// It ended as frames do; otherwise the recording ended, or a code came out of place, and `lines` are those before.
    whole: bool,
}

/// The frames that end up in memory, byte by byte.
#[must_use]
pub fn frames(recording: &[Clock], wanted: &Wanted) -> Vec<Vec<u8>> {
    let frames = match wanted.sync {
        Sync::Gated => gated(recording, wanted),
        Sync::Marker => marked(recording, wanted),
        Sync::Embedded { codes, masks } => embedded(recording, codes, masks),
    };
    frames
        .into_iter()
        .enumerate()
        .filter(|(number, _)| number % wanted.every == 0)
        .filter(|(_, frame)| {
            // What comes after the window's last line no longer matters.
            let window_end = wanted.crop.filter(|_| !wanted.jpeg).map(|(_, (top, height))| top + height);
            frame.whole || window_end.is_some_and(|end| frame.lines.len() >= end)
        })
        .map(|(_, frame)| bytes(&frame.lines, wanted))
        .collect()
}

/// Frames are the stretches between two VSYNC blankings, lines the stretches of valid HSYNC in them.
fn gated(recording: &[Clock], wanted: &Wanted) -> Vec<Frame> {
    let parts: Vec<&[Clock]> = recording.split(|clock| clock.vsync == wanted.vsync_level).collect();
    let last = parts.len() - 1;
    // The first part was under way when the recording started.
    (1..parts.len())
        .filter(|&part| !parts[part].is_empty())
        .map(|part| {
            let whole = part < last;
            let mut lines: Vec<&[Clock]> =
                parts[part].split(|clock| clock.hsync == wanted.hsync_level).collect();
            if !whole {
                lines.pop();
            }
            let lines = lines.into_iter().filter(|line| !line.is_empty());
            Frame { lines: lines.map(|line| line.iter().map(|clock| clock.data).collect()).collect(), whole }
        })
        .collect()
}

/// A cut wherever a wire goes to its marker level; a VSYNC cut ends the frame.
fn marked(recording: &[Clock], wanted: &Wanted) -> Vec<Frame> {
    let goes_to = |wire: fn(&Clock) -> bool, level: bool, at: usize| {
        at > 0 && wire(&recording[at]) == level && wire(&recording[at - 1]) != level
    };
    let mut frames = Vec::new();
    let mut frame = Frame::default();
    let mut line = Vec::new();
    for (at, clock) in recording.iter().enumerate() {
        let frame_ends = goes_to(|clock| clock.vsync, wanted.vsync_level, at);
        if frame_ends || goes_to(|clock| clock.hsync, wanted.hsync_level, at) {
            frame.lines.push(std::mem::take(&mut line));
        }
        if frame_ends {
            frame.whole = true;
            frames.push(std::mem::take(&mut frame));
        }
        line.push(clock.data);
    }
    frames.push(frame);
    frames
}

/// Cuts the bytes at codes and reads them as a sentence. A frame with a code out of place is not whole.
fn embedded(recording: &[Clock], codes: [u8; 4], masks: [u8; 4]) -> Vec<Frame> {
    let bytes: Vec<u8> = recording.iter().map(|clock| clock.data as u8).collect();
    let is = |code: u8, which: usize| code & masks[which] == codes[which] & masks[which];
    let (mut frames, mut frame, mut line) = (Vec::new(), None::<Frame>, None::<Vec<u16>>);
    let mut seen_frame_end = false;
    let mut at = 0;
    while at < bytes.len() {
        if bytes.len() - at < 4 || bytes[at..at + 3] != [0xFF, 0, 0] {
            // The last three bytes of the recording may yet turn into a code.
            if bytes.len() - at >= 4
                && let Some(line) = &mut line
            {
                line.push(u16::from(bytes[at]));
            }
            at += 1;
            continue;
        }
        let code = bytes[at + 3];
        at += 4;
        let starts_frame = codes[0] != 0xFF && is(code, 0);
        let (starts_line, ends_line) = (is(code, 1), is(code, 2));
        let ends_frame =
            if codes[3] == 0xFF { !starts_frame && !starts_line && !ends_line } else { is(code, 3) };
        match (&mut frame, &mut line) {
            (Some(frame), open @ Some(_)) if ends_line => frame.lines.extend(open.take()),
            (Some(_), open @ None) if starts_line => *open = Some(Vec::new()),
            (open @ Some(_), None) if ends_frame => {
                frames.extend(open.take().map(|frame| Frame { whole: true, ..frame }));
                seen_frame_end = true;
            }
            (open @ Some(_), _) if starts_frame || starts_line || ends_line || ends_frame => {
                frames.extend(open.take());
                line = None;
                seen_frame_end = ends_frame;
            }
            (None, _) if starts_frame => (frame, seen_frame_end) = (Some(Frame::default()), false),
            (None, open) if codes[0] == 0xFF && starts_line && seen_frame_end => {
                (frame, seen_frame_end) = (Some(Frame::default()), false);
                *open = Some(Vec::new());
            }
            (None, _) if ends_frame => seen_frame_end = true,
            _ => {}
        }
    }
    frames.extend(frame);
    frames
}

fn bytes(lines: &[Vec<u16>], wanted: &Wanted) -> Vec<u8> {
    let mut memory = Vec::new();
    for (y, line) in lines.iter().enumerate() {
        for (x, &sample) in line.iter().enumerate() {
            let in_window = wanted.crop.is_none_or(|((left, width), (top, height))| {
                (left..left + width).contains(&x) && (top..top + height).contains(&y)
            });
            let selected = wanted.bytes_of_four[x % 4] && wanted.lines_of_two[y % 2];
            if wanted.jpeg || in_window && selected {
                let value = sample & ((1 << wanted.bits) - 1);
                memory.push(value as u8);
                if wanted.bits > 8 {
                    memory.push((value >> 8) as u8);
                }
            }
        }
    }
    // Memory is written in words.
    if wanted.jpeg {
        memory.resize(memory.len().next_multiple_of(4), 0);
    } else {
        memory.truncate(memory.len() / 4 * 4);
    }
    memory
}
