use std::path::{Path, PathBuf};

use anyhow::Context;
use image::RgbImage;
use serde::Serialize;

use crate::picture;
use crate::pipeline::{Picture, Pipeline, Runner};

/// What `demo` makes of its first frame: the file, what it is, and the pipeline.
const PICTURES: [(&str, &str, &str); 4] = [
    ("balanced.png", "the colour of the light taken away", "balance:gray-world"),
    ("edges.png", "Canny's edges", "gray|canny:low=50,high=150,norm=l2"),
    (
        "quantized.png",
        "16 colours by median cut, dithered",
        "quantize:median-cut,colors=16,dither=floyd-steinberg",
    ),
    (
        "annotated.png",
        "edges followed as curves, boxes, lines, circles, text",
        "contours:least=24,color=yellow\
         |rectangle:from=4%x5%,to=96%x95%,color=cyan\
         |line:gupta-sproull,from=46%x50%,to=54%x50%,color=white\
         |line:gupta-sproull,from=50%x46%,to=50%x54%,color=white\
         |circle:radius=40,color=white\
         |text:edges\\, boxes\\, lines: drawn by algos-nostd,at=6%x8%,scale=2,plate=yes,color=white\
         |line:thick,from=6%x12%,to=82%x12%,width=3,color=magenta",
    ),
];

/// A picture that was made.
#[derive(Debug, Serialize)]
pub(super) struct Shown {
    pub(super) png: PathBuf,
    /// What it is.
    pub(super) about: &'static str,
    /// The pipeline.
    pub(super) op: &'static str,
}

/// Makes the pictures of a frame, in a folder.
pub(super) fn showcase(frame: &RgbImage, out: &Path) -> anyhow::Result<Vec<Shown>> {
    let show = |(name, about, op): (&str, &'static str, &'static str)| {
        let pipeline: Pipeline = op.parse()?;
        let png = out.join(name);
        let made = Runner::new(&pipeline).run(Picture::from_image(frame)).with_context(|| name.to_owned())?;
        picture::write_png(&png, &made.into_image())?;
        Ok(Shown { png, about, op })
    };
    PICTURES.into_iter().map(show).collect()
}
