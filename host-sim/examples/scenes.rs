//! Writes every scene's first frames as PNG files, to look at them: `cargo run -p host-sim --example scenes -- DIR`.

use std::path::PathBuf;

use anyhow::Context as _;
use host_sim::picture;
use host_sim::scene::Scene;

fn main() -> anyhow::Result<()> {
    let folder: PathBuf = std::env::args_os().nth(1).context("give a folder to write to")?.into();
    for name in Scene::NAMES {
        let scene = Scene::named(name, 1)?;
        for frame in [0, 20] {
            let path = folder.join(format!("{name}-{frame:04}.png"));
            picture::write_png(&path, &scene.render(frame, 640, 480))?;
            eprintln!("{}", path.display());
        }
    }
    Ok(())
}
