//! Lines, curves, areas, layers.

use algos_nostd::draw::{
    FillRule, Mix, Operator, PendingRun, Point, Premultiplied, Rgba, Sweep, Window, composite,
    composite_straight, divide_by_255, draw_arc, draw_box, draw_circle, draw_ellipse, draw_elliptic_arc,
    draw_line, draw_line_gupta_sproull, draw_line_runs, draw_line_thick, draw_line_wu, draw_text, fill_box,
    fill_circle, fill_ellipse, fill_polygon, flood_fill, flood_fill_queue, flood_fill_stack, flood_fill_walk,
    fuzzy_fill, paint_mask,
};
use algos_nostd::image::{Error, Image, ImageMut, Rgb};
use algos_nostd::pixel::rgb888;

use crate::report::{Clock, Done, Exercise, Unit::Drawn, Unit::Pixel, Unit::Segment};
use crate::space::{HEIGHT, PIXELS, SEGMENTS, WIDTH, Workspace, gray_view};

pub(crate) static EXERCISES: &[Exercise] = &[
    Exercise { name: "line bresenham", unit: Drawn, run: |s, c| lines(s, c, draw_line) },
    Exercise { name: "line run by run", unit: Drawn, run: |s, c| lines(s, c, draw_line_runs) },
    Exercise { name: "line 3 pixels wide", unit: Segment, run: thick },
    Exercise { name: "line wu", unit: Segment, run: |s, c| segments(s, c, draw_line_wu) },
    Exercise {
        name: "line gupta-sproull",
        unit: Segment,
        run: |s, c| segments(s, c, draw_line_gupta_sproull),
    },
    Exercise { name: "circle", unit: Drawn, run: |s, c| shape(s, c, |i| draw_circle(i, MIDDLE, 110, 255)) },
    Exercise {
        name: "circle filled",
        unit: Drawn,
        run: |s, c| shape(s, c, |i| fill_circle(i, MIDDLE, 110, 255)),
    },
    Exercise {
        name: "ellipse",
        unit: Drawn,
        run: |s, c| shape(s, c, |i| draw_ellipse(i, MIDDLE, (150, 90), 255)),
    },
    Exercise {
        name: "ellipse filled",
        unit: Drawn,
        run: |s, c| shape(s, c, |i| fill_ellipse(i, MIDDLE, (150, 90), 255)),
    },
    Exercise { name: "arc", unit: Drawn, run: arc },
    Exercise { name: "arc of an ellipse", unit: Drawn, run: elliptic_arc },
    Exercise { name: "polygon even-odd", unit: Drawn, run: |s, c| star(s, c, FillRule::EvenOdd) },
    Exercise { name: "polygon non-zero", unit: Drawn, run: |s, c| star(s, c, FillRule::NonZero) },
    Exercise { name: "rectangle", unit: Drawn, run: rectangle },
    Exercise { name: "rectangle filled", unit: Drawn, run: filled_rectangle },
    Exercise { name: "text", unit: Drawn, run: text },
    Exercise {
        name: "flood fill by spans",
        unit: Drawn,
        run: |s, c| fill(s, c, |i, runs, _| flood_fill(i, MIDDLE, 77, runs)),
    },
    Exercise {
        name: "flood fill by a stack",
        unit: Drawn,
        run: |s, c| fill(s, c, |i, _, points| flood_fill_stack(i, MIDDLE, 77, points)),
    },
    Exercise {
        name: "flood fill by a queue",
        unit: Drawn,
        run: |s, c| fill(s, c, |i, _, points| flood_fill_queue(i, MIDDLE, 77, points)),
    },
    Exercise {
        name: "flood fill by a walk",
        unit: Drawn,
        run: |s, c| fill(s, c, |i, _, _| flood_fill_walk(i, MIDDLE, 77)),
    },
    Exercise { name: "fuzzy fill", unit: Drawn, run: fuzzy },
    Exercise { name: "paint a mask", unit: Pixel, run: masked },
    Exercise { name: "mix", unit: Pixel, run: mixed },
    Exercise { name: "composite source-over", unit: Pixel, run: |s, c| layers(s, c, Operator::SourceOver) },
    Exercise { name: "composite xor", unit: Pixel, run: |s, c| layers(s, c, Operator::Xor) },
    Exercise { name: "composite plus", unit: Pixel, run: |s, c| layers(s, c, Operator::Plus) },
    Exercise { name: "composite straight source-over", unit: Pixel, run: straight_layers },
];

const MIDDLE: Point = Point::new(WIDTH as i16 / 2, HEIGHT as i16 / 2);

/// An empty gray canvas.
fn canvas(bytes: &mut [u8]) -> Result<ImageMut<'_, u8>, Error> {
    let bytes = &mut bytes[..PIXELS];
    bytes.fill(0);
    ImageMut::new(bytes, WIDTH, HEIGHT)
}

/// Draws on an empty canvas, and counts the pixels that are not empty any more.
fn shape(
    space: &mut Workspace,
    clock: &mut dyn Clock,
    draw: impl FnOnce(&mut ImageMut<'_, u8>),
) -> Result<Done, Error> {
    let mut image = canvas(&mut space.bytes)?;
    clock.start();
    draw(&mut image);
    clock.stop();
    let drawn = space.bytes[..PIXELS].iter().filter(|&&level| level != 0).count();
    Ok(Done::new(drawn, &space.bytes[..PIXELS]))
}

type Draw = fn(&mut ImageMut<'_, u8>, Point, Point, u8);

/// Segments that reach beyond the picture.
fn segments(space: &mut Workspace, clock: &mut dyn Clock, draw: Draw) -> Result<Done, Error> {
    let mut image = canvas(&mut space.bytes)?;
    clock.start();
    for &(from, to) in &space.segments {
        draw(&mut image, from, to, 255);
    }
    clock.stop();
    Ok(Done::new(SEGMENTS, &space.bytes[..PIXELS]))
}

/// The same, counted in the pixels that were drawn, those drawn twice too.
fn lines(space: &mut Workspace, clock: &mut dyn Clock, draw: Draw) -> Result<Done, Error> {
    let window = Window::of_mut(&canvas(&mut space.bytes)?);
    let walks =
        space.segments.iter().filter_map(|&(from, to)| algos_nostd::clip::clip_line(from, to, &window));
    let drawn: u32 = walks.map(|walk| walk.pixels_left()).sum();
    Ok(Done { units: drawn, ..segments(space, clock, draw)? })
}

fn thick(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    segments(space, clock, |image, from, to, color| draw_line_thick(image, from, to, 3, color))
}

fn arc(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let sweep = Sweep::new(Point::new(10, 3), Point::new(-7, -4))?;
    shape(space, clock, |image| draw_arc(image, MIDDLE, 110, sweep, 255))
}

fn elliptic_arc(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let sweep = Sweep::new(Point::new(10, 3), Point::new(-7, -4))?;
    shape(space, clock, |image| draw_elliptic_arc(image, MIDDLE, (150, 90), sweep, 255))
}

fn star(space: &mut Workspace, clock: &mut dyn Clock, rule: FillRule) -> Result<Done, Error> {
    let corners = [(160, 0), (250, 235), (10, 85), (310, 85), (70, 235)].map(|(x, y)| Point::new(x, y));
    let edges = &mut space.polygon;
    let mut image = canvas(&mut space.bytes)?;
    clock.start();
    let result = fill_polygon(&mut image, &[&corners], rule, 255, edges);
    clock.stop();
    result?;
    let drawn = space.bytes[..PIXELS].iter().filter(|&&level| level != 0).count();
    Ok(Done::new(drawn, &space.bytes[..PIXELS]))
}

fn rectangle(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let window = Window::new(Point::new(20, 30), Point::new(280, 200))?;
    shape(space, clock, |image| draw_box(image, &window, 255))
}

fn filled_rectangle(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let window = Window::new(Point::new(20, 30), Point::new(280, 200))?;
    shape(space, clock, |image| fill_box(image, &window, 255))
}

fn text(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    shape(space, clock, |image| draw_text(image, Point::new(4, 9), "camif 0123456789 ABCxyz", 2, 255))
}

/// Fills the ground around some shapes.
fn fill(
    space: &mut Workspace,
    clock: &mut dyn Clock,
    fill: fn(&mut ImageMut<'_, u8>, &mut [PendingRun], &mut [Point]) -> usize,
) -> Result<Done, Error> {
    let mut image = canvas(&mut space.bytes)?;
    for &(from, to) in &space.segments[..6] {
        draw_line(&mut image, from, to, 1);
    }
    draw_circle(&mut image, MIDDLE, 100, 2);
    clock.start();
    let filled = fill(&mut image, &mut space.runs, &mut space.points);
    clock.stop();
    Ok(Done::new(filled, &space.bytes[..PIXELS]))
}

fn fuzzy(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let mut mask = canvas(&mut space.bytes)?;
    let picture = gray_view(&space.gray)?;
    clock.start();
    let filled = fuzzy_fill(picture, MIDDLE, (40, 20), &mut mask, &mut space.runs);
    clock.stop();
    Ok(Done::new(filled?, &space.bytes[..PIXELS]))
}

fn masked(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    space.pixels.copy_from_slice(&space.picture);
    let mut image = ImageMut::new(&mut space.pixels, WIDTH, HEIGHT)?;
    let mask = gray_view(&space.gray)?;
    clock.start();
    let result = paint_mask(&mut image, mask, Rgb::new(255, 0, 40));
    clock.stop();
    result?;
    Ok(Done::new(PIXELS, rgb888::as_bytes(&space.pixels)))
}

fn mixed(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let out = &mut space.bytes[..PIXELS];
    clock.start();
    for ((out, &gray), pixel) in out.iter_mut().zip(&space.gray).zip(&space.picture) {
        *out = gray.mix(divide_by_255(u32::from(pixel.r) * 200) as u8, pixel.g);
    }
    clock.stop();
    Ok(Done::new(PIXELS, out))
}

/// A pixel of a layer that is nowhere of one colour or opacity.
fn translucent(index: usize) -> Rgba {
    let [r, g, b, a] = (index as u32).wrapping_mul(2_654_435_761).to_le_bytes();
    Rgba { r, g, b, a }
}

const LAYER: (usize, usize) = (WIDTH / 2, HEIGHT / 2);

fn layers(space: &mut Workspace, clock: &mut dyn Clock, operator: Operator) -> Result<Done, Error> {
    for (index, (layer, base)) in space.layer.iter_mut().zip(&mut space.base).enumerate() {
        *layer = Premultiplied::from_straight(translucent(index));
        *base = Premultiplied::from_straight(translucent(index + 7));
    }
    let source = Image::new(&space.layer[..], LAYER.0, LAYER.1)?;
    let mut destination = ImageMut::new(&mut space.base[..], LAYER.0, LAYER.1)?;
    clock.start();
    let result = composite(operator, source, &mut destination);
    clock.stop();
    result?;
    Ok(Done::of(PIXELS / 4, |results| {
        for pixel in &space.base {
            let Rgba { r, g, b, a } = pixel.multiplied();
            results.bytes(&[r, g, b, a]);
        }
    }))
}

fn straight_layers(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let source: &mut [Rgba] = bytemuck::cast_slice_mut(&mut space.words[..PIXELS / 4]);
    for (index, (layer, base)) in source.iter_mut().zip(&mut space.straight).enumerate() {
        (*layer, *base) = (translucent(index), translucent(index + 7));
    }
    let source = Image::new(source, LAYER.0, LAYER.1)?;
    let mut destination = ImageMut::new(&mut space.straight[..], LAYER.0, LAYER.1)?;
    clock.start();
    let result = composite_straight(Operator::SourceOver, source, &mut destination);
    clock.stop();
    result?;
    Ok(Done::new(PIXELS / 4, bytemuck::cast_slice(&space.straight)))
}
