use algos_nostd::image::{Error, Rgb};
use algos_nostd::quantize::{
    Annealing, ApplyPalette, BAYER_2, BAYER_4, BAYER_8, BLUE_NOISE, Cell, ColorIndex, ExactMap,
    FloydSteinberg, Group, InverseMap, Nearest, Ordered, Probe, spatial,
};

use super::palette::palette;
use super::parameter;
use crate::pipeline::arguments::Arguments;
use crate::pipeline::kind::Kind;
use crate::pipeline::picture::{Frame, Picture};
use crate::pipeline::run::Memory;
use crate::pipeline::table::{Input, Output, Stage};

pub(super) static STAGES: &[Stage] = &[Stage {
    name: "quantize",
    aliases: &[
        ("palette", ""),
        ("median-cut", "median-cut"),
        ("octree", "octree"),
        ("neuquant", "neuquant"),
        ("uniform", "uniform"),
        ("popularity", "popularity"),
        ("spatial", "spatial"),
    ],
    about: "few colours: finds a palette, and gives each pixel a colour of it",
    input: Input::Rgb,
    output: Output::Rgb,
    parameters: &[
        parameter(
            "method",
            Kind::Word(&[
                ("wu", "boxes of least variance: the one to start with"),
                ("median-cut", "boxes of equally many pixels"),
                ("octree", "a tree of bounded size"),
                ("k-means", "wu, then 5 iterations of k-means unless told otherwise"),
                ("local-k-means", "sample by sample, from wu; the colours of `palette` are reserved"),
                ("neuquant", "a self-organising line of neurons"),
                ("popularity", "the most frequent colours"),
                ("uniform", "the same for every picture: evenly spaced `levels`"),
                ("fixed", "the colours of `palette`"),
                ("spatial", "wu, then palette and dithering found together; takes its time"),
            ]),
            "wu",
            "how the palette is found",
        ),
        parameter("colors", Kind::Integer(1, 256), "16", "colours at most"),
        parameter(
            "dither",
            Kind::Word(&[
                ("none", "the nearest colour"),
                ("floyd-steinberg", "the error goes on to the neighbours, line by line to and fro"),
                ("bayer-2", "thresholds of 2 × 2 pixels"),
                ("bayer-4", "of 4 × 4 pixels"),
                ("bayer-8", "of 8 × 8 pixels"),
                ("blue-noise", "thresholds without a pattern"),
            ]),
            "none",
            "how colours between those of the palette are feigned",
        ),
        parameter(
            "search",
            Kind::Word(&[
                ("exact-map", "a table of candidates: the nearest"),
                ("nearest", "all of them: the nearest"),
                ("inverse-map", "a table: nearly the nearest"),
            ]),
            "exact-map",
            "how a pixel's colour is found",
        ),
        parameter("iterations", Kind::Integer(0, 100), "0", "of k-means after the method"),
        parameter("palette", Kind::Colors(256), "", "colours, of fixed and local-k-means"),
        parameter(
            "levels",
            Kind::Numbers(&[3], 1000, 255_000),
            "6;6;6",
            "of red, green and blue, of uniform; their product is at most 256",
        ),
        parameter(
            "spread",
            Kind::Integer(-1, 255),
            "-1",
            "levels between the thresholds of bayer and blue-noise; -1 suits the palette",
        ),
        parameter(
            "temperature",
            Kind::Integer(1, 65_535),
            "256",
            "of spatial: the first one, in squared levels",
        ),
        parameter(
            "sweeps",
            Kind::Integer(0, 32),
            "4",
            "of spatial: while the temperature falls by half each",
        ),
    ],
    least_width: 1,
    example: "quantize:median-cut,colors=16,dither=floyd-steinberg",
    apply: quantize,
}];

fn quantize(arguments: &Arguments<'_>, picture: Picture, _: &mut Memory) -> Result<Picture, Error> {
    let frame = picture.into_rgb();
    let mut palette = palette(arguments, &frame)?;
    let mut indices = Frame::filled(frame.width(), frame.height(), 0u8);
    if arguments.is("method", "spatial") {
        let annealing = Annealing {
            temperature: arguments.integer("temperature"),
            sweeps: arguments.integer("sweeps"),
            fixed: false,
        };
        let mut errors = vec![[0; 3]; frame.pixels().len()];
        spatial(frame.view()?, annealing, &mut errors, &mut palette, &mut indices.view_mut()?)?;
    } else {
        indices = searched(arguments, &frame, &palette)?;
    }
    let mut made = frame;
    for (pixel, &index) in made.pixels_mut().iter_mut().zip(indices.pixels()) {
        // An index is always within the palette.
        *pixel = palette.get(usize::from(index)).copied().unwrap_or_default();
    }
    Ok(made.into())
}

/// Groups lent to an exact map beyond those of the palette itself.
const GROUPS: usize = 4096;

fn searched(arguments: &Arguments<'_>, frame: &Frame<Rgb>, palette: &[Rgb]) -> Result<Frame<u8>, Error> {
    let mut probes = vec![Probe::EMPTY; palette.len()];
    match arguments.word("search") {
        "nearest" => dithered(arguments, frame, palette, Nearest::new(palette, &mut probes)?),
        "inverse-map" => {
            let mut cells = vec![0; InverseMap::<5>::cells()];
            let map = InverseMap::<5>::new(Nearest::new(palette, &mut probes)?, &mut cells)?;
            dithered(arguments, frame, palette, map)
        }
        _ => {
            let mut cells = vec![Cell::EMPTY; ExactMap::<5>::cells()];
            let mut groups = vec![Group::EMPTY; ExactMap::<5>::groups(palette.len()) + GROUPS];
            dithered(arguments, frame, palette, ExactMap::<5>::new(palette, &mut cells, &mut groups)?)
        }
    }
}

fn dithered<C: ColorIndex>(
    arguments: &Arguments<'_>,
    frame: &Frame<Rgb>,
    palette: &[Rgb],
    colors: C,
) -> Result<Frame<u8>, Error> {
    let (width, size) = (frame.width(), frame.size());
    let mut line = vec![0; width];
    let tile = match arguments.word("dither") {
        "none" => return frame.through(&mut ApplyPalette::new(width, colors, &mut line)?, size),
        "floyd-steinberg" => {
            let mut errors = vec![[0; 3]; width];
            return frame.through(&mut FloydSteinberg::new(width, colors, &mut line, &mut errors)?, size);
        }
        "bayer-2" => BAYER_2,
        "bayer-4" => BAYER_4,
        "bayer-8" => BAYER_8,
        _ => BLUE_NOISE,
    };
    let spread =
        u8::try_from(arguments.integer::<i32>("spread")).unwrap_or_else(|_| Ordered::<C>::spread_of(palette));
    let mut pixels = vec![Rgb::default(); width];
    frame.through(&mut Ordered::new(width, tile, spread, colors, &mut pixels, &mut line)?, size)
}
