use algos_nostd::clip::Point;
use algos_nostd::draw::{
    Operator, PendingRun, Premultiplied, Rgba, composite as composite_premultiplied, composite_straight,
    fill_circle, flood_fill, flood_fill_queue, flood_fill_stack, flood_fill_walk, fuzzy_fill, paint_mask,
};
use algos_nostd::image::{Error, Rgb};

use super::draw::{AT, COLOR, drawing, on_rgb};
use super::parameter;
use crate::pipeline::arguments::Arguments;
use crate::pipeline::kind::Kind;
use crate::pipeline::picture::{Frame, Picture};
use crate::pipeline::run::Memory;
use crate::pipeline::table::{Parameter, Stage};

const SEED: Parameter = parameter("at", Kind::Place, "50%x50%", "the pixel at which it begins");

pub(super) static STAGES: &[Stage] = &[
    drawing(
        "flood",
        "paints the pixels of one colour that hang together",
        &[("flood-fill", "")],
        &[
            parameter(
                "method",
                Kind::Word(&[
                    ("span", "run by run: the fast one"),
                    ("stack", "pixel by pixel, the latest found first"),
                    ("queue", "pixel by pixel, the nearest first"),
                    ("walk", "with the right hand on the wall: no memory"),
                ]),
                "span",
                "how; all paint the same pixels",
            ),
            SEED,
            COLOR,
        ],
        "canny|flood:at=50%x85%,color=blue",
        flood,
    ),
    drawing(
        "fuzzy-fill",
        "paints pixels like the one at a place that hang together with it, less where they are less alike",
        &[("wand", "")],
        &[
            SEED,
            parameter(
                "tolerance",
                Kind::Integer(0, 255),
                "24",
                "the difference of a channel that still belongs wholly",
            ),
            parameter("softness", Kind::Integer(0, 255), "24", "over which it falls off to nothing"),
            COLOR,
        ],
        "fuzzy-fill:at=70%x25%,tolerance=24,softness=24,color=orange",
        fuzzy,
    ),
    drawing(
        "composite",
        "lays a half-transparent disc on the picture by an operator of Porter and Duff; a checker shows through what is left open",
        &[],
        &[
            parameter(
                "operator",
                Kind::Word(&[
                    ("source-over", "the disc over the picture"),
                    ("source", "the disc alone"),
                    ("source-in", "the disc where the picture is"),
                    ("source-out", "the disc where the picture is not"),
                    ("source-atop", "the disc over the picture, where the picture is"),
                    ("destination", "the picture alone"),
                    ("destination-over", "the picture over the disc"),
                    ("destination-in", "the picture where the disc is"),
                    ("destination-out", "the picture where the disc is not"),
                    ("destination-atop", "the picture over the disc, where the disc is"),
                    ("xor", "each where the other is not"),
                    ("plus", "the sum"),
                    ("clear", "nothing"),
                ]),
                "source-over",
                "the operator",
            ),
            AT,
            parameter("radius", Kind::Integer(0, 32_767), "40", "of the disc, in pixels"),
            parameter("alpha", Kind::Integer(0, 255), "128", "how opaque the disc is"),
            parameter(
                "form",
                Kind::Word(&[("straight", "colours as they are"), ("premultiplied", "colours times alpha")]),
                "straight",
                "how pixels are kept",
            ),
            COLOR,
        ],
        "composite:destination-out,radius=60,alpha=192",
        composite,
    ),
];

/// Runs that may wait; beyond, the library fills without memory.
const RUNS: usize = 256;

fn flood(arguments: &Arguments<'_>, picture: Picture, _: &mut Memory) -> Result<Picture, Error> {
    on_rgb(picture, |image, size| {
        let (at, color) = (arguments.point("at", size), arguments.color("color"));
        let mut points = vec![Point::default(); 2 * (size.0 + size.1)];
        match arguments.word("method") {
            "stack" => flood_fill_stack(image, at, color, &mut points),
            "queue" => flood_fill_queue(image, at, color, &mut points),
            "walk" => flood_fill_walk(image, at, color),
            _ => flood_fill(image, at, color, &mut [PendingRun::default(); RUNS]),
        };
        Ok(())
    })
}

fn fuzzy(arguments: &Arguments<'_>, picture: Picture, _: &mut Memory) -> Result<Picture, Error> {
    let mut frame = picture.into_rgb();
    let mut mask = Frame::filled(frame.width(), frame.height(), 0u8);
    let limits = (arguments.integer("tolerance"), arguments.integer("softness"));
    let (at, mut pending) = (arguments.point("at", frame.size()), [PendingRun::default(); RUNS]);
    fuzzy_fill(frame.view()?, at, limits, &mut mask.view_mut()?, &mut pending)?;
    paint_mask(&mut frame.view_mut()?, mask.view()?, arguments.color("color"))?;
    Ok(frame.into())
}

/// The side of the checker's squares, in pixels.
const SQUARE: usize = 8;

fn composite(arguments: &Arguments<'_>, picture: Picture, _: &mut Memory) -> Result<Picture, Error> {
    let frame = picture.into_rgb();
    let (width, height) = frame.size();
    // The words of the table are the library's.
    let named = Operator::ALL.into_iter().find(|operator| arguments.is("operator", operator.name()));
    let operator = named.unwrap_or(Operator::SourceOver);
    let Rgb { r, g, b } = arguments.color("color");
    let mut disc = Frame::filled(width, height, Rgba { r: 0, g: 0, b: 0, a: 0 });
    let (at, color) =
        (arguments.point("at", (width, height)), Rgba { r, g, b, a: arguments.integer("alpha") });
    fill_circle(&mut disc.view_mut()?, at, arguments.integer("radius"), color);
    let opaque = |pixel: &Rgb| Rgba { r: pixel.r, g: pixel.g, b: pixel.b, a: 255 };
    let mut laid = Frame::filled(width, height, Rgba { r: 0, g: 0, b: 0, a: 0 });
    laid.pixels_mut().iter_mut().zip(frame.pixels()).for_each(|(laid, pixel)| *laid = opaque(pixel));
    if arguments.is("form", "premultiplied") {
        let multiplied = |frame: &Frame<Rgba>| {
            let mut made = Frame::filled(width, height, Premultiplied::default());
            let pairs = made.pixels_mut().iter_mut().zip(frame.pixels());
            pairs.for_each(|(made, pixel)| *made = Premultiplied::from_straight(*pixel));
            made
        };
        let (disc, mut both) = (multiplied(&disc), multiplied(&laid));
        composite_premultiplied(operator, disc.view()?, &mut both.view_mut()?)?;
        laid.pixels_mut().iter_mut().zip(both.pixels()).for_each(|(laid, pixel)| *laid = pixel.straight());
    } else {
        composite_straight(operator, disc.view()?, &mut laid.view_mut()?)?;
    }
    let mut seen = frame;
    for (y, (row, laid)) in seen.rows_mut().zip(laid.rows()).enumerate() {
        for (x, (pixel, laid)) in row.iter_mut().zip(laid).enumerate() {
            let gray = if (x / SQUARE + y / SQUARE).is_multiple_of(2) { 96 } else { 160 };
            let checker = opaque(&Rgb { r: gray, g: gray, b: gray });
            let Rgba { r, g, b, .. } = Operator::SourceOver.straight(*laid, checker);
            *pixel = Rgb { r, g, b };
        }
    }
    Ok(seen.into())
}
