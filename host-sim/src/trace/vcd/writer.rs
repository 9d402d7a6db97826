//! Stretches to a VCD file.
//!
//! ```text
//!                       clock k         clock k+1
//! time        t(2k)      t(2k+1)     t(2k+2)    t(2k+3)      t(n) = n half periods
//! PCLK      ───┐          ┌───────────┐          ┌──────
//!              └──────────┘           └──────────┘           rising active edge
//! data        ╳ changes here (OppositeEdge)   ╳ or with the active edge (WithEdge)
//! ```

use std::io::Write;

use firmware::camif::pins::{Edge, Samples, Sync};
use firmware::trace::StretchSink;

use super::ticks::Ticks;

/// How the data bus is declared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Layout {
    /// A wire a bit: `D0`, `D1`, …
    #[default]
    Wires,
    /// A vector: `D [7:0]`.
    Bus,
}

/// When data and sync change.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Style {
    /// With the inactive edge, half a period before they are sampled, as sensors do.
    #[default]
    OppositeEdge,
    /// In the time stamp of the active edge, before it.
    WithEdge,
}

/// What the wires are called.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct VcdNames {
    /// Pixel clock.
    pub pclk: String,
    /// Line sync.
    pub hsync: String,
    /// Frame sync.
    pub vsync: String,
    /// The bus, or what stands before the numbers of its lines.
    pub data: String,
}

impl Default for VcdNames {
    fn default() -> Self {
        Self { pclk: "PCLK".into(), hsync: "HSYNC".into(), vsync: "VSYNC".into(), data: "D".into() }
    }
}

/// How a VCD is to be written.
#[derive(Clone, Debug)]
pub struct VcdWriterOptions {
    /// Width of the data bus: 8, 10, 12 or 14.
    pub bus_bits: u8,
    /// Pixel clock in hertz, not 0.
    pub pclk_hz: u32,
    /// The active edge of the pixel clock.
    pub edge: Edge,
    /// How the bus is declared.
    pub layout: Layout,
    /// When data changes.
    pub style: Style,
    /// What the wires are called.
    pub names: VcdNames,
}

impl VcdWriterOptions {
    /// A wire a bit, changes with the inactive edge, rising edge active, plain names.
    #[must_use]
    pub fn new(bus_bits: u8, pclk_hz: u32) -> Self {
        Self {
            bus_bits,
            pclk_hz,
            edge: Edge::Rising,
            layout: Layout::default(),
            style: Style::default(),
            names: VcdNames::default(),
        }
    }
}

/// Why a VCD could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum VcdWriteError {
    /// The output failed.
    #[error(transparent)]
    Io(#[from] std::io::Error),
    /// The bus has no width that there is.
    #[error("a bus of {0} bits; it must be 8, 10, 12 or 14")]
    BusBits(u8),
    /// A clock of 0 Hz has no times.
    #[error("the pixel clock is unknown, and a VCD needs times; give pclk_hz in the profile")]
    NoClock,
    /// A name that a VCD cannot have.
    #[error("`{0}` cannot be the name of a wire; use printable characters without blanks")]
    Name(String),
    /// A sample does not fit the bus.
    #[error("sample 0x{value:X} at clock {clock} does not fit a bus of {bus_bits} bits")]
    Sample {
        /// Number of its clock.
        clock: u64,
        /// The sample.
        value: u16,
        /// Width of the bus.
        bus_bits: u8,
    },
}

/// Text collected before it is written.
const BUFFER: usize = 1 << 16;
/// More than the text of one clock.
const CLOCK_TEXT: usize = 256;

const PCLK_ID: u8 = b'P';
const HSYNC_ID: u8 = b'H';
const VSYNC_ID: u8 = b'V';
const BUS_ID: u8 = b'D';
const LINE_IDS: [u8; 14] = *b"abcdefghijklmn";

/// Writes a VCD. After an error the output is not a whole one.
#[derive(Debug)]
pub struct VcdWriter<W> {
    out: W,
    text: Vec<u8>,
    ticks: Ticks,
    options: VcdWriterOptions,
    active: u8,
    idle: u8,
    sync: Sync,
    value: u16,
    clocks: u64,
}

impl<W: Write> VcdWriter<W> {
    /// Writes the declarations.
    ///
    /// # Errors
    /// If the options have no VCD, or the output fails.
    pub fn new(out: W, options: VcdWriterOptions) -> Result<Self, VcdWriteError> {
        if !matches!(options.bus_bits, 8 | 10 | 12 | 14) {
            return Err(VcdWriteError::BusBits(options.bus_bits));
        }
        if options.pclk_hz == 0 {
            return Err(VcdWriteError::NoClock);
        }
        let names = [&options.names.pclk, &options.names.hsync, &options.names.vsync, &options.names.data];
        if let Some(name) =
            names.into_iter().find(|name| name.is_empty() || !name.bytes().all(|b| b.is_ascii_graphic()))
        {
            return Err(VcdWriteError::Name(name.clone()));
        }
        let (ticks, unit) = Ticks::new(options.pclk_hz);
        let (idle, active) = if options.edge == Edge::Rising { (b'0', b'1') } else { (b'1', b'0') };
        let (sync, value) = (Sync::default(), 0);
        let mut writer = Self {
            out,
            text: Vec::with_capacity(BUFFER + CLOCK_TEXT),
            ticks,
            options,
            active,
            idle,
            sync,
            value,
            clocks: 0,
        };
        writer.declare(unit);
        Ok(writer)
    }

    fn declare(&mut self, unit: &str) {
        let names = &self.options.names;
        let mut text =
            format!("$version camif host-sim $end\n$timescale {unit} $end\n$scope module camera $end\n");
        let mut wire = |width: u8, id: u8, name: &str| {
            text.push_str(&format!("$var wire {width} {} {name} $end\n", char::from(id)));
        };
        wire(1, PCLK_ID, &names.pclk);
        wire(1, HSYNC_ID, &names.hsync);
        wire(1, VSYNC_ID, &names.vsync);
        let bits = self.options.bus_bits;
        match self.options.layout {
            Layout::Wires => {
                for (line, &id) in LINE_IDS.iter().take(usize::from(bits)).enumerate() {
                    wire(1, id, &format!("{}{line}", names.data));
                }
            }
            Layout::Bus => wire(bits, BUS_ID, &format!("{} [{}:0]", names.data, bits - 1)),
        }
        text.push_str("$upscope $end\n$enddefinitions $end\n");
        self.text.extend_from_slice(text.as_bytes());
    }

    /// Where the wires stand before the first clock.
    fn dump(&mut self, sync: Sync, value: u16) {
        self.text.extend_from_slice(b"#0\n$dumpvars\n");
        (self.sync, self.value) = (Sync { hsync: !sync.hsync, vsync: !sync.vsync }, !value);
        self.clock_level(self.idle);
        self.wires(sync, value);
        self.text.extend_from_slice(b"$end\n");
    }

    /// Closes the last clock, writes what is held and gives the output back, with the number of clocks.
    ///
    /// # Errors
    /// The output's.
    pub fn finish(mut self) -> Result<(W, u64), VcdWriteError> {
        if self.clocks == 0 {
            self.dump(Sync::default(), 0);
        } else {
            self.stamp();
            self.clock_level(self.idle);
        }
        self.out.write_all(&self.text)?;
        self.out.flush()?;
        Ok((self.out, self.clocks))
    }

    /// One pixel clock.
    #[inline]
    fn clock(&mut self, sync: Sync, value: u16) -> Result<(), VcdWriteError> {
        if value >> self.options.bus_bits != 0 {
            let bus_bits = self.options.bus_bits;
            return Err(VcdWriteError::Sample { clock: self.clocks, value, bus_bits });
        }
        let with_edge = self.options.style == Style::WithEdge;
        if self.clocks == 0 {
            // With the edge, the first data still has to change.
            if with_edge { self.dump(Sync::default(), 0) } else { self.dump(sync, value) }
        } else {
            self.stamp();
            self.clock_level(self.idle);
            if !with_edge {
                self.wires(sync, value);
            }
        }
        self.ticks.advance();
        self.stamp();
        if with_edge {
            self.wires(sync, value);
        }
        self.clock_level(self.active);
        self.ticks.advance();
        self.clocks += 1;
        if self.text.len() >= BUFFER {
            self.out.write_all(&self.text)?;
            self.text.clear();
        }
        Ok(())
    }

    #[inline]
    fn stamp(&mut self) {
        let mut digits = itoa::Buffer::new();
        self.text.push(b'#');
        self.text.extend_from_slice(digits.format(self.ticks.now).as_bytes());
        self.text.push(b'\n');
    }

    #[inline]
    fn clock_level(&mut self, level: u8) {
        self.text.extend_from_slice(&[level, PCLK_ID, b'\n']);
    }

    /// The wires that change.
    #[inline]
    fn wires(&mut self, sync: Sync, value: u16) {
        if sync != self.sync {
            if sync.hsync != self.sync.hsync {
                self.text.extend_from_slice(&[b'0' + u8::from(sync.hsync), HSYNC_ID, b'\n']);
            }
            if sync.vsync != self.sync.vsync {
                self.text.extend_from_slice(&[b'0' + u8::from(sync.vsync), VSYNC_ID, b'\n']);
            }
            self.sync = sync;
        }
        let mut changed = (value ^ self.value) & ((1 << self.options.bus_bits) - 1);
        self.value = value;
        if changed == 0 {
            return;
        }
        if self.options.layout == Layout::Wires {
            while changed != 0 {
                let line = changed.trailing_zeros() as usize;
                let level = b'0' + (value >> line & 1) as u8;
                self.text.extend_from_slice(&[level, LINE_IDS[line % LINE_IDS.len()], b'\n']);
                changed &= changed - 1;
            }
        } else {
            self.text.push(b'b');
            self.text.extend((0..self.options.bus_bits).rev().map(|line| b'0' + (value >> line & 1) as u8));
            self.text.extend_from_slice(&[b' ', BUS_ID, b'\n']);
        }
    }
}

impl<W: Write> StretchSink for VcdWriter<W> {
    type Error = VcdWriteError;

    fn stretch(&mut self, sync: Sync, samples: Samples<'_>) -> Result<(), VcdWriteError> {
        match samples {
            Samples::Bytes(bytes) => bytes.iter().try_for_each(|&byte| self.clock(sync, u16::from(byte))),
            Samples::Words(words) => words.iter().try_for_each(|&word| self.clock(sync, word)),
            Samples::Repeat { value, clocks } => (0..clocks).try_for_each(|_| self.clock(sync, value)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(options: VcdWriterOptions) -> String {
        let mut writer = VcdWriter::new(Vec::new(), options).unwrap();
        writer.stretch(Sync { hsync: true, vsync: false }, Samples::Bytes(&[1])).unwrap();
        writer.stretch(Sync::default(), Samples::Repeat { value: 0x81, clocks: 1 }).unwrap();
        String::from_utf8(writer.finish().unwrap().0).unwrap()
    }

    #[test]
    fn both_styles_and_layouts_as_text() {
        let plain = written(VcdWriterOptions::new(8, 10_000_000));
        assert!(
            plain.contains("$timescale 10 ns $end") && plain.contains("$var wire 1 h D7 $end"),
            "{plain}"
        );
        let changes = plain.split("$enddefinitions $end\n").nth(1).unwrap();
        let expected = "#0\n$dumpvars\n0P\n1H\n0V\n1a\n0b\n0c\n0d\n0e\n0f\n0g\n0h\n$end\n\
                        #5\n1P\n#10\n0P\n0H\n1h\n#15\n1P\n#20\n0P\n";
        assert_eq!(changes, expected);
        let options = VcdWriterOptions {
            layout: Layout::Bus,
            style: Style::WithEdge,
            edge: Edge::Falling,
            ..VcdWriterOptions::new(8, 10_000_000)
        };
        let bus = written(options);
        assert!(bus.contains("$var wire 8 D D [7:0] $end"), "{bus}");
        let changes = bus.split("$enddefinitions $end\n").nth(1).unwrap();
        let expected = "#0\n$dumpvars\n1P\n0H\n0V\nb00000000 D\n$end\n\
                        #5\n1H\nb00000001 D\n0P\n#10\n1P\n#15\n0H\nb10000001 D\n0P\n#20\n1P\n";
        assert_eq!(changes, expected);
    }

    #[test]
    fn what_cannot_be_written_is_refused() {
        assert!(matches!(
            VcdWriter::new(Vec::new(), VcdWriterOptions::new(9, 1)),
            Err(VcdWriteError::BusBits(9))
        ));
        assert!(matches!(
            VcdWriter::new(Vec::new(), VcdWriterOptions::new(8, 0)),
            Err(VcdWriteError::NoClock)
        ));
        let names = VcdNames { pclk: "pixel clock".into(), ..VcdNames::default() };
        let options = VcdWriterOptions { names, ..VcdWriterOptions::new(8, 1) };
        assert!(matches!(VcdWriter::new(Vec::new(), options), Err(VcdWriteError::Name(_))));
        let mut writer = VcdWriter::new(Vec::new(), VcdWriterOptions::new(10, 1)).unwrap();
        let wide = writer.stretch(Sync::default(), Samples::Words(&[0x3FF, 0x400]));
        assert!(matches!(wide, Err(VcdWriteError::Sample { clock: 1, value: 0x400, .. })));
    }
}
