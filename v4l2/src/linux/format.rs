use super::call::{
    ENUMERATE_FORMATS, ENUMERATE_INTERVALS, ENUMERATE_SIZES, GET_FORMAT, GET_PARAMETERS, SET_FORMAT,
    SET_PARAMETERS,
};
use super::device::Device;
use super::error::Error;
use super::raw::{self, Plain, text};
use crate::four_cc::FourCc;

/// A pixel format that a device offers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PixelFormat {
    /// Its code.
    pub code: FourCc,
    /// Its name, for people.
    pub name: String,
    /// Flags `V4L2_FMT_FLAG_…`: 1 compressed, 2 emulated.
    pub flags: u32,
}

/// The sizes that a device offers in a format.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Sizes {
    /// These widths and heights.
    These(Vec<(u32, u32)>),
    /// All from the least to the greatest in steps.
    Range {
        /// Least width and height.
        least: (u32, u32),
        /// Greatest width and height.
        greatest: (u32, u32),
        /// Steps of width and height.
        step: (u32, u32),
    },
}

/// Seconds a frame takes, as a fraction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Interval {
    /// Above the line.
    pub numerator: u32,
    /// Below the line.
    pub denominator: u32,
}

impl Interval {
    /// Frames a second; 0 if the interval is none.
    #[must_use]
    pub fn rate(self) -> f64 {
        if self.numerator == 0 { 0.0 } else { f64::from(self.denominator) / f64::from(self.numerator) }
    }

    /// The interval of a number of frames a second, to a thousandth.
    #[must_use]
    pub fn of_rate(rate: f64) -> Self {
        let scaled = (rate * 1000.0).round().clamp(1.0, f64::from(u32::MAX)) as u32;
        if scaled.is_multiple_of(1000) {
            Self { numerator: 1, denominator: scaled / 1000 }
        } else {
            Self { numerator: 1000, denominator: scaled }
        }
    }
}

/// How frames stand in memory: what was asked for, or what the device does.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Format {
    /// Pixel format.
    pub code: FourCc,
    /// Pixels a line.
    pub width: u32,
    /// Lines.
    pub height: u32,
    /// `V4L2_FIELD_…`: 1 progressive.
    pub field: u32,
    /// `V4L2_COLORSPACE_…`
    pub colorspace: u32,
    /// `V4L2_YCBCR_ENC_…`; 0 is what the colour space says.
    pub encoding: u32,
    /// `V4L2_QUANTIZATION_…`: 1 full, 2 limited, 0 what the colour space says.
    pub quantization: u32,
    /// Each piece of memory of a buffer.
    pub planes: Vec<PlaneLayout>,
}

/// A piece of memory of a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlaneLayout {
    /// Bytes from the start of a line to the start of the next.
    pub stride: u32,
    /// Bytes of the piece.
    pub bytes: u32,
}

impl Format {
    fn from_raw(raw: &raw::Format) -> Self {
        let word = |index: usize| raw.fmt[index];
        if raw.kind == raw::CAPTURE {
            return Self {
                code: FourCc(word(2)),
                width: word(0),
                height: word(1),
                field: word(3),
                colorspace: word(6),
                encoding: word(9),
                quantization: word(10),
                planes: vec![PlaneLayout { stride: word(4), bytes: word(5) }],
            };
        }
        // After the five words of the head, five words a plane, and then bytes: planes, flags, encoding, quantization.
        let [planes, _, encoding, quantization] = word(5 + 5 * raw::PLANES).to_ne_bytes();
        let plane = |index| PlaneLayout { bytes: word(5 + 5 * index), stride: word(6 + 5 * index) };
        Self {
            code: FourCc(word(2)),
            width: word(0),
            height: word(1),
            field: word(3),
            colorspace: word(4),
            encoding: encoding.into(),
            quantization: quantization.into(),
            planes: (0..usize::from(planes).min(raw::PLANES)).map(plane).collect(),
        }
    }
}

impl Device {
    fn enumerate_formats(&self) -> Result<Vec<raw::FormatDescription>, Error> {
        self.enumerate(&ENUMERATE_FORMATS, |index| raw::FormatDescription {
            index,
            kind: self.kind,
            ..raw::FormatDescription::ZERO
        })
    }

    /// The pixel formats that the device offers.
    ///
    /// # Errors
    /// If the device does not answer.
    pub fn formats(&self) -> Result<Vec<PixelFormat>, Error> {
        let all = self.enumerate_formats()?.into_iter();
        Ok(all
            .map(|raw| PixelFormat {
                code: FourCc(raw.pixel_format),
                name: text(&raw.description),
                flags: raw.flags,
            })
            .collect())
    }

    /// The sizes of a format; none of a device that does not list them.
    ///
    /// # Errors
    /// If the device does not answer.
    pub fn sizes(&self, code: FourCc) -> Result<Sizes, Error> {
        let ask = |index| raw::FrameSize { index, pixel_format: code.0, ..raw::FrameSize::ZERO };
        let all = match self.enumerate(&ENUMERATE_SIZES, ask) {
            Err(error) if error.is_unsupported() => Vec::new(),
            other => other?,
        };
        if let Some(raw::FrameSize {
            kind: 2..,
            size: [least_x, most_x, step_x, least_y, most_y, step_y],
            ..
        }) = all.first()
        {
            return Ok(Sizes::Range {
                least: (*least_x, *least_y),
                greatest: (*most_x, *most_y),
                step: (*step_x, *step_y),
            });
        }
        Ok(Sizes::These(all.iter().map(|one| (one.size[0], one.size[1])).collect()))
    }

    /// The frame intervals of a format and size, shortest first. Of a device that offers a range, its two ends.
    ///
    /// # Errors
    /// If the device does not answer.
    pub fn intervals(&self, code: FourCc, (width, height): (u32, u32)) -> Result<Vec<Interval>, Error> {
        let ask = |index| raw::FrameInterval {
            index,
            pixel_format: code.0,
            width,
            height,
            ..raw::FrameInterval::ZERO
        };
        let all = match self.enumerate(&ENUMERATE_INTERVALS, ask) {
            Err(error) if error.is_unsupported() => Vec::new(),
            other => other?,
        };
        let mut intervals = Vec::new();
        for one in all {
            let [numerator, denominator, numerator_most, denominator_most, ..] = one.interval;
            intervals.push(Interval { numerator, denominator });
            if one.kind != 1 {
                intervals.push(Interval { numerator: numerator_most, denominator: denominator_most });
            }
        }
        intervals.sort_by(|a, b| b.rate().total_cmp(&a.rate()));
        intervals.dedup();
        Ok(intervals)
    }

    /// How frames stand in memory as the device is set.
    ///
    /// # Errors
    /// If the device does not answer.
    pub fn format(&self) -> Result<Format, Error> {
        let mut raw = raw::Format { kind: self.kind, ..raw::Format::ZERO };
        self.call(&GET_FORMAT, &mut raw)?;
        Ok(Format::from_raw(&raw))
    }

    /// Asks for a pixel format and a size. The device takes the nearest that it can, and that comes back.
    ///
    /// # Errors
    /// If the device refuses: most often it is in use.
    pub fn set_format(&self, code: FourCc, (width, height): (u32, u32)) -> Result<Format, Error> {
        let mut raw = raw::Format { kind: self.kind, ..raw::Format::ZERO };
        (raw.fmt[0], raw.fmt[1], raw.fmt[2], raw.fmt[3]) = (width, height, code.0, raw::PROGRESSIVE);
        if self.kind == raw::CAPTURE {
            raw.fmt[7] = raw::EXTENDED;
        }
        self.call(&SET_FORMAT, &mut raw)?;
        Ok(Format::from_raw(&raw))
    }

    /// The time a frame takes as the device is set; `None` if it does not say.
    ///
    /// # Errors
    /// If the device does not answer.
    pub fn interval(&self) -> Result<Option<Interval>, Error> {
        let mut raw = raw::StreamParameters { kind: self.kind, ..raw::StreamParameters::ZERO };
        match self.call(&GET_PARAMETERS, &mut raw) {
            Err(error) if error.is_unsupported() => return Ok(None),
            other => other?,
        }
        Ok(interval_of(&raw))
    }

    /// Asks for a time a frame. The device takes the nearest that it can, and that comes back; `None` if it can't be
    /// chosen.
    ///
    /// # Errors
    /// If the device refuses.
    pub fn set_interval(&self, interval: Interval) -> Result<Option<Interval>, Error> {
        let mut raw = raw::StreamParameters { kind: self.kind, ..raw::StreamParameters::ZERO };
        (raw.parm[2], raw.parm[3]) = (interval.numerator, interval.denominator);
        match self.call(&SET_PARAMETERS, &mut raw) {
            Err(error) if error.is_unsupported() => return Ok(None),
            other => other?,
        }
        // `V4L2_CAP_TIMEPERFRAME`
        Ok(if raw.parm[0] & 0x1000 == 0 { None } else { interval_of(&raw) })
    }
}

fn interval_of(raw: &raw::StreamParameters) -> Option<Interval> {
    let interval = Interval { numerator: raw.parm[2], denominator: raw.parm[3] };
    (interval.numerator != 0 && interval.denominator != 0).then_some(interval)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_become_intervals() {
        let of = |rate| {
            let interval = Interval::of_rate(rate);
            (interval.numerator, interval.denominator)
        };
        assert_eq!(
            [of(30.0), of(29.97), of(0.5), of(-1.0)],
            [(1, 30), (1000, 29970), (1000, 500), (1000, 1)]
        );
        assert_eq!(Interval { numerator: 0, denominator: 5 }.rate(), 0.0);
        assert_eq!(Interval { numerator: 1001, denominator: 30000 }.rate().round(), 30.0);
    }

    #[test]
    fn both_layouts_are_read() {
        let mut raw = raw::Format { kind: raw::CAPTURE, ..raw::Format::ZERO };
        for (index, word) in
            [640, 480, FourCc::new(b"YUYV").0, 1, 1280, 614_400, 8, 0, 0, 1, 2].into_iter().enumerate()
        {
            raw.fmt[index] = word;
        }
        let format = Format::from_raw(&raw);
        assert_eq!(format.planes, [PlaneLayout { stride: 1280, bytes: 614_400 }]);
        assert_eq!((format.field, format.colorspace, format.encoding, format.quantization), (1, 8, 1, 2));
        let mut raw = raw::Format { kind: raw::CAPTURE_PLANES, ..raw::Format::ZERO };
        for (index, word) in [640, 480, FourCc::new(b"NM12").0, 1, 3, 307_200, 640].into_iter().enumerate() {
            raw.fmt[index] = word;
        }
        (raw.fmt[10], raw.fmt[11]) = (153_600, 640);
        raw.fmt[45] = u32::from_ne_bytes([2, 0, 1, 2]);
        let format = Format::from_raw(&raw);
        let stride = 640;
        assert_eq!(
            format.planes,
            [PlaneLayout { stride, bytes: 307_200 }, PlaneLayout { stride, bytes: 153_600 }]
        );
        assert_eq!((format.colorspace, format.encoding, format.quantization), (3, 1, 2));
        raw.fmt[45] = u32::from_ne_bytes([255, 0, 0, 0]);
        assert_eq!(Format::from_raw(&raw).planes.len(), 8, "no more than there is room for");
    }
}
