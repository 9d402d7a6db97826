use std::path::{Path, PathBuf};

use image::RgbImage;
use image::imageops::{FilterType, crop_imm, flip_horizontal_in_place, resize};

use crate::fault::Random;
use crate::picture::{self, PictureError, crc32};
use crate::scene::Scene;

/// Photographs that sensors of a campaign look at, beside the scenes.
#[derive(Clone, Debug, Default)]
pub struct Pictures {
    photographs: Vec<RgbImage>,
    names: Vec<String>,
}

impl Pictures {
    /// All PNG and JPEG files of a folder, in the order of their names.
    ///
    /// # Errors
    /// [`PictureError`] if the folder or a picture in it cannot be read.
    pub fn open(folder: &Path) -> Result<Self, PictureError> {
        let unreadable = |error: std::io::Error| PictureError {
            path: folder.to_owned(),
            what: error.to_string(),
            remedy: "give a folder of PNG or JPEG pictures",
        };
        let mut paths: Vec<PathBuf> = std::fs::read_dir(folder)
            .and_then(|entries| entries.map(|entry| entry.map(|entry| entry.path())).collect())
            .map_err(unreadable)?;
        paths.retain(|path| {
            path.extension().is_some_and(|extension| {
                ["png", "jpg", "jpeg"].iter().any(|known| extension.eq_ignore_ascii_case(known))
            })
        });
        paths.sort();
        let mut pictures = Self::default();
        for path in paths {
            pictures.photographs.push(picture::read(&path)?);
            pictures.names.push(path.file_stem().unwrap_or_default().to_string_lossy().into_owned());
        }
        Ok(pictures)
    }

    /// The checksum of all of them: results of other pictures are not merged with these.
    #[must_use]
    pub fn checksum(&self) -> u32 {
        let each: Vec<u8> =
            self.photographs.iter().flat_map(|picture| crc32(picture.as_raw()).to_le_bytes()).collect();
        crc32(&each)
    }

    /// What the sensor of a faulty case looks at: a part of a photograph, maybe mirrored, or the test card.
    #[must_use]
    pub fn rich(&self, random: &mut Random, width: u32, height: u32) -> (String, Vec<RgbImage>) {
        let which = random.below(self.photographs.len() as u64 + 1) as usize;
        let Some(photograph) = self.photographs.get(which) else {
            let scene = Scene::Demo { seed: random.bits() };
            return (
                "demo".to_owned(),
                (0..FRAMES).map(|frame| scene.render(frame, width, height)).collect(),
            );
        };
        let (full_width, full_height) = photograph.dimensions();
        let percent = random.between(60, 100) as u32;
        let (part_width, part_height) = (full_width * percent / 100, full_height * percent / 100);
        let left = random.below(u64::from(full_width - part_width) + 1) as u32;
        let top = random.below(u64::from(full_height - part_height) + 1) as u32;
        let part = crop_imm(photograph, left, top, part_width, part_height).to_image();
        let mut picture = resize(&part, width, height, FilterType::Triangle);
        if random.below(2) == 1 {
            flip_horizontal_in_place(&mut picture);
        }
        tint(&mut picture, random);
        (self.names[which].clone(), vec![picture; FRAMES as usize])
    }

    /// What a clean case looks at: every scene and every photograph in turn, whole or in part.
    #[must_use]
    pub fn any(&self, turn: u64, random: &mut Random, width: u32, height: u32) -> (String, Vec<RgbImage>) {
        let names = Scene::NAMES;
        let which = (turn % (2 * names.len() as u64)) as usize;
        match names.get(which).and_then(|name| Scene::named(name, random.bits()).ok()) {
            Some(scene) => {
                (scene.name(), (0..FRAMES).map(|frame| scene.render(frame, width, height)).collect())
            }
            None => self.rich(random, width, height),
        }
    }
}

/// Gives a gray photograph colours that change slowly across it, as light and things have them.
///
/// Red and blue are gray times 0.5 to 1.5, in waves of a random direction about as long as the picture.
fn tint(picture: &mut RgbImage, random: &mut Random) {
    let is_gray = picture.pixels().all(|pixel| pixel.0[0] == pixel.0[1] && pixel.0[1] == pixel.0[2]);
    if !is_gray {
        return;
    }
    let (width, height) = (i64::from(picture.width()), i64::from(picture.height()));
    let mut wave = || {
        let (across, down, phase) =
            (random.between(-96, 96), random.between(-96, 96), random.between(0, 255));
        move |x: i64, y: i64| {
            // A triangle from 128 to 384, in 256ths.
            let at = (phase + across * x * 2 / width.max(1) + down * y * 2 / height.max(1)).rem_euclid(256);
            128 + 2 * at.min(256 - at)
        }
    };
    let (red, blue) = (wave(), wave());
    for (x, y, pixel) in picture.enumerate_pixels_mut() {
        let (x, y, gray) = (i64::from(x), i64::from(y), i64::from(pixel.0[1]));
        pixel.0[0] = (gray * red(x, y) / 256).min(255) as u8;
        pixel.0[2] = (gray * blue(x, y) / 256).min(255) as u8;
    }
}

/// Frames a case plays.
pub(super) const FRAMES: u64 = 4;
