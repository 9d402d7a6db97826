use algos_nostd::color::balance::adaptation::{Space, in_rgb};
use algos_nostd::color::balance::gray_edge::{GrayEdge, Norm};
use algos_nostd::color::balance::matrix::Matrix3;
use algos_nostd::color::balance::running::RunningWhite;
use algos_nostd::color::balance::white_patch::WhitePatch;
use algos_nostd::color::balance::{Gains, White, gray_world};
use algos_nostd::color::curve::Curve;
use algos_nostd::color::pointwise::PixelMap as _;
use algos_nostd::image::{Error, Rgb};

use super::parameter;
use crate::pipeline::arguments::Arguments;
use crate::pipeline::kind::Kind;
use crate::pipeline::picture::{Frame, Picture};
use crate::pipeline::run::Memory;
use crate::pipeline::table::{Input, Output, Stage};

pub(super) static STAGES: &[Stage] = &[
    Stage {
        name: "balance",
        aliases: &[
            ("white-balance", ""),
            ("gray-world", "gray-world"),
            ("white-patch", "white-patch"),
            ("gray-edge", "gray-edge"),
        ],
        about: "finds the colour of the light and takes it away",
        input: Input::Rgb,
        output: Output::Rgb,
        parameters: &[
            parameter(
                "method",
                Kind::Word(&[
                    ("gray-world", "the light is the mean of all pixels"),
                    ("white-patch", "the light is what the brightest pixels have"),
                    ("gray-edge", "the light is the mean of all differences between neighbours"),
                    ("white", "the light is the colour `white`"),
                ]),
                "gray-world",
                "how the light's colour is found; a picture without light or edges stays as it is",
            ),
            parameter(
                "space",
                Kind::Word(&[
                    ("gains", "a factor for each of R, G and B"),
                    ("rgb", "the same as a matrix in Q12"),
                    ("xyz", "in XYZ"),
                    ("bradford", "von Kries in Bradford's cone space"),
                    ("cat02", "in that of CIECAM02"),
                    ("cmccat2000", "in that of CMCCAT2000"),
                    ("sharp", "in sharpened sensors"),
                    ("romm", "in the primaries of ROMM"),
                ]),
                "gains",
                "where colours are scaled",
            ),
            parameter(
                "values",
                Kind::Word(&[
                    ("coded", "the values as they are"),
                    (
                        "linear",
                        "values in proportion to light: sRGB's curve is undone first and put back after",
                    ),
                ]),
                "coded",
                "what is scaled",
            ),
            parameter(
                "quantile",
                Kind::Integer(1, 1000),
                "990",
                "of white-patch: per mille of pixels that are not above the white",
            ),
            parameter(
                "norm",
                Kind::Word(&[("l1", "magnitudes"), ("l2", "squares")]),
                "l1",
                "of gray-edge: how differences are summed",
            ),
            parameter("white", Kind::Color, "white", "of white: the colour that is to become gray"),
            parameter(
                "rate",
                Kind::Integer(1, 256),
                "256",
                "over frames: how far, in 1/256, each moves the estimate",
            ),
            parameter(
                "band",
                Kind::Integer(0, 512),
                "0",
                "over frames: how far, in 1/1024, the estimate moves before it is followed",
            ),
        ],
        least_width: 1,
        example: "matrix:rows=1.1;0;0;0;0.9;0;0;0;0.6|balance:gray-world",
        apply: balance,
    },
    Stage {
        name: "matrix",
        aliases: &[],
        about: "multiplies each pixel by a 3 × 3 matrix",
        input: Input::Rgb,
        output: Output::Rgb,
        parameters: &[parameter(
            "rows",
            Kind::Numbers(&[9], -8000, 7999),
            "1;0;0;0;1;0;0;0;1",
            "the matrix, row by row; rows give R, G and B",
        )],
        least_width: 1,
        example: "matrix:rows=0.393;0.769;0.189;0.349;0.686;0.168;0.272;0.534;0.131",
        apply: matrix,
    },
];

fn balance(arguments: &Arguments<'_>, picture: Picture, memory: &mut Memory) -> Result<Picture, Error> {
    let mut frame = picture.into_rgb();
    let linear = arguments.is("values", "linear");
    if linear {
        Curve::srgb_to_linear().apply_line(frame.pixels_mut());
    }
    if let Some(estimate) = estimate(arguments, &frame)? {
        let white = match &mut memory.white {
            Some(running) => running.update(estimate),
            none => {
                let running = RunningWhite::new(arguments.integer("rate"), arguments.integer("band"))?;
                none.insert(running).update(estimate)
            }
        };
        match neutralize(arguments, white, &mut frame) {
            // An estimate that is too dark in a channel is no light: a black frame must not end a replay.
            Err(_) if !arguments.is("method", "white") => {}
            done => done?,
        }
    }
    if linear {
        Curve::linear_to_srgb().apply_line(frame.pixels_mut());
    }
    Ok(frame.into())
}

/// Makes `white` gray.
fn neutralize(arguments: &Arguments<'_>, white: White, frame: &mut Frame<Rgb>) -> Result<(), Error> {
    match Space::from_name(arguments.word("space")) {
        None => Gains::neutralizing(white)?.apply_line(frame.pixels_mut()),
        Some(space) => in_rgb(space, white, white.gray())?.apply_line(frame.pixels_mut()),
    }
    Ok(())
}

fn estimate(arguments: &Arguments<'_>, frame: &Frame<Rgb>) -> Result<Option<White>, Error> {
    Ok(match arguments.word("method") {
        "white-patch" => {
            let mut patch = WhitePatch::new(arguments.integer("quantile"))?;
            patch.push(frame.pixels());
            patch.finish()
        }
        "gray-edge" => {
            let norm = if arguments.is("norm", "l1") { Norm::L1 } else { Norm::L2 };
            let mut line = vec![Rgb::default(); frame.width()];
            let mut edge = GrayEdge::new(norm, &mut line)?;
            frame.rows().try_for_each(|row| edge.push(row))?;
            edge.finish()
        }
        "white" => Some(White::of(arguments.color("white"))),
        _ => Some(gray_world::estimate(frame.view()?)),
    })
}

fn matrix(arguments: &Arguments<'_>, picture: Picture, _: &mut Memory) -> Result<Picture, Error> {
    let mut rows = [[0i32; 3]; 3];
    for (slot, number) in rows.as_flattened_mut().iter_mut().zip(arguments.numbers("rows")) {
        *slot = (number * 10) as i32;
    }
    let mut frame = picture.into_rgb();
    Matrix3::from_ten_thousandths(rows)?.apply_line(frame.pixels_mut());
    Ok(frame.into())
}
