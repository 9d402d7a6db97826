use algos_nostd::clip::{
    ConvexWindow, Point, Window, clip_line, clipped_polygon_capacity, cohen_sutherland, cyrus_beck,
    liang_barsky, nicholl_lee_nicholl, nine_regions, sutherland_hodgman,
};
use algos_nostd::draw::{
    Edge, FillRule, Sweep, draw_box, draw_circle, draw_ellipse, draw_elliptic_arc, draw_line,
    draw_line_gupta_sproull, draw_line_runs, draw_line_thick, draw_line_wu, draw_text, fill_box, fill_circle,
    fill_ellipse, fill_polygon, polygon_edges, text_size,
};
use algos_nostd::image::{Error, ImageMut, Rgb};

use super::edges::{HIGH, LEAST, LOW, TOLERANCE, canny_map, draw_curve, traced_curves};
use super::{YES_NO, parameter};
use crate::pipeline::arguments::Arguments;
use crate::pipeline::kind::Kind;
use crate::pipeline::picture::Picture;
use crate::pipeline::run::Memory;
use crate::pipeline::table::{Input, Output, Parameter, Stage};

pub(super) const COLOR: Parameter = parameter("color", Kind::Color, "red", "the colour");
pub(super) const AT: Parameter = parameter("at", Kind::Place, "50%x50%", "the centre");
const FROM: Parameter = parameter("from", Kind::Place, "10%x10%", "where it begins");
const TO: Parameter = parameter("to", Kind::Place, "90%x90%", "where it ends");
const FILL: Parameter = parameter("fill", YES_NO, "no", "whether the inside is filled");
const RADII: Parameter =
    parameter("radii", Kind::Size, "30%x20%", "across and down, in pixels or of the picture");

/// A stage that draws on a picture in colour.
pub(super) const fn drawing(
    name: &'static str,
    about: &'static str,
    aliases: &'static [(&'static str, &'static str)],
    parameters: &'static [Parameter],
    example: &'static str,
    apply: fn(&Arguments<'_>, Picture, &mut Memory) -> Result<Picture, Error>,
) -> Stage {
    let (input, output) = (Input::Rgb, Output::Rgb);
    Stage { name, aliases, about, input, output, parameters, least_width: 1, example, apply }
}

pub(super) static STAGES: &[Stage] = &[
    drawing(
        "line",
        "a line",
        &[],
        &[
            parameter(
                "style",
                Kind::Word(&[
                    ("bresenham", "pixel by pixel"),
                    ("runs", "the same, run by run"),
                    ("thick", "Murphy: `width` pixels thick, square ends"),
                    ("wu", "smooth, two pixels a step"),
                    ("gupta-sproull", "smooth, equally strong in every direction"),
                ]),
                "bresenham",
                "how it is drawn",
            ),
            FROM,
            TO,
            parameter("width", Kind::Integer(1, 255), "3", "of thick: in pixels"),
            COLOR,
        ],
        "line:from=5%x20%,to=95%x60%|line:thick,from=5%x40%,to=95%x80%,width=5,color=yellow|line:gupta-sproull,from=5%x60%,to=95%x100%,color=white",
        line,
    ),
    drawing(
        "circle",
        "a circle",
        &[],
        &[AT, parameter("radius", Kind::Integer(0, 32_767), "20", "in pixels"), FILL, COLOR],
        "circle:radius=50,fill=yes,color=orange|circle:radius=60,color=white",
        |arguments, picture, _| {
            on_rgb(picture, |image, size| {
                let (at, radius) = (arguments.point("at", size), arguments.integer("radius"));
                let draw = if arguments.is("fill", "yes") { fill_circle } else { draw_circle };
                draw(image, at, radius, arguments.color("color"));
                Ok(())
            })
        },
    ),
    drawing(
        "ellipse",
        "an ellipse with level axes",
        &[],
        &[AT, RADII, FILL, COLOR],
        "ellipse:radii=40%x30%,color=yellow|ellipse:radii=25%x20%,fill=yes,color=blue",
        |arguments, picture, _| {
            on_rgb(picture, |image, size| {
                let draw = if arguments.is("fill", "yes") { fill_ellipse } else { draw_ellipse };
                draw(image, arguments.point("at", size), radii(arguments, size), arguments.color("color"));
                Ok(())
            })
        },
    ),
    drawing(
        "arc",
        "a part of an ellipse, clockwise between two rays",
        &[],
        &[
            AT,
            RADII,
            parameter("start", Kind::Place, "0x-1", "the ray at which it begins, as a step from the centre"),
            parameter("end", Kind::Place, "1x1", "the ray at which it ends"),
            COLOR,
        ],
        "arc:radii=40%x40%,start=-1x0,end=1x1,color=yellow|arc:radii=30%x30%,start=0x-1,end=0x1",
        |arguments, picture, _| {
            on_rgb(picture, |image, size| {
                let sweep = Sweep::new(arguments.point("start", size), arguments.point("end", size))?;
                draw_elliptic_arc(
                    image,
                    arguments.point("at", size),
                    radii(arguments, size),
                    sweep,
                    arguments.color("color"),
                );
                Ok(())
            })
        },
    ),
    drawing(
        "polygon",
        "a filled polygon, cut to a window (Sutherland and Hodgman)",
        &[],
        &[
            parameter(
                "points",
                Kind::Places(3, 1000),
                "50%x10%;75%x90%;10%x40%;90%x40%;25%x90%",
                "its corners in order",
            ),
            parameter(
                "rule",
                Kind::Word(&[("even-odd", "overlaps are holes"), ("non-zero", "overlaps belong to it")]),
                "even-odd",
                "what is inside",
            ),
            parameter(
                "window",
                Kind::Places(2, 2),
                "0%x0%;100%x100%",
                "two corners of the rectangle that is drawn in",
            ),
            COLOR,
        ],
        "polygon:color=yellow,window=0x0;60%x100%",
        polygon,
    ),
    drawing(
        "clip",
        "a fan of lines from the picture's corner, cut to a window",
        &[],
        &[
            parameter(
                "method",
                Kind::Word(&[
                    ("kuzmin", "the one that drawing uses"),
                    ("cohen-sutherland", "edge by edge"),
                    ("liang-barsky", "four inequalities"),
                    ("nicholl-lee-nicholl", "by the sides of the corners"),
                    ("nine-regions", "by a table of pairs of regions"),
                    ("cyrus-beck", "any convex window"),
                ]),
                "kuzmin",
                "how it is cut; all but cyrus-beck light the same pixels",
            ),
            parameter(
                "window",
                Kind::Places(2, 64),
                "25%x25%;75%x75%",
                "two corners of a rectangle; for cyrus-beck also the corners of a convex polygon",
            ),
            parameter("lines", Kind::Integer(1, 1000), "24", "lines of the fan"),
            COLOR,
        ],
        "clip:cyrus-beck,window=50%x10%;90%x60%;40%x90%;15%x50%,color=yellow",
        clip,
    ),
    drawing(
        "rectangle",
        "a rectangle with level sides",
        &[],
        &[FROM, TO, FILL, COLOR],
        "rectangle:from=10%x10%,to=60%x70%,color=yellow",
        |arguments, picture, _| {
            on_rgb(picture, |image, size| {
                let (from, to) = (arguments.point("from", size), arguments.point("to", size));
                let window = between(from, to)?;
                let draw = if arguments.is("fill", "yes") { fill_box } else { draw_box };
                draw(image, &window, arguments.color("color"));
                Ok(())
            })
        },
    ),
    drawing(
        "text",
        "text in letters of 5 × 7 pixels, times a scale",
        &[],
        &[
            parameter("text", Kind::Text, "camif", "what it says; \\, stands for a comma"),
            parameter("at", Kind::Place, "2%x2%", "the upper left corner"),
            parameter("scale", Kind::Integer(1, 64), "1", "pixels of the picture a pixel of a letter"),
            parameter("plate", YES_NO, "no", "whether black lies behind it"),
            COLOR,
        ],
        "text:camif 240 x 180,scale=2,plate=yes,color=white,at=4%x4%",
        text,
    ),
    drawing(
        "contours",
        "finds Canny's edges, follows them and draws the curves on the picture",
        &[("overlay", "")],
        &[LOW, HIGH, LEAST, TOLERANCE, COLOR],
        "contours:least=16,color=yellow",
        contours,
    ),
];

/// Draws on a picture; the size is (width, height).
pub(super) fn on_rgb(
    picture: Picture,
    draw: impl FnOnce(&mut ImageMut<'_, Rgb>, (usize, usize)) -> Result<(), Error>,
) -> Result<Picture, Error> {
    let mut frame = picture.into_rgb();
    let size = frame.size();
    draw(&mut frame.view_mut()?, size)?;
    Ok(frame.into())
}

fn radii(arguments: &Arguments<'_>, size: (usize, usize)) -> (u16, u16) {
    let (across, down) = arguments.extent("radii", size);
    (u16::try_from(across).unwrap_or(u16::MAX), u16::try_from(down).unwrap_or(u16::MAX))
}

/// The rectangle between two corners, whichever they are.
fn between(a: Point, b: Point) -> Result<Window, Error> {
    Window::new(Point::new(a.x.min(b.x), a.y.min(b.y)), Point::new(a.x.max(b.x), a.y.max(b.y)))
}

fn line(arguments: &Arguments<'_>, picture: Picture, _: &mut Memory) -> Result<Picture, Error> {
    on_rgb(picture, |image, size| {
        let (from, to) = (arguments.point("from", size), arguments.point("to", size));
        let color = arguments.color("color");
        match arguments.word("style") {
            "runs" => draw_line_runs(image, from, to, color),
            "thick" => draw_line_thick(image, from, to, arguments.integer("width"), color),
            "wu" => draw_line_wu(image, from, to, color),
            "gupta-sproull" => draw_line_gupta_sproull(image, from, to, color),
            _ => draw_line(image, from, to, color),
        }
        Ok(())
    })
}

fn polygon(arguments: &Arguments<'_>, picture: Picture, _: &mut Memory) -> Result<Picture, Error> {
    on_rgb(picture, |image, size| {
        let points = arguments.points("points", size);
        let mut room = vec![Point::default(); clipped_polygon_capacity(points.len())];
        let corners = sutherland_hodgman(&points, &arguments.window("window", size)?, &mut room)?;
        let rule = if arguments.is("rule", "even-odd") { FillRule::EvenOdd } else { FillRule::NonZero };
        let mut edges = vec![Edge::default(); polygon_edges(corners.len())];
        fill_polygon(image, &[corners], rule, arguments.color("color"), &mut edges)
    })
}

fn clip(arguments: &Arguments<'_>, picture: Picture, _: &mut Memory) -> Result<Picture, Error> {
    on_rgb(picture, |image, size| {
        let corners = arguments.points("window", size);
        let rectangle = arguments.window("window", size)?;
        let convex = arguments.is("method", "cyrus-beck") && corners.len() > 2;
        let (a, b) = (rectangle.top_left(), rectangle.bottom_right());
        let of_rectangle = [a, Point::new(b.x, a.y), b, Point::new(a.x, b.y)];
        let corners = if convex { &corners[..] } else { &of_rectangle };
        let method: &dyn Fn(Point, Point) -> Option<algos_nostd::clip::Walk> = match arguments.word("method")
        {
            "cohen-sutherland" => &|from, to| cohen_sutherland(from, to, &rectangle),
            "liang-barsky" => &|from, to| liang_barsky(from, to, &rectangle),
            "nicholl-lee-nicholl" => &|from, to| nicholl_lee_nicholl(from, to, &rectangle),
            "nine-regions" => &|from, to| nine_regions(from, to, &rectangle),
            // A rectangle of one line of pixels has no inside for a convex polygon.
            "cyrus-beck" if convex || (a.x < b.x && a.y < b.y) => {
                &|from, to| ConvexWindow::new(corners).ok().and_then(|window| cyrus_beck(from, to, &window))
            }
            _ => &|from, to| clip_line(from, to, &rectangle),
        };
        if convex {
            ConvexWindow::new(corners)?;
        }
        let color = arguments.color("color");
        let half = Rgb { r: color.r / 2, g: color.g / 2, b: color.b / 2 };
        let next = corners.iter().cycle().skip(1);
        for (&from, &to) in corners.iter().zip(next) {
            draw_line(image, from, to, half);
        }
        for to in fan(size, arguments.integer("lines")) {
            for at in method(Point::new(0, 0), to).into_iter().flatten() {
                let place = (usize::try_from(at.x), usize::try_from(at.y));
                if let (Ok(x), Ok(y)) = place
                    && let Some(pixel) = image.pixel_mut(x, y)
                {
                    *pixel = color;
                }
            }
        }
        Ok(())
    })
}

/// Places along the right and the lower side of a picture.
fn fan((width, height): (usize, usize), lines: usize) -> impl Iterator<Item = Point> {
    let (width, height) = (width.min(32_767), height.min(32_767));
    (0..lines).map(move |line| {
        let along = (2 * line + 1) * (width + height) / (2 * lines);
        let (x, y) =
            if along < height { (width, along) } else { ((width + height).saturating_sub(along), height) };
        Point::new(x as i16, y as i16)
    })
}

fn text(arguments: &Arguments<'_>, picture: Picture, _: &mut Memory) -> Result<Picture, Error> {
    on_rgb(picture, |image, size| {
        let (at, text, scale) =
            (arguments.point("at", size), arguments.text("text"), arguments.integer::<u8>("scale"));
        if arguments.is("plate", "yes") {
            let (width, height) = text_size(text);
            let reach = |start: i16, length: usize| {
                let end = i64::from(start) + (length * usize::from(scale)) as i64;
                end.clamp(i64::from(start), i16::MAX.into()) as i16
            };
            let border = Point::new(at.x.saturating_sub(scale.into()), at.y.saturating_sub(scale.into()));
            let window = between(border, Point::new(reach(at.x, width), reach(at.y, height)))?;
            fill_box(image, &window, Rgb::default());
        }
        draw_text(image, at, text, scale, arguments.color("color"));
        Ok(())
    })
}

fn contours(arguments: &Arguments<'_>, picture: Picture, _: &mut Memory) -> Result<Picture, Error> {
    let gray = picture.clone().into_gray();
    let mut frame = picture.into_rgb();
    let map = canny_map(arguments, &gray, "l2", "5")?;
    for curve in traced_curves(arguments, &map)? {
        draw_curve(&mut frame, &curve, arguments.color("color"))?;
    }
    Ok(frame.into())
}
