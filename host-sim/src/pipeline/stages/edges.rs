use algos_nostd::draw::draw_line;
use algos_nostd::edges::gradient::{CentralDifference, Prewitt, Roberts, Scharr, Sobel};
use algos_nostd::edges::measure::{Components, L1, L2, Saturated, Sector4, Sector8};
use algos_nostd::edges::smooth::{Gaussian3, Gaussian5, NoSmoothing, Smoothing};
use algos_nostd::edges::{
    CannyConfig, CannySmoothing, GradientFilter, Measure, Norm, Operator, Point, Thinning, Thresholds,
    ZeroCrossings, canny, canny_memory, grow, thin, thin_memory,
};
use algos_nostd::image::{Error, Rgb};

use super::maps::Map;
use super::parameter;
use crate::pipeline::arguments::Arguments;
use crate::pipeline::kind::Kind;
use crate::pipeline::picture::{Frame, Picture};
use crate::pipeline::run::Memory;
use crate::pipeline::table::{Input, Output, Parameter, Stage};

const NORM: Kind = Kind::Word(&[("l1", "|x| + |y|"), ("l2", "√(x² + y²)")]);
const SMOOTHING: Parameter = parameter(
    "smooth",
    Kind::Word(&[
        ("5", "Gaussian of 5 × 5 pixels, σ = 1.4"),
        ("3", "Gaussian of 3 × 3 pixels"),
        ("none", "the picture is smooth already"),
    ]),
    "5",
    "the smoothing before",
);
const MAP_LEVEL: Parameter = parameter("level", Kind::Integer(0, 254), "127", "pixels above it are the map");
pub(super) const LOW: Parameter = parameter(
    "low",
    Kind::Integer(0, 2040),
    "50",
    "what a candidate's gradient exceeds (a step of one gray level counts 4)",
);
pub(super) const HIGH: Parameter = parameter(
    "high",
    Kind::Integer(0, 2040),
    "150",
    "what a gradient exceeds that starts an edge; not below low",
);
pub(super) const LEAST: Parameter =
    parameter("least", Kind::Integer(1, 32_767), "10", "pixels that a curve has at least");
pub(super) const TOLERANCE: Parameter = parameter(
    "tolerance",
    Kind::Decimal(0, 255_000),
    "1",
    "pixels that a curve may be simplified by (Ramer–Douglas–Peucker); 0 leaves it",
);

/// A stage that makes a gray picture or a map of a gray picture.
const fn detector(
    name: &'static str,
    about: &'static str,
    aliases: &'static [(&'static str, &'static str)],
    parameters: &'static [Parameter],
    example: &'static str,
    apply: fn(&Arguments<'_>, Picture, &mut Memory) -> Result<Picture, Error>,
) -> Stage {
    let (input, output) = (Input::Gray, Output::Gray);
    Stage { name, aliases, about, input, output, parameters, least_width: 1, example, apply }
}

pub(super) static STAGES: &[Stage] = &[
    detector(
        "gradient",
        "how fast levels rise, by a pair of small kernels",
        &[("sobel", "sobel"), ("scharr", "scharr"), ("prewitt", "prewitt"), ("roberts", "roberts")],
        &[
            parameter(
                "operator",
                Kind::Word(&[
                    ("sobel", "differences averaged 1 2 1"),
                    ("scharr", "differences averaged 3 10 3"),
                    ("prewitt", "differences averaged over three lines"),
                    ("roberts", "diagonals of 2 × 2 pixels"),
                    ("central", "the neighbour after less the neighbour before"),
                ]),
                "sobel",
                "the kernels",
            ),
            parameter(
                "measure",
                Kind::Word(&[
                    ("l1", "|x| + |y|, at most 255"),
                    ("l2", "√(x² + y²), at most 255"),
                    ("x", "the rise to the right, over the operator's gain; 128 is none"),
                    ("y", "the rise downwards, over the operator's gain; 128 is none"),
                    ("sector4", "the direction in quarters of half a turn: 0, 64, 128, 192"),
                    ("sector8", "the direction in eighths of a turn: 0, 32 … 224"),
                ]),
                "l1",
                "what is made of a gradient",
            ),
        ],
        "gradient:sobel,measure=l2",
        |arguments, picture, _| {
            let frame = picture.into_gray();
            match arguments.word("operator") {
                "scharr" => gradient::<Scharr>(arguments, &frame),
                "prewitt" => gradient::<Prewitt>(arguments, &frame),
                "roberts" => gradient::<Roberts>(arguments, &frame),
                "central" => gradient::<CentralDifference>(arguments, &frame),
                _ => gradient::<Sobel>(arguments, &frame),
            }
        },
    ),
    detector(
        "canny",
        "Canny's edges: smoothed, one pixel wide, followed from strong to weak",
        &[],
        &[LOW, HIGH, parameter("norm", NORM, "l2", "how a gradient is measured"), SMOOTHING],
        "gray|canny:low=50,high=150,norm=l2",
        |arguments, picture, _| {
            Ok(canny_map(arguments, &picture.into_gray(), arguments.word("norm"), arguments.word("smooth"))?
                .into_picture())
        },
    ),
    detector(
        "zero-crossing",
        "Marr and Hildreth's edges: where the Laplacian of the smoothed picture changes its sign",
        &[("marr-hildreth", ""), ("laplacian", ""), ("log", "")],
        &[
            parameter(
                "threshold",
                Kind::Integer(0, 4080),
                "12",
                "how far apart the Laplacians of either side are, in gray levels",
            ),
            SMOOTHING,
        ],
        "zero-crossing:threshold=12",
        |arguments, picture, _| {
            let (frame, threshold) = (picture.into_gray(), arguments.integer("threshold"));
            match arguments.word("smooth") {
                "none" => crossings::<NoSmoothing>(&frame, threshold),
                "3" => crossings::<Gaussian3>(&frame, threshold),
                _ => crossings::<Gaussian5>(&frame, threshold),
            }
        },
    ),
    detector(
        "hysteresis",
        "keeps what is above the lower level and hangs together with something above the upper one",
        &[],
        &[
            parameter("low", Kind::Integer(0, 254), "50", "candidates are above it"),
            parameter("high", Kind::Integer(0, 254), "150", "what starts is above it; not below low"),
        ],
        "gaussian|sobel|hysteresis:low=60,high=160",
        hysteresis,
    ),
    detector(
        "thin",
        "peels a map from its sides until it is one pixel wide",
        &[],
        &[
            parameter(
                "method",
                Kind::Word(&[
                    ("zhang-suen", "two passes a round; diagonals stay two wide"),
                    ("guo-hall", "two passes a round; diagonals become one wide"),
                    ("four-sides", "side by side, after Rosenfeld; keeps every figure and hole"),
                ]),
                "guo-hall",
                "what may be peeled",
            ),
            MAP_LEVEL,
        ],
        "gaussian|sobel|threshold:90|thin:guo-hall",
        thinned,
    ),
    Stage {
        name: "trace",
        aliases: &[("curves", "")],
        about: "follows the edges of a map and draws each curve in a colour of its own",
        input: Input::Gray,
        output: Output::Rgb,
        parameters: &[LEAST, TOLERANCE, MAP_LEVEL],
        least_width: 1,
        example: "canny|trace:least=12,tolerance=1",
        apply: traced,
    },
];

/// A line filter's result for a whole picture.
fn measured<O: Operator, M: Measure>(frame: &Frame<u8>) -> Result<Frame<M::Output>, Error>
where
    M::Output: Default,
{
    let width = frame.width();
    let mut memory = vec![0; GradientFilter::<O, M>::memory(width)];
    let mut line = vec![M::Output::default(); width];
    frame.through(&mut GradientFilter::<O, M>::new(width, &mut memory, &mut line)?, frame.size())
}

fn gradient<O: Operator>(arguments: &Arguments<'_>, frame: &Frame<u8>) -> Result<Picture, Error> {
    let spread = |mut frame: Frame<u8>, step: u8| {
        frame.pixels_mut().iter_mut().for_each(|sector| *sector *= step);
        Picture::Gray(frame)
    };
    match arguments.word("measure") {
        "l1" => Ok(measured::<O, Saturated<L1>>(frame)?.into()),
        "l2" => Ok(measured::<O, Saturated<L2>>(frame)?.into()),
        "sector4" => Ok(spread(measured::<O, Sector4>(frame)?, 64)),
        "sector8" => Ok(spread(measured::<O, Sector8>(frame)?, 32)),
        component => {
            let gradients = measured::<O, Components>(frame)?;
            let mut gray = Frame::filled(frame.width(), frame.height(), 0);
            for (pixel, gradient) in gray.pixels_mut().iter_mut().zip(gradients.pixels()) {
                let rise = if component == "x" { gradient.x } else { gradient.y };
                *pixel = (128 + rise / O::SLOPE).clamp(0, 255) as u8;
            }
            Ok(gray.into())
        }
    }
}

/// Canny's edges with the stage's `low` and `high`.
pub(super) fn canny_map(
    arguments: &Arguments<'_>,
    frame: &Frame<u8>,
    norm: &str,
    smooth: &str,
) -> Result<Map, Error> {
    let smoothing = match smooth {
        "none" => CannySmoothing::None,
        "3" => CannySmoothing::Gaussian3,
        _ => CannySmoothing::Gaussian5,
    };
    let norm = if norm == "l1" { Norm::L1 } else { Norm::L2 };
    let thresholds = Thresholds { low: arguments.integer("low"), high: arguments.integer("high"), norm };
    let mut memory = vec![0; canny_memory(frame.width(), frame.height(), smoothing)];
    let mut map = Map::empty(frame.size());
    canny(frame.view()?, &CannyConfig { smoothing, thresholds }, &mut memory, &mut map.view_mut()?)?;
    Ok(map)
}

fn crossings<S: Smoothing>(frame: &Frame<u8>, threshold: u16) -> Result<Picture, Error> {
    let mut memory = vec![0; ZeroCrossings::<S>::memory(frame.width())];
    let mut filter = ZeroCrossings::<S>::new(frame.width(), threshold, &mut memory)?;
    Ok(Map::lines(frame, &mut filter)?.into_picture())
}

fn hysteresis(arguments: &Arguments<'_>, picture: Picture, _: &mut Memory) -> Result<Picture, Error> {
    let (low, high): (u8, u8) = (arguments.integer("low"), arguments.integer("high"));
    if low > high {
        return Err(Error::Parameter { name: "low", got: low.into(), allowed: "at most `high`" });
    }
    let frame = picture.into_gray();
    let (candidates, mut strong) = (Map::above(&frame, low)?, Map::above(&frame, high)?);
    grow(candidates.view()?, &mut strong.view_mut()?)?;
    Ok(strong.into_picture())
}

fn thinned(arguments: &Arguments<'_>, picture: Picture, _: &mut Memory) -> Result<Picture, Error> {
    let thinning = match arguments.word("method") {
        "zhang-suen" => Thinning::ZhangSuen,
        "four-sides" => Thinning::FourSides,
        _ => Thinning::GuoHall,
    };
    let frame = picture.into_gray();
    let mut map = Map::above(&frame, arguments.integer("level"))?;
    let mut memory = vec![0; thin_memory(frame.width())];
    thin(&mut map.view_mut()?, thinning, &mut memory)?;
    Ok(map.into_picture())
}

/// Colours that are told apart well, one curve after the other.
const CURVE_COLORS: [Rgb; 6] = [
    Rgb { r: 255, g: 96, b: 96 },
    Rgb { r: 96, g: 255, b: 96 },
    Rgb { r: 112, g: 144, b: 255 },
    Rgb { r: 255, g: 224, b: 64 },
    Rgb { r: 64, g: 240, b: 240 },
    Rgb { r: 255, g: 112, b: 255 },
];

fn traced(arguments: &Arguments<'_>, picture: Picture, _: &mut Memory) -> Result<Picture, Error> {
    let frame = picture.into_gray();
    let curves = traced_curves(arguments, &Map::above(&frame, arguments.integer("level"))?)?;
    let mut drawn = Frame::filled(frame.width(), frame.height(), Rgb::default());
    for (curve, color) in curves.iter().zip(CURVE_COLORS.iter().cycle()) {
        draw_curve(&mut drawn, curve, *color)?;
    }
    Ok(drawn.into())
}

/// The curves of a map, by the stage's `least` and `tolerance`.
pub(super) fn traced_curves(arguments: &Arguments<'_>, map: &Map) -> Result<Vec<Vec<Point>>, Error> {
    let tolerance: u32 = arguments.milli("tolerance");
    map.curves(arguments.integer("least"), tolerance * 256 / 1000)
}

/// Lines from point to point.
pub(super) fn draw_curve(frame: &mut Frame<Rgb>, curve: &[Point], color: Rgb) -> Result<(), Error> {
    let mut view = frame.view_mut()?;
    for pair in curve.windows(2) {
        if let &[from, to] = pair {
            draw_line(&mut view, from, to, color);
        }
    }
    Ok(())
}
