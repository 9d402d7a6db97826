//! What the images for Cortex-M are given, and what the host makes of the same: both must come to one result.
//!
//! | module | what lives there |
//! |---|---|
//! | [`pictures`] | the pictures on which every algorithm is exercised |
//! | [`traces`] | the traces of the scenarios |
//! | [`replay`] | what the host makes of a scenario |

pub mod pictures;
pub mod traces;
pub mod replay;

use std::path::Path;

use anyhow::{Context, Result};
use exercise::replay::faults::FAULTS;
use exercise::replay::scenario::{CANNY, FRAMES, PALETTE, SOBEL, STREAM};

/// Writes the files that an image opens into `folder`, where it runs.
///
/// # Errors
/// If a file cannot be read or written.
pub fn write_inputs(folder: &Path) -> Result<()> {
    std::fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    let files = [("gray.raw", pictures::gray()?), ("picture.raw", pictures::colour())];
    for (name, bytes) in files {
        let path = folder.join(name);
        std::fs::write(&path, bytes).with_context(|| format!("cannot write {}", path.display()))?;
    }
    for scenario in [SOBEL, CANNY, PALETTE, FRAMES, STREAM].iter().chain(&FAULTS) {
        traces::write(scenario, folder)?;
    }
    Ok(())
}
