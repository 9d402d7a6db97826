use algos_nostd::filter::scale::bilinear::{self, BilinearScale};
use algos_nostd::filter::scale::box_area::{self, BoxScale};
use algos_nostd::filter::scale::{Bytes, Sizes};
use algos_nostd::image::{Error, geometry};
use algos_nostd::lines::LineFilter as _;

use super::parameter;
use crate::pipeline::arguments::Arguments;
use crate::pipeline::kind::Kind;
use crate::pipeline::picture::{Frame, Picture};
use crate::pipeline::run::Memory;
use crate::pipeline::table::{Input, Output, Stage};

pub(super) static STAGES: &[Stage] = &[
    Stage {
        name: "flip",
        aliases: &[("mirror", "horizontal")],
        about: "mirrors the picture",
        input: Input::Any,
        output: Output::Same,
        parameters: &[parameter(
            "axis",
            Kind::Word(&[("horizontal", "left becomes right"), ("vertical", "top becomes bottom")]),
            "horizontal",
            "which way",
        )],
        least_width: 1,
        example: "flip:horizontal",
        apply: flip,
    },
    Stage {
        name: "rotate",
        aliases: &[("turn", "")],
        about: "turns the picture clockwise by quarters of a turn",
        input: Input::Any,
        output: Output::Same,
        parameters: &[parameter("angle", Kind::OneOf(&[90, 180, 270]), "90", "degrees, clockwise")],
        least_width: 1,
        example: "rotate:90",
        apply: rotate,
    },
    Stage {
        name: "crop",
        aliases: &[("cut", "")],
        about: "cuts a rectangle out",
        input: Input::Any,
        output: Output::Same,
        parameters: &[
            parameter("at", Kind::Place, "25%x25%", "the top left corner"),
            parameter("size", Kind::Size, "50%x50%", "width and height; must lie within the picture"),
        ],
        least_width: 1,
        example: "crop:at=10%x40%,size=40%x50%",
        apply: crop,
    },
    Stage {
        name: "scale",
        aliases: &[("resize", "")],
        about: "makes the picture smaller or larger",
        input: Input::Any,
        output: Output::Same,
        parameters: &[
            parameter("size", Kind::Size, "50%x50%", "width and height"),
            parameter(
                "method",
                Kind::Word(&[
                    ("box", "the exact mean of the area that a pixel covers: for making smaller"),
                    ("bilinear", "a weighing of the four nearest pixels: for making larger"),
                ]),
                "box",
                "what a new pixel is made of",
            ),
        ],
        least_width: 1,
        example: "scale:size=12%x12%|scale:size=800%x800%,method=bilinear",
        apply: scale,
    },
];

fn flip(arguments: &Arguments<'_>, picture: Picture, _: &mut Memory) -> Result<Picture, Error> {
    fn turned<P: Copy>(mut frame: Frame<P>, horizontal: bool) -> Result<Frame<P>, Error> {
        let mut view = frame.view_mut()?;
        if horizontal {
            geometry::flip_horizontal(&mut view);
        } else {
            geometry::flip_vertical(&mut view);
        }
        Ok(frame)
    }
    let horizontal = arguments.is("axis", "horizontal");
    Ok(match picture {
        Picture::Rgb(frame) => turned(frame, horizontal)?.into(),
        Picture::Gray(frame) => turned(frame, horizontal)?.into(),
    })
}

fn rotate(arguments: &Arguments<'_>, picture: Picture, _: &mut Memory) -> Result<Picture, Error> {
    fn turned<P: Copy + Default>(mut frame: Frame<P>, angle: u32) -> Result<Frame<P>, Error> {
        if angle == 180 {
            geometry::rotate_180(&mut frame.view_mut()?);
            return Ok(frame);
        }
        let mut made = Frame::filled(frame.height(), frame.width(), P::default());
        match angle {
            90 => geometry::rotate_90(frame.view()?, &mut made.view_mut()?)?,
            _ => geometry::rotate_270(frame.view()?, &mut made.view_mut()?)?,
        }
        Ok(made)
    }
    let angle = arguments.integer("angle");
    Ok(match picture {
        Picture::Rgb(frame) => turned(frame, angle)?.into(),
        Picture::Gray(frame) => turned(frame, angle)?.into(),
    })
}

fn crop(arguments: &Arguments<'_>, picture: Picture, _: &mut Memory) -> Result<Picture, Error> {
    fn cut<P: Copy + Default>(
        frame: &Frame<P>,
        corner: (usize, usize),
        size: (usize, usize),
    ) -> Result<Frame<P>, Error> {
        let mut filter = geometry::CropLines::new(frame.width(), corner, size)?;
        let mut made = Frame::filled(size.0, size.1, P::default());
        let whole =
            Error::SizeMismatch { expected: frame.size(), got: (corner.0 + size.0, corner.1 + size.1) };
        if corner.1 + size.1 > frame.height() {
            return Err(whole);
        }
        let mut rows = made.rows_mut();
        let mut sink = |line: &[P]| {
            if let Some(row) = rows.next() {
                row.copy_from_slice(line);
            }
        };
        for row in frame.rows() {
            filter.push(row, &mut sink)?;
        }
        filter.finish(&mut sink);
        drop(rows);
        Ok(made)
    }
    let size = picture.size();
    let corner = arguments.point("at", size);
    let outside = |name, got: i16| Error::Parameter { name, got: got.into(), allowed: "within the picture" };
    let column = usize::try_from(corner.x).map_err(|_| outside("at", corner.x))?;
    let line = usize::try_from(corner.y).map_err(|_| outside("at", corner.y))?;
    let extent = arguments.extent("size", size);
    Ok(match picture {
        Picture::Rgb(frame) => cut(&frame, (column, line), extent)?.into(),
        Picture::Gray(frame) => cut(&frame, (column, line), extent)?.into(),
    })
}

fn scale(arguments: &Arguments<'_>, picture: Picture, _: &mut Memory) -> Result<Picture, Error> {
    fn scaled<P: Bytes + Copy + Default>(
        frame: &Frame<P>,
        sizes: Sizes,
        smooth: bool,
    ) -> Result<Frame<P>, Error> {
        let mut line = vec![P::default(); sizes.to.0];
        if smooth {
            let mut work = vec![0; bilinear::values(sizes.to.0, P::CHANNELS)];
            frame.through(&mut BilinearScale::new(sizes, &mut work, &mut line)?, sizes.to)
        } else {
            let mut work = vec![0; box_area::sums(sizes.to.0, P::CHANNELS)];
            frame.through(&mut BoxScale::new(sizes, &mut work, &mut line)?, sizes.to)
        }
    }
    let sizes = Sizes { from: picture.size(), to: arguments.extent("size", picture.size()) };
    // Before memory is taken for it: a percentage may ask for more than the library does.
    if sizes.to.0.max(sizes.to.1) > Sizes::LIMIT {
        let got = sizes.to.0.max(sizes.to.1) as i64;
        return Err(Error::Parameter { name: "size", got, allowed: "at most 4096 pixels a side" });
    }
    let smooth = arguments.is("method", "bilinear");
    Ok(match picture {
        Picture::Rgb(frame) => scaled(&frame, sizes, smooth)?.into(),
        Picture::Gray(frame) => scaled(&frame, sizes, smooth)?.into(),
    })
}
