use algos_nostd::clip::Point;
use algos_nostd::color::curve::Curve;
use algos_nostd::color::demosaic::{bilinear, malvar};
use algos_nostd::color::histogram::Histogram;
use algos_nostd::color::pointwise::PixelMap as _;
use algos_nostd::draw::draw_line;
use algos_nostd::image::{Error, Rgb};
use algos_nostd::pixel::bayer::{BayerOrder, mosaic_line};
use algos_nostd::pixel::black_level::BlackLevel;
use algos_nostd::pixel::format::{Format, Meaning};
use algos_nostd::pixel::yuv422::{Coefficients, Matrix, Range};
use algos_nostd::pixel::{BitDepth, raw};

use super::parameter;
use crate::pipeline::arguments::Arguments;
use crate::pipeline::kind::Kind;
use crate::pipeline::picture::{Frame, Picture};
use crate::pipeline::run::Memory;
use crate::pipeline::table::{Input, Output, Parameter, Stage};

const BAYER: Kind = Kind::Word(&[
    ("rggb", "red at the top left"),
    ("bggr", "blue at the top left"),
    ("grbg", "green at the top left, red beside it"),
    ("gbrg", "green at the top left, blue beside it"),
]);
const ORDER: Parameter = parameter("order", BAYER, "rggb", "colours of the mosaic from the top left corner");

pub(super) static STAGES: &[Stage] = &[
    Stage {
        name: "gray",
        aliases: &[("grey", ""), ("luma", "")],
        about: "turns colour into its BT.601 luma",
        input: Input::Gray,
        output: Output::Gray,
        parameters: &[],
        least_width: 1,
        example: "gray",
        apply: |_, picture, _| Ok(picture),
    },
    Stage {
        name: "rgb",
        aliases: &[("colour", ""), ("color", "")],
        about: "gives gray to red, green and blue alike",
        input: Input::Rgb,
        output: Output::Rgb,
        parameters: &[],
        least_width: 1,
        example: "gray|rgb",
        apply: |_, picture, _| Ok(picture),
    },
    Stage {
        name: "gamma",
        aliases: &[],
        about: "raises levels to a power",
        input: Input::Any,
        output: Output::Same,
        parameters: &[parameter(
            "power",
            Kind::Decimal(10, 10_000),
            "0.455",
            "the exponent; below 1 brightens",
        )],
        least_width: 1,
        example: "gamma:0.455",
        apply: |arguments, picture, _| Ok(through(&Curve::gamma(arguments.milli("power"))?, picture)),
    },
    Stage {
        name: "srgb",
        aliases: &[],
        about: "goes between sRGB's values and those in proportion to light",
        input: Input::Any,
        output: Output::Same,
        parameters: &[parameter(
            "direction",
            Kind::Word(&[("to-linear", "undoes sRGB's curve"), ("from-linear", "puts it on")]),
            "to-linear",
            "which way",
        )],
        least_width: 1,
        example: "srgb:to-linear",
        apply: |arguments, picture, _| {
            let to_linear = arguments.is("direction", "to-linear");
            Ok(through(&if to_linear { Curve::srgb_to_linear() } else { Curve::linear_to_srgb() }, picture))
        },
    },
    Stage {
        name: "curve",
        aliases: &[],
        about: "changes levels by straight lines between points",
        input: Input::Any,
        output: Output::Same,
        parameters: &[parameter(
            "points",
            Kind::Pairs(1, 256),
            "0:0;255:255",
            "level in:level out, the levels in ascending",
        )],
        least_width: 1,
        example: "curve:0:0;64:32;192:224;255:255",
        apply: |arguments, picture, _| Ok(through(&Curve::through(arguments.pairs("points"))?, picture)),
    },
    Stage {
        name: "threshold",
        aliases: &[("binary", "")],
        about: "makes white what is above a level, and black the rest",
        input: Input::Gray,
        output: Output::Gray,
        parameters: &[parameter(
            "level",
            Kind::Integer(0, 255),
            "127",
            "the highest level that becomes black",
        )],
        least_width: 1,
        example: "threshold:127",
        apply: |arguments, picture, _| {
            let level: usize = arguments.integer("level");
            Ok(through(
                &Curve::from_table(std::array::from_fn(|value| if value > level { 255 } else { 0 })),
                picture,
            ))
        },
    },
    Stage {
        name: "levels",
        aliases: &[("stretch", "")],
        about: "stretches the levels of each channel to the full range, by its histogram",
        input: Input::Any,
        output: Output::Same,
        parameters: &[
            parameter("low", Kind::Integer(0, 999), "5", "per mille of pixels that become black"),
            parameter("high", Kind::Integer(1, 1000), "995", "per mille of pixels that do not become white"),
        ],
        least_width: 1,
        example: "curve:0:80;255:160|levels",
        apply: levels,
    },
    Stage {
        name: "histogram",
        aliases: &[],
        about: "plots how often each level occurs, 256 × 128 pixels",
        input: Input::Any,
        output: Output::Same,
        parameters: &[],
        least_width: 1,
        example: "histogram",
        apply: |_, picture, _| plot(picture),
    },
    Stage {
        name: "mosaic",
        aliases: &[("bayer", "")],
        about: "keeps of each pixel the colour that a Bayer sensor sees",
        input: Input::Rgb,
        output: Output::Gray,
        parameters: &[ORDER],
        least_width: 1,
        example: "crop:at=20%x20%,size=20%x20%|mosaic:rggb|scale:400%x400%",
        apply: mosaic,
    },
    Stage {
        name: "black-level",
        aliases: &[],
        about: "takes off what a sensor reads in the dark, at each of the mosaic's four places",
        input: Input::Gray,
        output: Output::Gray,
        parameters: &[
            parameter(
                "levels",
                Kind::Numbers(&[4], 0, 16_382_000),
                "16;16;16;16",
                "black at the top left, top right, bottom left, bottom right",
            ),
            parameter(
                "bits",
                Kind::OneOf(&[8, 10, 12, 14]),
                "8",
                "depth in which it is done, and that `levels` are in",
            ),
        ],
        least_width: 1,
        example: "gray|black-level:levels=40;40;40;40",
        apply: black_level,
    },
    Stage {
        name: "demosaic",
        aliases: &[("debayer", "")],
        about: "makes colour of a Bayer mosaic",
        input: Input::Gray,
        output: Output::Rgb,
        parameters: &[
            parameter(
                "method",
                Kind::Word(&[
                    ("bilinear", "the mean of the nearest samples of a colour"),
                    ("malvar", "Malvar, He and Cutler: corrected by the pixel's own colour"),
                ]),
                "bilinear",
                "how missing colours are found",
            ),
            ORDER,
        ],
        least_width: 3,
        example: "crop:at=20%x20%,size=20%x20%|mosaic|demosaic:malvar|scale:400%x400%",
        apply: demosaic,
    },
    Stage {
        name: "format",
        aliases: &[],
        about: "sends the picture through a camera's pixel format, to show what it loses",
        input: Input::Rgb,
        output: Output::Rgb,
        parameters: &[
            parameter(
                "name",
                Kind::Word(&[
                    ("rgb565-be", "5, 6 and 5 bits, high byte first"),
                    ("rgb565-le", "the same, low byte first"),
                    ("rgb888", "8 bits each: loses nothing"),
                    ("gray8", "luma"),
                    ("yuyv", "YUV 4:2:2; lines of an even number of pixels"),
                    ("uyvy", "the same in another order"),
                ]),
                "rgb565-be",
                "the format",
            ),
            parameter(
                "matrix",
                Kind::Word(&[("bt601", "BT.601"), ("bt709", "BT.709")]),
                "bt601",
                "of YUV: what luma is",
            ),
            parameter(
                "range",
                Kind::Word(&[("limited", "black is 16"), ("full", "black is 0")]),
                "limited",
                "of YUV: where black and white lie",
            ),
        ],
        least_width: 1,
        example: "format:rgb565-be",
        apply: format,
    },
];

fn through(curve: &Curve, mut picture: Picture) -> Picture {
    match &mut picture {
        Picture::Rgb(frame) => curve.apply_line(frame.pixels_mut()),
        Picture::Gray(frame) => curve.apply_line(frame.pixels_mut()),
    }
    picture
}

/// Histograms of red, green and blue.
fn histograms(frame: &Frame<Rgb>) -> [Histogram; 3] {
    let mut histograms = [Histogram::new(), Histogram::new(), Histogram::new()];
    for pixel in frame.pixels() {
        for (histogram, value) in histograms.iter_mut().zip([pixel.r, pixel.g, pixel.b]) {
            histogram.count(value);
        }
    }
    histograms
}

fn levels(arguments: &Arguments<'_>, picture: Picture, _: &mut Memory) -> Result<Picture, Error> {
    let (low, high): (u32, u32) = (arguments.integer("low"), arguments.integer("high"));
    if low >= high {
        return Err(Error::Parameter { name: "low", got: low.into(), allowed: "below `high`" });
    }
    let curve = |histogram: &Histogram| match (histogram.quantile(low, 1000), histogram.quantile(high, 1000))
    {
        (Some(black), Some(white)) if black < white => Curve::through(&[(black, 0), (white, 255)]),
        // One level is left: there is nothing to stretch.
        _ => Curve::through(&[(0, 0), (255, 255)]),
    };
    Ok(match picture {
        Picture::Gray(frame) => {
            let mut histogram = Histogram::new();
            histogram.push(frame.pixels());
            through(&curve(&histogram)?, Picture::Gray(frame))
        }
        Picture::Rgb(mut frame) => {
            let [red, green, blue] = histograms(&frame);
            let [red, green, blue] = [curve(&red)?, curve(&green)?, curve(&blue)?];
            for pixel in frame.pixels_mut() {
                *pixel = Rgb { r: red.apply(pixel.r), g: green.apply(pixel.g), b: blue.apply(pixel.b) };
            }
            frame.into()
        }
    })
}

/// Lines of the plot.
const PLOT_HEIGHT: i16 = 128;

fn plot(picture: Picture) -> Result<Picture, Error> {
    let bars = |histogram: &Histogram| -> Result<Frame<u8>, Error> {
        let most = u64::from(histogram.bins().iter().copied().max().unwrap_or(0)).max(1);
        let mut plot = Frame::filled(256, PLOT_HEIGHT as usize, 0);
        let mut view = plot.view_mut()?;
        for (x, &count) in (0i16..).zip(histogram.bins()) {
            let bar = (u64::from(count) * PLOT_HEIGHT as u64).div_ceil(most) as i16;
            if bar > 0 {
                draw_line(&mut view, Point::new(x, PLOT_HEIGHT - 1), Point::new(x, PLOT_HEIGHT - bar), 255);
            }
        }
        Ok(plot)
    };
    match picture {
        Picture::Gray(frame) => {
            let mut histogram = Histogram::new();
            histogram.push(frame.pixels());
            Ok(bars(&histogram)?.into())
        }
        Picture::Rgb(frame) => {
            let [red, green, blue] = histograms(&frame);
            let [red, green, blue] = [bars(&red)?, bars(&green)?, bars(&blue)?];
            let mut plot = Frame::filled(red.width(), red.height(), Rgb::default());
            let planes = red.pixels().iter().zip(green.pixels()).zip(blue.pixels());
            for (pixel, ((&r, &g), &b)) in plot.pixels_mut().iter_mut().zip(planes) {
                *pixel = Rgb { r, g, b };
            }
            Ok(plot.into())
        }
    }
}

fn order_of(arguments: &Arguments<'_>) -> BayerOrder {
    // The words of the table are the library's.
    BayerOrder::from_name(arguments.word("order")).unwrap_or(BayerOrder::Rggb)
}

fn mosaic(arguments: &Arguments<'_>, picture: Picture, _: &mut Memory) -> Result<Picture, Error> {
    let frame = picture.into_rgb();
    let mut samples = Frame::filled(frame.width(), frame.height(), 0);
    for (y, (row, samples)) in frame.rows().zip(samples.rows_mut()).enumerate() {
        mosaic_line(row, samples, order_of(arguments), y)?;
    }
    Ok(samples.into())
}

fn black_level(arguments: &Arguments<'_>, picture: Picture, _: &mut Memory) -> Result<Picture, Error> {
    let depth = BitDepth::new(arguments.integer("bits"))?;
    let black = BlackLevel::new(arguments.whole::<u16, 4>("levels"), depth)?;
    let mut frame = picture.into_gray();
    for (y, row) in frame.rows_mut().enumerate() {
        let mut samples: Vec<u16> = row.iter().map(|&sample| depth.expand(sample)).collect();
        black.apply_line(&mut samples, y);
        raw::reduce_line(&samples, row, depth)?;
    }
    Ok(frame.into())
}

fn demosaic(arguments: &Arguments<'_>, picture: Picture, _: &mut Memory) -> Result<Picture, Error> {
    let (samples, order) = (picture.into_gray(), order_of(arguments));
    let mut line = vec![Rgb::default(); samples.width()];
    let (depth, size) = (BitDepth::Bits8, samples.size());
    Ok(if arguments.is("method", "malvar") {
        let mut window = vec![0u8; malvar::window(size.0)];
        samples.through(&mut malvar::Malvar::new(order, depth, &mut window, &mut line)?, size)?
    } else {
        let mut window = vec![0u8; bilinear::window(size.0)];
        samples.through(&mut bilinear::Bilinear::new(order, depth, &mut window, &mut line)?, size)?
    }
    .into())
}

fn format(arguments: &Arguments<'_>, picture: Picture, _: &mut Memory) -> Result<Picture, Error> {
    // The words of the table are the library's.
    let format = Format::from_name(arguments.word("name")).unwrap_or(Format::Rgb888);
    let matrix = if arguments.is("matrix", "bt601") { Matrix::Bt601 } else { Matrix::Bt709 };
    let range = if arguments.is("range", "full") { Range::Full } else { Range::Limited };
    let meaning = Meaning { yuv: Coefficients::new(matrix, range), bayer: BayerOrder::Rggb };
    let mut frame = picture.into_rgb();
    let mut bytes = vec![0; format.line_bytes(frame.width())];
    for (y, row) in frame.rows_mut().enumerate() {
        format.encode_line(row, &mut bytes, y, &meaning)?;
        format.decode_line(&bytes, row, &meaning)?;
    }
    Ok(frame.into())
}
