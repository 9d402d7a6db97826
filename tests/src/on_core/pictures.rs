//! The pictures on which every algorithm is exercised: a photograph in gray, and a scene in colour.

use std::path::Path;

use anyhow::{Context, Result};
use exercise::space::{HEIGHT, WIDTH, Workspace};
use host_sim::scene::Scene;

/// The middle of a photograph, 320 × 240.
///
/// # Errors
/// If the photograph cannot be read.
pub fn gray() -> Result<Vec<u8>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/photographs/astronaut.png");
    let photograph =
        image::open(&path).with_context(|| format!("cannot read {}", path.display()))?.into_luma8();
    let (width, height) = (WIDTH as u32, HEIGHT as u32);
    let (x, y) = ((photograph.width() - width) / 2, (photograph.height() - height) / 2);
    Ok(image::imageops::crop_imm(&photograph, x, y, width, height).to_image().into_raw())
}

/// The first frame of the moving scene, 320 × 240, RGB888.
#[must_use]
pub fn colour() -> Vec<u8> {
    Scene::Moving.render(0, WIDTH as u32, HEIGHT as u32).into_raw()
}

/// Puts the pictures into the memory of the exercises.
///
/// # Errors
/// As [`gray`].
pub fn prepare(space: &mut Workspace) -> Result<()> {
    space.gray_mut().copy_from_slice(&gray()?);
    space.picture_mut().copy_from_slice(&colour());
    space.prepare();
    Ok(())
}
