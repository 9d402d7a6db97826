use std::path::{Path, PathBuf};

use anyhow::Context;
use image::RgbImage;
use serde::Serialize;

use crate::picture;
use crate::pipeline::{Picture, Pipeline, Runner};

/// What `demo` makes of its first frame: the file, and the pipeline.
const PICTURES: [(&str, &str); 4] = [
    ("balanced.png", "balance:gray-world"),
    ("edges.png", "gray|canny:low=50,high=150,norm=l2"),
    ("quantized.png", "quantize:median-cut,colors=16,dither=floyd-steinberg"),
    (
        "annotated.png",
        "contours:least=24,color=yellow\
         |rectangle:from=4%x5%,to=96%x95%,color=cyan\
         |line:gupta-sproull,from=46%x50%,to=54%x50%,color=white\
         |line:gupta-sproull,from=50%x46%,to=50%x54%,color=white\
         |circle:radius=40,color=white\
         |line:thick,from=4%x95%,to=50%x95%,width=5,color=magenta\
         |text:edges\\, boxes\\, lines: drawn by algos-nostd,at=6%x8%,scale=2,plate=yes,color=white",
    ),
];

/// A picture that was made.
#[derive(Debug, Serialize)]
pub(super) struct Shown {
    pub(super) png: PathBuf,
    pub(super) op: String,
}

/// Makes the pictures of a frame, in a folder.
pub(super) fn showcase(frame: &RgbImage, out: &Path) -> anyhow::Result<Vec<Shown>> {
    let show = |(name, op): (&str, &str)| {
        let pipeline: Pipeline = op.parse()?;
        let png = out.join(name);
        let made = Runner::new(&pipeline).run(Picture::from_image(frame)).with_context(|| name.to_owned())?;
        picture::write_png(&png, &made.into_image())?;
        Ok(Shown { png, op: op.to_owned() })
    };
    PICTURES.into_iter().map(show).collect()
}
