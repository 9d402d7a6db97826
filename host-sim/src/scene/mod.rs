//! Scenes: what a virtual camera looks at.
//!
//! The map:
//!
//! | file | what lives there |
//! |---|---|
//! | `paint` | integer mathematics of pictures: mixing, noise, soft edges |
//! | `bars` | `bars`: eight colour bars over a castellation, a ramp and black levels |
//! | `patterns` | `checker`, `gradient`, `noise`, `moving` |
//! | `demo` | `demo`: a test card with bars, spheres, a star of wedges and text, that changes from frame to frame |
//! | `text` | letters of any size |
//! | `still` | a PNG or JPEG file, scaled where its size is another |
//!
//! A scene is a function of its seed, the frame's number and the size, and of nothing else: whoever renders it
//! again gets the same bytes. All of it is integer arithmetic (a scaled file apart), so that holds across machines.

mod paint;
mod bars;
mod patterns;
mod demo;
pub(crate) mod text;
mod still;

use image::RgbImage;

use crate::profile::nearest;

pub use still::Still;

/// What a virtual camera looks at.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Scene {
    /// Colour bars and level steps; it stands still.
    Bars,
    /// Black and white squares; it stands still.
    Checker,
    /// Hue across and brightness down; it stands still.
    Gradient,
    /// A disc that crosses a plain ground and bounces off its edges, for what must see motion.
    Moving,
    /// Noise in every byte, new in every frame: what no compression makes smaller.
    Noise {
        /// Other seeds give other noise.
        seed: u64,
    },
    /// A test card with a bit of everything; the star turns, the ball rolls and the frame's number counts.
    Demo {
        /// Other seeds give the background another grain.
        seed: u64,
    },
    /// A picture file; it stands still.
    Still(Still),
}

/// A scene's name that is none.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "no scene is called `{name}`; did you mean `{nearest}`? There are {known}; for a picture file give its path as an image"
)]
pub struct UnknownScene {
    /// The name given.
    pub name: String,
    /// The scene nearest to it.
    pub nearest: &'static str,
    /// All of them.
    pub known: String,
}

impl Scene {
    /// The names of the scenes that are not files.
    pub const NAMES: [&'static str; 6] = ["demo", "bars", "checker", "gradient", "moving", "noise"];

    /// The scene of this name. The seed matters to `demo` and `noise`.
    ///
    /// # Errors
    /// [`UnknownScene`] with the nearest name.
    pub fn named(name: &str, seed: u64) -> Result<Self, UnknownScene> {
        match name {
            "bars" => Ok(Self::Bars),
            "checker" => Ok(Self::Checker),
            "gradient" => Ok(Self::Gradient),
            "moving" => Ok(Self::Moving),
            "noise" => Ok(Self::Noise { seed }),
            "demo" => Ok(Self::Demo { seed }),
            _ => Err(UnknownScene {
                name: name.to_owned(),
                nearest: nearest(name, Self::NAMES).unwrap_or("demo"),
                known: Self::NAMES.join(", "),
            }),
        }
    }

    /// The name, or the file's path.
    #[must_use]
    pub fn name(&self) -> String {
        match self {
            Self::Bars => "bars".to_owned(),
            Self::Checker => "checker".to_owned(),
            Self::Gradient => "gradient".to_owned(),
            Self::Moving => "moving".to_owned(),
            Self::Noise { .. } => "noise".to_owned(),
            Self::Demo { .. } => "demo".to_owned(),
            Self::Still(still) => still.path().display().to_string(),
        }
    }

    /// Whether every frame is the same, so that one rendering serves all.
    #[must_use]
    pub fn is_still(&self) -> bool {
        match self {
            Self::Bars | Self::Checker | Self::Gradient | Self::Still(_) => true,
            Self::Moving | Self::Noise { .. } | Self::Demo { .. } => false,
        }
    }

    /// What the camera sees in a frame; frames count from 0. A side of 0 gives an empty picture.
    #[must_use]
    pub fn render(&self, frame_number: u64, width: u32, height: u32) -> RgbImage {
        let mut picture = RgbImage::new(width, height);
        if width == 0 || height == 0 {
            return picture;
        }
        match self {
            Self::Bars => bars::paint(&mut picture),
            Self::Checker => patterns::checker(&mut picture),
            Self::Gradient => patterns::gradient(&mut picture),
            Self::Moving => patterns::moving(&mut picture, frame_number),
            Self::Noise { seed } => patterns::noise(&mut picture, *seed, frame_number),
            Self::Demo { seed } => demo::paint(&mut picture, *seed, frame_number),
            Self::Still(still) => picture = still.scaled(width, height),
        }
        picture
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_the_scenes() {
        for name in Scene::NAMES {
            assert_eq!(Scene::named(name, 1).unwrap().name(), name);
        }
        assert_eq!(Scene::named("chequer", 1).unwrap_err().nearest, "checker");
    }

    #[test]
    fn every_size_renders_and_frames_differ_only_where_things_move() {
        for name in Scene::NAMES {
            let scene = Scene::named(name, 1).unwrap();
            for (width, height) in [(1, 1), (2, 7), (7, 2), (1, 64), (64, 1), (33, 31), (320, 240), (0, 5)] {
                let picture = scene.render(3, width, height);
                assert_eq!(picture.dimensions(), (width, height));
                assert_eq!(picture, scene.render(3, width, height), "{name} is the same again");
            }
            let moves = scene.render(0, 320, 240) != scene.render(1, 320, 240);
            assert_eq!(moves, !scene.is_still(), "{name}");
            // Far frames do not overflow.
            let _ = scene.render(u64::MAX, 40, 30);
        }
    }

    #[test]
    fn seeds_matter_where_they_say_so() {
        for (name, matters) in [("noise", true), ("demo", true), ("bars", false)] {
            let render = |seed| Scene::named(name, seed).unwrap().render(0, 64, 48);
            assert_eq!(render(1) != render(2), matters, "{name}");
        }
    }

    /// Looked at before they were blessed; a change here is a change of every recorded result.
    #[test]
    fn scenes_are_the_same_bytes_everywhere() {
        let sums = Scene::NAMES.map(|name| {
            let picture = Scene::named(name, 1).unwrap().render(20, 320, 240);
            format!("{name} {:08x}", crate::picture::crc32(picture.as_raw()))
        });
        assert_eq!(
            sums,
            [
                "demo e5f281c0",
                "bars b7fa21f1",
                "checker ba21da95",
                "gradient e833491c",
                "moving cff0d721",
                "noise 51e8c052",
            ]
        );
    }
}
