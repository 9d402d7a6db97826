use algos_nostd::filter::{
    Bilateral, Convolution, Difference, Gaussian, Gaussian3, Gaussian5, Mask, Mean, Median3, Median5,
    Morphology, MorphologyFilter, MorphologyPair, Operation, Order, Separable, Unsharp, close, open,
};
use algos_nostd::image::Error;

use super::channels::{AnySize, SIZES, each_channel, neighbourhood, with_size};
use super::parameter;
use crate::pipeline::arguments::Arguments;
use crate::pipeline::kind::Kind;
use crate::pipeline::picture::Picture;
use crate::pipeline::run::Memory;
use crate::pipeline::table::{Input, Output, Parameter, Stage};

const SIZE: Parameter = parameter("size", Kind::OneOf(SIZES), "5", "pixels a side");
const DIVISOR: Parameter = parameter("divisor", Kind::Integer(1, 1 << 24), "1", "what the sum is divided by");
const OFFSET: Parameter =
    parameter("offset", Kind::Integer(-255, 255), "0", "gray levels added to the quotient");

/// A filter: it takes gray, or colour a channel at a time.
const fn filter(
    name: &'static str,
    about: &'static str,
    aliases: &'static [(&'static str, &'static str)],
    parameters: &'static [Parameter],
    example: &'static str,
    apply: fn(&Arguments<'_>, Picture, &mut Memory) -> Result<Picture, Error>,
) -> Stage {
    let (input, output) = (Input::Any, Output::Same);
    Stage { name, aliases, about, input, output, parameters, least_width: 1, example, apply }
}

pub(super) static STAGES: &[Stage] = &[
    filter(
        "box",
        "mean over a square",
        &[("mean", ""), ("blur", "")],
        &[SIZE],
        "box:9",
        |arguments, picture, _| with_size(arguments.integer("size"), Box(&picture)),
    ),
    filter(
        "gaussian",
        "smooths by a bell; the usual kernels of small integers for size 3 σ 0.85, 5 σ 1.4 and 7 σ 1.4",
        &[("gauss", "")],
        &[SIZE, parameter("sigma", Kind::Decimal(100, 16_000), "1.4", "standard deviation in pixels")],
        "gaussian:size=9,sigma=2",
        |arguments, picture, _| gaussian(arguments, &picture),
    ),
    filter(
        "median",
        "the middle value: takes specks away and leaves edges",
        &[],
        &[parameter("size", Kind::OneOf(&[3, 5]), "3", "pixels a side")],
        "median:3",
        |arguments, picture, _| match arguments.integer("size") {
            3 => neighbourhood(&picture, [Median3; 3]),
            _ => neighbourhood(&picture, [Median5; 3]),
        },
    ),
    filter(
        "bilateral",
        "smooths and leaves edges: neighbours count by distance and likeness",
        &[],
        &[
            parameter("size", Kind::OneOf(&[3, 5, 7, 9, 11]), "5", "diameter in pixels"),
            parameter("space", Kind::Decimal(1, 1_000_000), "2", "σ of the distance in pixels"),
            parameter("range", Kind::Decimal(1, 1_000_000), "25", "σ of the difference in gray levels"),
        ],
        "bilateral:size=9,space=3,range=30",
        |arguments, picture, _| bilateral(arguments, &picture),
    ),
    filter(
        "convolve",
        "convolution or correlation with a kernel",
        &[("kernel", "")],
        &[
            parameter(
                "kernel",
                Kind::Numbers(&[9, 25, 49], -32_768_000, 32_767_000),
                "0;-1;0;-1;5;-1;0;-1;0",
                "whole weights of 3 × 3, 5 × 5 or 7 × 7, row by row",
            ),
            DIVISOR,
            OFFSET,
            parameter(
                "mode",
                Kind::Word(&[
                    ("convolution", "the kernel is turned by half a turn"),
                    ("correlation", "the kernel is laid on as it is"),
                ]),
                "convolution",
                "which way round",
            ),
        ],
        "convolve:kernel=-2;-1;0;-1;1;1;0;1;2,mode=correlation",
        |arguments, picture, _| convolve(arguments, &picture),
    ),
    filter(
        "separable",
        "convolution with a column times a row",
        &[],
        &[
            parameter(
                "across",
                Kind::Numbers(&[3, 5, 7], -32_768_000, 32_767_000),
                "1;4;6;4;1",
                "whole weights of the row",
            ),
            parameter(
                "down",
                Kind::Numbers(&[3, 5, 7], -32_768_000, 32_767_000),
                "1;4;6;4;1",
                "whole weights of the column, as many",
            ),
            parameter("divisor", Kind::Integer(1, 1 << 24), "256", "what the sum is divided by"),
            OFFSET,
        ],
        "separable:across=1;4;6;4;1,down=1;4;6;4;1,divisor=256",
        |arguments, picture, _| separable(arguments, &picture),
    ),
    filter(
        "morphology",
        "least and greatest values under a mask",
        &[
            ("erode", "erode"),
            ("dilate", "dilate"),
            ("open", "open"),
            ("close", "close"),
            ("top-hat", "top-hat"),
            ("black-hat", "black-hat"),
        ],
        &[
            parameter(
                "operation",
                Kind::Word(&[
                    ("erode", "the least value"),
                    ("dilate", "the greatest value"),
                    ("gradient", "the difference of both"),
                    ("open", "erode, then dilate: takes away what is bright and small"),
                    ("close", "dilate, then erode: takes away what is dark and small"),
                    ("top-hat", "what opening takes away"),
                    ("black-hat", "what closing takes away"),
                ]),
                "erode",
                "what is made of the values",
            ),
            parameter("size", Kind::OneOf(SIZES), "3", "pixels a side of the mask"),
            parameter(
                "mask",
                Kind::Word(&[("square", "all pixels"), ("cross", "the centre's row and column")]),
                "square",
                "which pixels count",
            ),
        ],
        "morphology:gradient,size=5",
        |arguments, picture, _| with_size(arguments.integer("size"), Morphological(arguments, &picture)),
    ),
    filter(
        "unsharp",
        "sharpens: adds what smoothing takes away",
        &[("sharpen", "")],
        &[
            parameter("amount", Kind::Integer(0, 199), "100", "per cent of the difference that is added"),
            parameter(
                "radius",
                Kind::Decimal(100, 16_000),
                "1",
                "standard deviation of the smoothing in pixels",
            ),
            parameter(
                "threshold",
                Kind::Integer(0, 255),
                "0",
                "differences up to so many gray levels are left alone",
            ),
            SIZE,
        ],
        "unsharp:amount=150,radius=1.4,size=9",
        |arguments, picture, _| with_size(arguments.integer("size"), Sharpen(arguments, &picture)),
    ),
];

struct Box<'a>(&'a Picture);

impl AnySize for Box<'_> {
    fn run<const SIZE: usize>(self) -> Result<Picture, Error> {
        let width = self.0.size().0;
        let columns = Mean::<SIZE>::columns(width);
        let (mut red, mut green, mut blue) = (vec![0; columns], vec![0; columns], vec![0; columns]);
        let kernels = [
            Mean::<SIZE>::new(width, &mut red)?,
            Mean::new(width, &mut green)?,
            Mean::new(width, &mut blue)?,
        ];
        neighbourhood(self.0, kernels)
    }
}

struct Bell<'a>(&'a Picture, u32);

impl AnySize for Bell<'_> {
    fn run<const SIZE: usize>(self) -> Result<Picture, Error> {
        let kernel = Gaussian::<SIZE>::new(self.1)?;
        neighbourhood(self.0, [kernel; 3])
    }
}

fn gaussian(arguments: &Arguments<'_>, picture: &Picture) -> Result<Picture, Error> {
    let sigma = arguments.milli("sigma");
    match (arguments.integer("size"), sigma) {
        (3, 850) => neighbourhood(picture, [Gaussian3; 3]),
        (5, 1400) => neighbourhood(picture, [Gaussian5; 3]),
        (7, 1400) => neighbourhood(picture, [Gaussian::SEVEN; 3]),
        (size, _) => with_size(size, Bell(picture, sigma)),
    }
}

fn bilateral(arguments: &Arguments<'_>, picture: &Picture) -> Result<Picture, Error> {
    fn run<const SIZE: usize>(picture: &Picture, space: u32, range: u32) -> Result<Picture, Error> {
        let mut tables = [(); 3].map(|()| vec![0; Bilateral::<SIZE>::table()]);
        let [red, green, blue] = &mut tables;
        let kernels = [
            Bilateral::<SIZE>::new(space, range, red)?,
            Bilateral::new(space, range, green)?,
            Bilateral::new(space, range, blue)?,
        ];
        neighbourhood(picture, kernels)
    }
    let (space, range) = (arguments.milli("space"), arguments.milli("range"));
    match arguments.integer("size") {
        3 => run::<3>(picture, space, range),
        5 => run::<5>(picture, space, range),
        7 => run::<7>(picture, space, range),
        9 => run::<9>(picture, space, range),
        _ => run::<11>(picture, space, range),
    }
}

fn convolve(arguments: &Arguments<'_>, picture: &Picture) -> Result<Picture, Error> {
    fn run<const SIZE: usize>(arguments: &Arguments<'_>, picture: &Picture) -> Result<Picture, Error> {
        let mut weights = [[0i16; SIZE]; SIZE];
        for (weight, number) in weights.as_flattened_mut().iter_mut().zip(arguments.numbers("kernel")) {
            *weight = i16::try_from(number / 1000).unwrap_or_default();
        }
        let (divisor, offset) = (arguments.integer("divisor"), arguments.integer("offset"));
        let kernel = if arguments.is("mode", "correlation") {
            Convolution::correlation(weights, divisor, offset)?
        } else {
            Convolution::new(weights, divisor, offset)?
        };
        neighbourhood(picture, [kernel; 3])
    }
    match arguments.numbers("kernel").len() {
        9 => run::<3>(arguments, picture),
        25 => run::<5>(arguments, picture),
        _ => run::<7>(arguments, picture),
    }
}

fn separable(arguments: &Arguments<'_>, picture: &Picture) -> Result<Picture, Error> {
    fn run<const SIZE: usize>(arguments: &Arguments<'_>, picture: &Picture) -> Result<Picture, Error> {
        let (across, down) = (arguments.whole::<i16, SIZE>("across"), arguments.whole::<i16, SIZE>("down"));
        let kernel = Separable::new(across, down, arguments.integer("divisor"), arguments.integer("offset"))?;
        neighbourhood(picture, [kernel; 3])
    }
    let (across, down) = (arguments.numbers("across").len(), arguments.numbers("down").len());
    if across != down {
        return Err(Error::BufferLength { name: "down", expected: across, got: down });
    }
    match across {
        3 => run::<3>(arguments, picture),
        5 => run::<5>(arguments, picture),
        _ => run::<7>(arguments, picture),
    }
}

struct Morphological<'a>(&'a Arguments<'a>, &'a Picture);

impl AnySize for Morphological<'_> {
    fn run<const SIZE: usize>(self) -> Result<Picture, Error> {
        let Self(arguments, picture) = self;
        let mask = || if arguments.is("mask", "cross") { Mask::<SIZE, SIZE>::Cross } else { Mask::Rectangle };
        let plain = |operation| {
            let kernel = Morphology::new(operation, mask())?;
            neighbourhood(picture, [kernel; 3])
        };
        match arguments.word("operation") {
            "erode" => return plain(Operation::Erode),
            "dilate" => return plain(Operation::Dilate),
            "gradient" => return plain(Operation::Gradient),
            _ => {}
        }
        let width = picture.size().0;
        let mut memories = [(); 3].map(|()| vec![0; 2 * MorphologyFilter::<SIZE, SIZE>::memory(width)]);
        let [red, green, blue] = &mut memories;
        let opens = matches!(arguments.word("operation"), "open" | "top-hat");
        let order = if opens { Order::InputMinusOutput } else { Order::OutputMinusInput };
        let filters = [
            pair(opens, mask(), width, red)?,
            pair(opens, mask(), width, green)?,
            pair(opens, mask(), width, blue)?,
        ];
        if matches!(arguments.word("operation"), "open" | "close") {
            return each_channel(picture, filters);
        }
        let [a, b, c] = filters;
        let mut rings = [(); 3].map(|()| vec![0; difference_memory(&a, width)]);
        let [red, green, blue] = &mut rings;
        let filters = [
            Difference::new(a, order, width, red)?,
            Difference::new(b, order, width, green)?,
            Difference::new(c, order, width, blue)?,
        ];
        each_channel(picture, filters)
    }
}

/// Opening or closing.
fn pair<const SIZE: usize>(
    opens: bool,
    mask: Mask<SIZE, SIZE>,
    width: usize,
    memory: &mut [u8],
) -> Result<MorphologyPair<'_, SIZE, SIZE>, Error> {
    if opens { open(mask, width, memory) } else { close(mask, width, memory) }
}

/// Bytes that the difference from that filter takes.
fn difference_memory<F: algos_nostd::lines::LineFilter<Input = u8, Output = u8>>(
    _: &F,
    width: usize,
) -> usize {
    Difference::<F>::memory(width)
}

struct Sharpen<'a>(&'a Arguments<'a>, &'a Picture);

impl AnySize for Sharpen<'_> {
    fn run<const SIZE: usize>(self) -> Result<Picture, Error> {
        let Self(arguments, picture) = self;
        let (amount, radius) = (arguments.integer("amount"), arguments.milli("radius"));
        let kernel = Unsharp::<SIZE>::new(amount, radius, arguments.integer("threshold"))?;
        neighbourhood(picture, [kernel; 3])
    }
}
